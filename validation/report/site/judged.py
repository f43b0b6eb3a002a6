"""The page and the badge of a judged answer: two files that need nothing else."""

from __future__ import annotations

import tempfile
from contextlib import ExitStack
from importlib import metadata
from pathlib import Path

from validation.errors import InputError
from validation.problems.data import PACK
from validation.problems.judge import Word
from validation.report.blocks import Heading
from validation.report.chapters.judged import JudgedAnswer
from validation.report.chapters.judged import page as page_of_answer
from validation.report.render import html
from validation.runs.files import atomic_path
from validation.runs.numbers import error_percent
from validation.runs.text import visible

PAGE = "judged.html"
BADGE = "badge.svg"
COLORS = {Word.PASS: "#1c6b2f", Word.PARTIAL: "#8a5a00", Word.FAIL: "#a80f0f", Word.NOT_JUDGED: "#5a5a5a"}
LETTER = 7  # px, width of a badge's letter, amply
MARGIN = 12  # px, beside a text


def write_judged(judged: JudgedAnswer, program: str, place: Path) -> list[Path]:
    """Write page and badge into a directory that is there, and return their paths.

    Raises
    ------
    InputError
        A file cannot be written.
    """
    paths = [place / PAGE, place / BADGE]
    for path in paths:
        if path.is_dir():
            raise InputError(
                "must be a file or nothing yet",
                source=path,
                value="a directory",
                advice="choose another place with --out",
            )
    with ExitStack() as both:  # leaves both files or neither
        for path, text in zip(paths, (page(judged, program), badge(judged)), strict=True):
            both.enter_context(atomic_path(path)).write_bytes(text.encode())
    return paths


def page(judged: JudgedAnswer, program: str) -> str:
    """Return the page: verdict, cause, columns, curves."""
    title = f"{program} on the problem {judged.problem.name}"
    with tempfile.TemporaryDirectory() as name:
        blocks = [Heading(title), *page_of_answer(judged, Path(name))]
        return html.page(
            title, blocks, imprint=imprint(), figure=html.embedded(Path(name)), css=html.static(html.STYLE)
        )


def imprint() -> str:
    """Return who judged, and what."""
    return f"Judged by dda-validation {metadata.version('dda-validation')}, pack {PACK}."


def badge(judged: JudgedAnswer) -> str:
    """Return the badge: the problem, the verdict, the error that decides, and the columns that are withheld."""
    judgement = judged.judgement
    label = f"DDA field: {judged.problem.name}"
    verdict = str(judgement.word)
    if judgement.deciding:
        verdict += f" {error_percent(judgement.deciding.error)}"
    if judgement.withheld:
        verdict += f"; {', '.join(judgement.withheld)} not reported"
    return badge_of(label, verdict, COLORS[judgement.word])


def badge_of(label: str, verdict: str, color: str) -> str:
    """Return a badge: a label, and a verdict on a coloured ground."""
    import jinja2

    widths = {name: LETTER * len(text) + MARGIN for name, text in (("left", label), ("right", verdict))}
    template = Path(__file__).with_name("badge.svg.j2").read_text("utf-8")
    texts = {"label": visible(label), "verdict": visible(verdict), "color": color}
    return str(jinja2.Template(template, autoescape=True).render(**texts, **widths))
