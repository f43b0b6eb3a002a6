"""The chapter of the study `field`: programs by problems on one page, why they fail and what they cannot express."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from validation.problems.cause import NOT_EXPLAINED, WOULD_TELL
from validation.report.blocks import Blocks, Heading, Paragraph, Table, TableColumn, table
from validation.report.chapters.scene import opening
from validation.runs.numbers import DASH, short, significant
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.field.marks import (
    NONE,
    NONE_INSTALLED,
    NOT_THIS_VERSION,
    about_rows,
    absent_of,
    cells_of,
    installed_of,
    lines_of,
)
from validation.studies.field.table import (
    FAIL,
    JUDGED,
    NOT_APPLICABLE,
    NOT_RUN,
    PARTIAL,
    PASS,
    Cell,
    ProgramLine,
    read,
)
from validation.studies.field.table import FieldTable as Field

METHOD = (
    "Each problem has an exact motion. An answer passes where its relative L2 error is below what one per cent of the "
    "problem's data changes; the row of what is allowed states it. Each program runs with parameters chosen for "
    "accuracy and, below, with its defaults. What it cannot express is not applicable, and is not forced to fit."
)
NOTE = (
    "Relative L2 error in per cent of the column that is worst relative to its band; PARTIAL: the columns that are "
    "reported pass, others that the problem asks for are withheld; n. a.: not applicable; a dash: no "
    "answer; the reasons are given below. Time: of all answers together, with the start of the program, on this "
    "machine."
)
UNEXPLAINED_NOTE = (
    "In brackets: the time up to which the error of an answer without a certain cause is within what is allowed. What "
    f"would tell the cause: {WOULD_TELL}."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: the table, the causes of failures, what has no verdict, the programs."""
    field = read(results)
    if field is None:
        return [*opening(manifest), Paragraph(NOT_THIS_VERSION)]
    installed = installed_of(field, field.programs)
    return [
        *opening(manifest, results.verdicts(manifest["study"])),
        Paragraph(counted(field)),
        Paragraph(METHOD),
        by_problem(field, installed),
        *_part("Why answers fail", failures(field, installed)),
        *_part("What is not applicable or gave no answer", absent_of(field, installed)),
        *_part("The programs", programs(installed)),
    ]


def counted(field: Field) -> str:
    """Return how many answers pass and fail, and how many failures have a cause, in a sentence."""
    suite = {program.name for program in field.programs if program.kind == "suite"}
    cells = [cell for cell in field.cells.values() if cell.program not in suite]
    names = {cell.program.removesuffix("-default") for cell in cells if cell.verdict in JUDGED}
    if not names:
        return NONE_INSTALLED
    verdicts = [cell.verdict for cell in cells]
    passed = verdicts.count(PASS)
    partial = verdicts.count(PARTIAL)
    failed = verdicts.count(FAIL)
    explained = sum(cell.verdict == FAIL and not cell.cause.startswith(NOT_EXPLAINED) for cell in cells)
    in_part = f" and {partial} in part (a column is withheld)" if partial else ""
    return (
        f"Other programs: {len(names)}, with {passed + partial + failed} answers to {len(field.problems)} problems. "
        f"Of these {passed} pass{in_part} and {failed} fail, {explained} of them with a cause that is certain."
    )


def _part(title: str, table: Table) -> Blocks:
    return [Heading(title, 3), table] if table.rows else []


def by_problem(field: Field, installed: Sequence[ProgramLine]) -> Table:
    """Return the table of programs by problems."""
    rows = [("allowed [%]", *(allowed(field, problem.name) for problem in field.problems), "")]
    rows += [(program.title, *_outcomes(field, program), seconds(field, program)) for program in installed]
    notes = [NOTE]
    missing = [program.title for program in field.programs if program not in installed]
    if missing:
        notes.append(f"Not installed: {', '.join(missing)}.")
    return table(
        ("Program", *(TableColumn(problem.name, "outcome") for problem in field.problems), "Time [s]"),
        rows,
        "Programs and problems.",
        tuple(notes),
    )


def _outcomes(field: Field, program: ProgramLine) -> Iterator[str]:
    for cell in cells_of(field, program):
        if cell.verdict == NOT_RUN:
            yield DASH
        elif cell.verdict in JUDGED:
            yield f"{cell.verdict} {error(cell)}".rstrip()
        else:
            yield NONE if cell.verdict == NOT_APPLICABLE else cell.verdict


def error(cell: Cell) -> str:
    """Return the error of a cell in per cent, nothing where a run itself reports that it is wrong."""
    if cell.error is None:
        return ""
    if cell.error > 10:
        return "> 1000"
    return "< 0.001" if cell.error < 1e-5 else short(100 * cell.error, 2)


def allowed(field: Field, problem: str) -> str:
    """Return the band of a problem in per cent: of the column that decides most often."""
    bands = [cell.band for cell in field.row(problem) if cell.band is not None]
    return short(100 * max(set(bands), key=bands.count), 2) if bands else DASH


def seconds(field: Field, program: ProgramLine) -> str:
    """Return what the answers of a program took together [s], to two digits."""
    times = [cell.seconds for cell in cells_of(field, program) if cell.seconds is not None]
    return short(significant(sum(times), 2), 2) if times else DASH


def failures(field: Field, installed: Sequence[ProgramLine]) -> Table:
    """Return the causes of failures, those of one program with one cause in a line."""
    rows = lines_of(field, installed, (FAIL,), lambda cell: cell.cause, _right_until)
    is_unexplained = any(row[-1] == NOT_EXPLAINED for row in rows)
    notes = (UNEXPLAINED_NOTE,) if is_unexplained else ()
    return table(("Program", "Problems", TableColumn("Cause", "fill")), rows, notes=notes)


def _right_until(cell: Cell) -> str:
    """Return in brackets how far an answer is right whose failure is not explained."""
    if cell.cause != NOT_EXPLAINED or cell.within is None:
        return ""
    return f" ({short(significant(cell.within, 3))} s)"


def programs(installed: Sequence[ProgramLine]) -> Table:
    """Return what each program says of itself."""
    rows = [row for _, _, row in about_rows(installed)]
    return table(("Program", "Version", TableColumn("Model", "fill"), TableColumn("Settings", "fill")), rows)
