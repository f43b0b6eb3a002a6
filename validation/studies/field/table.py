"""The field as a table, read from a results directory; no solver is called.

The study `field` keeps a derived row for each cell that a run completed, the rows of the runs, and in its data the
programs and the problems. `read` puts them together.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from validation.runs.results import Results
from validation.runs.row import Row, Value
from validation.runs.run import Outcome

STUDY = "field"
BESIDE = "error over band"
PASS = "PASS"
PARTIAL = "PARTIAL"
FAIL = "FAIL"
NOT_RUN = "NOT RUN"
NOT_APPLICABLE = "not applicable"
JUDGED = (PASS, PARTIAL, FAIL)
# A run that ends so has told that it is wrong; every other end says nothing of the program's mechanics.
WRONG = (Outcome.WRONG_UNITS, Outcome.NOT_A_NUMBER, Outcome.OVERFLOW, Outcome.UNSTABLE)
MISSING = "is not installed"  # what an adapter says where its program is absent


def cell_name(program: str) -> str:
    """Return the name of the derived row that is a program's cell."""
    return f"judged {program}"


def is_absent(endings: Collection[tuple[bool, str]]) -> bool:
    """Whether the runs of a program say that it is not there.

    An adapter may refuse a problem before it looks for its program: what it refuses so says nothing about that.

    Parameters
    ----------
    endings
        Of each problem, whether the run ended without an answer that the program itself gave (not applicable, or the
        program missing), and what it said.
    """
    return any(MISSING in reason for _, reason in endings) and all(refused for refused, _ in endings)


@dataclass(frozen=True)
class ColumnCell:
    """A column of a cell."""

    name: str
    word: str  # PASS, FAIL, "not reported" or "not judged"
    error: float | None  # relative L2 [1]
    band: float | None  # upper edge [1]
    until: float  # s
    reason: str  # why the band ends there


@dataclass(frozen=True)
class Number:
    """A number that people understand, of the program and of the exact motion."""

    name: str
    unit: str
    value: float | None
    exact: float | None


@dataclass(frozen=True)
class Cell:
    """A program's answer to a problem.

    Attributes
    ----------
    problem, program
        Row and column of the table.
    verdict
        PASS, PARTIAL (a column that the problem asks for is withheld), FAIL, NOT RUN, not applicable or not judged.
    says
        The verdict in full: what it does not speak of is named.
    cause
        Of a FAIL, in one line: "not explained" where nothing is known for certain.
    column
        The column whose error is largest beside its band; `error` and `band` are its.
    error, band
        Relative L2 error, and the upper edge of its band [1].
    within
        Instant up to which its error is within what is allowed [s].
    seconds
        Of the run; None where it did not complete.
    reason
        Why the band ends there; why there is no PASS or FAIL.
    columns, numbers
        Every column, and what is told beside.
    key
        Of the row of the run, for `Results.history`.
    """

    problem: str
    program: str
    verdict: str
    says: str = ""
    cause: str = ""
    column: str = ""
    error: float | None = None
    band: float | None = None
    within: float | None = None
    seconds: float | None = None
    reason: str = ""
    columns: tuple[ColumnCell, ...] = ()
    numbers: tuple[Number, ...] = ()
    key: str = ""


@dataclass(frozen=True)
class ProblemLine:
    """A row of the table."""

    name: str
    scene: str  # name of the case
    title: str
    asks: str


@dataclass(frozen=True)
class ProgramLine:
    """A column of the table; `about` is what the program says of itself (program, version, recipe, model, settings)."""

    name: str
    title: str
    recipe: str
    kind: str  # "suite", "chosen" (for accuracy), "default" (as it comes) or "user"
    installed: bool
    about: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class FieldTable:
    """A field: every problem has a cell for every program."""

    problems: tuple[ProblemLine, ...]
    programs: tuple[ProgramLine, ...]
    cells: Mapping[tuple[str, str], Cell]  # by names of problem and program

    def cell(self, problem: str, program: str) -> Cell:
        """Return a cell.

        Raises
        ------
        KeyError
            There is no such problem or program.
        """
        return self.cells[problem, program]

    def row(self, problem: str) -> tuple[Cell, ...]:
        """Return the cells of a problem in the order of the programs."""
        return tuple(self.cells[problem, program.name] for program in self.programs)


@dataclass(frozen=True)
class KeptField:
    """What a results directory holds of the field."""

    problems: tuple[ProblemLine, ...]
    programs: tuple[ProgramLine, ...]
    data: Mapping[str, Any]
    rows: Mapping[tuple[str, str], Row]  # by scene and solver
    metrics: Mapping[tuple[str, str], Mapping[str, Value]]  # of derived rows, by scene and name


