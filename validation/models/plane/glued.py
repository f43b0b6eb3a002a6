"""What goes with glued blocks: clamps, observations, and bodies of triangles that one table draws.

A plate with a hole or a disc is drawn as a quarter and mirrored, so that opposite points move alike.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from validation.models.plane.blocks import Point, Vertices
from validation.models.plane.joints import Segment
from validation.runs.history import Array
from validation.scenes.keys import Key, Section
from validation.scenes.tables import Count, Positive, Real

MOST_CELLS = 50  # along a quarter: 20,000 triangles, as many as any table makes
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(8)
Loads = tuple[tuple[Segment, tuple[float, float]], ...]  # edges [m] and the tractions on them [Pa]


class ClampSection(Section):
    """A straight part of the outline that does not move."""

    edge: Annotated[Segment, Key("m", "from a point to a point of the outline")]


class ObserveSection(Section):
    """The displacement that a history holds: the mean of an edge, or that of a point, less what others move by."""

    edge: Annotated[Segment | None, Key("m", "of whose displacement the mean is taken")] = None
    point: Annotated[Point | None, Key("m", "in its place")] = None
    direction: Annotated[tuple[Real, Real], Key("", "of the displacement, a unit vector")]
    less: Annotated[tuple[Segment, ...], Key("m", "edges, the mean of whose displacements is subtracted")] = ()
    stress: Annotated[Point | None, Key("m", "where the mean stress of the blocks is observed that meet there")] = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.edge is None) == (self.point is None):
            raise ValueError(f"needs an edge or a point, got {'neither' if self.edge is None else 'both'}")
        if abs(math.hypot(*self.direction) - 1) > 1e-9:
            raise ValueError(f"direction must be of length 1, got {math.hypot(*self.direction):g}")
        return self

    @property
    def place(self) -> Segment:
        """Where it is: an edge, or a point twice."""
        if self.edge is not None:
            return self.edge
        return (self.point, self.point)  # type: ignore[return-value]  # one of the two is stated


class BodySection(Section):
    """A body about the origin, of triangles that are glued, under a load of its own."""

    cells: Annotated[Count, Field(ge=2, le=MOST_CELLS), Key("", "along a quarter of its circle")]

    def grid(self) -> list[list[Point]]:
        """Return the nodes of the first quarter [m]: layers from within, each from the x axis on."""
        raise NotImplementedError

    @property
    def tractions(self) -> Loads:
        """The loads."""
        raise NotImplementedError

    @property
    def observed(self) -> ObserveSection:
        """What is observed if the scene does not say."""
        raise NotImplementedError

    def triangles(self) -> Iterator[Vertices]:
        """Yield the blocks: each cell cut from inner-lower to outer-upper."""
        quarter: list[Vertices] = []
        for low, high in itertools.pairwise(self.grid()):
            for (a, d), (b, c) in zip(itertools.pairwise(low), itertools.pairwise(high), strict=True):
                quarter += [(a, b, c), (a, c, d)] if a != d else [(a, b, c)]
        return _mirrored(quarter)

    def rim(self) -> list[Segment]:
        """Return the edges of the outer layer, counter-clockwise as their triangles have them."""
        return [(start, end) for start, end in _mirrored([*itertools.pairwise(self.grid()[-1])])]


class PlateSection(BodySection):
    """A plate with a hole under tension along x: round, or a rectangle that is pulled on its upright sides.

    On the outline of a round one act the tractions that an endless plate has there (Kirsch 1898), uniform over each
    edge: its truth is closed whatever its radius. Observed are by how much the hole widens along x and, if nothing else
    is stated, the stress at its top.
    """

    hole: Annotated[Positive, Key("m", "radius of the hole", "a")]
    radius: Annotated[Positive | None, Key("m", "of a round plate", "R")] = None
    width: Annotated[Positive | None, Key("m", "of a rectangle, along the tension", "W")] = None
    height: Annotated[Positive | None, Key("m", "of a rectangle", "H")] = None
    tension: Annotated[Real, Key("Pa", "along x, far from the hole", "s")]

    @model_validator(mode="after")
    def _check(self) -> Self:
        stated = [name for name in ("radius", "width", "height") if getattr(self, name) is not None]
        if stated not in (["radius"], ["width", "height"]):
            raise ValueError(f"needs a radius, or width and height, got {' and '.join(stated) or 'none'}")
        least = min(self.sides) / 2
        if self.hole >= least:
            raise ValueError(f"hole must be within the outline, below {least:g} m, got {self.hole:g}")
        return self

    @property
    def sides(self) -> tuple[float, float]:
        """Width and height, of a round plate its diameter twice [m]."""
        diameter = 2 * (self.radius or 0.0)
        return self.width or diameter, self.height or diameter

    def grid(self) -> list[list[Point]]:
        """Return the nodes: radii in geometric progression from hole to outline, the rectangle's corner one."""
        n = self.cells
        angles = [math.pi / 2 * j / n for j in range(n + 1)]
        outer = [self.sides[0] / 2] * (n + 1)
        if self.radius is None:
            x, y = self.sides[0] / 2, self.sides[1] / 2
            corner = math.atan2(y, x)
            upright = min(max(round(n * corner / (math.pi / 2)), 1), n - 1)  # cells on the upright side
            angles = [*np.linspace(0, corner, upright + 1), *np.linspace(corner, math.pi / 2, n - upright + 1)[1:]]
            outer = [x / math.cos(angle) if j <= upright else y / math.sin(angle) for j, angle in enumerate(angles)]
        layers = []
        for k in range(n + 1):
            layers.append(_layer([self.hole * (radius / self.hole) ** (k / n) for radius in outer], angles))
        return layers

    def stresses(self, points: Array) -> Array:
        """Return s_xx, s_yy, s_xy at points of an endless plate with the hole [Pa], shape (n, 3).

        By the potentials s/4 (z + 2 a^2/z) and -s/2 (z + a^2/z - a^4/z^3) of Kolosov and Muskhelishvili.
        """
        z = points[:, 0] + 1j * points[:, 1]
        q = (self.hole / z) ** 2
        half_sum = self.tension / 2 * (1 - 2 * q).real
        half_difference = self.tension * (z.conj() / z * q - (1 - q + 3 * q**2) / 2)
        x = half_sum - half_difference.real
        y = half_sum + half_difference.real
        return np.stack([x, y, half_difference.imag], axis=-1)

    @property
    def tractions(self) -> Loads:
        """The tension on both sides of a rectangle, or the mean of an endless plate's tractions on each edge."""
        if self.radius is None:
            x, y = self.sides[0] / 2, self.sides[1] / 2
            return (((x, -y), (x, y)), (self.tension, 0.0)), (((-x, y), (-x, -y)), (-self.tension, 0.0))
        loads = []
        for start, end in self.rim():
            middle = np.add(start, end) / 2
            half = np.subtract(end, start) / 2
            s_xx, s_yy, s_xy = WEIGHTS / 2 @ self.stresses(middle + POINTS[:, None] * half)
            nx, ny = _normal(start, end)
            loads.append(((start, end), (float(s_xx * nx + s_xy * ny), float(s_xy * nx + s_yy * ny))))
        return tuple(loads)

    @property
    def observed(self) -> ObserveSection:
        """By how much the hole widens, and the stress at its top."""
        return _widening(self.hole, (0.0, self.hole))


