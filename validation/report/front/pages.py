"""The front matter as a whole: the first page, what did not pass, the three decisions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from validation.report.blocks import Blocks, PageBreak, Paragraph
from validation.report.chapters.alarms import alarm_lines
from validation.report.chapters.data import Groups, Verdicts
from validation.report.chapters.gates import not_passed
from validation.report.front.decisions import decisions
from validation.report.front.first import first_page, verdict_line
from validation.report.front.groups import paper_scene
from validation.report.references import PAPER, identity


def front_pages(
    groups: Groups,
    verdicts: Verdicts,
    studies: Sequence[str],
    directory: Path,
    provenances: Sequence[Mapping[str, Any]] = (),
) -> Blocks:
    """Return the pages that are read first; of results without the paper's block, what they are and their verdicts."""
    imprint = Paragraph(f"The model is that of {PAPER}. {identity(provenances)}.", "small")
    paper = paper_scene(groups)
    failures = not_passed(verdicts)
    if paper is None:
        judged = [verdict_line(verdicts)] if verdicts else []
        if len(groups) == 1:  # whose page begins here, with its alarms
            return [imprint, *judged, *failures]
        what = f"{len(groups)} scene{'s' * (len(groups) != 1)} of {', '.join(studies)}: one chapter a study."
        return [imprint, Paragraph(what, "lead"), *judged, *alarm_lines(groups), *failures, PageBreak()]
    return [
        imprint,
        *first_page(groups, paper, verdicts, directory),
        *([PageBreak(), *failures] if failures else []),
        *decisions(groups, paper, directory),
        PageBreak(),
    ]
