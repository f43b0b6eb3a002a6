"""The chapters of the report as parts of pages: texts, tables and figures without what a page has in its own form."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from validation.errors import InputError
from validation.gallery.cases import GalleryScene, GalleryStudy, PlainData, readable
from validation.gallery.svg import Sheet
from validation.report.blocks import Block, Callout, FigureBlock, Heading, PageBreak, Table
from validation.report.chapters.registry import chapter_of
from validation.report.names import Readable, escaped, unescaped, with_texts
from validation.runs.results import Results
from validation.runs.text import printable

DAMAGED = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


def page_blocks(results: Results, study: GalleryStudy) -> list[PlainData]:
    """Return the blocks of the chapter that the report has of a study; in place of what cannot be drawn, why.

    Figures of one scene lead to its page.
    """
    readable_results = Readable(results)
    pages = {escaped(scene.name): scene for scene in study.scenes}
    sheet = Sheet()
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        try:
            manifest = readable_results.whole(escaped(study.name), histories=True)
            blocks = chapter_of(study.name)(readable_results, manifest, directory)
        except (InputError, *DAMAGED) as error:
            reason = readable(printable(str(error)))
            blocks = [Callout(f"The chapter cannot be drawn from these results ({reason}).", "fail")]
        if isinstance(blocks[0], Heading):
            blocks = blocks[1:]
        shown = [block for block in blocks if not isinstance(block, PageBreak) and not _lists_verdicts(block)]
        return _without_empty_headings([placed(block, directory, sheet, pages) for block in shown])


def placed(block: Block, directory: Path, sheet: Sheet, pages: Mapping[str, GalleryScene] = {}) -> PlainData:
    """Return a block for the template, a figure with its drawing, and with the page of the scene that it shows."""
    if not isinstance(block, FigureBlock):
        data = with_texts(asdict(block), lambda text: readable(unescaped(text)))
        return {"block": type(block).__name__, **data}
    caption = unescaped(block.caption)
    svg = (directory / block.file).read_text(encoding="utf-8")
    return {
        "block": "FigureBlock",
        "svg": sheet.placed(svg, caption),
        "caption": caption,
        "scene": pages.get(block.scene),
    }


def _lists_verdicts(block: Block) -> bool:
    """Whether a block is a table of gates, which the page lists in one that can be filtered."""
    return isinstance(block, Table) and any(column.kind == "verdict" for column in block.columns)


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
