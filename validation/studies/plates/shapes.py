"""Meshes of a ring and of a disc: triangles in each quarter, mirrored, so that opposite points move alike."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

Point = tuple[float, float]
Triangle = tuple[Point, Point, Point]


def ring(inner: float, outer: float, n: int) -> list[Triangle]:
    """Return a ring: n x n cells a quarter, radii in geometric progression, cut from inner-lower to outer-upper."""
    radii = [inner * (outer / inner) ** (k / n) for k in range(n + 1)]
    return list(_mirrored(_cells(radii, n)))


def disc(radius: float, n: int) -> list[Triangle]:
    """Return a disc: n cells along a quarter and half as many along the radius, triangles about the centre."""
    radii = [2 * radius * k / n for k in range(1, n // 2 + 1)]
    middle = [((0.0, 0.0), _at(radii[0], j, n), _at(radii[0], j + 1, n)) for j in range(n)]
    return list(_mirrored([*middle, *_cells(radii, n)]))


def outline(triangles: list[Triangle], radius: float) -> list[tuple[Point, Point]]:
    """Return the edges whose ends lie on a circle, counter-clockwise as their triangles have them."""
    edges = []
    for corners in triangles:
        for start, end in zip(corners, (*corners[1:], corners[0]), strict=True):
            if all(abs(math.hypot(*point) - radius) < 1e-9 * radius for point in (start, end)):
                edges.append((start, end))
    return edges


def _at(radius: float, j: int, n: int) -> Point:
    """Return a node of the first quarter; those on the axes lie on them to the last digit, so that mirrors meet."""
    angle = math.pi / 2 * j / n
    return (0.0 if j == n else radius * math.cos(angle), 0.0 if j == 0 else radius * math.sin(angle))


def _cells(radii: list[float], n: int) -> list[Triangle]:
    triangles = []
    for low, high in itertools.pairwise(radii):
        for j in range(n):
            a = _at(low, j, n)
            b = _at(high, j, n)
            c = _at(high, j + 1, n)
            d = _at(low, j + 1, n)
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def _mirrored(quarter: list[Triangle]) -> Iterator[Triangle]:
    """Yield a quarter and its mirror images, each counter-clockwise."""
    for x in (1.0, -1.0):
        for y in (1.0, -1.0):
            for corners in quarter:
                images = [(x * a + 0.0, y * b + 0.0) for a, b in corners]
                first, second, third = images if x * y > 0 else images[::-1]
                yield first, second, third
