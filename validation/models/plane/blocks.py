"""Blocks in the plane as a scene states them, by corners or by a shape, and where they are at t = 0."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from validation.runs.history import Array
from validation.scenes.keys import Key, Section
from validation.scenes.outline import area, check_polygon
from validation.scenes.tables import Count, Cut, Flag, Hypothesis, Pattern, PoissonRatio, Positive, Real, Stiffness

Point = tuple[Real, Real]
Vertices = tuple[tuple[float, float], ...]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=100)]
OF_MATERIAL = ("density", "young", "poisson")  # what a block may state itself
Sides = Annotated[Count, Field(ge=3, le=1000)]


@dataclass(frozen=True)
class PlacedBlock:
    """A block where it is at t = 0."""

    name: str
    vertices: Vertices  # [m], counter-clockwise
    density: float  # kg/m3
    young: float  # Pa; infinite: rigid
    poisson: float
    hypothesis: Hypothesis
    fixed: bool
    motion: str | None  # file of the record by which it is driven
    velocity: tuple[float, float]  # of the centroid [m/s]
    spin: float  # rad/s
    angle: float  # from the outline as it is stated [rad]

    @property
    def held(self) -> bool:
        """Whether nothing moves it but a record, if that."""
        return self.fixed or self.motion is not None

    @property
    def corners(self) -> Array:
        """Its corners, shape (n, 2) [m]."""
        return np.array(self.vertices)

    @property
    def centroid(self) -> tuple[float, float]:
        """Its centroid [m]."""
        return centroid(self.vertices)

    @property
    def thickness(self) -> float:
        """The least extent normal to an edge [m]."""
        return thickness(self.vertices)

    @property
    def area(self) -> float:
        """Its area [m2]."""
        return area(self.vertices)

    @property
    def mass(self) -> float:
        """Its mass of unit depth [kg]."""
        return self.density * self.area


class PlaneMaterialSection(Section):
    """What blocks are made of where they say nothing themselves."""

    young: Annotated[Stiffness, Key("Pa", "Young's modulus; inf: rigid", "E")]
    density: Annotated[Positive, Key("kg/m3", "mass of a volume", "ρ")]
    poisson: Annotated[PoissonRatio, Key("", "Poisson's ratio", "μ")] = 0.0
    hypothesis: Annotated[Hypothesis, Key("", "of the plane problem", "")] = "plane stress"


class PlaneBlockSection(Section):
    """A block by its corners, as a rectangle or as a regular polygon; moved to `at` when it has been turned."""

    name: Annotated[Name | Literal[""], Key("", "letters, digits and _; block_1, block_2, ... if absent")] = ""
    vertices: Annotated[
        Annotated[tuple[Point, ...], Field(min_length=3)] | None, Key("m", "corners, counter-clockwise")
    ] = None
    rectangle: Annotated[tuple[Positive, Positive] | None, Key("m", "width and height, about its centre")] = None
    sides: Annotated[Sides | None, Key("", "of a regular polygon about its centre")] = None
    radius: Annotated[Positive | None, Key("m", "from its centre to its corners")] = None
    at: Annotated[Point, Key("m", "where the origin of the corners is, the centre of a shape")] = (0.0, 0.0)
    turned: Annotated[Real, Key("deg", "about that origin, counter-clockwise")] = 0.0
    velocity: Annotated[tuple[Real, Real], Key("m/s", "of the centroid at t = 0")] = (0.0, 0.0)
    spin: Annotated[Real, Key("rad/s", "at t = 0, counter-clockwise")] = 0.0
    fixed: Annotated[Flag, Key("", "whether it does not move")] = False
    motion: Annotated[
        str | None,
        Key("", "of a block that is driven: CSV file with the header time,x or time,y or time,x,y, in s and m"),
    ] = None
    density: Annotated[Positive | None, Key("kg/m3", "that of plane if absent", "ρ")] = None
    young: Annotated[Stiffness | None, Key("Pa", "that of plane if absent; inf: rigid", "E")] = None
    poisson: Annotated[PoissonRatio | None, Key("", "that of plane if absent", "μ")] = None
    subdivide: Annotated[Cut | None, Key("blocks", "of a rectangle in x and in y, glued by plane.glue", "")] = None
    pattern: Annotated[
        Pattern,
        Key("", "of these; triangles: each cell cut from lower left to upper right"),
    ] = "squares"

    @model_validator(mode="after")
    def _check(self) -> Self:
        shapes = [name for name in ("vertices", "rectangle", "sides") if getattr(self, name) is not None]
        if len(shapes) != 1:
            rule = "needs vertices, a rectangle or sides with radius"
            raise ValueError(f"{self.label}{rule}, got {' and '.join(shapes) or 'none'}")
        if (self.sides is None) != (self.radius is None):
            raise ValueError(f"{self.label}sides and radius go together, got one of them")
        if self.subdivide is not None and self.rectangle is None:
            raise ValueError(f"{self.label}subdivide goes with rectangle only, got {shapes[0]}")
        if self.motion is not None:
            apart = [name for name in ("fixed", "velocity", "spin", "subdivide") if name in self.model_fields_set]
            if apart:
                raise ValueError(f"{self.label}motion and {apart[0]} exclude each other, got both")
        if self.fixed and (self.spin or any(self.velocity)):
            raise ValueError(f"{self.label}must not move where it is fixed, got a velocity")
        if self.fixed and self.subdivide is not None:
            raise ValueError(f"{self.label}fixed and subdivide exclude each other, got both")
        try:
            check_polygon(self.outline, 0, 1)
        except ValueError as error:
            raise ValueError(f"{self.label}{error}") from None
        return self

    @property
    def label(self) -> str:
        """What a message begins with: the name, where there is one."""
        return f"of {self.name}: " if self.name else ""

    @property
    def outline(self) -> Vertices:
        """Corners about the outline's own origin [m]."""
        if self.vertices is not None:
            return self.vertices
        if self.rectangle is not None:
            width, height = self.rectangle
            return upright(-width / 2, -height / 2, width, height)
        sides = self.sides or 1
        turns = [2 * math.pi * k / sides for k in range(sides)]
        radius = self.radius or 1.0
        return tuple((radius * math.cos(turn), radius * math.sin(turn)) for turn in turns)

    def placed(self, material: PlaneMaterialSection, name: str) -> Iterator[PlacedBlock]:
        """Yield the block where it is at t = 0, or the blocks that it is cut into, row by row from below.

        Parts of a block that turns have the velocities of one rigid body.
        """
        centre = centroid(moved(self.outline, self.at, self.turned))
        stated = {key: value for key in OF_MATERIAL if (value := getattr(self, key)) is not None}
        made_of = {key: getattr(material, key) for key in OF_MATERIAL} | stated
        for suffix, outline in self._parts():
            vertices = moved(outline, self.at, self.turned)
            x, y = np.subtract(centroid(vertices), centre).tolist()
            yield PlacedBlock(
                name=f"{name}{suffix}",
                vertices=vertices,
                hypothesis=material.hypothesis,
                fixed=self.fixed,
                motion=self.motion,
                velocity=(self.velocity[0] - self.spin * y, self.velocity[1] + self.spin * x),
                spin=self.spin,
                angle=math.radians(self.turned),
                **made_of,
            )

    def _parts(self) -> Iterator[tuple[str, Vertices]]:
        """Yield what each part is called behind the block's name, and its outline."""
        if self.rectangle is None or self.subdivide is None:
            yield "", self.outline
            return
        width, height = self.rectangle
        for suffix, outline in cells(width, height, self.subdivide, self.pattern):
            yield suffix, tuple((x - width / 2, y - height / 2) for x, y in outline)


