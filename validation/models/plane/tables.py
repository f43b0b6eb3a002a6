"""The table of blocks in the plane that are glued along the edges they share, `[plane]`, in the place of a block."""

from __future__ import annotations

import itertools
import math
from functools import cached_property
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from validation.scenes.keys import Key, Section
from validation.scenes.outline import check_polygon
from validation.scenes.tables import Count, Positive, Real

MOST_BLOCKS = 20_000  # polygons are lists, made before memory is predicted
Point = tuple[Real, Real]
Segment = tuple[Point, Point]
PoissonRatio = Annotated[Real, Field(gt=-1, lt=0.5)]
Polygon = tuple[tuple[float, float], ...]


class PlaneBlockSection(Section):
    """A block by its corners."""

    vertices: Annotated[tuple[Point, ...], Field(min_length=3), Key("m", "corners, counter-clockwise")]

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_polygon(self.vertices, 0, 1)
        return self


class ClampSection(Section):
    """A straight part of the outline that does not move."""

    edge: Annotated[Segment, Key("m", "from a point to a point of the outline")]


class EdgeLoadSection(Section):
    """A uniform traction on a straight part of the outline."""

    edge: Annotated[Segment, Key("m", "from a point to a point of the outline")]
    traction: Annotated[tuple[Real, Real], Key("Pa", "in x and y")]


class ObserveSection(Section):
    """The displacement that a history holds: the mean of an edge, or that of a point, less what others move by."""

    edge: Annotated[Segment | None, Key("m", "of whose displacement the mean is taken")] = None
    point: Annotated[Point | None, Key("m", "in its place")] = None
    direction: Annotated[tuple[Real, Real], Key("", "of the displacement, a unit vector")]
    less: Annotated[tuple[Segment, ...], Key("m", "edges, the mean of whose displacements is subtracted")] = ()

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


class PlaneSection(Section):
    """Blocks of one strain in the plane, glued along all edges that they share, and the elastic body of their outline.

    The blocks are stated one by one (`[[plane.block]]`), or as an upright rectangle with its lower left corner at the
    origin that is cut into equal blocks (`width`, `height`, `subdivide`). At each end of a shared edge stand a
    normal and a shear spring of `glue` times Young's modulus, for unit thickness.
    """

    young: Annotated[Positive, Key("Pa", "Young's modulus", "E")]
    density: Annotated[Positive, Key("kg/m3", "mass of a volume", "ρ")]
    poisson: Annotated[PoissonRatio, Key("", "Poisson's ratio", "μ")] = 0.0
    hypothesis: Annotated[Literal["plane stress", "plane strain"], Key("", "of the plane problem", "")] = "plane stress"
    glue: Annotated[Positive, Key("m", "end spring of a shared edge over young", "g")] = 1.0e6
    clamp_glue: Annotated[Positive, Key("m", "the same of a clamped edge")] = 1.0e6
    stress: Annotated[
        tuple[Real, Real, Real], Key("Pa", "s_xx, s_yy, s_xy, whose tractions act on all of the outline", "σ")
    ] = (0.0, 0.0, 0.0)
    gravity: Annotated[tuple[Real, Real], Key("m/s2", "acceleration in x and y")] = (0.0, 0.0)
    width: Annotated[Positive | None, Key("m", "of a rectangle that is cut", "W")] = None
    height: Annotated[Positive | None, Key("m", "of a rectangle that is cut", "H")] = None
    subdivide: Annotated[tuple[Count, Count] | None, Key("blocks", "of it in x and in y", "")] = None
    pattern: Annotated[
        Literal["squares", "triangles"],
        Key("", "of its blocks; triangles: each cell cut from lower left to upper right", "", ("subdivide",)),
    ] = "squares"
    block: Annotated[tuple[PlaneBlockSection, ...], Field(max_length=MOST_BLOCKS)] = ()
    clamp: tuple[ClampSection, ...] = ()
    load: tuple[EdgeLoadSection, ...] = ()
    observe: ObserveSection

    @model_validator(mode="after")
    def _check(self) -> Self:
        stated = [name for name in ("width", "height", "subdivide") if getattr(self, name) is not None]
        if self.block and stated:
            raise ValueError(f"block and {stated[0]} exclude each other, got both")
        if not self.block and len(stated) < 3:
            raise ValueError(f"needs blocks, or width, height and subdivide, got {' and '.join(stated) or 'none'}")
        count = math.prod(self.subdivide or (1,)) * (2 if self.pattern == "triangles" else 1)
        if count > MOST_BLOCKS:
            raise ValueError(f"subdivide must make at most {MOST_BLOCKS} blocks, got {count}")
        if not self.load and not any(self.stress) and not any(self.gravity):
            raise ValueError("needs a load: stress, gravity or [[plane.load]], got none")
        return self

    @property
    def present(self) -> bool:
        """Whether the scene is of this kind."""
        return True

    @property
    def rectangle(self) -> tuple[float, float] | None:
        """Width and height of the rectangle that is cut [m], None where blocks are stated one by one."""
        return None if self.width is None or self.height is None else (self.width, self.height)

    @cached_property
    def polygons(self) -> tuple[Polygon, ...]:
        """Corners of every block, of a rectangle row by row from below."""
        if self.rectangle is None or self.subdivide is None:
            return tuple(block.vertices for block in self.block)
        width, height = self.rectangle
        along, up = self.subdivide
        xs = [width * i / along for i in range(along + 1)]
        ys = [height * j / up for j in range(up + 1)]
        polygons: list[Polygon] = []
        for (low, high), (left, right) in itertools.product(itertools.pairwise(ys), itertools.pairwise(xs)):
            a, b, c, d = (left, low), (right, low), (right, high), (left, high)
            polygons += [(a, b, c, d)] if self.pattern == "squares" else [(a, b, c), (a, c, d)]
        return tuple(polygons)

    @property
    def outline_polygons(self) -> tuple[Polygon, ...]:
        """Polygons that tile the body, as few as there are: the rectangle, or the blocks."""
        if self.rectangle is None:
            return self.polygons
        width, height = self.rectangle
        return (((0.0, 0.0), (width, 0.0), (width, height), (0.0, height)),)
