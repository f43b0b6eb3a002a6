"""The chapters of the report as parts of pages: texts, tables and figures without what a page has in its own form."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.errors import InputError
from validation.gallery.cases import GalleryScene, GalleryStudy, readable
from validation.gallery.svg import Sheet
from validation.report.blocks import Block, Callout, FigureBlock, Heading, PageBreak, Table
from validation.report.chapters.registry import chapter_of
from validation.report.names import Readable, escaped, unescaped
from validation.runs.results import Results
from validation.runs.text import printable

DAMAGED = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


@dataclass(frozen=True)
class Drawing:
    """A figure of a chapter."""

    file: str
    caption: str
    svg: str


@dataclass(frozen=True)
class Chapter:
    """The chapter of a study, and its figures by file name."""

    blocks: tuple[Block, ...]
    drawings: Mapping[str, Drawing]


def chapter_for(results: Results, study: GalleryStudy) -> Chapter:
    """Return the chapter that the report has of a study; in place of what cannot be drawn, why."""
    known = Readable(results)
    with tempfile.TemporaryDirectory() as name:
        try:
            manifest = known.whole(escaped(study.name), histories=True)
            blocks = chapter_of(study.name)(known, manifest, Path(name))
        except (InputError, *DAMAGED) as error:
            said = readable(printable(str(error)))
            return Chapter((Callout(f"The chapter cannot be drawn from these results ({said}).", "fail"),), {})
        figures = [block for block in blocks if isinstance(block, FigureBlock)]
        drawings = {
            f.file: Drawing(f.file, unescaped(f.caption), (Path(name) / f.file).read_text(encoding="utf-8"))
            for f in figures
        }
    return Chapter(tuple(blocks), drawings)


def scene_of_figure(file: str, scenes: Sequence[GalleryScene]) -> GalleryScene | None:
    """Return the scene that a figure belongs to by its file name, the one with the longest name."""
    own = [scene for scene in scenes if file.startswith(f"{slug(scene.name)}-")]
    return max(own, key=lambda scene: len(scene.name), default=None)


def slug(name: str) -> str:
    """Return a scene's name as it begins the file names of its figures."""
    return re.sub(r"[^\w.-]+", "-", escaped(name)).strip("-.") or "scene"


def shown(chapter: Chapter, scenes: Sequence[GalleryScene], sheet: Sheet) -> list[dict[str, Any]]:
    """Return the blocks of a chapter for the template; figures of one scene lead to its page."""
    blocks = chapter.blocks[1:] if isinstance(chapter.blocks[0], Heading) else chapter.blocks
    found: list[dict[str, Any]] = []
    for block in blocks:
        if isinstance(block, PageBreak) or (isinstance(block, Table) and _of_verdicts(block)):
            continue
        if isinstance(block, FigureBlock):
            found.append(_figure(chapter.drawings[block.file], scenes, sheet))
        else:
            found.append(placed(block, Path(), sheet))
    return _without_empty_headings(found)


def placed(block: Block, directory: Path, sheet: Sheet) -> dict[str, Any]:
    """Return a block for the template, a figure with its drawing."""
    if not isinstance(block, FigureBlock):
        found: dict[str, Any] = {"block": type(block).__name__} | _plain(vars(block))
        return found
    svg = (directory / block.file).read_text(encoding="utf-8")
    return _figure(Drawing(block.file, unescaped(block.caption), svg), (), sheet)


def _figure(drawing: Drawing, scenes: Sequence[GalleryScene], sheet: Sheet) -> dict[str, Any]:
    scene = scene_of_figure(drawing.file, scenes)
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


def _without_empty_headings(blocks: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Leave out headings of which nothing follows before the next of the same or a higher level."""
    kept: list[dict[str, Any]] = []
    for block in reversed(blocks):
        follows = kept[-1] if kept else None
        ends = follows is None or (follows["block"] == "Heading" and follows["level"] <= block.get("level", 0))
        if not (block["block"] == "Heading" and ends):
            kept.append(block)
    return kept[::-1]


def _plain(value: Any) -> Any:
    """Return data of a block in which every text can be shown."""
    if isinstance(value, str):
        return readable(unescaped(value))
    if isinstance(value, Mapping):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    return _plain(vars(value)) if hasattr(value, "__dataclass_fields__") else value