def kept_field(results: Results) -> KeptField | None:
    """Return what is kept of the field, None where its study was not run.

    Raises
    ------
    InputError
        The results are damaged.
    """
    manifest = results.manifest(STUDY)
    data = manifest.get("data", {})
    if "programs" not in data:
        return None
    rows = results.rows()
    cases = [case for case in manifest.get("cases", []) if case["key"] in rows]
    return KeptField(
        tuple(ProblemLine(**line) for line in data["problems"]),
        tuple(ProgramLine(**line) for line in data["programs"]),
        data,
        {(case["scene"], case["solver"]): rows[case["key"]] for case in cases},
        {(row["scene"], row["name"]): row["metrics"] for row in manifest.get("derived", [])},
    )


def read(results: Results) -> FieldTable | None:
    """Return the field of a results directory, None where the study was not run.

    Raises
    ------
    InputError
        The results are damaged.
    """
    kept = kept_field(results)
    if kept is None:
        return None
    cells = {}
    for problem, program in itertools.product(kept.problems, kept.programs):
        case, name = kept.data["runs"].get(f"{problem.name} {program.name}", (("", ""), ""))
        metrics = kept.metrics.get((problem.scene, name), {})
        cells[problem.name, program.name] = _cell(problem, program, kept.rows.get(tuple(case)), metrics)
    return FieldTable(kept.problems, kept.programs, cells)


def _cell(problem: ProblemLine, program: ProgramLine, row: Row | None, metrics: Mapping[str, Value]) -> Cell:
    if not program.installed:
        return Cell(problem.name, program.name, NOT_RUN, NOT_RUN, reason=f"not installed: {program.recipe}")
    if row is None:
        why = "takes too long here" if program.kind == "suite" else "was not run"
        return Cell(problem.name, program.name, NOT_RUN, NOT_RUN, reason=why)
    if row.outcome is not Outcome.COMPLETED or not metrics:
        return _ended(problem, program, row)
    texts = {name: str(metrics.get(name) or "") for name in ("verdict", "says", "cause", "column", "reason")}
    return Cell(
        problem.name,
        program.name,
        **texts,
        error=number(metrics.get("error")),
        band=number(metrics.get("band")),
        within=number(metrics.get("within")),
        seconds=sum(row.seconds.values()) if row.seconds else None,
        columns=_columns(metrics),
        numbers=_numbers(metrics),
        key=row.key,
    )


def _ended(problem: ProblemLine, program: ProgramLine, row: Row) -> Cell:
    """Return the cell of a run that did not complete, or that could not be judged."""
    word, note = unanswered(row)
    if row.outcome in WRONG:
        sentence = row.outcome.sentence[0].lower() + row.outcome.sentence[1:].rstrip(".")
        why = note if row.outcome is Outcome.WRONG_UNITS else f"{sentence} ({note})"
        return Cell(problem.name, program.name, FAIL, FAIL, cause=why, reason=row.outcome.sentence, key=row.key)
    return Cell(problem.name, program.name, word, word, reason=note, key=row.key)


def last_note(row: Row) -> str:
    """Return what a run said at its end."""
    return row.notes[-1] if row.notes else row.outcome.sentence


def unanswered(row: Row) -> tuple[str, str]:
    """Return NOT RUN or not applicable for a run without an answer, and why."""
    note = last_note(row)
    absent = row.outcome is not Outcome.NOT_APPLICABLE or MISSING in note
    return NOT_RUN if absent else NOT_APPLICABLE, note


def _columns(metrics: Mapping[str, Value]) -> tuple[ColumnCell, ...]:
    names = [key.removesuffix(": word") for key in metrics if key.endswith(": word")]
    return tuple(
        ColumnCell(
            name,
            str(metrics[f"{name}: word"]),
            number(metrics.get(f"{name}: error")),
            number(metrics.get(f"{name}: band")),
            number(metrics.get(f"{name}: until")) or 0.0,
            str(metrics.get(f"{name}: reason") or ""),
        )
        for name in names
    )


def _numbers(metrics: Mapping[str, Value]) -> tuple[Number, ...]:
    numbers = []
    for key in metrics:
        if key.startswith("told value: "):
            name = key.removeprefix("told value: ")
            quantity, _, unit = name.rpartition(" [")
            exact = number(metrics.get(f"told exact: {name}"))
            numbers.append(Number(quantity, unit.removesuffix("]"), number(metrics[key]), exact))
    return tuple(numbers)


def number(value: Any) -> float | None:
    """Return a metric that is a number, or None."""
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None
