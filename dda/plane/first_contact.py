r"""When and where two polygons in uniform motion first touch.

Polygons that are apart first touch with a corner of one on an edge of the other, its ends included. In the axes of that
edge a corner is the distance s along it and the gap g before it, and they do not touch while one of

    g,  -g,  -s,  s - L

is positive. With the motion x = o + v t + R(theta + omega t) xi of every point, the origins apart by o + v t, each of
these changes from w at an instant to at least

    w + w' tau - M tau^2 / 2,    M = omega_e^2 max|o + v t| + 2 |omega_e| |v| + (omega_c - omega_e)^2 |xi_c|,

so that the pair does not touch before the root of this bound. The least of these times over all pairs is safe, and
advancing by it reaches the first touch from before as Newton's method does, a grazing one by halves.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dda.model.checks import check_finite, check_positive
from dda.model.polygon import checked_polygon
from dda.plane.bodies import Points, as_complex
from dda.plane.polygons import convex_parts, turns_of, without_straight_corners

CORNER_EDGE = "corner-edge"
CORNER_CORNER = "corner-corner"
EDGE_EDGE = "edge-edge"
NEAR = 1e-9  # of the size, within which places coincide at the first touch and edges lie on each other
ROUNDING = 16 * np.finfo(float).eps  # of the size, within which a distance counts as none
ADVANCES = 100_000  # after which the search gives up; a fast spin beside a long way needs some thousand


class UniformMotion(NamedTuple):
    """Motion of a polygon's own origin, x = (x, y) + (vx, vy) t, and its turn, angle + spin t."""

    x: float  # [m]
    y: float
    angle: float  # [rad]
    vx: float  # [m/s]
    vy: float
    spin: float  # [rad/s]

    def turn(self, time: float) -> complex:
        """Return the turn of the polygon, exp(i angle)."""
        return cmath.exp(1j * (self.angle + self.spin * time))


class TouchingCorner(NamedTuple):
    """A corner of one polygon on an edge of the other."""

    block: int  # whose corner it is: 0 of A, 1 of B
    corner: int
    edge: int  # of the other one, from its corner of this number
    foot: float  # share of the edge at which it is touched, 0 to 1


class Touch(NamedTuple):
    """One place, or two edges, where polygons touch."""

    kind: str  # "corner-edge", "corner-corner" or "edge-edge"
    points: tuple[TouchingCorner, ...]  # one; of a corner at a corner that of A and that of B; of edges both ends
    normals: tuple[float, float]  # least and greatest direction of a normal, from B to A, against x [rad]


class FirstContact(NamedTuple):
    """When two polygons first touch, and all places where they do."""

    time: float  # [s]
    touches: tuple[Touch, ...]  # by the number of their first corner


def first_contact(
    A: ArrayLike, B: ArrayLike, motion_A: Sequence[float], motion_B: Sequence[float], until: float
) -> FirstContact | None:
    """Return the first contact of two polygons in uniform motion, None where there is none until then.

    Polygons that touch at t = 0 have their first contact there, whether they part or not.

    Parameters
    ----------
    A, B : (n, 2) arrays [m]
        Corners about their own origins, counter-clockwise; they need not be convex.
    motion_A, motion_B : six numbers
        `UniformMotion`: place, angle, velocity and spin of the origin.
    until : float [s]
        Last instant that is looked at.

    Raises
    ------
    ValueError
        If an outline or a number is not one, or the polygons overlap at t = 0.
    RuntimeError
        If they come no nearer to a decision in 100,000 advances.

    Examples
    --------
    >>> square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    >>> contact = first_contact(square, square, (0.5, 3, 0, 0, -1, 0), (0, 0, 0, 0, 0, 0), 2.0)
    >>> contact.time, contact.touches[0].kind
    (1.0, 'edge-edge')
    """
    polygons = as_complex(checked_polygon(A)), as_complex(checked_polygon(B))
    motions = UniformMotion(*motion_A), UniformMotion(*motion_B)
    for motion in motions:
        check_finite(**motion._asdict())
    check_positive(until=until)
    extents = [max(np.ptp(polygon.real), np.ptp(polygon.imag)) for polygon in polygons]
    start = [complex(one.x, one.y) + polygon * one.turn(0.0) for polygon, one in zip(polygons, motions, strict=True)]
    rounding = ROUNDING * max(np.max(np.abs(place - start[1][0])) for place in start)
    near = NEAR * min(extents) + rounding
    if overlap(*start) > near:
        raise ValueError("polygons: must not overlap at t = 0")
    A_on_B = Pairs(polygons[0], polygons[1], motions[0], motions[1])
    B_on_A = Pairs(polygons[1], polygons[0], motions[1], motions[0])
    time = 0.0
    window = until
    tolerance = near
    for _ in range(ADVANCES):
        safe = min(pairs.safe_time(time, window, tolerance) for pairs in (A_on_B, B_on_A))
        if safe == 0.0:
            return FirstContact(time, touches_at(time, A_on_B, B_on_A, near))
        if time >= until:
            return None
        time = min(time + safe, until)
        window = max(4 * safe, 1e-9 * until)
        tolerance = rounding
    raise RuntimeError(f"first contact: no decision after {ADVANCES} advances, at t = {time!r} s")


