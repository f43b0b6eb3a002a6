"""Outlines of blocks as contacts see them: convex parts of a polygon, and the records of corners and sides.

A polygon that is not convex is cut by diagonals between its own corners only. So every side of a part is either a whole
edge of the outline or a cut, and no contact is looked for through a cut. Corners on a straight line bound no part: the
edge goes on over them, and has the number of the corner from which it starts.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from dda.model.arrays import Array

STRAIGHT = 1e-9  # sine of the turn at a corner, up to which it counts as lying on a straight edge

CORNER = np.dtype(
    [
        ("block", np.int64),
        ("first", np.int64),  # number of the block's first corner
        ("after", np.int64),  # where the edge ends that starts here
        ("convex", np.int64),  # 1 where it can touch an edge
        ("x0", float),  # place at the start of a step [m]
        ("y0", float),
        ("x1", float),  # place at its end, as it would be without contact
        ("y1", float),
        ("found", np.int64),  # last contact of this corner in this step, -1: none
    ]
)
SIDE = np.dtype([("corner", np.int64), ("end", np.int64), ("after", np.int64), ("prior", np.int64), ("real", np.int64)])
PART = np.dtype(
    [
        ("first", np.int64),  # its sides are those from `first` to before `last`
        ("last", np.int64),
        ("block", np.int64),
        ("left", float),  # box over a step [m]
        ("right", float),
        ("low", float),
        ("high", float),
        ("order", np.int64),  # number of the part at this place of the sweep
    ]
)


class Outlines(NamedTuple):
    """Corners of blocks, sides of their convex parts, and these parts: arrays of records."""

    corners: Any
    sides: Any
    parts: Any


def sine_of_turn(a: Array, b: Array, c: Array) -> float:
    """Return the sine of the turn from a-b to b-c, positive to the left."""
    before = b - a
    following = c - b
    cross = before[0] * following[1] - before[1] * following[0]
    return float(cross / np.sqrt((before @ before) * (following @ following)))


def turns_of(vertices: Array, ring: Sequence[int]) -> list[float]:
    """Return the sines of the turns at the corners of a ring."""
    places = vertices[list(ring)]
    corners = zip(np.roll(places, 1, axis=0), places, np.roll(places, -1, axis=0), strict=True)
    return [sine_of_turn(*three) for three in corners]


def without_straight_corners(vertices: Array) -> list[int]:
    """Return the corners at which an outline turns."""
    ring = range(len(vertices))
    return [corner for corner, turn in zip(ring, turns_of(vertices, ring), strict=True) if abs(turn) > STRAIGHT]


def convex_parts(vertices: Array) -> list[list[int]]:
    """Return convex parts of a simple counter-clockwise polygon, as rings of its corners.

    Ears are cut off, and parts joined again wherever what they make is convex (Hertel and Mehlhorn): at most four times
    as many parts as there must be.
    """
    ring = without_straight_corners(vertices)
    if min(turns_of(vertices, ring)) > 0:
        return [ring]
    return _joined(vertices, _triangles(vertices, ring))


def _triangles(vertices: Array, ring: list[int]) -> list[list[int]]:
    triangles = []
    while len(ring) > 3:
        ear = next(number for number in range(len(ring)) if _is_ear(vertices, ring, number))
        triangles.append([ring[ear - 1], ring[ear], ring[(ear + 1) % len(ring)]])
        ring = ring[:ear] + ring[ear + 1 :]
    return [*triangles, ring]


def _is_ear(vertices: Array, ring: list[int], number: int) -> bool:
    """Tell whether a corner and its neighbours make a triangle that no other corner lies in or on."""
    triangle = [ring[number - 1], ring[number], ring[(number + 1) % len(ring)]]
    a, b, c = vertices[triangle]
    if sine_of_turn(a, b, c) <= 0:
        return False
    others = vertices[[corner for corner in ring if corner not in triangle]] - b
    inside = np.ones(len(others), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        edge = end - start
        across = edge[0] * (others[:, 1] - (start - b)[1]) - edge[1] * (others[:, 0] - (start - b)[0])
        inside &= across >= -STRAIGHT * (edge @ edge)
    return not np.any(inside)


def _joined(vertices: Array, parts: list[list[int]]) -> list[list[int]]:
    """Return the parts with every cut left out that convexity does not need."""
    cuts = [(ring[number - 1], ring[number]) for ring in parts for number in range(len(ring))]
    for start, end in cuts:
        sharing = [ring for ring in parts if start in ring and end in ring]
        left = [ring for ring in sharing if ring[(ring.index(start) + 1) % len(ring)] == end]
        right = [ring for ring in sharing if ring[(ring.index(end) + 1) % len(ring)] == start]
        if not left or not right:  # an edge of the outline, or a cut left out already
            continue
        at = left[0].index(end)
        opposite = right[0].index(start)
        union = left[0][at:] + left[0][:at] + (right[0][opposite:] + right[0][:opposite])[1:-1]
        if min(turns_of(vertices, union)) > STRAIGHT:
            parts = [ring for ring in parts if ring is not left[0] and ring is not right[0]] + [union]
    return parts


def outlines(polygons: Sequence[Array]) -> Outlines:
    """Return the records of blocks with the corners (n, 2) [m], block by block in the order of their corners.

    The places of a step, `x0`, `y0`, `x1`, `y1`, are those given.
    """
    corners = np.zeros(sum(len(vertices) for vertices in polygons), CORNER)
    sides: list[tuple[int, int, int, int, int]] = []
    parts: list[tuple[int, int, int]] = []
    first = 0
    for block, vertices in enumerate(polygons):
        outline = without_straight_corners(vertices)
        following = dict(zip(outline, outline[1:] + outline[:1], strict=True))
        own = corners[first : first + len(vertices)]
        own["block"] = block
        own["first"] = first
        own["after"] = first + (np.arange(len(vertices)) + 1) % len(vertices)
        own["convex"][outline] = np.array(turns_of(vertices, outline)) > 0
        for corner, end in following.items():
            own["after"][corner] = first + end
        for column, number in (("x0", 0), ("y0", 1), ("x1", 0), ("y1", 1)):
            own[column] = vertices[:, number]
        for ring in convex_parts(vertices):
            base = len(sides)
            for number, corner in enumerate(ring):
                end = ring[(number + 1) % len(ring)]
                after = base + (number + 1) % len(ring)
                prior = base + (number - 1) % len(ring)
                sides.append((first + corner, first + end, after, prior, int(following[corner] == end)))
            parts.append((base, len(sides), block))
        first += len(vertices)
    part_records = np.zeros(len(parts), PART)
    for name, values in zip(("first", "last", "block"), np.transpose(parts), strict=True):
        part_records[name] = values
    part_records["order"] = np.arange(len(parts))
    return Outlines(corners, np.array(sides, SIDE), part_records)


def as_objects(records: Any) -> list[Any]:
    """Return an array of records as a list of objects with the same attributes, which plain Python reads faster."""
    names = records.dtype.names
    return [SimpleNamespace(**dict(zip(names, row, strict=True))) for row in records.tolist()]
