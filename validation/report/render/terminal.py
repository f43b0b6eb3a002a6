"""Blocks as lines of a terminal, each with the style of its first word or of all of it."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator

from validation.advice.plain import in_columns, in_rows
from validation.report.blocks import (
    Beside,
    Block,
    Callout,
    FigureBlock,
    Heading,
    Links,
    Listing,
    PageBreak,
    Paragraph,
    Points,
    References,
    Table,
)

STYLES = {"PASS": "green", "FAIL": "bold red", "NOT RUN": "yellow", "worse": "bold red", "better": "green"}
StyledLine = tuple[str, str]  # text, and the word of `STYLES` that it is coloured as
VERDICTS = {"pass": "PASS", "fail": "FAIL"}  # of callouts
WARNING = "! "  # before a callout that warns
NOT_SHOWN = (PageBreak, FigureBlock, References)  # what a terminal cannot show


def lines(blocks: Iterable[Block], width: int | None) -> Iterator[StyledLine]:
    """Yield blocks as lines of a width, an empty one between two; a callout stands close to what it is of.

    Without a width no line is broken.
    """
    is_first = True
    for block in blocks:
        if isinstance(block, NOT_SHOWN):
            continue
        if not is_first and not isinstance(block, Callout):
            yield "", ""
        is_first = False
        yield from block_lines(block, width)


def block_lines(block: Block, width: int | None) -> Iterator[StyledLine]:
    """Yield the lines of a block."""
    match block:
        case Heading() | Paragraph():
            yield from wrapped(block.text, width)
        case Listing():
            for line in block.text.split("\n"):
                yield line, ""
        case Callout():
            mark = WARNING if block.tone == "warn" else ""
            yield from wrapped(mark + block.text, width, VERDICTS.get(block.tone, ""))
        case Points():
            for head, text in block.items:
                yield from wrapped(f"{head} {text}", width)
        case Links():
            rows = [(link.target, link.title, link.text) for link in block.items]
            for text in in_columns(rows, width).splitlines():
                yield text, ""
        case Beside():
            yield from lines((*block.left, *block.right), width)
        case Table():
            yield from table_lines(block, width)


def table_lines(table: Table, width: int | None) -> Iterator[StyledLine]:
    """Yield a table: caption, heads if any, rows in columns, remarks and notes."""
    if table.caption:
        yield from wrapped(table.caption, width)
    titles = tuple(f"{column.group} {column.title}".strip() for column in table.columns)
    heads = [titles] if any(titles) else []
    rows = [*heads, *(row for row in table.rows if len(row) == len(table.columns))]
    right = [place for place, column in enumerate(table.columns) if column.kind == "decimal"]
    texts = iter(in_rows(rows, width, right=right))
    for _ in heads:
        yield from ((text, "") for text in next(texts))
    for row in table.rows:
        if len(row) == len(table.columns):
            verdict = next((word for word in row if word in STYLES), "")
            yield from ((text, verdict) for text in next(texts))
        else:
            yield from wrapped(row[0], width)
    for note in table.notes:
        yield from wrapped(note, width)


def wrapped(text: str, width: int | None, style: str = "") -> Iterator[StyledLine]:
    """Yield a text in lines of a width, indented after the first."""
    if width is None:
        yield text, style
        return
    indent = " " * (len(text) - len(text.lstrip()) + 2)
    for line in textwrap.wrap(
        text, max(width, 20), subsequent_indent=indent, break_on_hyphens=False, break_long_words=False
    ):
        yield line, style
        style = ""  # of the first line alone
