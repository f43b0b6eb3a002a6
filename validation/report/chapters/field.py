"""The chapter of the study `field`: programs by problems on one page, why they fail and what they cannot express."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path

from validation.problems.cause import NOT_EXPLAINED, WOULD_TELL
from validation.report.blocks import Blocks, Heading, Paragraph, Table, TableColumn, table
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, short
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.field.table import (
    FAIL,
    JUDGED,
    MISSING,
    NOT_APPLICABLE,
    NOT_RUN,
    PARTIAL,
    PASS,
    Cell,
    ProgramLine,
    is_absent,
    read,
)
from validation.studies.field.table import FieldTable as Field

NONE = "n. a."
PLACE = re.compile(r" \([^()]*:\d+, in [^()]*\)$")  # of the code that raised an error
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
        return [*opening(manifest), Paragraph("The study was not run by this version; run it again.")]
    return [
        *opening(manifest, results.verdicts(manifest["study"])),
        Paragraph(counted(field)),
        Paragraph(METHOD),
        by_problem(field),
        *_part("Why answers fail", failures(field)),
        *_part("What is not applicable or gave no answer", absent(field)),
        *_part("The programs", programs(field)),
    ]


def counted(field: Field) -> str:
    """Return how many answers pass and fail, and how many failures have a cause, in a sentence."""
    suite = {program.name for program in field.programs if program.kind == "suite"}
    cells = [cell for cell in field.cells.values() if cell.program not in suite]
    names = {cell.program.removesuffix("-default") for cell in cells if cell.verdict in JUDGED}
    if not names:
        return "No other program is installed here: README of examples/peers has a recipe for each."
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


def by_problem(field: Field) -> Table:
    """Return the table of programs by problems."""
    installed = installed_programs(field)
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


def installed_programs(field: Field) -> list[ProgramLine]:
    """Return the programs that are installed; one that gave no answer at all is among them."""
    return [program for program in field.programs if program.installed and not _is_adapter_alone(field, program)]


def _is_adapter_alone(field: Field, program: ProgramLine) -> bool:
    """Whether the adapter of a program is there and the program is not."""
    cells = _cells(field, program)
    return is_absent([(cell.verdict == NOT_APPLICABLE or MISSING in cell.reason, cell.reason) for cell in cells])


def _cells(field: Field, program: ProgramLine) -> list[Cell]:
    return [field.cell(problem.name, program.name) for problem in field.problems]


def _outcomes(field: Field, program: ProgramLine) -> Iterator[str]:
    for cell in _cells(field, program):
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
    times = [cell.seconds for cell in _cells(field, program) if cell.seconds is not None]
    return short(float(f"{sum(times):.2g}"), 2) if times else DASH


def failures(field: Field) -> Table:
    """Return the causes of failures, those of one program with one cause in a line."""
    rows = _lines(field, (FAIL,), lambda cell: cell.cause, _right_until)
    is_unexplained = any(row[-1] == NOT_EXPLAINED for row in rows)
    notes = (UNEXPLAINED_NOTE,) if is_unexplained else ()
    return table(("Program", "Problems", TableColumn("Cause", "fill")), rows, notes=notes)


def _right_until(cell: Cell) -> str:
    """Return in brackets how far an answer is right whose failure is not explained."""
    if cell.cause != NOT_EXPLAINED or cell.within is None:
        return ""
    return f" ({short(float(f'{cell.within:.3g}'))} s)"


def absent(field: Field) -> Table:
    """Return why problems are not applicable or have no answer, those of one program with one reason in a line."""
    rows = _lines(field, (NOT_APPLICABLE, NOT_RUN), _reason)
    return table(("Program", "Problems", TableColumn("Reason", "fill")), rows)


def _reason(cell: Cell) -> str:
    """Return why a problem has no verdict."""
    reason = PLACE.sub("", cell.reason.removeprefix("the solver says that it is not made for this scene: "))
    return f"no answer: {reason}" if cell.verdict == NOT_RUN else reason


def _lines(
    field: Field,
    verdicts: Collection[str],
    text_of: Callable[[Cell], str],
    remark: Callable[[Cell], str] = lambda cell: "",
) -> list[tuple[str, str, str]]:
    """Return of each program a line for each text, with the problems of these verdicts that it applies to."""
    lines = []
    for program in installed_programs(field):
        problems_by_text: dict[str, list[str]] = {}
        for cell in _cells(field, program):
            if cell.verdict in verdicts:
                problems_by_text.setdefault(text_of(cell), []).append(cell.problem + remark(cell))
        title = program.title
        for text, problems in problems_by_text.items():
            names = "all" if len(problems) == len(field.problems) > 1 else ", ".join(problems)
            lines.append((title, names, text))
            title = ""
    return lines


def programs(field: Field) -> Table:
    """Return what each program says of itself."""
    rows: list[tuple[str, str, str, str]] = []
    previous: Mapping[str, str] = {}
    for program in installed_programs(field):
        about = program.about
        version = about.get("version", "")
        model = about.get("model", "")
        if about.get("program", "") != "" and about["program"] == previous.get("program"):
            version = ""
            if model == previous.get("model"):
                model = "the same"
        rows.append((program.title, version, model, about.get("settings", "")))
        previous = about
    return table(("Program", "Version", TableColumn("Model", "fill"), TableColumn("Settings", "fill")), rows)
