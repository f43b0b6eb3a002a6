"""The columns of histories: their words, units and meanings, in the order in which they are drawn.

``displacement_2`` is the displacement at the second height of a column. A kind of scene may have columns of its own:
`own`, by their names, of numbered ones without the number (``x`` of ``x_1``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from validation.runs.history import DISPLACEMENT, PRESSURE


@dataclass(frozen=True)
class ColumnKind:
    """What a column holds: its unit, what it means (of the n-th height or box), and words other than its name."""

    unit: str
    meaning: str
    words: str = ""  # in a figure, with {n}
    rounding: float = 0.0  # size below which its values are those of a body at rest
    from_zero: bool = True  # whether a figure shows zero; not of places, which are measured from anywhere


OF_BLOCK: Mapping[str, ColumnKind] = {
    DISPLACEMENT: ColumnKind("m", "vertical displacement of the centroid, upwards positive"),
    PRESSURE: ColumnKind(
        "Pa", "sum of the normal forces of the springs over the length of the base, compression positive"
    ),
    "horizontal_displacement": ColumnKind(
        "m", "horizontal displacement of the centroid, towards +x, which is down a slope"
    ),
    "rotation": ColumnKind("rad", "rotation since t = 0, counter-clockwise positive"),
}
AT_HEIGHT: Mapping[str, ColumnKind] = {
    DISPLACEMENT: ColumnKind(
        "m", "displacement at the {n}. of the heights, upwards positive (of shear: across the column)"
    ),
    "stress": ColumnKind("Pa", "stress at the {n}. of the heights, compression positive"),
    "velocity": ColumnKind(
        "m/s", "velocity at the {n}. of the heights, upwards positive (of shear: across the column)"
    ),
    "force": ColumnKind(
        "Pa",
        "stress of the contact at the {n}. of the heights on what is above it: compression positive, 0 while it is "
        "open (of shear: along the positive displacement)",
    ),
    "gap": ColumnKind("m", "opening of the contact at the {n}. of the heights, 0 while it is closed"),
    "slip": ColumnKind(
        "m", "slip of the contact at the {n}. of the heights since t = 0, of what is above it against what is below"
    ),
}
OwnColumns = Mapping[str, ColumnKind]
NO_OWN: OwnColumns = MappingProxyType({})


def split(column: str) -> tuple[str, str]:
    """Return the name of a column without its number, and the number or nothing."""
    plain, _, number = column.rpartition("_")
    return (plain, number) if number.isdigit() else (column, "")


def kind_of(column: str, own: OwnColumns = NO_OWN) -> ColumnKind | None:
    """Return what a column holds, None where it is of no kind that is known."""
    plain, number = split(column)
    if not number:
        return OF_BLOCK.get(plain) or own.get(plain)
    return own.get(plain) or AT_HEIGHT.get(plain)


def unit_of(column: str, own: OwnColumns = NO_OWN) -> str:
    """Return the unit of a column; nothing where it is not known."""
    kind = kind_of(column, own)
    return "" if kind is None else kind.unit


def axis_of(column: str, own: OwnColumns = NO_OWN) -> tuple[str, str]:
    """Return what a column is, in words, and its unit."""
    kind = kind_of(column, own)
    if kind is not None and kind.words:
        return kind.words.format(n=split(column)[1]), kind.unit
    return column.replace("_", " ").capitalize(), unit_of(column, own)


def rank(column: str) -> tuple[int, int]:
    """Return a key that sorts columns as they are drawn: those of a block, those at heights, then all others."""
    plain, number = split(column)
    kinds, first = (AT_HEIGHT, len(OF_BLOCK)) if number else (OF_BLOCK, 0)
    place = first + [*kinds].index(plain) if plain in kinds else len(OF_BLOCK) + len(AT_HEIGHT)
    return place, int(number or 0)
