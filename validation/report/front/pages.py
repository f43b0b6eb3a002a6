"""The front matter as a whole: the first page, what did not pass, the three decisions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from validation.report.blocks import Blocks, Heading, PageBreak, Paragraph
from validation.report.chapters.data import Groups, Verdicts
from validation.report.chapters.gates import not_passed
from validation.report.chapters.summary import overview
from validation.report.front.decisions import decisions
from validation.report.front.first import first_page, verdict_line
from validation.report.front.groups import paper_scene
from validation.report.references import PAPER, identity

OVERVIEW_SCENES = 25  # lines of a table that leave room on a page for what the gates found


def front_pages(
    groups: Groups,
    verdicts: Verdicts,
    studies: Sequence[str],
    directory: Path,
    provenances: Sequence[Mapping[str, Any]] = (),
) -> Blocks:
    """Return the pages that are read first; of results without the paper's block, what they are and their verdicts."""
    paper = paper_scene(groups)
    model = "" if paper is None else f"The model is that of {PAPER}. "
    imprint = Paragraph(f"{model}{identity(provenances)}.", "small")
    failures = not_passed(verdicts)
    if paper is None:
        judged = [verdict_line(verdicts)] if verdicts else []
        if len(groups) == 1:  # whose page begins here, with its alarms
            return [imprint, *judged, *failures]
        # More scenes than a page has lines for are those of studies, whose chapters begin with what came out.
        scenes: Blocks = [Heading("Scenes"), overview(groups)] if len(groups) <= OVERVIEW_SCENES else []
        return [imprint, *scenes, *judged, *failures]
    return [
        imprint,
        *first_page(groups, paper, verdicts, directory),
        *([PageBreak(), *failures] if failures else []),
        *decisions(groups, paper, directory),
        PageBreak(),
    ]
