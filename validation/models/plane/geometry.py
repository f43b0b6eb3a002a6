"""How outlines lie to each other: which are near, which overlap, and which parts of edges they share."""

from __future__ import annotations

import functools
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
    for place, block in enumerate(order.tolist()):
        others = order[place + 1 : ends[place]]
        overlapping = (low[others, 1] <= high[block, 1]) & (low[block, 1] <= high[others, 1])
        for other in others[overlapping].tolist():
            yield min(block, other), max(block, other)


def overlap(first: Vertices, second: Vertices) -> float:
    """Return how deep two blocks lie in each other [m], 0 where they only touch.

    The outline of one is cut where it meets that of the other; the middle of each piece that lies inside is so far
    from the other outline. Where two outlines are the same, nothing of either lies inside: then an inner point does.
    """
    if separated(first, second) or separated(second, first):
        return 0.0
    depths = [0.0]
    for one, other in ((first, second), (second, first)):
        points = np.array([*_middles(one, other), inner_point(one)])
        within = inside(points, other)
        if within.any():
            depths.append(float(np.max(distances(points[within], other))))
    return max(depths)


def separated(outline: Vertices, neighbour: Vertices) -> bool:
    """Return whether the line of an edge of an outline has all of it on one side, and its neighbour on the other."""
    starts = np.array(outline)
    edges = np.roll(starts, -1, axis=0) - starts
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    normals = np.array([-edges[:, 1], edges[:, 0]]) / lengths  # to the left of each edge: inwards
    levels = np.sum(starts.T * normals, axis=0)
    nearest = np.min(starts @ normals - levels, axis=0)
    farthest = np.max(np.array(neighbour) @ normals - levels, axis=0)
    rounding = SAME * lengths
    return bool(np.any((nearest >= -rounding) & (farthest <= rounding)))


def _middles(one: Vertices, other: Vertices) -> Iterator[Array]:
    """Yield the middles of the pieces into which the edges of one outline are cut by those of the other."""
    starts = np.array(other)
    along = np.roll(starts, -1, axis=0) - starts
    points = np.array(one)
    for start, end in zip(points, np.roll(points, -1, axis=0), strict=True):
        edge = end - start
        crosses = edge[0] * along[:, 1] - edge[1] * along[:, 0]
        apart = starts - start
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (apart[:, 0] * along[:, 1] - apart[:, 1] * along[:, 0]) / crosses
            share_of_other = (apart[:, 0] * edge[1] - apart[:, 1] * edge[0]) / crosses
        meets = (crosses != 0) & (share > 0) & (share < 1) & (share_of_other >= 0) & (share_of_other <= 1)
        # Corners of the other outline along this edge cut it too: of an edge on the same line.
        on_edge = apart @ edge / (edge @ edge)
        cuts = np.sort(np.concatenate([[0.0, 1.0], share[meets], on_edge[(on_edge > 0) & (on_edge < 1)]]))
        for low, high in itertools.pairwise(cuts):
            yield start + (low + high) / 2 * edge


@functools.lru_cache(maxsize=128)  # asked for each neighbour of a block
def inner_point(outline: Vertices) -> Array:
    """Return a point inside an outline [m]: the centre of its largest triangle."""
    triangles = np.array(outline)[np.array(triangles_of(outline))]
    areas = [_twice_area(*triangle) for triangle in triangles]
    return np.asarray(triangles[np.argmax(areas)].mean(axis=0))


def inside(points: Array, outline: Vertices) -> NDArray[np.bool_]:
    """Return which points lie inside an outline, by the number of its edges that a ray to the right crosses."""
    x, y = points[:, :1], points[:, 1:]
    x0, y0 = np.array(outline).T
    x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = x < x0 + (y - y0) / (y1 - y0) * (x1 - x0)
    crossed = ((y0 > y) != (y1 > y)) & left
    return np.asarray(np.count_nonzero(crossed, axis=1) % 2 == 1)


def distances(points: Array, outline: Vertices) -> Array:
    """Return the distances of points from an outline [m]."""
    corners = np.array(outline)
    along = np.roll(corners, -1, axis=0) - corners
    apart = points[:, None, :] - corners
    share = np.clip(np.sum(apart * along, axis=2) / np.sum(along**2, axis=1), 0, 1)
    return np.asarray(np.min(np.linalg.norm(apart - share[:, :, None] * along, axis=2), axis=1))


def gap(first: Vertices, second: Vertices) -> float:
    """Return the distance of two outlines [m]: that of a corner from an edge, as they do not cross."""
    pairs = (first, second), (second, first)
    return min(float(np.min(distances(np.array(one), other))) for one, other in pairs)


def shared_edges(first: Vertices, second: Vertices, tolerance: float) -> Iterator[Segment]:
    """Yield the parts of edges of the first outline that are, within a tolerance [m], edges of the second one."""
    one, other = ([complex(*corner) for corner in (*outline, outline[0])] for outline in (first, second))
    for a, b in itertools.pairwise(one):
        length = abs(b - a)
        along = (b - a) / length
        for c, d in itertools.pairwise(other):
            p, q = ((place - a) * along.conjugate() for place in (d, c))
            start, end = max(0.0, p.real), min(length, q.real)
            if max(abs(p.imag), abs(q.imag)) <= tolerance and end - start > tolerance:
                ends = (a + start * along, a + end * along)
                yield (ends[0].real, ends[0].imag), (ends[1].real, ends[1].imag)


def corner_on_edge(corner: tuple[float, float], outline: Vertices, edge: int) -> tuple[float, float]:
    """Return where the foot of a corner is, as a share of an edge, and how far outside the corner is [m]."""
    start = complex(*outline[edge])
    along = complex(*outline[(edge + 1) % len(outline)]) - start
    apart = (complex(*corner) - start) * along.conjugate()
    return apart.real / abs(along) ** 2, (0.0 - apart.imag) / abs(along)


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
    """Whether a corner among those left sticks out with no other in the triangle of its neighbours."""
    corners = left[place - 1], left[place], left[(place + 1) % len(left)]
    a, b, c = points[list(corners)]
    if _twice_area(a, b, c) <= 0:
        return False
    others = points[[corner for corner in left if corner not in corners]].T
    covered = np.all([_twice_area(p, q, others) >= 0 for p, q in ((a, b), (b, c), (c, a))], axis=0)
    return not covered.any()


def _twice_area(a: Array, b: Array, c: Array) -> Array:
    """Return twice the signed area of triangles whose third corners may be many [m2]."""
    return np.asarray((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
