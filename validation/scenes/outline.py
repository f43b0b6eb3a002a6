"""Outlines of blocks: which polygons are simple, counter-clockwise and have a base and a top."""

from __future__ import annotations

import itertools

Point = tuple[float, float]


def check_polygon(vertices: tuple[Point, ...], base: int, top: int) -> None:
    """Check that a polygon is simple, counter-clockwise and has the two edges.

    Raises
    ------
    ValueError
        Fewer than three vertices, an edge index out of range, a clockwise or self-crossing outline.
    """
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
        adjacent = j == i + 1 or (i == 0 and j == n - 1)
        if _folds_back(edges[i], edges[j]) if adjacent else _cross(edges[i], edges[j]):
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
    (a, b), (c, d) = first, second
    t1, t2, t3, t4 = _turn(a, b, c), _turn(a, b, d), _turn(c, d, a), _turn(c, d, b)
    if ((t1 > 0) - (t1 < 0)) * ((t2 > 0) - (t2 < 0)) < 0 and ((t3 > 0) - (t3 < 0)) * ((t4 > 0) - (t4 < 0)) < 0:
        return True
    touches = ((t1, c, a, b), (t2, d, a, b), (t3, a, c, d), (t4, b, c, d))
    return any(t == 0 and _within(p, s, e) for t, p, s, e in touches)


def _folds_back(first: tuple[Point, Point], second: tuple[Point, Point]) -> bool:
    """Whether two edges that share a vertex overlap."""
    shared = first[1] if first[1] in second else first[0]
    a = first[0] if first[1] == shared else first[1]
    b = second[1] if second[0] == shared else second[0]
    forward = (a[0] - shared[0]) * (b[0] - shared[0]) + (a[1] - shared[1]) * (b[1] - shared[1])
    return _turn(shared, a, b) == 0 and forward > 0