def cells(width: float, height: float, subdivide: Cut, pattern: Pattern) -> Iterator[tuple[str, Vertices]]:
    """Yield the parts of an upright rectangle from the origin, row by row from below: ``_2_1`` is second in the first.

    Triangles of a cell are ``_2_1a``, below its diagonal, and ``_2_1b``.
    """
    along, up = subdivide
    for row, column in itertools.product(range(1, up + 1), range(1, along + 1)):
        left, right = (width * i / along for i in (column - 1, column))
        low, high = (height * j / up for j in (row - 1, row))
        a, b, c, d = (left, low), (right, low), (right, high), (left, high)
        if pattern == "squares":
            yield f"_{column}_{row}", (a, b, c, d)
        else:
            yield f"_{column}_{row}a", (a, b, c)
            yield f"_{column}_{row}b", (a, c, d)


def upright(left: float, low: float, width: float, height: float) -> Vertices:
    """Return the corners of an upright rectangle from its lower left one on [m]."""
    return ((left, low), (left + width, low), (left + width, low + height), (left, low + height))


def moved(outline: Vertices, at: tuple[float, float], turned: float) -> Vertices:
    """Return an outline turned about its origin [deg] and then moved [m]; what does not turn keeps its digits."""
    x, y = at
    if not turned:
        return tuple((px + x, py + y) for px, py in outline)
    cosine, sine = math.cos(math.radians(turned)), math.sin(math.radians(turned))
    return tuple((x + cosine * px - sine * py, y + sine * px + cosine * py) for px, py in outline)


def centroid(vertices: Vertices) -> tuple[float, float]:
    """Return the centroid of an outline [m]."""
    points = np.array(vertices)
    local = points - points[0]
    following = np.roll(local, -1, axis=0)
    crosses = local[:, 0] * following[:, 1] - following[:, 0] * local[:, 1]
    x, y = points[0] + crosses @ (local + following) / (3 * np.sum(crosses))
    return float(x), float(y)


def second_moments(vertices: Vertices) -> Array:
    """Return the second moments of an outline about its centroid [m4], shape (2, 2); their trace is the polar one.

    Each triangle of the centroid and an edge from a to b gives (a x b) (a a + (a b + b a) / 2 + b b) / 12.
    """
    a = np.array(vertices) - centroid(vertices)
    b = np.roll(a, -1, axis=0)
    crosses = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
    products = np.einsum("n,ni,nj->ij", crosses, a, a + b / 2) + np.einsum("n,ni,nj->ij", crosses, b, b + a / 2)
    return np.asarray(products / 12)


def thickness(vertices: Vertices) -> float:
    """Return the least extent of an outline normal to one of its edges [m]."""
    points = np.array(vertices)
    x, y = (np.roll(points, -1, axis=0) - points).T
    normals = np.stack([-y, x]) / np.hypot(x, y)
    return float(np.min(np.ptp(points @ normals, axis=0)))
