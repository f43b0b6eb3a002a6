"""The site of answers to the problems: a table of all, a page a program, curves, badges, verdicts as plain data."""

from __future__ import annotations

import itertools
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import metadata
from pathlib import Path

from validation.gates.gate import Status
from validation.problems.answers import AnswerSet
from validation.problems.data import PACK
from validation.problems.problem import names
from validation.report.blocks import Blocks, Callout, FigureBlock, Heading, Link, Links, Paragraph, TableColumn, table
from validation.report.chapters.answers import (
    LEAD,
    answer_table,
    asks_of,
    cells,
    headline,
    reason_blocks,
    stated_table,
    summary,
    verdicts,
)
from validation.report.chapters.judged import page
from validation.report.render import html
from validation.runs.files import atomic_directory, check_place, write_new
from validation.runs.progress import Progress
from validation.runs.text import visible
from validation.suite.judging import JudgedAnswer

VERDICTS = "verdicts.json"  # marks a directory as such a site
COLORS = {Status.PASS: "#1c6b2f", Status.PARTIAL: "#8a5a00", Status.FAIL: "#a80f0f"}
LETTER = 7  # px, width of a badge's letter, amply
MARGIN = 12  # px, beside a text


def write_site(sets: Sequence[AnswerSet], out: Path, progress: Progress) -> Path:
    """Write the site of judged answers and return its first page.

    Parameters
    ----------
    out
        A new or empty directory, or an earlier site, which is replaced as a whole.
    progress
        Told before each page: how many are finished, of how many, and which is next.

    Raises
    ------
    InputError
        The directory is not one to write to.
    """
    check_place(out, VERDICTS, "site")
    programs = {
        name: list(group)
        for name, group in itertools.groupby(sorted(sets, key=_by_address), key=lambda one: one.address[0])
    }
    ordered = [judged for group in programs.values() for judged in group]
    total = len(ordered) + len(programs) + 1
    with atomic_directory(out) as place:
        site = Site(programs, place)
        for number, judged in enumerate(ordered):
            progress(number, total, f"page of {judged.title}")
            site.curves(judged)
            write_new(place / f"badge_{judged.stem}.svg", set_badge(judged))
        for number, name in enumerate(programs, start=len(ordered)):
            progress(number, total, f"page of {name}")
            site.program(name)
        progress(total - 1, total, "first page")
        site.index()
        write_new(place / VERDICTS, json.dumps(verdicts(ordered), indent=1, allow_nan=False) + "\n")
        for name in (html.STYLE, html.SCRIPT):
            write_new(place / name, html.static(name))
    return out / "index.html"


def _by_address(judged: AnswerSet) -> tuple[str, ...]:
    return judged.address


class Site:
    """The pages of a site: folders of answers by program."""

    def __init__(self, programs: Mapping[str, Sequence[AnswerSet]], place: Path) -> None:
        self._programs = programs
        self._place = place
        self._menu = [
            ("index.html", "All programs"),
            *((f"program_{name}.html", group[-1].data.program) for name, group in programs.items()),
        ]

    def _write(self, file: str, title: str, blocks: Blocks) -> None:
        text = html.page(
            title, [Heading(title), *blocks], file=file, name="Answers to the problems", menu=self._menu,
            imprint=imprint(), figure=lambda figure: f"{file.removesuffix('.html')}/{figure}",
        )  # fmt: skip
        write_new(self._place / file, text)

    def index(self) -> None:
        """Write the first page: problems against programs with versions and settings."""
        sets = [judged for group in self._programs.values() for judged in group]
        asks = asks_of(sets)
        missing = [name for name in names() if name not in asks]
        unanswered = [Paragraph(f"Not answered by any of them: {', '.join(missing)}.", "small")] if missing else []
        blocks = [
            Paragraph(f"{LEAD} All verdicts as plain data: {VERDICTS}.", "lead"),
            answer_table(sets),
            *unanswered,
            *reason_blocks(sets),
            Heading("Programs", 2),
            _links(sets),
            Heading("The problems", 2),
            table(("Problem", TableColumn("What it asks", "fill")), list(asks.items())),
        ]
        self._write("index.html", f"Answers to the problems of pack {PACK}", blocks)

    def program(self, name: str) -> None:
        """Write the page of a program, all versions and settings."""
        group = self._programs[name]
        blocks = [_links(group), answer_table(group), *reason_blocks(group), stated_table(group)]
        self._write(f"program_{name}.html", group[-1].data.program, blocks)

    def curves(self, judged: AnswerSet) -> None:
        """Write the page of a folder of answers: each problem as `judge` shows it."""
        file = f"answers_{judged.stem}.html"
        directory = self._place / file.removesuffix(".html")
        blocks: Blocks = [Callout(f"{headline(judged)}.", "rule"), stated_table([judged])]
        by_name = {cell.problem: cell for cell in cells(judged)}
        for answer in judged.answers:
            cell = by_name[answer.name]
            blocks.append(Heading(cell.problem, 2))
            if not isinstance(answer, JudgedAnswer):
                blocks.append(Callout(f"{cell.status}: {cell.reason}.", "warn"))
                continue
            for block in page(answer, directory / answer.name):
                if isinstance(block, FigureBlock):
                    block = replace(block, file=f"{answer.name}/{block.file}")
                blocks.append(block)
        self._write(file, judged.title, blocks)


def _links(sets: Sequence[AnswerSet]) -> Links:
    links = [
        Link(f"answers_{judged.stem}.html", judged.title, headline(judged), f"badge_{judged.stem}.svg")
        for judged in sets
    ]
    return Links(tuple(links))


def set_badge(judged: AnswerSet) -> str:
    """Return the badge of a program: how many problems it passes."""
    statuses = set(summary([judged]))
    if Status.FAIL in statuses:
        status = Status.FAIL
    elif statuses == {Status.PASS}:
        status = Status.PASS
    else:
        status = Status.PARTIAL
    label = f"DDA problems {PACK}: {judged.data.program} {judged.data.settings_name}".rstrip()
    return badge(label, headline(judged), COLORS[status])


def badge(label: str, verdict: str, color: str) -> str:
    """Return a badge: a label, and a verdict on a coloured ground."""
    import jinja2

    widths = {name: LETTER * len(text) + MARGIN for name, text in (("left", label), ("right", verdict))}
    template = Path(__file__).with_name("badge.svg.j2").read_text("utf-8")
    texts = {"label": visible(label), "verdict": visible(verdict), "color": color}
    return str(jinja2.Template(template, autoescape=True).render(**texts, **widths))


def imprint() -> str:
    """Return who judged, and what."""
    return f"Judged by dda-validation {metadata.version('dda-validation')}, pack {PACK}."
