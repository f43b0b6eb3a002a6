"""The pages that are read first: what the results are, what did not pass, and the pages that a study has for them.

A ``front.toml`` in a study's folder is a chapter (`validation.report.chapters.written`) of the scenes of all studies:
its ``first`` stands before what did not pass, its `DECISIONS` are pages after it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from validation.report.blocks import Blocks, Heading, PageBreak, Paragraph
from validation.report.chapters.data import Groups, Verdicts
from validation.report.chapters.described import Description
from validation.report.chapters.gates import not_passed, verdict_line
from validation.report.chapters.queries import StudyTable
from validation.report.chapters.summary import overview
from validation.report.chapters.written import WrittenChapter
from validation.report.references import PAPER, identity
from validation.runs.results import Results
from validation.suite.folders import folder_of

DECISIONS = ("step", "springs", "discount")
OVERVIEW_SCENES = 25  # lines of a table that leave room on a page for what the gates found


def front_chapter(results: Results, studies: Sequence[str], directory: Path) -> WrittenChapter | None:
    """Return what the first study with such pages says, None without one."""
    for study in studies:
        folder = folder_of(study)
        description = None if folder is None else folder.path / "front.toml"
        manifest = results.manifest(study)
        if description is not None and description.exists() and manifest.get("derived"):
            others = [results.manifest(name) for name in studies if name != study]
            table = StudyTable(results, manifest, *others, drawn=False)
            return WrittenChapter(Description(description), table, directory)
    return None


def front_pages(
    front: WrittenChapter | None, groups: Groups, verdicts: Verdicts, provenances: Sequence[Mapping[str, Any]] = ()
) -> Blocks:
    """Return the pages that are read first; without such a study, what the results are and their verdicts."""
    model = "" if front is None else f"The model is that of {PAPER}. "
    imprint = Paragraph(f"{model}{identity(provenances)}.", "small")
    failures = not_passed(verdicts)
    if front is None:
        judged = [verdict_line(verdicts)] if verdicts else []
        if len(groups) == 1:  # whose page begins here, with its alarms
            return [imprint, *judged, *failures]
        # More scenes than a page has lines for are those of studies, whose chapters begin with what came out.
        scenes: Blocks = [Heading("Scenes"), overview(groups)] if len(groups) <= OVERVIEW_SCENES else []
        return [imprint, *scenes, *judged, *failures]
    blocks: Blocks = [imprint, *front.blocks("first"), verdict_line(verdicts)]
    blocks += [PageBreak(), *failures] if failures else []
    for decision in DECISIONS:
        blocks += [PageBreak(), *front.blocks(decision)]
    return [*blocks, PageBreak()]
