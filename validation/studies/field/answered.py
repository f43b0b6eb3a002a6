"""Whether a program answers at all: one that is installed answers a problem at least."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from validation.engine.finished import Derived, Finished, NothingToDerive
from validation.gates.gate import Gate
from validation.runs.row import Value
from validation.runs.run import Outcome
from validation.studies.field.table import is_absent
from validation.suite.programs import Program

ANSWERED = "problems answered"
# How the run of a program may end that answers wrongly: a finding, and no failure of the study.
ENDS = tuple(o for o in Outcome if o not in (Outcome.COMPLETED, Outcome.NOT_RUN, Outcome.NOT_APPLICABLE))


def rows(study: str, programs: Sequence[Program], scenes: Sequence[str]) -> Iterator[Derived]:
    """Yield how many problems each program answers, by the scenes of the problems."""
    for program in programs:
        yield Derived(study, program.name, (), answered(program, scenes))


def answered(program: Program, scenes: Sequence[str]) -> Callable[[Finished], Mapping[str, Value]]:
    """Return the function that counts the problems that a program answers."""

    def compute(finished: Finished) -> Mapping[str, Value]:
        answers = [finished.rows.get((scene, program.name)) for scene in scenes]
        present = [row for row in answers if row is not None]
        endings = [(row.outcome is Outcome.NOT_APPLICABLE, "; ".join(row.notes)) for row in present]
        if not present or is_absent(endings):
            raise NothingToDerive(f"not installed: {program.recipe}")
        return {ANSWERED: float(sum(row.outcome is Outcome.COMPLETED for row in present))}

    return compute


def gates(study: str, programs: Sequence[Program], problems: int) -> Iterator[Gate]:
    """Yield the gates on programs that are there."""
    for program in programs:
        why = "a program that is installed answers a problem at least; there are no more than all"
        yield Gate(study, (program.name,), ANSWERED, 1.0, float(problems), why)
