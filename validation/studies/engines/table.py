"""The field of contact engines as a table, read from a results directory; no solver is called."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from validation.runs.results import Results
from validation.runs.row import Row, Value
from validation.runs.run import Outcome
from validation.studies.field.table import (
    BESIDE,
    NOT_RUN,
    KeptField,
    ProblemLine,
    ProgramLine,
    Table,
    cell_name,
    is_absent,
    kept_field,
    number,
    unanswered,
)

STUDY = "engines"


@dataclass(frozen=True)
class Quantity:
    """A number of an answer, and what it is judged by.

    Attributes
    ----------
    name, unit
        What is measured, such as ``"creep"`` in ``"mm/s"``.
    case
        The values of the problem's sweep that it belongs to, in words; empty where there is one case.
    value
        Of the program; None where it cannot be measured on the answer.
    exact
        The exact value.
    band
        Lower and upper edge of what passes.
    word
        PASS, FAIL or "not reported".
    reason
        Why the band ends there.
    """

    name: str
    unit: str
    case: str
    value: float | None
    exact: float
    band: tuple[float, float]
    word: str
    reason: str


@dataclass(frozen=True)
class WorkPoint:
    """A run of a curve of error over cost: the program's step halved `refine` times.

    The error is the largest of the problem's errors, each over the half-width of its band; 1 is just allowed.
    """

    refine: int
    step: float  # the program's own [s]
    steps: int
    seconds: float | None
    error: float | None  # None where the run did not complete
    outcome: str


@dataclass(frozen=True)
class EngineCell:
    """A program's answer to a problem.

    Attributes
    ----------
    problem, program
        Row and column.
    verdict
        PASS, PARTIAL, FAIL, NOT RUN, not applicable or not judged.
    says
        What came out, short enough for a table: ``"creeps 48 mm/s"``, ``"stands from 0.2 deg on"``.
    finding
        What its curve shows, in a sentence: "the error halves with the step", "does not shrink with the step".
    error
        Of the quantity that is furthest from its exact value beside its band: the error over the band; 1 is just
        allowed.
    seconds
        Of the run; None where it did not complete.
    reason
        Why there is no PASS or FAIL.
    quantities
        Every quantity of every case.
    points
        The curve of error over cost, coarsest first; empty where the problem has none.
    """

    problem: str
    program: str
    verdict: str
    says: str = ""
    finding: str = ""
    error: float | None = None
    seconds: float | None = None
    reason: str = ""
    quantities: tuple[Quantity, ...] = ()
    points: tuple[WorkPoint, ...] = ()


EngineTable = Table[EngineCell]


def read(results: Results) -> EngineTable | None:
    """Return the field of engines of a results directory, None where the study was not run.

    Raises
    ------
    InputError
        The results are damaged.
    """
    kept = kept_field(results, STUDY)
    if kept is None:
        return None
    cells = {}
    for program in kept.programs:
        own_rows = [row for (_, solver), row in kept.rows.items() if solver == program.name]
        endings = [(row.outcome is Outcome.NOT_APPLICABLE, " ".join(row.notes)) for row in own_rows]
        absent = not program.installed or is_absent(endings)
        for problem in kept.problems:
            cell = EngineCell(problem.name, program.name, NOT_RUN, NOT_RUN, reason=f"not installed: {program.recipe}")
            if not absent:
                cell = _cell(problem, program, kept)
            cells[problem.name, program.name] = cell
    return Table(kept.problems, kept.programs, cells)


def _cell(problem: ProblemLine, program: ProgramLine, kept: KeptField) -> EngineCell:
    metrics = kept.metrics.get((problem.scene, cell_name(program.name)))
    cases = [kept.rows.get((name, program.name)) for name in kept.data["cases"][problem.name]]
    if metrics:
        curve = [kept.rows.get((name, program.name)) for name in kept.data["curves"][problem.name]]
        return _judged(problem.name, program.name, metrics, _seconds(cases[0]), [_seconds(row) for row in curve])
    word, note = next((unanswered(row) for row in cases if row is not None), (NOT_RUN, "was not run"))
    return EngineCell(problem.name, program.name, word, word, reason=note)


def _seconds(row: Row | None) -> float | None:
    return sum(row.seconds.values()) if row is not None and row.outcome is Outcome.COMPLETED else None


def _judged(
    problem: str, program: str, metrics: Mapping[str, Value], seconds: float | None, curve: Sequence[float | None]
) -> EngineCell:
    """Return the cell of a derived row; seconds are those of the runs, of the problem's own case and of its curve."""
    quantities = []
    for entry in _numbered(metrics, "number"):
        texts = {name: str(entry[name] or "") for name in ("name", "unit", "case", "word", "reason")}
        exact, low, high = (number(entry[name]) or 0.0 for name in ("exact", "low", "high"))
        quantities.append(Quantity(value=number(entry["value"]), exact=exact, band=(low, high), **texts))
    points = []
    for entry in _numbered(metrics, "point"):
        refine, steps = (int(number(entry[name]) or 0) for name in ("refine", "steps"))
        step = number(entry["step"]) or math.nan
        outcome = str(entry["outcome"])
        points.append(WorkPoint(refine, step, steps, curve[refine], number(entry["error"]), outcome))
    texts_of_cell = {name: str(metrics.get(name) or "") for name in ("verdict", "says", "finding", "reason")}
    return EngineCell(
        problem,
        program,
        **texts_of_cell,
        error=number(metrics.get(BESIDE)),
        seconds=seconds,
        quantities=tuple(quantities),
        points=tuple(points),
    )


def _numbered(metrics: Mapping[str, Value], kind: str) -> list[dict[str, Value]]:
    """Return the metrics ``kind 0: name``, ``kind 1: name``, ... as one mapping for each number."""
    groups: dict[int, dict[str, Value]] = {}
    for key, value in metrics.items():
        head, _, name = key.partition(": ")
        word, _, number = head.partition(" ")
        if word == kind and number.isdigit():
            groups.setdefault(int(number), {})[name] = value
    return [groups[number] for number in sorted(groups)]
