"""The front matter as a whole: the first page, what did not pass, the three decisions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.report.blocks import PageBreak, Paragraph, Part
from validation.report.chapters.gates import not_passed
from validation.report.front.decisions import decisions
from validation.report.front.first import first_page, verdict_line
from validation.report.front.found import Found, paper_scene
from validation.runs.records import VerdictRecord


def front_pages(found: Found, verdicts: Sequence[VerdictRecord], studies: Sequence[str], directory: Path) -> list[Part]:
    """Return the pages that are read first; of results without the paper's block, what they are and their verdicts."""
    paper = paper_scene(found)
    if paper is None:
        what = f"{len(found)} scene{'s' * (len(found) != 1)} of {', '.join(studies)}: one chapter a study."
        return [Paragraph(what, "lead"), verdict_line(verdicts), *not_passed(verdicts)]
    failures = not_passed(verdicts)
    return [
        *first_page(found, paper, verdicts, directory),
        *([PageBreak(), *failures] if failures else []),
        *decisions(found, paper, directory),
    ]
