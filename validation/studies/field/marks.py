"""What the chapter of the field says of programs: who is there, why problems have no verdict, what they are."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence

from validation.report.blocks import Table, TableColumn, table
from validation.studies.field.table import MISSING, NOT_APPLICABLE, NOT_RUN, Cell, FieldTable, ProgramLine, is_absent

NONE_INSTALLED = "No other program is installed here: README of examples/peers has a recipe for each."
NOT_THIS_VERSION = "The study was not run by this version; run it again."
NONE = "n. a."
PLACE = re.compile(r" \([^()]*:\d+, in [^()]*\)$")  # of the code that raised an error


def cells_of(field: FieldTable, program: ProgramLine) -> list[Cell]:
    """Return the cells of a program, problem by problem."""
    return [field.cells[problem.name, program.name] for problem in field.problems]


def installed_of(field: FieldTable, programs: Iterable[ProgramLine]) -> list[ProgramLine]:
    """Return the programs that are there; one that gave no answer at all is among them, an adapter alone is not."""
    installed = []
    for program in programs:
        endings = []
        for cell in cells_of(field, program):
            endings.append((cell.verdict == NOT_APPLICABLE or MISSING in cell.reason, cell.reason))
        if program.installed and not is_absent(endings):
            installed.append(program)
    return installed


def lines_of(
    field: FieldTable,
    programs: Iterable[ProgramLine],
    verdicts: Collection[str],
    text_of: Callable[[Cell], str],
    remark: Callable[[Cell], str] = lambda cell: "",
) -> list[tuple[str, str, str]]:
    """Return of each program a line for each text, with the problems of these verdicts that it applies to."""
    lines = []
    for program in programs:
        problems_by_text: dict[str, list[str]] = {}
        for cell in cells_of(field, program):
            if cell.verdict in verdicts:
                problems_by_text.setdefault(text_of(cell), []).append(cell.problem + remark(cell))
        title = program.title
        for text, problems in problems_by_text.items():
            names = "all" if len(problems) == len(field.problems) > 1 else ", ".join(problems)
            lines.append((title, names, text))
            title = ""
    return lines


def absent_of(field: FieldTable, programs: Iterable[ProgramLine]) -> Table:
    """Return why problems are not applicable or have no answer, those of one program with one reason in a line."""
    rows = lines_of(field, programs, (NOT_APPLICABLE, NOT_RUN), _reason)
    return table(("Program", "Problems", TableColumn("Reason", "fill")), rows)


def _reason(cell: Cell) -> str:
    reason = PLACE.sub("", cell.reason.removeprefix("the solver says that it is not made for this scene: "))
    return f"no answer: {reason}" if cell.verdict == NOT_RUN else reason


def about_rows(programs: Sequence[ProgramLine]) -> Iterator[tuple[ProgramLine, bool, tuple[str, str, str, str]]]:
    """Yield each program, whether the line before is of the same, and title, version, model and settings."""
    previous: Mapping[str, str] = {}
    for program in programs:
        about = program.about
        model = about.get("model", "")
        is_same = bool(about.get("program")) and about["program"] == previous.get("program")
        version = "" if is_same else about.get("version", "")
        if is_same and model == previous.get("model", ""):
            model = "the same"
        yield program, is_same, (program.title, version, model, about.get("settings", ""))
        previous = about
