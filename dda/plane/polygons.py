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
from dda.plane.bodies import Points

STRAIGHT = 1e-9  # sine of the turn at a corner, up to which it counts as lying on a straight edge


class Corners(NamedTuple):
    """Corners of all blocks, (n,) each, block by block in the order of the outlines."""

    block: Any
    start: Any  # number of the block's first corner
    after: Any  # corner at which the edge ends that starts here
    convex: Any  # 1 where it can touch an edge
    now: Points  # (n,) places at the start of a step
    then: Points  # (n,) places at its end, as they would be without contact


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


def turns_of(vertices: Points, ring: Sequence[int]) -> Array:
    """Return the sines of the turns at the corners of a ring, positive to the left."""
    places = vertices[list(ring)]
    edges = np.roll(places, -1) - places
    products = np.roll(edges, 1).conj() * edges
    return np.asarray(products.imag / np.abs(products))


def without_straight_corners(vertices: Points) -> list[int]:
    """Return the corners at which an outline turns."""
    turns = turns_of(vertices, range(len(vertices)))
    return [int(corner) for corner in np.flatnonzero(np.abs(turns) > STRAIGHT)]


def convex_parts(vertices: Points) -> list[list[int]]:
    """Return convex parts of a simple counter-clockwise polygon, as rings of its corners.

    Ears are cut off, and parts joined again wherever what they make is convex (Hertel and Mehlhorn): at most four times
    as many parts as there must be.
    """
    ring = without_straight_corners(vertices)
    if min(turns_of(vertices, ring)) > 0:
        return [ring]
    return _joined(vertices, _triangles(vertices, ring))


def _triangles(vertices: Points, ring: list[int]) -> list[list[int]]:
    triangles = []
    while len(ring) > 3:
        ear = next(number for number in range(len(ring)) if _is_ear(vertices, ring, number))
        triangles.append([ring[ear - 1], ring[ear], ring[(ear + 1) % len(ring)]])
        ring = ring[:ear] + ring[ear + 1 :]
    return [*triangles, ring]


def _is_ear(vertices: Points, ring: list[int], number: int) -> bool:
    """Tell whether a corner and its neighbours make a triangle that no other corner lies in or on."""
    triangle = [ring[number - 1], ring[number], ring[(number + 1) % len(ring)]]
    if turns_of(vertices, triangle)[1] <= 0:
        return False
    starts = vertices[triangle][:, None]
    edges = np.roll(starts, -1, axis=0) - starts
    others = vertices[[corner for corner in ring if corner not in triangle]]
    across = (edges.conj() * (others - starts)).imag
    return not np.any(np.all(across >= -STRAIGHT * np.abs(edges) ** 2, axis=0))


def _joined(vertices: Points, parts: list[list[int]]) -> list[list[int]]:
    """Return the parts with every cut left out that convexity does not need."""
    for start, end in list(_rings_by_side(parts)):
        rings = _rings_by_side(parts)
        left = rings.get((start, end))
        right = rings.get((end, start))
        if left is None or right is None:  # an edge of the outline, or a cut left out already
            continue
        at = left.index(end)
        opposite = right.index(start)
        union = left[at:] + left[:at] + (right[opposite:] + right[:opposite])[1:-1]
        if min(turns_of(vertices, union)) > STRAIGHT:
            parts = [ring for ring in parts if ring not in (left, right)] + [union]
    return parts


def _rings_by_side(parts: list[list[int]]) -> dict[tuple[int, int], list[int]]:
    """Return the ring of every side, by the corners at which it starts and ends."""
    return {(ring[number - 1], ring[number]): ring for ring in parts for number in range(len(ring))}


def outlines(polygons: Sequence[Points]) -> tuple[Corners, Sides, Parts]:
    """Return corners, sides and convex parts of blocks with these corners."""
    places = np.concatenate(polygons)
    sizes = [len(vertices) for vertices in polygons]
    start = np.cumsum([0, *sizes[:-1]])
    after = np.arange(len(places))
    convex = np.zeros(len(places), dtype=np.int64)
    sides: list[list[int]] = []
    parts: list[tuple[int, int, int, int]] = []
    for block, vertices in enumerate(polygons):
        ring = without_straight_corners(vertices)
        corners = start[block] + np.array(ring)
        after[corners] = np.roll(corners, -1)
        convex[corners] = turns_of(vertices, ring) > 0
        rings = convex_parts(vertices)
        for part in rings:
            first = len(sides)
            numbers = first + np.arange(len(part))
            own = start[block] + np.array(part)
            ends = np.roll(own, -1)
            real = after[own] == ends
            sides += np.transpose([own, ends, np.roll(numbers, -1), np.roll(numbers, 1), real]).tolist()
            parts.append((first, len(sides), block, int(len(rings) == 1)))
    first_side, last_side, owner, alone = np.transpose(parts).copy()
    return (
        Corners(
            block=np.repeat(np.arange(len(polygons)), sizes),
            start=np.repeat(start, sizes),
            after=after,
            convex=convex,
            now=places.copy(),
            then=places.copy(),
        ),
        Sides(*np.transpose(np.array(sides, dtype=np.int64)).copy()),
        Parts(first_side, last_side, owner, alone, np.zeros((len(parts), 4)), np.arange(len(parts))),
    )
