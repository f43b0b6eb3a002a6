"""Answers as plain data, and as columns of text."""

from __future__ import annotations

import dataclasses
import math
import textwrap
from collections.abc import Sequence
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
    """Return lines with their columns aligned.

    The last column is as long as it likes, or wrapped to a width: beside the others, or below where there is no room.
    """
    widths = [max(map(len, column)) for column in zip(*filter(None, lines), strict=True)][:-1]
    offset = len(indent) + sum(n + 2 for n in widths)
    rows: list[str] = []
    for line in lines:
        if not line:
            rows.append("")
            continue
        *cells, last = line
        start = indent + "".join(cell.ljust(n + 2) for cell, n in zip(cells, widths, strict=True))
        if width is None or offset + len(last) <= width:
            rows.append((start + last).rstrip())
        elif width - offset >= NARROW:
            rows += textwrap.wrap(
                last, width, initial_indent=start, subsequent_indent=" " * offset, break_on_hyphens=False
            )
        else:
            below = indent + "    "
            rows.append(start.rstrip())
            rows += textwrap.wrap(last, max(width, NARROW), initial_indent=below, subsequent_indent=below)
    return "\n".join(rows)