def overlap(A: Points, B: Points) -> float:
    """Return how deep two polygons lie in each other, negative where they are apart [m].

    It is that of the convex parts that lie deepest, through the edge by which they part soonest.
    """
    pairs = product([A[ring] for ring in convex_parts(A)], [B[ring] for ring in convex_parts(B)])
    return max(-max(separation(a, b), separation(b, a)) for a, b in pairs)


def separation(ring: Points, points: Points) -> float:
    """Return the greatest distance that points keep from the line of an edge of a convex ring [m]."""
    tangents = np.roll(ring, -1) - ring
    gaps = ((points - ring[:, None]) * (tangents / np.abs(tangents)).conj()[:, None]).imag
    return float(np.max(np.min(-gaps, axis=1)))


class Place(NamedTuple):
    """Where a corner lies on an edge, and all edges that it lies on."""

    point: TouchingCorner
    at: complex  # from the origin of B [m]
    on_a: tuple[int, ...]
    on_b: tuple[int, ...]

    def coincides(self, other: Place, near: float) -> bool:
        """Tell whether another place is the same one."""
        return bool(abs(self.at - other.at) <= 4 * near)


class Pairs:
    """All corners of a polygon that can touch, beside all edges of another one."""

    def __init__(self, outline: Points, other: Points, motion: UniformMotion, motion_of_edges: UniformMotion) -> None:
        self.ring = without_straight_corners(outline)
        turns = turns_of(outline, self.ring)
        self.corners = [corner for corner, turn in zip(self.ring, turns, strict=True) if turn > 0]
        self.edges = without_straight_corners(other)
        self.xi = outline[self.corners]
        self.starts = other[self.edges]
        sides = np.roll(self.starts, -1) - self.starts
        self.lengths = np.abs(sides)
        self.tangents = sides / self.lengths
        self.motion = motion
        self.motion_of_edges = motion_of_edges
        self.origin = complex(motion.x - motion_of_edges.x, motion.y - motion_of_edges.y)
        self.velocity = complex(motion.vx - motion_of_edges.vx, motion.vy - motion_of_edges.vy)

    def relative(self, time: float) -> tuple[Points, Points]:
        """Return s - i g of all corners and edges, (corners, edges) [m], and its rate in the axes of the edges."""
        from_origin = self.xi * self.motion.turn(time)
        turn = self.motion_of_edges.turn(time)
        places = self.origin + self.velocity * time + from_origin
        rates = self.velocity + 1j * (self.motion.spin * from_origin - self.motion_of_edges.spin * places)
        axes = (self.tangents * turn).conj()
        return (places[:, None] - self.starts * turn) * axes, rates[:, None] * axes

    def safe_time(self, time: float, window: float, tolerance: float) -> float:
        """Return for how long no corner touches an edge, at most the window; 0 where one touches [s]."""
        place, rates = self.relative(time)
        apart = np.stack([-place.imag, place.imag, -place.real, place.real - self.lengths])
        rate = np.stack([-rates.imag, rates.imag, -rates.real, rates.real])
        spin = self.motion_of_edges.spin
        distance = max(abs(self.origin + self.velocity * instant) for instant in (time, time + window))
        bend = spin**2 * distance + 2 * abs(spin) * abs(self.velocity)
        bends = bend + (self.motion.spin - spin) ** 2 * np.abs(self.xi)[:, None]
        w = np.maximum(apart, 0.0)
        root = np.sqrt(rate**2 + 2 * bends * w)
        with np.errstate(divide="ignore", invalid="ignore"):
            # the root of w + w' tau - M tau^2 / 2, without cancellation for either sign of w'
            bounds = np.where(rate < 0, 2 * w / (root - rate), (root + rate) / bends)
        bounds = np.where((rate >= 0) & (bends == 0), window, bounds)
        bounds = np.where(apart > tolerance, bounds, 0.0)
        return float(min(np.min(np.max(bounds, axis=0)), window))

    def touching(self, time: float, near: float, block: int) -> list[Place]:
        """Return every corner that lies on an edge; the corners are those of A, block 0, or of B."""
        places, _ = self.relative(time)
        along = places.real
        origin = self.origin + self.velocity * time if block == 0 else 0.0
        on_edge = (np.abs(places.imag) <= near) & (along >= -near) & (along <= self.lengths + near)
        touching = []
        for corner, edge in np.argwhere(on_edge).tolist():
            foot = float(np.clip(along[corner, edge] / self.lengths[edge], 0.0, 1.0))
            point = TouchingCorner(block, self.corners[corner], self.edges[edge], foot)
            at = complex(origin + self.xi[corner] * self.motion.turn(time))
            edges = self.edges_at(point.corner), (point.edge,)
            touching.append(Place(point, at, edges[block], edges[1 - block]))
        return touching

    def direction(self, edge: int, time: float) -> float:
        """Return the direction of an edge's outward normal against x, the edge by the number of its corner [rad]."""
        normal = -1j * complex(self.tangents[self.edges.index(edge)])
        return cmath.phase(normal) + self.motion_of_edges.angle + self.motion_of_edges.spin * time

    def edges_at(self, corner: int) -> tuple[int, int]:
        """Return the two edges of the corners' own polygon that meet in one of its corners."""
        return self.ring[self.ring.index(corner) - 1], corner


