"""The chapters of the report as parts of pages: texts, tables and figures without what a page has in its own form."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from validation.errors import InputError
from validation.gallery.cases import GalleryScene, GalleryStudy, PlainData, readable
from validation.gallery.engines import program_blocks
from validation.gallery.svg import Sheet
from validation.report.blocks import Block, Callout, FigureBlock, Heading, PageBreak, Table
from validation.report.chapters.registry import chapter_of
from validation.report.names import Readable, escaped, unescaped, with_texts
from validation.runs.results import Results
from validation.runs.text import printable
from validation.studies.engines.table import STUDY, read

DAMAGED = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


@dataclass(frozen=True)
class Drawing:
    """A figure of a chapter."""

    file: str
    caption: str
    svg: str
    scene: str  # name as the report writes it; empty where a figure is of several


@dataclass(frozen=True)
class DrawnChapter:
    """The chapter of a study, and its figures by file name."""

    blocks: tuple[Block, ...]
    drawings: Mapping[str, Drawing]


def chapter_for(results: Results, study: GalleryStudy) -> DrawnChapter:
    """Return the chapter that the report has of a study; in place of what cannot be drawn, why."""
    readable_results = Readable(results)
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        try:
            manifest = readable_results.whole(escaped(study.name), histories=True)
            blocks = chapter_of(study.name)(readable_results, manifest, directory)
            if study.name == STUDY and (engines := read(readable_results)) is not None:
                blocks += program_blocks(engines)
        except (InputError, *DAMAGED) as error:
            reason = readable(printable(str(error)))
            return DrawnChapter((Callout(f"The chapter cannot be drawn from these results ({reason}).", "fail"),), {})
        drawings = {block.file: _drawing(block, directory) for block in blocks if isinstance(block, FigureBlock)}
    return DrawnChapter(tuple(blocks), drawings)


def _drawing(block: FigureBlock, directory: Path) -> Drawing:
    svg = (directory / block.file).read_text(encoding="utf-8")
    return Drawing(block.file, unescaped(block.caption), svg, block.scene)


def scene_of_figure(drawing: Drawing, scenes: Sequence[GalleryScene]) -> GalleryScene | None:
    """Return the scene that a figure shows, None where it is of several."""
    return next((scene for scene in scenes if escaped(scene.name) == drawing.scene), None)


def page_blocks(chapter: DrawnChapter, scenes: Sequence[GalleryScene], sheet: Sheet) -> list[PlainData]:
    """Return the blocks of a chapter for the template; figures of one scene lead to its page."""
    blocks = chapter.blocks[1:] if isinstance(chapter.blocks[0], Heading) else chapter.blocks
    template_blocks: list[PlainData] = []
    for block in blocks:
        if isinstance(block, PageBreak) or (isinstance(block, Table) and _of_verdicts(block)):
            continue
        if isinstance(block, FigureBlock):
            template_blocks.append(_figure(chapter.drawings[block.file], scenes, sheet))
        else:
            template_blocks.append(_record(block))
    return _without_empty_headings(template_blocks)


def placed(block: Block, directory: Path, sheet: Sheet) -> PlainData:
    """Return a block for the template, a figure with its drawing."""
    if isinstance(block, FigureBlock):
        return _figure(_drawing(block, directory), (), sheet)
    return _record(block)


def _record(block: Block) -> PlainData:
    """Return the name of a block's kind and its data."""
    return {"block": type(block).__name__, **with_texts(asdict(block), lambda text: readable(unescaped(text)))}


def _figure(drawing: Drawing, scenes: Sequence[GalleryScene], sheet: Sheet) -> PlainData:
    scene = scene_of_figure(drawing, scenes)
    return {
        "block": "FigureBlock",
        "svg": sheet.placed(drawing.svg, drawing.caption),
        "caption": drawing.caption,
        "page": None if scene is None else scene.page,
        "name": None if scene is None else scene.name,
    }


def _of_verdicts(table: Table) -> bool:
    """Whether a table lists gates, which the page lists in one that can be filtered."""
    return any(column.kind == "verdict" for column in table.columns)


def _without_empty_headings(blocks: Sequence[PlainData]) -> list[PlainData]:
    """Leave out headings of which nothing follows before the next of the same or a higher level."""
    reversed_blocks: list[PlainData] = []
    for block in reversed(blocks):
        if block["block"] == "Heading":
            if not reversed_blocks:
                continue
            following = reversed_blocks[-1]
            if following["block"] == "Heading" and following["level"] <= block["level"]:
                continue
        reversed_blocks.append(block)
    return reversed_blocks[::-1]
