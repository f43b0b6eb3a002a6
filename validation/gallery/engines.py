"""What the page of the field of engines has beside the chapter: a section for each program."""

from __future__ import annotations

from validation.report.blocks import Blocks, Heading, Paragraph, Table, TableColumn, table
from validation.report.chapters.engines import ADAPTERS, SETTINGS, adapter, installed_programs, outcome, plain_title
from validation.report.chapters.text import capital
from validation.studies.engines.table import EngineCell, EngineTable
from validation.studies.field.table import ProgramLine


def program_blocks(engines: EngineTable) -> Blocks:
    """Return a section for each program: what it says of itself, and its answers to all problems."""
    sides: dict[str, list[ProgramLine]] = {}
    for program in installed_programs(engines):
        sides.setdefault(plain_title(program), []).append(program)
    blocks: Blocks = []
    for title, programs in sides.items():
        blocks += [Heading(title, 2), *_about(programs), _answers(engines, programs)]
    return [Heading("Program by program"), *blocks] if blocks else []


def _about(programs: list[ProgramLine]) -> Blocks:
    first = programs[0]
    version = first.about.get("version", "")
    model = first.about.get("model", "")
    lines = [f"{first.about.get('program', first.title)} {version}".strip() + (f": {model}." if model else ".")]
    for program in programs:
        if settings := program.about.get("settings", ""):
            words = "As it comes" if program.kind == "default" else "Chosen settings"
            lines.append(f"{words if program.kind in ('default', 'chosen') else 'Settings'}: {settings}.")
    if first.kind in ("default", "chosen"):
        lines.append(f"Adapter: {ADAPTERS}/{adapter(first.name)}; install by {first.recipe}.")
    return [Paragraph(line, "small" if number else "plain") for number, line in enumerate(lines)]


def _answers(engines: EngineTable, programs: list[ProgramLine]) -> Table:
    rows = []
    for problem in engines.problems:
        cells = [engines.cells[problem.name, program.name] for program in programs]
        rows.append((problem.name, *map(outcome, cells), _findings(programs, cells)))
    titles = ["As it comes" if program.kind == "default" else "Chosen settings" for program in programs]
    columns = [TableColumn(title if len(programs) > 1 else "Answer", "outcome") for title in titles]
    return table(["Problem", *columns, TableColumn("Curve", "fill")], rows)


def _findings(programs: list[ProgramLine], cells: list[EngineCell]) -> str:
    """Return what the curves show, with the settings that each is of where there are two."""
    findings = []
    for program, cell in zip(programs, cells, strict=True):
        if cell.finding:
            words = f"{SETTINGS[program.kind]}: " if len(programs) > 1 else ""
            findings.append(words + cell.finding)
    return capital("; ".join(findings))
