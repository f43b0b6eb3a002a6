"""Outlines of blocks as contacts see them: corners, and the sides of convex parts.

A polygon that is not convex is cut by diagonals between its own corners only. So every side of a part is either a whole
edge of the outline or a cut, and no contact is looked for through a cut. Corners on a straight line bound no part: the
edge goes on over them, and has the number of the corner from which it starts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dda.contact.dense import Matrix
from dda.model.arrays import Array

STRAIGHT = 1e-9  # sine of the turn at a corner, up to which it counts as lying on a straight edge


class Corners(NamedTuple):
    """Corners of all blocks, (n,) each, block by block in the order of the outlines."""

    block: Any
    start: Any  # number of the block's first corner
    after: Any  # corner at which the edge ends that starts here
    convex: Any  # 1 where it can touch an edge
    now: Matrix  # (n, 2) places at the start of a step [m]
    then: Matrix  # (n, 2) places at its end, as they would be without contact


class Sides(NamedTuple):
    """Sides of convex parts, (n,) each. A side that is real is the edge with the number of its first corner."""

    corner: Any
    end: Any  # corner
    after: Any  # next side of the part
    prior: Any
    real: Any  # 0 of a cut inside a block


class Parts(NamedTuple):
    """Convex parts of blocks, (n,) each."""

    first: Any  # its sides are those from here
    last: Any  # to before this one
    block: Any
    alone: Any  # 1 of one that is its whole block
    box: Matrix  # (n, 4) left, right, low, high over a step [m]
    order: Any  # numbers of the parts in the order of the sweep


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


def outlines(polygons: Sequence[Array]) -> tuple[Corners, Sides, Parts]:
    """Return corners, sides and convex parts of blocks with the corners (n, 2) [m], at these places."""
    sizes = [len(vertices) for vertices in polygons]
    start = np.cumsum([0, *sizes[:-1]])
    convex: list[int] = []
    ends: list[int] = []
    sides: list[tuple[int, int, int, int, int]] = []
    parts: list[tuple[int, int, int]] = []
    for block, vertices in enumerate(polygons):
        ring = without_straight_corners(vertices)
        turning_left = {corner for corner, turn in zip(ring, turns_of(vertices, ring), strict=True) if turn > 0}
        convex += [int(corner in turning_left) for corner in range(len(vertices))]
        following = dict(zip(ring, ring[1:] + ring[:1], strict=True))
        ends += [int(start[block]) + following.get(corner, corner) for corner in range(len(vertices))]
        for part in convex_parts(vertices):
            first = len(sides)
            for number, corner in enumerate(part):
                end = part[(number + 1) % len(part)]
                after = first + (number + 1) % len(part)
                prior = first + (number - 1) % len(part)
                is_edge = int(following[corner] == end)
                sides.append((int(start[block]) + corner, int(start[block]) + end, after, prior, is_edge))
            parts.append((first, len(sides), block))
    places = np.vstack(polygons)
    n = len(parts)
    corners = Corners(
        block=np.repeat(np.arange(len(polygons)), sizes),
        start=np.repeat(start, sizes),
        after=np.array(ends),
        convex=np.array(convex),
        now=places.copy(),
        then=places.copy(),
    )
    first, last, owner = np.transpose(parts).copy()
    alone = (np.bincount(owner)[owner] == 1).astype(np.int64)
    return corners, Sides(*np.transpose(sides).copy()), Parts(first, last, owner, alone, np.zeros((n, 4)), np.arange(n))
