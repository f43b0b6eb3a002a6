"""The chapter of the study `field`: programs by problems on one page, why they fail and what they cannot express."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from validation.problems.cause import NOT_EXPLAINED, WOULD_TELL
from validation.report.blocks import Block, Column, Heading, Paragraph, Table
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
from validation.studies.field.table import Table as Field

NONE = "n. a."
PLACE = re.compile(r" \([^()]*:\d+, in [^()]*\)$")  # of the code that raised an error
SAID = (
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
SILENT = (
    "In brackets: the time up to which the error of an answer without a certain cause is within what is allowed. What "
    f"would tell the cause: {WOULD_TELL}."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter: the table, the causes of failures, what has no verdict, the programs."""
    found = read(results)
    if found is None:
        return [*opening(manifest), Paragraph("The study was not run by this version; run it again.")]
    return [
        *opening(manifest, results.verdicts(manifest["study"])),
        Paragraph(counted(found)),
        Paragraph(SAID),
        by_problem(found),
        *_part("Why answers fail", failures(found)),
        *_part("What is not applicable or gave no answer", absent(found)),
        *_part("The programs", programs(found)),
    ]


def counted(found: Field) -> str:
    """Return how many answers pass and fail, and how many failures have a cause, in a sentence."""
    others = [cell for cell in found.cells.values() if _kind(found, cell) != "suite"]
    words = [cell.verdict for cell in others]
    failed = [cell for cell in others if cell.verdict == FAIL]
    named = sum(not cell.cause.startswith(NOT_EXPLAINED) for cell in failed)
    there = {cell.program.removesuffix("-default") for cell in others if cell.verdict in JUDGED}
    if not there:
        return "No other program is installed here: README of examples/peers has a recipe for each."
    passed = words.count(PASS)
    partial = words.count(PARTIAL)
    failing = words.count(FAIL)
    in_part = f" and {partial} in part (a column is withheld)" if partial else ""
    return (
        f"Other programs: {len(there)}, with {passed + partial + failing} answers to {len(found.problems)} problems. "
        f"Of these {passed} pass{in_part} and {failing} fail, {named} of them with a cause that is certain."
    )


def _kind(found: Field, cell: Cell) -> str:
    return next(program.kind for program in found.programs if program.name == cell.program)


def _part(title: str, table: Table) -> list[Block]:
    return [Heading(title, 3), table] if table.rows else []


def by_problem(found: Field) -> Table:
    """Return the table of programs by problems."""
    titles = (
        Column("Program"),
        *(Column(problem.name, "outcome") for problem in found.problems),
        Column("Time [s]", "decimal"),
    )
    rows = [("allowed [%]", *(allowed(found, problem.name) for problem in found.problems), "")]
    rows += [(program.title, *_outcomes(found, program), seconds(found, program)) for program in shown(found)]
    away = [program.title for program in found.programs if program not in shown(found)]
    notes = (NOTE, *([f"Not installed: {', '.join(away)}."] if away else []))
    return Table(titles, tuple(rows), "Programs and problems.", notes)


def shown(found: Field) -> list[ProgramLine]:
    """Return the programs that are installed; one that gave no answer at all is among them."""
    return [program for program in found.programs if program.installed and not _is_away(found, program)]


def _is_away(found: Field, program: ProgramLine) -> bool:
    """Whether the adapter of a program is there and the program is not."""
    cells = _cells(found, program)
    return is_absent([(cell.verdict == NOT_APPLICABLE or MISSING in cell.reason, cell.reason) for cell in cells])


def _cells(found: Field, program: ProgramLine) -> list[Cell]:
    return [found.cell(problem.name, program.name) for problem in found.problems]


def _outcomes(found: Field, program: ProgramLine) -> Iterator[str]:
    for cell in _cells(found, program):
        if cell.verdict == NOT_RUN:
            yield DASH
        elif cell.verdict in JUDGED:
            yield f"{cell.verdict} {error(cell)}".rstrip()
        else:
            yield NONE if cell.verdict == NOT_APPLICABLE else cell.verdict


def error(cell: Cell) -> str:
    """Return the error of a cell in per cent, nothing where a run told itself that it is wrong."""
    if cell.error is None:
        return ""
    if cell.error > 10:
        return "> 1000"
    return "< 0.001" if cell.error < 1e-5 else short(100 * cell.error, 2)


def allowed(found: Field, problem: str) -> str:
    """Return the band of a problem in per cent: of the column that decides most often."""
    bands = [cell.band for cell in found.row(problem) if cell.band is not None]
    return short(100 * max(set(bands), key=bands.count), 2) if bands else DASH


def seconds(found: Field, program: ProgramLine) -> str:
    """Return what the answers of a program took together [s], to two digits."""
    took = [cell.seconds for cell in _cells(found, program) if cell.seconds is not None]
    return short(float(f"{sum(took):.2g}"), 2) if took else DASH


def failures(found: Field) -> Table:
    """Return the causes of failures, those of one program with one cause in a line."""
    titles = (Column("Program"), Column("Problems"), Column("Cause", "fill"))
    rows = []
    for program in shown(found):
        by_cause: dict[str, list[str]] = {}
        for cell in _cells(found, program):
            if cell.verdict == FAIL:
                by_cause.setdefault(cell.cause, []).append(cell.problem + _so_far(cell))
        rows += _lines(found, program, by_cause)
    return Table(titles, tuple(rows), notes=(SILENT,) if any(row[-1] == NOT_EXPLAINED for row in rows) else ())


def _so_far(cell: Cell) -> str:
    """Return in brackets how far an answer is right whose failure is not explained."""
    if cell.cause != NOT_EXPLAINED or cell.within is None:
        return ""
    return f" ({short(float(f'{cell.within:.3g}'))} s)"


def absent(found: Field) -> Table:
    """Return why problems are not applicable or have no answer, those of one program with one reason in a line."""
    titles = (Column("Program"), Column("Problems"), Column("Reason", "fill"))
    rows = []
    for program in shown(found):
        by_reason: dict[str, list[str]] = {}
        for cell in _cells(found, program):
            if cell.verdict in (NOT_APPLICABLE, NOT_RUN):
                reason = PLACE.sub("", cell.reason.removeprefix("the solver says that it is not made for this scene: "))
                told = reason if cell.verdict == NOT_APPLICABLE else f"no answer: {reason}"
                by_reason.setdefault(told, []).append(cell.problem)
        rows += _lines(found, program, by_reason)
    return Table(titles, tuple(rows))


def _lines(found: Field, program: ProgramLine, said: dict[str, list[str]]) -> list[tuple[str, ...]]:
    """Return a line for each text, with the problems that it is said of."""
    every = len(found.problems)
    lines = [("all" if len(problems) == every > 1 else ", ".join(problems), words) for words, problems in said.items()]
    return [(program.title if n == 0 else "", *line) for n, line in enumerate(lines)]


def programs(found: Field) -> Table:
    """Return what each program says of itself."""
    titles = (Column("Program"), Column("Version"), Column("Model", "fill"), Column("Settings", "fill"))
    rows: list[tuple[str, str, str, str]] = []
    before: Mapping[str, str] = {}
    for program in shown(found):
        said = program.about
        alike = said.get("program", "") != "" and said["program"] == before.get("program")
        version, model = said.get("version", ""), said.get("model", "")
        told = ("" if alike else version, "the same" if alike and model == before.get("model") else model)
        rows.append((program.title, *told, said.get("settings", "")))
        before = said
    return Table(titles, tuple(rows))