class DiscSection(BodySection):
    """A disc under a pressure on two arcs about its poles (Hondros 1959).

    Observed are by how much it widens across them and, if nothing else is stated, the stress in its middle.
    """

    radius: Annotated[Positive, Key("m", "of the disc", "R")]
    pressure: Annotated[Real, Key("Pa", "on both arcs", "p")]
    half_arc: Annotated[Real, Field(gt=0, le=90), Key("deg", "of an arc to each side of its pole")]

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.cells % 2:
            raise ValueError(f"cells must be even, half of them along the radius, got {self.cells}")
        share = self.half_arc * self.cells / 90
        if abs(share - round(share)) > 1e-9 * share:
            rule = "half_arc must be a multiple of 90 / cells, so that its ends are nodes"
            raise ValueError(f"{rule}: of {90 / self.cells:g} deg, got {self.half_arc:g}")
        return self

    def grid(self) -> list[list[Point]]:
        """Return the nodes: equal layers about the middle, half as many as cells along a quarter."""
        n = self.cells
        angles = [math.pi / 2 * j / n for j in range(n + 1)]
        return [_layer([2 * self.radius * k / n] * (n + 1), angles) for k in range(n // 2 + 1)]

    @property
    def tractions(self) -> Loads:
        """The pressure on the edges of both arcs."""
        loads = []
        for start, end in self.rim():
            if math.degrees(math.atan2(abs(start[0] + end[0]), abs(start[1] + end[1]))) < self.half_arc:
                nx, ny = _normal(start, end)
                loads.append(((start, end), (-self.pressure * nx, -self.pressure * ny)))
        return tuple(loads)

    @property
    def observed(self) -> ObserveSection:
        """By how much it widens, and the stress in its middle."""
        return _widening(self.radius, (0.0, 0.0))


def _widening(x: float, stress: Point) -> ObserveSection:
    """Return by how much the points (x, 0) and (-x, 0) part."""
    return ObserveSection(point=(x, 0.0), less=(((-x, 0.0), (-x, 0.0)),), direction=(1.0, 0.0), stress=stress)


def _layer(radii: Sequence[float], angles: Sequence[float]) -> list[Point]:
    """Return points from axis to axis; first and last lie on these to the last digit, so that mirrors meet."""
    points = [(float(r * math.cos(angle)), float(r * math.sin(angle))) for r, angle in zip(radii, angles, strict=True)]
    points[0] = (points[0][0], 0.0)
    points[-1] = (0.0, points[-1][1])
    return points


def _normal(start: Point, end: Point) -> Point:
    """Return the unit vector to the right of an edge."""
    length = math.dist(start, end)
    return (end[1] - start[1]) / length, (start[0] - end[0]) / length


def _mirrored(quarter: Sequence[Vertices]) -> Iterator[Vertices]:
    """Yield what lies in a quarter and its mirror images, each counter-clockwise."""
    for x in (1.0, -1.0):
        for y in (1.0, -1.0):
            for corners in quarter:
                images = tuple((x * a + 0.0, y * b + 0.0) for a, b in corners)
                yield images if x * y > 0 else images[::-1]
