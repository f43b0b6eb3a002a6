"""What a page is made of, whether it is printed, on a site or in a terminal: blocks of plain data."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from validation.runs.records import Manifest
    from validation.runs.results import Results

Kind = Literal["text", "decimal", "verdict", "outcome", "code", "id", "fill"]  # of the cells of a column


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
class TableColumn:
    """A table column: title, kind of its cells, and a title shared with neighbours.

    ``decimal`` aligns numbers at the decimal point, ``verdict`` colours PASS, FAIL and NOT RUN, ``outcome`` the same
    with what follows the word, ``code`` is an identifier, ``id`` a long one that breaks and takes the remaining width,
    as ``fill`` does for text.
    """

    title: str
    kind: Kind = "text"
    group: str = ""


@dataclass(frozen=True)
class Table:
    """A table; a row of one cell spans all columns as a remark on the rows below it.

    Where `ruled`, a thin rule is drawn above each row whose first cell is not empty; `dense` sets it in small type.
    """

    columns: tuple[TableColumn, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    notes: tuple[str, ...] = ()
    ruled: bool = True
    dense: bool = False

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) not in (1, len(self.columns)):
                raise ValueError(f"rows: must have {len(self.columns)} cells each, or one, got {len(row)}")


# A title, a column with its kind, or a shared title and those below it.
Head = str | TableColumn | Sequence[str]
NUMBER = re.compile("<?[−+]?[0-9][0-9.]*(×10)?[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]*( / [0-9]+)?")  # or a bound, or two counts


def table(
    heads: Iterable[Head],
    rows: Iterable[Sequence[str]],
    caption: str = "",
    notes: Iterable[str] = (),
    ruled: bool = True,
    dense: bool = False,
) -> Table:
    """Return a table whose columns of numbers are aligned at the decimal point, as their cells show.

    Example
    -------
    >>> table(("Case", ("Order", "v", "p")), [("a", "1.98", "–")]).columns[1].kind
    'decimal'
    """
    titles: list[tuple[str, str] | TableColumn] = []  # of a column and of its group
    for head in heads:
        if isinstance(head, TableColumn):
            titles.append(head)
        elif isinstance(head, str):
            titles.append((head, ""))
        else:
            titles += [(title, head[0]) for title in head[1:]]
    lines = [tuple(row) for row in rows]
    columns = []
    for place, title in enumerate(titles):
        if isinstance(title, TableColumn):
            columns.append(title)
        else:
            cells = [line[place] for line in lines if len(line) == len(titles)]
            columns.append(TableColumn(title[0], "decimal" if _are_numbers(cells) else "text", title[1]))
    return Table(tuple(columns), tuple(lines), caption, tuple(notes), ruled, dense)


def _are_numbers(cells: Sequence[str]) -> bool:
    """Whether some cells are numbers and the others hold no digit."""
    numbers = [cell for cell in cells if NUMBER.fullmatch(cell)]
    others = [cell for cell in cells if not NUMBER.fullmatch(cell) and any(map(str.isdigit, cell))]
    return bool(numbers) and not others


@dataclass(frozen=True)
class FigureBlock:
    """A figure by its file name in the figure directory."""

    file: str
    caption: str
    scene: str = ""  # of which it shows the histories or what is computed from them


@dataclass(frozen=True)
class Callout:
    """A framed remark: `fail` in red, `warn` in amber, `pass` in green, `rule` in blue."""

    text: str
    tone: Literal["fail", "warn", "pass", "rule"]


@dataclass(frozen=True)
class PageBreak:
    """The rest starts on a new page (nothing at the top of a page)."""


@dataclass(frozen=True)
class Points:
    """Numbered points, each opened by its own words in bold."""

    items: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Beside:
    """Blocks side by side; `share` of the width goes to those at the left."""

    left: tuple[Block, ...]
    right: tuple[Block, ...]
    share: float


@dataclass(frozen=True)
class Listing:
    """Lines of characters whose places matter, such as a drawing in text."""

    text: str


@dataclass(frozen=True)
class Link:
    """A page that others lead to: file, name, what is on it, file of a picture, and pages below it."""

    target: str
    title: str
    text: str = ""
    image: str = ""
    below: tuple[Link, ...] = ()


@dataclass(frozen=True)
class Links:
    """A list of pages."""

    items: tuple[Link, ...]


@dataclass(frozen=True)
class References:
    """The sources that the document cites, numbered; without it keys are not set as numbers."""


Block = Heading | Paragraph | Table | FigureBlock | Callout | PageBreak | Points | Beside | Listing | Links | References
Blocks = list[Block]
Chapter = Callable[["Results", "Manifest", Path], Blocks]


def figures_of(blocks: Iterable[Block]) -> list[FigureBlock]:
    """Return the figures among blocks, those that stand beside a text last."""
    figures: list[FigureBlock] = []
    beside: list[FigureBlock] = []
    for block in blocks:
        if isinstance(block, FigureBlock):
            figures.append(block)
        elif isinstance(block, Beside):
            beside += figures_of((*block.left, *block.right))
    return figures + beside


def as_data(block: Block, text: Callable[[str], str]) -> dict[str, Any]:
    """Return a block as plain data with the name of its kind, as those within it, every text changed."""
    data: dict[str, Any] = _changed(block, text)
    return data


def _changed(part: Any, text: Callable[[str], str]) -> Any:
    if isinstance(part, str):
        return text(part)
    if isinstance(part, tuple | list):
        return [_changed(item, text) for item in part]
    if is_dataclass(part):
        parts = {field.name: _changed(getattr(part, field.name), text) for field in fields(part)}
        return {"block": type(part).__name__, **parts}
    return part
