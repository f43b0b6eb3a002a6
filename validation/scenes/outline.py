"""Outlines of blocks: which polygons are simple, counter-clockwise and have a base and a top."""

from __future__ import annotations

import itertools

Point = tuple[float, float]


def check_polygon(vertices: tuple[Point, ...], base: int, top: int) -> None:
    """Raise ValueError for fewer than three vertices, an edge out of range, a clockwise or self-crossing outline."""
    n = len(vertices)
    if n < 3:
        raise ValueError(f"vertices must be three or more, got {n}")
    for name, index in (("base", base), ("top", top)):
        if not 0 <= index < n:
            raise ValueError(f"{name} must be an edge index from 0 to {n - 1}, got {index}")
    if base == top:
        raise ValueError(f"base and top must be different edges, got {base} twice")
    edges = [(vertices[i], vertices[(i + 1) % n]) for i in range(n)]
    if any(start == end for start, end in edges):
        raise ValueError("vertices must not repeat, got an edge of length zero")
    for i, j in itertools.combinations(range(n), 2):
        shared = {(i + 1) % n, i} & {j, (j + 1) % n}  # the corner of two edges that follow each other
        if _folds_back(vertices, *shared) if shared else _cross(edges[i], edges[j]):
            raise ValueError(f"vertices must not cross themselves, got edges {i} and {j} that do")
    if area(vertices) <= 0:
        raise ValueError("vertices must run counter-clockwise, got a clockwise outline")


def convex_quadrilateral(points: tuple[Point, ...]) -> bool:
    """Whether an outline is a counter-clockwise convex quadrilateral."""
    return len(points) == 4 and all(_turn(*(points[(i + k) % 4] for k in range(3))) > 0 for i in range(4))


def _turn(o: Point, a: Point, b: Point) -> float:
    """Twice the signed area of a triangle [m2]."""
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def area(points: tuple[Point, ...]) -> float:
    """Return the area of an outline, negative where it runs clockwise [m2]."""
    origin = points[0]
    return sum(_turn(origin, a, b) for a, b in itertools.pairwise(points[1:])) / 2


def _within(p: Point, a: Point, b: Point) -> bool:
    """Whether p, on the line through a and b, lies between them."""
    return min(a[0], b[0]) <= p[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= p[1] <= max(a[1], b[1])


def _cross(first: tuple[Point, Point], second: tuple[Point, Point]) -> bool:
    """Whether two closed segments have a point in common."""
    turns = [_turn(*line, p) for line, ends in ((first, second), (second, first)) for p in ends]
    signs = [(turn > 0) - (turn < 0) for turn in turns]
    if signs[0] * signs[1] < 0 and signs[2] * signs[3] < 0:
        return True
    touches = zip(signs, (*second, *first), (first, first, second, second), strict=True)
    return any(sign == 0 and _within(p, *line) for sign, p, line in touches)


def _folds_back(vertices: tuple[Point, ...], number: int) -> bool:
    """Whether the two edges that meet in a vertex overlap."""
    (x, y), *ends = vertices[number], vertices[number - 1], vertices[(number + 1) % len(vertices)]
    (ax, ay), (bx, by) = ends
    return _turn((x, y), *ends) == 0 and (ax - x) * (bx - x) + (ay - y) * (by - y) > 0
