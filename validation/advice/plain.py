"""Answers as plain data, and as columns of text."""

from __future__ import annotations

import dataclasses
import itertools
import math
import textwrap
from collections.abc import Collection, Sequence
from typing import Any

Line = tuple[str, ...]
NARROW = 34  # characters: a last column with less room stands below its line


class PlainAnswer:
    """An answer, a dataclass, that ``--json`` prints field by field."""

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        return dataclasses.asdict(self)  # type: ignore[call-overload, no-any-return]


def plain(value: Any) -> Any:
    """Return data in which None stands for what is not finite, such as w_c of a rigid contact."""
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [plain(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def in_columns(lines: Sequence[Line], width: int | None = None, indent: str = "") -> str:
    """Return lines with their columns aligned, as `in_rows` sets them."""
    return "\n".join(itertools.chain.from_iterable(in_rows(lines, width, indent)))


def in_rows(
    lines: Sequence[Line], width: int | None = None, indent: str = "", right: Collection[int] = ()
) -> list[list[str]]:
    """Return the rows of a table, a list of lines each, with their columns aligned.

    The last column is as long as it likes, or wrapped to a line of `width` characters: beside the others, or, where
    there is no room, below the columns that the width has room for, with those that it has none for. Each line begins
    with `indent`; the columns `right` end, and do not begin, below one another.
    """
    columns = [*zip(*filter(None, lines), strict=True)]
    widths = [max(map(len, column)) for column in columns]
    offsets = [len(indent), *itertools.accumulate((n + 2 for n in widths), initial=len(indent))][1:]
    count = max(len(columns) - 1, 0)  # columns beside which the last one is wrapped
    fits_beside = not columns or width is None or offsets[count] + NARROW <= width
    if width is not None and not fits_beside:
        count = max(1, sum(offset - 2 <= width for offset in offsets[1 : count + 1]))
    rows = []
    for line in lines:
        padded = zip(line, widths, strict=False)  # no cells are an empty line
        cells = [cell.rjust(n) if i in right else cell.ljust(n) for i, (cell, n) in enumerate(padded)]
        whole = (indent + "  ".join(cells)).rstrip() if line else ""
        start = indent + "".join(f"{cell}  " for cell in cells[:count])
        rest = "  ".join(filter(None, line[count:]))
        if width is None or len(whole) <= width:
            rows.append([whole])
        elif fits_beside:
            follow = " " * offsets[count]
            rows.append(
                textwrap.wrap(rest, width, initial_indent=start, subsequent_indent=follow, break_on_hyphens=False)
            )
        else:
            below = indent + "    "
            wrapped = textwrap.wrap(rest, max(width, NARROW), initial_indent=below, subsequent_indent=below)
            rows.append([start.rstrip(), *wrapped])
    return rows
