"""What the chapter of the study `beams` draws by itself: the beams."""

from __future__ import annotations

from pathlib import Path

from validation.report.blocks import Blocks
from validation.report.chapters.described import Description
from validation.report.chapters.queries import StudyTable
from validation.report.figures.blocks import blocks_figure
from validation.report.figures.histories import saved

PAGE = Description(__file__)


def beams(table: StudyTable, directory: Path) -> Blocks:
    """Return the picture of the beams, one of each scene."""
    described = PAGE.described("picture", "beams")
    drawn = []
    for scene, title in described["scenes"].items():
        for line in table.lines({"of": scene})[:1]:
            if line.case is not None and line.case.scene.plane is not None:
                drawn.append((title, line.case.scene.plane))
    if not drawn:
        return []
    return [saved(blocks_figure(drawn, described["height"]), directory, described["file"], described["caption"])]
