"""Columns of a history of moving blocks: of a block, of a contact, of all; their units and what they mean.

``A.x`` is of block A, ``A.2-B.0.normal`` of corner 2 of A on edge 0 of B, ``A-B.normal`` of all contacts between both,
``momentum.x`` and ``energy.kinetic`` of all.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from validation.runs.columns import ColumnKind

POSE = ("x", "y", "angle")
MOMENTUM, ENERGY = "momentum", "energy"
GAP = "gap"  # of a contact
RESERVED = (MOMENTUM, ENERGY)  # no block is called so
OF_BLOCK: Mapping[str, tuple[str, str]] = {
    "x": ("m", "position of the centroid"),
    "y": ("m", "position of the centroid, upwards"),
    "angle": ("rad", "angle to the outline as it is stated, counter-clockwise, not folded"),
    "vx": ("m/s", "velocity of the centroid"),
    "vy": ("m/s", "velocity of the centroid, upwards"),
    "spin": ("rad/s", "rate of the angle"),
    "ex": ("", "strain along x of the block's own axes, which turn with it"),
    "ey": ("", "strain along y of the block's own axes, which turn with it"),
    "gxy": ("", "shear strain in the block's own axes"),
}
OF_CONTACT: Mapping[str, tuple[str, str]] = {
    "normal": ("N", "normal force, compression positive"),
    "shear": ("N", "force against the direction of the edge, which runs counter-clockwise about its block"),
    GAP: ("m", "distance of the corner from the edge, negative where the spring is compressed"),
    "slip": ("m", "sliding of the corner along the edge"),
}
OF_PAIR: Mapping[str, tuple[str, str]] = {
    "normal": ("N", "normal forces of all contacts between two blocks, compression positive"),
}
OF_MOMENTUM: Mapping[str, tuple[str, str]] = {
    "x": ("kg m/s", "momentum of all blocks that move"),
    "y": ("kg m/s", "momentum of all blocks that move, upwards"),
    "angular": ("kg m2/s", "angular momentum of all blocks that move, about the origin"),
}
OF_ENERGY: Mapping[str, tuple[str, str]] = {
    "kinetic": ("J", "kinetic energy"),
    "strain": ("J", "energy of the blocks' strains"),
    "springs": ("J", "energy of contact springs and glue"),
    "load": ("J", "what weight and loads have given since t = 0, negative"),
    "friction": ("J", "work that friction has taken since t = 0"),
    "algorithmic": ("J", "energy that the scheme has taken since t = 0"),
    "kinetic_damping": ("J", "energy that gg has taken since t = 0"),
    "switching": ("J", "energy that closing and opening have taken since t = 0"),
    "balance": ("J", "what the account leaves: rounding"),
}
_OF_CONTACT = re.compile(r"(\w+)\.(\d+)-(\w+)\.(\d+)\.(\w+)")
_OF_PAIR = re.compile(r"(\w+)-(\w+)\.(\w+)")
WHOLE = {MOMENTUM: OF_MOMENTUM, ENERGY: OF_ENERGY}


class ColumnPlace(NamedTuple):
    """What a column is of: a block, a contact (block, corner, other block, edge), a pair, or all blocks."""

    part: str  # "x", "normal", "kinetic"
    meaning: tuple[str, str]  # unit, and what it is
    block: str = ""
    contact: tuple[str, int, str, int] | None = None
    pair: tuple[str, str] | None = None
    whole: str = ""  # "momentum" or "energy"


def place_of(column: str) -> ColumnPlace:
    """Return what a column is of by its name; a KeyError if no column is called so."""
    if match := _OF_CONTACT.fullmatch(column):
        block, corner, on, edge, part = match.groups()
        return ColumnPlace(part, OF_CONTACT[part], contact=(block, int(corner), on, int(edge)))
    if match := _OF_PAIR.fullmatch(column):
        first, second, part = match.groups()
        return ColumnPlace(part, OF_PAIR[part], pair=(first, second))
    name, _, part = column.partition(".")
    if name in WHOLE:
        return ColumnPlace(part, WHOLE[name][part], whole=name)
    return ColumnPlace(part, OF_BLOCK[part], block=name)


class PlaneColumns(Mapping[str, ColumnKind]):
    """What every column of moving blocks holds, by name; too many to be listed."""

    def __getitem__(self, column: str) -> ColumnKind:
        place = place_of(column)
        from_zero = place.part not in POSE or bool(place.whole)
        return ColumnKind(*place.meaning, words=column, from_zero=from_zero)

    def __iter__(self) -> Iterator[str]:
        return iter(())

    def __len__(self) -> int:
        return 0


def contact_column(block: str, corner: int, on: str, edge: int, part: str) -> str:
    """Return the name of a contact's column."""
    return f"{block}.{corner}-{on}.{edge}.{part}"


def pair_column(first: str, second: str) -> str:
    """Return the name of the column of the normal forces between two blocks."""
    return f"{first}-{second}.normal"


def numbers_of(contact: tuple[str, int, str, int], names: Sequence[str]) -> tuple[int, int, int, int]:
    """Return a contact by the numbers of its blocks in place of their names."""
    block, corner, on, edge = contact
    return names.index(block), corner, names.index(on), edge
