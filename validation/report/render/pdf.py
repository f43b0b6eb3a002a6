"""Blocks set as PDF by typst."""

from __future__ import annotations

import itertools
import json
import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from validation.errors import InputError
from validation.report.blocks import (
    Beside,
    Block,
    FigureBlock,
    Heading,
    PageBreak,
    Paragraph,
    References,
    Table,
    as_data,
)
from validation.report.names import unescaped
from validation.report.references import BIBLIOGRAPHY, CITED, marked, references
from validation.runs.files import write_atomically

TEMPLATE = Path(__file__).with_name("report.typ")
PIXELS_PER_INCH = 200.0


def write_document(out: Path, blocks_of: Callable[[Path], Sequence[Block]]) -> Path:
    """Write a PDF of the blocks that a function returns for a directory of figures; return the path.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    if not out.parent.is_dir():
        raise InputError(
            f"cannot be written: {out.parent} is not a directory", source=out, advice="choose another place"
        )
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        pdf = typeset(root, blocks_of(root))
    write_atomically(out, lambda stream: stream.write(pdf))
    return out


def kept_with_next(blocks: Sequence[Block]) -> list[bool]:
    """Return which blocks stay on the page on which the next one begins.

    Headings do; paragraphs and rules before a figure or table, and a figure before its table; all that opens a chapter
    before its first figure, table or section.
    """
    is_lead = [isinstance(block, Paragraph) or getattr(block, "tone", "") == "rule" for block in blocks]
    kept = [False] * len(blocks)
    is_opening = False
    for place, (block, following) in enumerate(itertools.pairwise(blocks)):
        kept[place] = is_opening and is_lead[place] and not isinstance(following, PageBreak)
        is_opening = kept[place] or (isinstance(block, Heading) and block.level == 1)
    for place in reversed(range(len(blocks) - 1)):
        following = blocks[place + 1]
        if is_lead[place]:
            leads_on = is_lead[place + 1] and kept[place + 1]
            kept[place] |= leads_on or isinstance(following, FigureBlock | Table | Beside)
        elif isinstance(blocks[place], FigureBlock):
            kept[place] = isinstance(following, Table)
    return kept


def typeset(root: Path, blocks: Sequence[Block]) -> bytes:
    """Return the PDF; template and data are copied beside the figures, which is all typst can read."""
    import typst

    shutil.copyfile(TEMPLATE, root / "report.typ")
    shutil.copyfile(BIBLIOGRAPHY, root / BIBLIOGRAPHY.name)
    content = [
        as_data(block, lambda text: unescaped(text, marked)) | {"kept": kept}
        for block, kept in zip(blocks, kept_with_next(blocks), strict=True)
    ]
    if CITED not in json.dumps(content, ensure_ascii=False):  # a list of no sources would be its title alone
        content = [block for block in content if block["block"] != References.__name__]
    data = {
        "title": "Discontinuous Deformation Analysis against finite elements",
        "subtitle": "Cross-validation of blocks on contact springs",
        "keys": list(references()) if References() in blocks else [],
        "cited": CITED,
        "blocks": content,
    }
    (root / "report.json").write_text(json.dumps(data, allow_nan=False), encoding="utf-8")
    try:
        pdf = typst.compile(str(root / "report.typ"), root=str(root), format="pdf", ignore_system_fonts=True)
    except typst.TypstError as error:
        raise InputError(f"the report cannot be set: {' '.join(str(error).split())}") from error
    return bytes(pdf)


def png_of(svg: Path) -> Path:
    """Write a PNG of an SVG file beside it, as the report renders it."""
    import typst

    page = f'#set page(width: auto, height: auto, margin: 2mm)\n#image("{svg.name}")\n'
    with tempfile.TemporaryDirectory() as name:
        shutil.copyfile(svg, Path(name) / svg.name)
        (Path(name) / "page.typ").write_text(page, encoding="utf-8")
        source = str(Path(name) / "page.typ")
        image = typst.compile(source, root=name, format="png", ppi=PIXELS_PER_INCH, ignore_system_fonts=True)
    path = svg.with_suffix(".png")
    write_atomically(path, lambda stream: stream.write(bytes(image)))
    return path
