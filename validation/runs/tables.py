"""Tables of numbers in text files, as programs and spreadsheets write them: cells with their places.

Commas, semicolons, tabs or blanks between the cells; decimal commas, where something else separates; exponents with E
or D; quotes; comments after # or %, and lines that begin with // or !; a byte-order mark, ends of lines of any system.
"""

from __future__ import annotations

import io
import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from validation.errors import InputError
from validation.runs.defects import Place
from validation.runs.regular import regular

SEPARATORS = (";", "\t", ",")  # the first that a line holds; without one, blanks separate
_CELLS = {mark: re.compile(rf'(\s*"(?:[^"]|"")*"[^{mark}]*|[^{mark}]*)(?:{mark}|$)') for mark in SEPARATORS}
_BLANK_CELLS = re.compile(r'("(?:[^"]|"")*"|\S+)')
_QUOTED = re.compile(r'"(?:[^"]|"")*"')
_COMMENT = re.compile(r"[#%].*|^\s*(//|!).*")
_OF_NUMPY = re.compile(r"np\.float\d+\(.*\)")
_GROUPED = re.compile(r"[+-]?\d{1,3}(?:[ '\u2019_\u00a0]\d{3})+(?:\.\d*)?")


@dataclass(frozen=True)
class Cell:
    """A cell of a table: its text without blanks and quotes, and where it begins in the file."""

    text: str
    line: int
    column: int

    @property
    def end(self) -> int:
        """The character behind it."""
        return self.column + len(self.text)


Row = Sequence[Cell]


def read_text(path: Path, largest: float = math.inf) -> str:
    """Return the text of a file of at most so many bytes, a regular one in UTF-8; raises as `regular` does."""
    regular(path, largest)
    content = path.read_bytes()
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        utf16 = content[:2] in (b"\xff\xfe", b"\xfe\xff")
        raise InputError(
            "must be text in UTF-8",
            source=Place(path, before.count(b"\n") + 1, error.start - before.rfind(b"\n")),
            value=f"the byte 0x{content[error.start]:02x}",
            advice="it is UTF-16; save it as UTF-8" if utf16 else None,
        ) from None


def rows_of(text: str, most: int | None = None) -> list[Row]:
    """Return the rows of a text that hold a cell, the header among them; at most so many are read."""
    lines = enumerate(io.StringIO(text, newline=None), start=1)
    rows = (_cells(_COMMENT.sub("", line.rstrip("\n")), number) for number, line in lines)
    return list(itertools.islice(filter(None, rows), most))


def _cells(line: str, number: int) -> Row:
    """Return the cells of a line, without the empty ones at its end, which spreadsheets leave."""
    plain = _QUOTED.sub("", line)
    separator = next((mark for mark in SEPARATORS if mark in plain), None)
    pattern = _BLANK_CELLS if separator is None else _CELLS[separator]
    cells = []
    for match in pattern.finditer(line):
        text = match[1].strip()
        column = match.start() + len(match[1]) - len(match[1].lstrip()) + 1
        if len(text) > 1 and text[0] == text[-1] == '"':
            text = text[1:-1].replace('""', '"').strip()
        cells.append(Cell(text, number, column))
    while cells and not cells[-1].text:
        cells.pop()
    return cells


def number(text: str) -> float | None:
    """Return the number that a cell holds, None where it holds none; Python's own ways to write one are none."""
    if "_" in text or not text.isascii():
        return None
    try:
        return float(text.replace("D", "e").replace("d", "e").replace(",", "."))
    except ValueError:
        return None


def meant(text: str) -> str | None:
    """Return what was probably meant by a text that is no number."""
    if _OF_NUMPY.fullmatch(text):
        return "numpy's repr; float(x) of it is a number"
    return "digits are not grouped" if _GROUPED.fullmatch(text) else None
