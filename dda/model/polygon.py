"""Area integrals of simple polygons, exact in exact arithmetic and free of far-origin rounding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dda.model.arrays import Array


@dataclass(frozen=True)
class AreaIntegrals:
    """Integrals over a polygon about the origin of its coordinates."""

    area: float  # integral of 1 [m^2]
    x: float  # integral of x [m^3]
    y: float  # integral of y [m^3]
    xx: float  # integral of x^2 [m^4]
    yy: float  # integral of y^2 [m^4]
    xy: float  # integral of x y [m^4]


@dataclass(frozen=True)
class Section:
    """Area, centroid and central second moments: s, (x0, y0), s1, s2, s3 of eq. (16)."""

    area: float  # s [m^2]
    centroid: tuple[float, float]  # (x0, y0) [m]
    s1: float  # integral of (x - x0)^2 [m^4]
    s2: float  # integral of (y - y0)^2 [m^4]
    s3: float  # integral of (x - x0)(y - y0) [m^4]


def area_integrals(vertices: Array) -> AreaIntegrals:
    """Integrate 1, x, y, x^2, y^2 and xy over a polygon by Green's theorem.

    Its corners, (n, 2) [m], are counter-clockwise; the origin should lie near them.
    """
    x, y = vertices.T
    X, Y = np.roll(vertices, -1, axis=0).T
    moments = np.array(
        [
            np.ones(len(x)),
            x + X,
            y + Y,
            x * x + x * X + X * X,
            y * y + y * Y + Y * Y,
            x * Y + 2 * x * y + 2 * X * Y + X * y,
        ]
    )
    totals = np.sum((x * Y - X * y) * moments, axis=1) / np.array([2, 6, 6, 12, 12, 24])
    return AreaIntegrals(*totals.tolist())


def section(vertices: Array) -> Section:
    """Return area, centroid and central moments, evaluated about a local origin.

    The corners are shifted by the first corner, then by the centroid, so that a block
    far from the origin keeps the digits that its coordinates hold.
    """
    local = vertices - vertices[0]
    first = area_integrals(local)
    shift = np.array([first.x / first.area, first.y / first.area])
    i = area_integrals(local - shift)
    x0, y0 = vertices[0] + shift
    return Section(i.area, (float(x0), float(y0)), i.xx, i.yy, i.xy)


def checked_polygon(vertices: ArrayLike) -> Array:
    """Return the corners as a read-only (n, 2) array of a simple counter-clockwise polygon.

    Raises
    ------
    ValueError
        If the shape is not (n >= 3, 2), a coordinate is not finite, an edge has no length,
        edges cross or touch, or the corners run clockwise.
    """
    points = np.array(vertices, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
        raise ValueError(f"vertices: at least three corners [x, y] are needed, got shape {points.shape}")
    if not np.all(np.isfinite(points)):
        raise ValueError(f"vertices: coordinates must be finite, got {points.tolist()}")
    local = points - points[0]
    if fault := _fault(local):
        raise ValueError(f"vertices: {fault}, got {points.tolist()}")
    points.setflags(write=False)
    return points


def _fault(local: Array) -> str | None:
    """Return what keeps corners, relative to the first, from being a simple counter-clockwise polygon."""
    if not np.all(np.any(np.roll(local, -1, axis=0) != local, axis=1)):
        return "consecutive corners must differ"
    if _touches_itself(local):
        return "edges must not cross or touch each other"
    return None if area_integrals(local).area > 0 else "corners must run counter-clockwise"


def _orientation(a: Array, b: Array, c: Array) -> Array:
    """Return the sign of the turn a-b-c, zero on a line."""
    turn = (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
    return np.sign(turn)


def _touches_itself(points: Array) -> bool:
    """Tell whether two edges meet anywhere but in the corner that neighbours share."""
    n = len(points)
    following = np.roll(points, -1, axis=0)
    i, j = np.triu_indices(n, 1)
    apart = (j - i > 1) & ~((i == 0) & (j == n - 1))
    a = points[i]
    b = following[i]
    c = points[j]
    d = following[j]
    # each edge has the ends of the other one on both sides of its line, or on it; of edges on one line boxes decide
    across = (_orientation(a, b, c) * _orientation(a, b, d) <= 0) & (_orientation(c, d, a) * _orientation(c, d, b) <= 0)
    beside = np.all((np.minimum(a, b) <= np.maximum(c, d)) & (np.minimum(c, d) <= np.maximum(a, b)), axis=1)
    if np.any(apart & across & beside):
        return True
    before = np.roll(points, 1, axis=0)
    along = np.sum((points - before) * (following - points), axis=1)
    return bool(np.any((_orientation(before, points, following) == 0) & (along < 0)))
