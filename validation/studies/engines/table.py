"""The field of contact engines as a table, read from a results directory; no solver is called."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from validation.runs.results import Results
from validation.runs.row import Row, Value
from validation.runs.run import Outcome
from validation.studies.field.table import (
    MISSING,
    NOT_APPLICABLE,
    NOT_RUN,
    ProblemLine,
    ProgramLine,
    Table,
    is_absent,
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
    manifest = results.manifest(STUDY)
    data = manifest.get("data", {})
    if "programs" not in data:
        return None
    problems = tuple(ProblemLine(**line) for line in data["problems"])
    programs = tuple(ProgramLine(**line) for line in data["programs"])
    rows = results.rows()
    row_by_case: dict[tuple[str, str], Row] = {}
    for case in manifest.get("cases", []):
        if case["key"] in rows:
            row_by_case[case["scene"], case["solver"]] = rows[case["key"]]

    def seconds_of(scene: str, program: str) -> float | None:
        row = row_by_case.get((scene, program))
        return sum(row.seconds.values()) if row is not None and row.outcome is Outcome.COMPLETED else None

    metrics_by_cell = {(row["scene"], row["name"]): row["metrics"] for row in manifest.get("derived", [])}
    cells = {}
    for program in programs:
        program_rows = [row for (_, solver), row in row_by_case.items() if solver == program.name]
        endings = [(row.outcome is Outcome.NOT_APPLICABLE, " ".join(row.notes)) for row in program_rows]
        absent = not program.installed or is_absent(endings)
        for problem in problems:
            metrics = metrics_by_cell.get((problem.scene, f"judged {program.name}"), {})
            if absent:
                reason = f"not installed: {program.recipe}"
                cell = EngineCell(problem.name, program.name, NOT_RUN, NOT_RUN, reason=reason)
            elif metrics:
                curve = [seconds_of(name, program.name) for name in data["curves"][problem.name]]
                own_seconds = seconds_of(data["cases"][problem.name][0], program.name)
                cell = _judged(problem.name, program.name, metrics, own_seconds, curve)
            else:
                own_rows = [row_by_case.get((name, program.name)) for name in data["cases"][problem.name]]
                cell = _unanswered(problem.name, program.name, [row for row in own_rows if row is not None])
            cells[problem.name, program.name] = cell
    return Table(problems, programs, cells)


def _judged(
    problem: str, program: str, metrics: Mapping[str, Value], seconds: float | None, curve: Sequence[float | None]
) -> EngineCell:
    """Return the cell of a derived row; seconds are those of the runs, of the problem's own case and of its curve."""
    quantities = []
    for entry in _numbered(metrics, "number"):
        band = (_number(entry["low"]) or 0.0, _number(entry["high"]) or 0.0)
        name = str(entry["name"])
        unit = str(entry["unit"])
        label = str(entry["case"] or "")
        exact = _number(entry["exact"]) or 0.0
        reason = str(entry["reason"] or "")
        quantities.append(Quantity(name, unit, label, _number(entry["value"]), exact, band, str(entry["word"]), reason))
    points = []
    for entry in _numbered(metrics, "point"):
        counts = [int(_number(entry[name]) or 0) for name in ("refine", "steps")]
        step = _number(entry["step"]) or math.nan
        points.append(
            WorkPoint(counts[0], step, counts[1], curve[counts[0]], _number(entry["error"]), str(entry["outcome"]))
        )
    texts_of_cell = {name: str(metrics.get(name) or "") for name in ("verdict", "says", "finding", "reason")}
    return EngineCell(
        problem,
        program,
        **texts_of_cell,
        error=_number(metrics.get("error over band")),
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


def _unanswered(problem: str, program: str, rows: Sequence[Row]) -> EngineCell:
    """Return the cell of a problem of which no case was answered."""
    if not rows:
        return EngineCell(problem, program, NOT_RUN, NOT_RUN, reason="was not run")
    row = rows[0]
    note = row.notes[-1] if row.notes else row.outcome.sentence
    absent = row.outcome is not Outcome.NOT_APPLICABLE or MISSING in note
    word = NOT_RUN if absent else NOT_APPLICABLE
    return EngineCell(problem, program, word, word, reason=note)


def _number(value: Value) -> float | None:
    return float(value) if isinstance(value, int | float) else None
