"""The columns of histories: their words, units and meanings, in the order in which they are drawn.

``displacement_2`` is the displacement at the second height of a column, ``x_1`` a position of the first rigid box;
``force_1`` is a stress in a column and a force on a box.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from validation.runs.history import DISPLACEMENT, PRESSURE


@dataclass(frozen=True)
class ColumnKind:
    """What a column holds: its unit, what it means (of the n-th height or box), and words other than its name."""

    unit: str
    meaning: str
    words: str = ""


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
OF_BOX: Mapping[str, ColumnKind] = {
    "x": ColumnKind("m", "position of the centre of box {n} along the ground, down a slope positive", "x"),
    "y": ColumnKind("m", "height of the centre of box {n} above the ground, normal to it", "y"),
    "angle": ColumnKind("rad", "angle of box {n}, counter-clockwise positive, not folded", "Rotation"),
    "force": ColumnKind("N", "normal force between box {n} and what it stands on", "Normal force"),
}


def split(column: str) -> tuple[str, str]:
    """Return the name of a column without its number, and the number or nothing."""
    plain, _, number = column.rpartition("_")
    return (plain, number) if number.isdigit() else (column, "")


def kind_of(column: str, of_boxes: bool = False) -> ColumnKind | None:
    """Return what a column holds, None where it is of no kind that is known."""
    plain, number = split(column)
    if not number:
        return OF_BLOCK.get(plain)
    kinds = (OF_BOX, AT_HEIGHT) if of_boxes else (AT_HEIGHT, OF_BOX)
    return next((kind[plain] for kind in kinds if plain in kind), None)


def unit_of(column: str, of_boxes: bool = False) -> str:
    """Return the unit of a column; nothing where it is not known."""
    kind = kind_of(column, of_boxes)
    return "" if kind is None else kind.unit


def axis_of(column: str, of_boxes: bool = False) -> tuple[str, str]:
    """Return what a column is, in words, and its unit."""
    kind = kind_of(column, of_boxes)
    if of_boxes and kind is not None and kind.words:
        return f"{kind.words}, box {split(column)[1]}", kind.unit
    return column.replace("_", " ").capitalize(), unit_of(column, of_boxes)


def rank(column: str) -> tuple[int, int]:
    """Return a key that sorts columns as they are drawn: those of a block, those at heights, then all others."""
    plain, number = split(column)
    kinds, first = (AT_HEIGHT, len(OF_BLOCK)) if number else (OF_BLOCK, 0)
    place = first + [*kinds].index(plain) if plain in kinds else len(OF_BLOCK) + len(AT_HEIGHT)
    return place, int(number or 0)