def touches_at(time: float, A_on_B: Pairs, B_on_A: Pairs, near: float) -> tuple[Touch, ...]:
    """Return all places at which two polygons touch; edges that lie on each other are one touch."""
    places = A_on_B.touching(time, near, 0) + B_on_A.touching(time, near, 1)
    touches = []
    on_edges: list[Place] = []
    for edge_of_A, edge_of_B in sorted({(a, b) for place in places for a in place.on_a for b in place.on_b}):
        shared = [place for place in places if edge_of_A in place.on_a and edge_of_B in place.on_b]
        ends = distinct(shared, near)
        if len(ends) > 1:
            points = tuple(place.point for place in ends)
            touches.append(Touch(EDGE_EDGE, points, one_normal(A_on_B.direction(edge_of_B, time))))
            on_edges += ends
    for first in distinct([place for place in places if not any(place.coincides(end, near) for end in on_edges)], near):
        here = [place.point for place in places if place.coincides(first, near)]
        of_A = [point for point in here if point.block == 0]
        of_B = [point for point in here if point.block == 1]
        if of_A and of_B:
            normals = common_normals(time, A_on_B, B_on_A, of_A[0].corner, of_B[0].corner)
            touches.append(Touch(CORNER_CORNER, (of_A[0], of_B[0]), normals))
            continue
        for point in here:
            edges = A_on_B if point.block == 0 else B_on_A
            direction = edges.direction(point.edge, time) + math.pi * point.block
            touches.append(Touch(CORNER_EDGE, (point,), one_normal(direction)))
    return tuple(sorted(touches, key=lambda touch: touch.points))


def distinct(places: list[Place], near: float) -> list[Place]:
    """Return the first of all places that coincide."""
    kept: list[Place] = []
    for place in places:
        if not any(place.coincides(other, near) for other in kept):
            kept.append(place)
    return kept


def one_normal(direction: float) -> tuple[float, float]:
    """Return the interval of one direction, within half a turn of x [rad]."""
    within = math.remainder(direction, 2 * math.pi)
    return within, within


def common_normals(
    time: float, A_on_B: Pairs, B_on_A: Pairs, corner_of_A: int, corner_of_B: int
) -> tuple[float, float]:
    """Return the directions that are normals, from B to A, of both corners: what their two cones share [rad]."""
    from_B = [A_on_B.direction(edge, time) for edge in B_on_A.edges_at(corner_of_B)]
    from_A = [B_on_A.direction(edge, time) + math.pi for edge in A_on_B.edges_at(corner_of_A)]
    width_of_B = (from_B[1] - from_B[0]) % (2 * math.pi)
    width_of_A = (from_A[1] - from_A[0]) % (2 * math.pi)
    offset = math.remainder(from_A[0] - from_B[0], 2 * math.pi)
    least = max(0.0, offset)
    greatest = max(least, min(width_of_B, offset + width_of_A))
    start = math.remainder(from_B[0] + least, 2 * math.pi)
    return start, start + greatest - least
