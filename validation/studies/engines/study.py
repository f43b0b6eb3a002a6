"""The study `engines`: problems of rigid boxes by programs; every cell PASS, PARTIAL, FAIL, NOT RUN or not applicable.

A program's FAIL is a finding and no gate. The gates are on this suite's side: the exact motions pass what they answer,
which says that the measures measure; a program that is installed answers a problem at least; and a program whose
integrator is known falls as that integrator does, which says that its adapter states the problem rightly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from validation.engine.finished import Derived, Finished, NothingToDerive
from validation.gates.gate import Gate
from validation.problems.boxes import ASKS, PREFIX, box_problems
from validation.runs.records import Annotations
from validation.runs.row import Value
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.studies.declaration import Study
from validation.studies.engines import cells, predictions
from validation.studies.engines.cells import BESIDE, case_scenes, curve_scenes
from validation.studies.engines.programs import BoxProgram, about, box_programs
from validation.studies.engines.table import STUDY
from validation.studies.field.table import is_absent

ENDS = tuple(o for o in Outcome if o not in (Outcome.COMPLETED, Outcome.NOT_RUN, Outcome.NOT_APPLICABLE))
ANSWERED = "problems answered"


def gates() -> Iterator[Gate]:
    """Yield the gates on this suite's own answers, and that programs which are there answer."""
    for name in box_problems():
        why = "it is the exact motion; what is left is what measuring at the rows adds"
        yield Gate(PREFIX + name, (cells.EXACT_CELL,), BESIDE, 0.0, cells.SETTLED, why)
    yield from predictions.gates()
    for program in box_programs():
        if program.kind in ("chosen", "default"):
            why = "a program that is installed answers a problem at least; there are no more than all"
            yield Gate(STUDY, (program.name,), ANSWERED, 1.0, float(len(box_problems())), why)


def derived() -> Iterator[Derived]:
    """Yield the cells, and how many problems each program answers."""
    yield from cells.derived()
    yield from predictions.derived()
    for program in box_programs():
        if program.kind in ("chosen", "default"):
            yield Derived(STUDY, program.name, (), _answered(program))


def _answered(program: BoxProgram) -> Callable[[Finished], Mapping[str, Value]]:
    def compute(finished: Finished) -> Mapping[str, Value]:
        own_scenes = [case_scenes(name)[0][1].name for name in box_problems()]
        rows = [finished.rows.get((scene, program.name)) for scene in own_scenes]
        present = [row for row in rows if row is not None]
        endings = [(row.outcome is Outcome.NOT_APPLICABLE, "; ".join(row.notes)) for row in present]
        if not present or is_absent(endings):
            raise NothingToDerive(f"not installed: {program.recipe}")
        return {ANSWERED: float(sum(row.outcome is Outcome.COMPLETED for row in present))}

    return compute


def data() -> Mapping[str, Any]:
    """Return the rows and columns of the table, and which cases each problem has."""
    problems = []
    cases = {}
    curves = {}
    for name, problem in box_problems().items():
        title = problem.scene().title
        problems.append({"name": name, "scene": PREFIX + name, "title": title, "asks": ASKS[name]})
        cases[name] = [scene.name for _, scene in case_scenes(name)]
        curves[name] = [scene.name for scene in curve_scenes(name)]
    return {
        "problems": problems,
        "cases": cases,
        "curves": curves,
        "programs": [_program(program) for program in box_programs()],
    }


def _program(program: BoxProgram) -> dict[str, Any]:
    names = ("name", "title", "recipe", "kind", "family", "installed")
    return {name: getattr(program, name) for name in names} | {"about": about(program)}


def nothing(scenes: Sequence[Scene], finished: Finished) -> Annotations:
    """Return no alarms and no budgets: what a program does is what its cells say."""
    return {"alarms": [], "budgets": []}


def study() -> Study:
    """Return the study over the programs that are installed now."""
    return Study(
        name=STUDY,
        title="The field of contact engines",
        purpose="Contact engines on rigid boxes: who stands still, who bounces, who gains energy, at what price.",
        scenes=list(cells.scenes()),
        gates=lambda: tuple(gates()),
        derived=lambda: tuple(derived()),
        data=data,
        measures=(),
        pairs=(),
        annotate=nothing,
        expects=ENDS,
        long=True,
    )
