r"""When two polygons in uniform motion first touch, by roots: an own way beside the query and the steps of `dda`.

Polygons that are apart first touch with a corner of one on an edge of the other. In the axes of that edge the corner is
g before it and s along it; the first touch is the least root of a g that becomes negative where 0 <= s <= L. Roots are
looked for between samples and found to rounding.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from validation.runs.history import Array

SAMPLES = 4000  # of the time that is looked at: gaps are smooth, and change their sign once between two
NEAR = 1e-9  # share of an edge, nearer to whose end a corner touches a corner


@dataclass(frozen=True)
class MovingPolygon:
    """A rigid polygon that moves uniformly and turns about its centroid."""

    corners: Array  # (n, 2) from the centroid, at t = 0 [m]
    centroid: tuple[float, float]  # at t = 0 [m]
    velocity: tuple[float, float]  # m/s
    spin: float  # rad/s

    def at(self, times: Array) -> Array:
        """Return the corners at times, shape (times, n, 2) [m]."""
        turn = self.spin * times
        cosine = np.cos(turn)[:, None]
        sine = np.sin(turn)[:, None]
        x, y = self.corners.T
        middle = np.array(self.centroid) + times[:, None] * np.array(self.velocity)
        placed: Array = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1) + middle[:, None, :]
        return placed

    def corner(self, number: int, time: float) -> complex:
        """Return the place of a corner at a time, x + i y [m]."""
        turned = complex(*self.corners[number].tolist()) * cmath.rect(1.0, self.spin * time)
        return turned + complex(*self.centroid) + time * complex(*self.velocity)


@dataclass(frozen=True)
class FirstTouch:
    """A corner on an edge, when they first touch."""

    time: float  # s
    block: int  # whose corner it is: 0 or 1
    corner: int
    edge: int  # of the other one
    foot: float  # share of the edge
    normal: float  # direction of the force on polygon 0 [rad]


def first_touches(first: MovingPolygon, second: MovingPolygon, until: float, together: float) -> list[FirstTouch]:
    """Return the first touch of two polygons, and others that follow it within a time [s]."""
    times = np.linspace(0.0, until, SAMPLES + 1)
    rings = [polygon.at(times) @ (1, 1j) for polygon in (first, second)]
    touches = []
    for block, (mover, other) in enumerate(((first, second), (second, first))):
        for edge in range(len(other.corners)):
            start = rings[1 - block][:, edge, None]
            end = rings[1 - block][:, edge - len(other.corners) + 1, None]
            gaps = -((rings[block] - start) * np.conj(end - start)).imag  # in areas; of all corners
            for corner in range(len(mover.corners)):
                touch = _touch(mover, other, corner, edge, times, gaps[:, corner])
                if touch is not None:
                    time, foot, normal = touch
                    touches.append(FirstTouch(time, block, corner, edge, foot, normal + math.pi * block))
    touches.sort(key=lambda touch: (touch.time, touch.block, touch.corner, touch.edge))
    return [touch for touch in touches if touch.time <= touches[0].time + together]


def _touch(
    mover: MovingPolygon, other: MovingPolygon, corner: int, edge: int, times: Array, gap: Array
) -> tuple[float, float, float] | None:
    """Return when a corner crosses an edge from before [s], at which share, and the edge's normal [rad]."""

    def in_axes(time: float) -> tuple[complex, complex]:
        """Return the corner along the edge and behind it, and the edge [m]."""
        start = other.corner(edge, time)
        along = other.corner(edge - len(other.corners) + 1, time) - start
        return (mover.corner(corner, time) - start) * along.conjugate() / abs(along), along

    for k in np.flatnonzero((gap[:-1] > 0) & (gap[1:] <= 0)):
        time = brentq(lambda t: in_axes(t)[0].imag, times[k], times[k + 1], xtol=1e-15, rtol=1e-14)
        place, along = in_axes(time)
        foot = place.real / abs(along)
        if -1e-12 <= foot <= 1 + 1e-12:
            return time, foot, cmath.phase(-1j * along)
    return None


def normals(first: MovingPolygon, second: MovingPolygon, touch: FirstTouch) -> tuple[float, float]:
    """Return the least and the greatest direction that a force on the first polygon may have [rad].

    A corner inside an edge has the edge's normal; a corner on a corner any direction that is a normal of both.
    """
    if NEAR < touch.foot < 1 - NEAR:
        return touch.normal, touch.normal
    mover, other = (second, first) if touch.block else (first, second)
    hit = (touch.edge + (touch.foot > 0.5)) % len(other.corners)
    low, high = _cone(other, hit, touch.time)
    own_low, own_high = (direction + math.pi for direction in _cone(mover, touch.corner, touch.time))
    shift = 2 * math.pi * round((low + high - own_low - own_high) / (4 * math.pi))
    turned = math.pi * touch.block
    return max(low, own_low + shift) + turned, min(high, own_high + shift) + turned


def _cone(polygon: MovingPolygon, corner: int, time: float) -> tuple[float, float]:
    """Return the normals of the two edges that meet in a corner, counter-clockwise [rad]."""
    corners = polygon.at(np.array([time]))[0]
    before, here, after = (corners[(corner + k) % len(corners)] for k in (-1, 0, 1))
    first, second = (math.atan2(-along[0], along[1]) for along in (here - before, after - here))
    return first, first + (second - first) % (2 * math.pi)
