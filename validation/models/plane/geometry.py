"""How outlines lie to each other: which are near, which overlap, and the parts of edges that two of them share."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from validation.models.plane.blocks import Vertices
from validation.runs.history import Array

SAME = 1e-9  # of a block's thickness: rounding of corners that were meant to be one
Segment = tuple[tuple[float, float], tuple[float, float]]


def near_pairs(outlines: Sequence[Vertices], reach: Array) -> Iterator[tuple[int, int]]:
    """Yield the pairs, first below second, whose boxes grown by a reach each [m] have a point in common."""
    low = np.array([np.min(outline, axis=0) for outline in outlines]) - reach[:, None]
    high = np.array([np.max(outline, axis=0) for outline in outlines]) + reach[:, None]
    order = np.argsort(low[:, 0], kind="stable")
    ends = np.searchsorted(low[order, 0], high[order, 0], side="right")
    for place, block in enumerate(order):
        others = order[place + 1 : ends[place]]
        overlapping = (low[others, 1] <= high[block, 1]) & (low[block, 1] <= high[others, 1])
        for other in others[overlapping]:
            yield (int(block), int(other)) if block < other else (int(other), int(block))


def overlap(first: Vertices, second: Vertices) -> float:
    """Return how deep two blocks lie in each other [m], 0 where they only touch.

    The outline of one is cut where it meets that of the other; the middle of each piece that lies inside is so far
    from the other outline. Where two outlines are the same, nothing of either lies inside: then an inner point does.
    """
    depths = [0.0]
    for one, other in ((first, second), (second, first)):
        points = np.array([*_middles(one, other), inner_point(one)])
        within = inside(points, other)
        if within.any():
            depths.append(float(np.max(distances(points[within], other))))
    return max(depths)


def _middles(one: Vertices, other: Vertices) -> Iterator[Array]:
    """Yield the middles of the pieces into which the edges of one outline are cut by those of the other."""
    starts = np.array(other)
    along = np.roll(starts, -1, axis=0) - starts
    for start, end in _edges(one):
        edge = end - start
        crosses = edge[0] * along[:, 1] - edge[1] * along[:, 0]
        apart = starts - start
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (apart[:, 0] * along[:, 1] - apart[:, 1] * along[:, 0]) / crosses
            share_of_other = (apart[:, 0] * edge[1] - apart[:, 1] * edge[0]) / crosses
        meets = (crosses != 0) & (share > 0) & (share < 1) & (share_of_other >= 0) & (share_of_other <= 1)
        # Corners of the other outline that lie along this edge cut it too: of an edge of the other on the same line.
        on_edge = apart @ edge / (edge @ edge)
        cuts = np.sort(np.concatenate([[0.0, 1.0], share[meets], on_edge[(on_edge > 0) & (on_edge < 1)]]))
        for low, high in itertools.pairwise(cuts):
            yield start + (low + high) / 2 * edge


def _edges(outline: Vertices) -> Iterator[tuple[Array, Array]]:
    points = np.array(outline)
    yield from zip(points, np.roll(points, -1, axis=0), strict=True)


def inner_point(outline: Vertices) -> Array:
    """Return a point inside an outline [m]: the centre of its largest triangle."""
    triangles = np.array(outline)[np.array(triangles_of(outline))]
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    largest = int(np.argmax(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
    centre: Array = triangles[largest].mean(axis=0)
    return centre


def inside(points: Array, outline: Vertices) -> NDArray[np.bool_]:
    """Return which points lie inside an outline, by the number of its edges that a ray to the right crosses."""
    x, y = points[:, :1], points[:, 1:]
    corners = np.array(outline)
    following = np.roll(corners, -1, axis=0)
    spans = (corners[:, 1] > y) != (following[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (y - corners[:, 1]) / (following[:, 1] - corners[:, 1])
        crossed = spans & (x < corners[:, 0] + share * (following[:, 0] - corners[:, 0]))
    within: NDArray[np.bool_] = np.count_nonzero(crossed, axis=1) % 2 == 1
    return within


def distances(points: Array, outline: Vertices) -> Array:
    """Return the distances of points from an outline [m]."""
    corners = np.array(outline)
    along = np.roll(corners, -1, axis=0) - corners
    apart = points[:, None, :] - corners
    share = np.clip(np.sum(apart * along, axis=2) / np.sum(along**2, axis=1), 0, 1)
    nearest: Array = np.min(np.linalg.norm(apart - share[:, :, None] * along, axis=2), axis=1)
    return nearest


def gap(first: Vertices, second: Vertices) -> float:
    """Return the distance of two outlines [m]: that of a corner from an edge, as they do not cross."""
    return min(float(np.min(distances(np.array(first), second))), float(np.min(distances(np.array(second), first))))


def shared_edges(first: Vertices, second: Vertices, tolerance: float) -> Iterator[Segment]:
    """Yield the parts of edges of the first outline that are, within a tolerance [m], edges of the second one."""
    for a, b in _edges(first):
        length = float(np.hypot(*(b - a)))
        along = (b - a) / length
        for c, d in _edges(second):
            offsets = [abs(along[0] * (point - a)[1] - along[1] * (point - a)[0]) for point in (c, d)]
            start, end = max(0.0, float((d - a) @ along)), min(length, float((c - a) @ along))
            if max(offsets) <= tolerance and (d - c) @ along < 0 and end - start > tolerance:
                p, q = a + start * along, a + end * along
                yield (float(p[0]), float(p[1])), (float(q[0]), float(q[1]))


def corner_on_edge(corner: tuple[float, float], outline: Vertices, edge: int) -> tuple[float, float]:
    """Return where along an edge the foot of a corner is, as a share of it, and how far outside the corner is [m]."""
    start = np.array(outline[edge])
    along = np.array(outline[(edge + 1) % len(outline)]) - start
    apart = np.array(corner) - start
    share = float(apart @ along) / float(along @ along)
    outward = np.array([along[1], -along[0]]) / np.hypot(*along)  # of an outline that runs counter-clockwise
    return share, float(apart @ outward)


def triangles_of(outline: Vertices) -> list[tuple[int, int, int]]:
    """Return triangles of corners that tile an outline, by cutting off its ears one after the other."""
    points = np.array(outline)
    left = list(range(len(points)))
    triangles = []
    while len(left) > 3:
        place = next((k for k in range(len(left)) if _is_ear(points, left, k)), 0)  # rounding may leave none
        triangles.append((left[place - 1], left[place], left[(place + 1) % len(left)]))
        del left[place]
    return [*triangles, (left[0], left[1], left[2])]


def _is_ear(points: Array, left: list[int], place: int) -> bool:
    """Whether a corner among those that are left sticks out with no other one in the triangle of its neighbours."""
    corners = left[place - 1], left[place], left[(place + 1) % len(left)]
    a, b, c = points[list(corners)]
    if _twice_area(a, b, c) <= 0:
        return False
    others = points[[corner for corner in left if corner not in corners]]
    covered = np.all([_twice_area(p, q, others.T[:, :, None]) >= 0 for p, q in ((a, b), (b, c), (c, a))], axis=0)
    return not covered.any()


def _twice_area(a: Array, b: Array, c: Array) -> Array:
    """Return twice the signed area of triangles whose third corners may be many [m2]."""
    area: Array = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return area
