"""The report: blocks of chapters, built from a results directory and set by typst; no solver is imported.

A chapter is a function of (results, manifest, figure directory) that returns blocks and writes its figures; the
PDF is the front matter, a chapter for each study in the directory, and the provenance.
"""

from __future__ import annotations

import importlib
import json
import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import typst

from validation.history import write_atomically
from validation.results import Results
from validation.scene import SceneError

TEMPLATE = Path(__file__).with_name("report.typ")
# study name to "module:function"; a study without an entry gets DEFAULT_CHAPTER
CHAPTERS: dict[str, str] = {
    "work-precision": "validation.chapters_work:chapter",
    "paper": "validation.chapters_paper:paper_chapter",
    "subblocks": "validation.chapters_subblocks:chapter",
    "stability": "validation.chapters_stability:stability_chapter",
    "stability-small": "validation.chapters_stability:stability_chapter",
    "stiff-contact": "validation.chapters_contact:contact_chapter",
}
DEFAULT_CHAPTER = "validation.chapters:scene_chapter"
PIXELS_PER_INCH = 200.0


@dataclass(frozen=True)
class Heading:
    """A heading; level 1 opens a chapter, 2 a scene, 3 a part of it."""

    text: str
    level: int = 1


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of plain text; `lead` sets it larger, `small` smaller."""

    text: str
    tone: Literal["plain", "lead", "small"] = "plain"


@dataclass(frozen=True)
class Column:
    """A table column: title, kind of its cells, and a title shared with neighbours.

    ``decimal`` aligns numbers at the decimal point, ``verdict`` colours PASS, FAIL and NOT RUN, ``code`` is
    an identifier, ``id`` a long one that breaks and takes the remaining width, as ``fill`` does for text.
    """

    title: str
    kind: Literal["text", "decimal", "verdict", "code", "id", "fill"] = "text"
    group: str = ""


@dataclass(frozen=True)
class Table:
    """A table; a row of one cell spans all columns as a remark on the rows below it.

    Where `ruled`, a thin rule is drawn above each row whose first cell is not empty.
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    notes: tuple[str, ...] = ()
    ruled: bool = True

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) not in (1, len(self.columns)):
                raise ValueError(f"rows: must have {len(self.columns)} cells each, or one, got {len(row)}")


@dataclass(frozen=True)
class FigureBlock:
    """A figure by its file name in the figure directory."""

    file: str
    caption: str


@dataclass(frozen=True)
class Callout:
    """A framed remark: `fail` in red, `warn` in amber."""

    text: str
    tone: Literal["fail", "warn"]


@dataclass(frozen=True)
class Math:
    """A displayed formula in typst's mathematics."""

    source: str


@dataclass(frozen=True)
class PageBreak:
    """The rest starts on a new page (nothing happens at the top of a page)."""


Block = Heading | Paragraph | Table | FigureBlock | Callout | Math | PageBreak
Chapter = Callable[[Results, dict[str, Any], Path], list[Block]]


def chapter_of(study: str) -> Chapter:
    """Return the function that writes a study's chapter, importing its module now."""
    module, _, name = CHAPTERS.get(study, DEFAULT_CHAPTER).partition(":")
    function: Chapter = getattr(importlib.import_module(module), name)
    return function


def ordered_studies(results: Results) -> list[str]:
    """Return the studies of a directory, the core study first.

    Raises
    ------
    SceneError
        There is none.
    """
    studies = sorted(results.studies(), key=lambda name: (name != "core", name))
    if not studies:
        raise SceneError(f"{results.directory}: no study's results here; run a study first")
    return studies


def build(results: Results, out: Path) -> Path:
    """Write the PDF of all studies in a results directory and return its path.

    Raises
    ------
    SceneError
        There are no results, or the file cannot be written.
    """
    studies = ordered_studies(results)
    return write_document(out, lambda root: _all_blocks(results, studies, root))


def write_document(out: Path, blocks_of: Callable[[Path], Sequence[Block]]) -> Path:
    """Write a PDF of the blocks that a function returns for a directory of its figures; return the path.

    Raises
    ------
    SceneError
        The file cannot be written.
    """
    if not out.parent.is_dir():
        raise SceneError(f"{out}: cannot be written: {out.parent} is no directory; choose another place")
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        pdf = _typeset(root, blocks_of(root))
    write_atomically(out, lambda stream: stream.write(pdf))
    return out


def _all_blocks(results: Results, studies: Sequence[str], figures: Path) -> list[Block]:
    from validation import chapters_front

    chapters = [
        block
        for study in studies
        for block in (PageBreak(), *chapter_of(study)(results, results.manifest(study), figures))
    ]
    return [
        *chapters_front.front_matter(results, studies, figures),
        *chapters,
        PageBreak(),
        *chapters_front.provenance(results, studies),
    ]


def _typeset(root: Path, blocks: Sequence[Block]) -> bytes:
    """Return the PDF; the template and its data are copied beside the figures, which is all typst can read."""
    shutil.copyfile(TEMPLATE, root / "report.typ")
    data = {
        "title": "Discontinuous Deformation Analysis against finite elements",
        "subtitle": "Cross-validation on the two-block model",
        "blocks": [{"block": type(block).__name__} | asdict(block) for block in blocks],
    }
    (root / "report.json").write_text(json.dumps(data, allow_nan=False), encoding="utf-8")
    pdf = typst.compile(str(root / "report.typ"), root=str(root), format="pdf", ignore_system_fonts=True)
    return bytes(pdf)


def figures(study: str, results: Results, out: Path) -> list[Path]:
    """Write the figures of a study's chapter to a directory as SVG and PNG and return their paths.

    Raises
    ------
    SceneError
        The directory has no such study, or cannot be made.
    """
    if study not in results.studies():
        known = ", ".join(results.studies()) or "none"
        raise SceneError(f"study: must be one of those in {results.directory} ({known}), got {study!r}")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SceneError(f"{out}: cannot be made: {error.strerror}; choose another place") from None
    blocks = chapter_of(study)(results, results.manifest(study), out)
    drawn = [out / block.file for block in blocks if isinstance(block, FigureBlock)]
    return [path for svg in drawn for path in (svg, _png(svg))]


def _png(svg: Path) -> Path:
    """Write a PNG of an SVG file beside it, rendered as in the report."""
    page = f'#set page(width: auto, height: auto, margin: 2mm)\n#image("{svg.name}")\n'
    with tempfile.TemporaryDirectory() as name:
        shutil.copyfile(svg, Path(name) / svg.name)
        (Path(name) / "page.typ").write_text(page, encoding="utf-8")
        image = bytes(
            typst.compile(
                str(Path(name) / "page.typ"), root=name, format="png", ppi=PIXELS_PER_INCH, ignore_system_fonts=True
            )
        )
    path = svg.with_suffix(".png")
    write_atomically(path, lambda stream: stream.write(image))
    return path
