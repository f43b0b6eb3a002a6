"""What people draw, as blocks: stacks, walls, arches, columns on a stepped base, blocks on a slope, random polygons.

Each generator is a table with a name, from which its blocks are called ``name_1``, ``name_2``, ...
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from validation.models.plane.blocks import Name, PlaneBlockSection, Point, Sides, Vertices, moved, upright
from validation.scenes.keys import Key, Section
from validation.scenes.tables import Angle, Count, Index, NonNegative, Positive, Real

MOST_BLOCKS = 20_000  # polygons are lists, made before memory is predicted
Outlines = Iterator[tuple[str, Vertices, bool]]  # what a block is called behind the name, its corners, whether fixed
ORIGIN = (0.0, 0.0)
Size = Annotated[tuple[Positive, Positive], Key("m", "width and height of each")]
Several = Annotated[Count, Field(le=MOST_BLOCKS)]


class GeneratorSection(Section):
    """Blocks that are drawn by one table: in their own frame, turned about its origin and moved to `at`."""

    name: Annotated[Name, Key("", "from which its blocks are called name_1, name_2, ...")]
    at: Annotated[Point, Key("m", "where the origin of its frame is")] = ORIGIN
    turned: Annotated[Real, Key("deg", "about that origin, counter-clockwise")] = 0.0

    def outlines(self) -> Outlines:
        """Yield what each block is called behind the name, its corners in the own frame, and whether it is fixed."""
        raise NotImplementedError

    def blocks(self) -> Iterator[PlaneBlockSection]:
        """Yield the blocks."""
        for suffix, vertices, fixed in self.outlines():
            yield PlaneBlockSection(
                name=f"{self.name}_{suffix}", vertices=vertices, at=self.at, turned=self.turned, fixed=fixed
            )


class StackSection(GeneratorSection):
    """Equal rectangles on each other, from the lowest up; the origin is the middle of its foot."""

    count: Annotated[Several, Key("", "of blocks")]
    rectangle: Size
    offsets: Annotated[tuple[Real, ...], Key("m", "of each block from the one below, the first from the origin")] = ()
    gap: Annotated[NonNegative, Key("m", "between blocks, and below the first one")] = 0.0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.offsets and len(self.offsets) != self.count:
            raise ValueError(f"offsets must be one for each block, {self.count}, got {len(self.offsets)}")
        return self

    def outlines(self) -> Outlines:
        """Yield the blocks from the lowest up."""
        width, height = self.rectangle
        middles = np.cumsum(self.offsets or [0.0] * self.count).tolist()
        for number, middle in enumerate(middles):
            low = self.gap + number * (height + self.gap)
            yield f"{number + 1}", upright(middle - width / 2, low, width, height), False


class WallSection(GeneratorSection):
    """A wall in running bond, every second row with half bricks at its ends; the origin is its lower left corner."""

    rows: Annotated[Several, Key("", "of bricks")]
    bricks: Annotated[Several, Key("", "in a row of whole ones")]
    rectangle: Annotated[tuple[Positive, Positive], Key("m", "width and height of a brick")]

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (count := self.rows * (self.bricks + 1)) > MOST_BLOCKS:
            raise ValueError(f"rows and bricks must make at most {MOST_BLOCKS} blocks, got {count}")
        return self

    def outlines(self) -> Outlines:
        """Yield the bricks row by row from below, ``2_3`` the third of the second row."""
        width, height = self.rectangle
        whole = [width * k for k in range(self.bricks + 1)]
        halved = [0.0, *(width * (k + 0.5) for k in range(self.bricks)), width * self.bricks]
        for row in range(self.rows):
            joints = halved if row % 2 else whole
            for number, (left, right) in enumerate(itertools.pairwise(joints), start=1):
                yield f"{row + 1}_{number}", upright(left, height * row, right - left, height), False


class ArchSection(GeneratorSection):
    """A circular arch of voussoirs between two fixed abutments; the origin is the centre of its circle."""

    radius: Annotated[Positive, Key("m", "mean radius", "R")]
    thickness: Annotated[Positive, Key("m", "across", "t")]
    voussoirs: Annotated[Count, Field(ge=2, le=MOST_BLOCKS), Key("", "of equal angle, from left to right")]
    opening: Annotated[Annotated[Real, Field(gt=0, le=180)], Key("deg", "angle of the arch at its centre")] = 180.0
    chords: Annotated[
        Annotated[Count, Field(le=100)], Key("", "that an arc of a voussoir is drawn by; 1: straight voussoirs")
    ] = 1

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.thickness >= 2 * self.radius:
            raise ValueError(f"thickness must be below twice the radius {self.radius:g}, got {self.thickness:g}")
        return self

    def outlines(self) -> Outlines:
        """Yield the voussoirs from the left, and the abutments ``left`` and ``right``, as long as the arch is thick."""
        inner, outer = self.radius - self.thickness / 2, self.radius + self.thickness / 2
        half = math.radians(self.opening) / 2
        # Joint j stands at this angle from the vertical, clockwise; it is computed once, so that neighbours share
        # their corners to the last digit.
        count = self.voussoirs * self.chords
        angles = [half * (2 * j / count - 1) for j in range(count + 1)]
        intrados = [(inner * math.sin(a), inner * math.cos(a)) for a in angles]
        extrados = [(outer * math.sin(a), outer * math.cos(a)) for a in angles]
        for number in range(self.voussoirs):
            arc = slice(number * self.chords, (number + 1) * self.chords + 1)
            yield f"{number + 1}", (*intrados[arc], *reversed(extrados[arc])), False
        for side, joint, sign in (("left", 0, -1.0), ("right", -1, 1.0)):
            x, y = sign * self.thickness * math.cos(half), -self.thickness * math.sin(half)
            (a, b), (c, d) = intrados[joint], extrados[joint]
            corners = ((a, b), (c, d), (c + x, d + y), (a + x, b + y))
            yield side, corners if sign < 0 else corners[::-1], True


class ColumnsSection(GeneratorSection):
    """Columns side by side on a stepped base that dips to the right; the origin is the foot of the toe, column 1.

    Columns stand normal to the treads, which dip by `dip`; column n + 1 stands by `rise` higher than n, on its left.
    """

    width: Annotated[Positive, Key("m", "of a column, along the dip")]
    heights: Annotated[tuple[Positive, ...], Field(min_length=1, max_length=MOST_BLOCKS), Key("m", "from the toe on")]
    dip: Annotated[Angle, Key("deg", "of the treads, down to the right")] = 0.0
    rise: Annotated[NonNegative, Key("m", "of the base from a column to the next one")] = 0.0
    base: Annotated[Positive, Key("m", "thickness of the fixed base below the toe")] = 1.0

    def outlines(self) -> Outlines:
        """Yield the columns from the toe on, and the fixed ``base``."""
        count = len(self.heights)
        for number, height in enumerate(self.heights):
            column = upright(-self.width * (number + 1), self.rise * number, self.width, height)
            yield f"{number + 1}", moved(column, ORIGIN, -self.dip), False
        steps = [(-self.width * (k + side), self.rise * k) for k in range(count) for side in (0, 1)]
        treads = list(dict.fromkeys(steps)) if self.rise else [steps[0], steps[-1]]
        beyond = 2 * self.width  # on which what has slid off comes to lie
        last = -self.width * count
        outline = ((last, -self.base), (beyond, -self.base), (beyond, 0.0), *treads)
        yield "base", moved(outline, ORIGIN, -self.dip), True


class SlopeSection(GeneratorSection):
    """Rectangles on a fixed slope that falls to the right; the origin is its upper end, where they begin."""

    angle: Annotated[Angle, Field(ge=0), Key("deg", "of the slope", "β")]
    length: Annotated[Positive, Key("m", "of the slope")]
    rectangles: Annotated[
        tuple[tuple[Positive, Positive], ...], Field(min_length=1, max_length=MOST_BLOCKS), Key("m", "from above")
    ]
    noses: Annotated[
        tuple[NonNegative, ...], Key("m", "how far each block has a tip towards the one above, at half its height")
    ] = ()
    gaps: Annotated[tuple[NonNegative, ...], Key("m", "before each block, the first from the upper end")] = ()
    sinks: Annotated[tuple[Real, ...], Key("m", "how deep each block stands in the slope at t = 0")] = ()
    speeds: Annotated[tuple[Real, ...], Key("m/s", "of each block at t = 0, down the slope")] = ()
    base: Annotated[Positive, Key("m", "thickness of the fixed ground")] = 1.0

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in ("noses", "gaps", "sinks", "speeds"):
            if (values := getattr(self, name)) and len(values) != len(self.rectangles):
                raise ValueError(f"{name} must be one for each rectangle, {len(self.rectangles)}, got {len(values)}")
        return self

    def outlines(self) -> Outlines:
        """Yield the blocks from above, and the fixed ``ground``."""
        zeros = (0.0,) * len(self.rectangles)
        place = 0.0
        sizes = zip(self.rectangles, self.noses or zeros, self.gaps or zeros, self.sinks or zeros, strict=True)
        for number, ((width, height), nose, gap, sink) in enumerate(sizes, start=1):
            left = place + gap + nose
            body = upright(left, -sink, width, height)
            tip = ((left - nose, height / 2 - sink),) if nose else ()
            yield f"{number}", moved((*body, *tip), ORIGIN, -self.angle), False
            place = left + width
        yield "ground", moved(upright(0.0, -self.base, self.length, self.base), ORIGIN, -self.angle), True

    def blocks(self) -> Iterator[PlaneBlockSection]:
        """Yield the blocks with their speeds."""
        direction = math.radians(self.turned - self.angle)
        for block, speed in zip(super().blocks(), (*(self.speeds or (0.0,) * len(self.rectangles)), 0.0), strict=True):
            velocity = speed * math.cos(direction), speed * math.sin(direction)
            yield block.model_copy(update={"velocity": velocity})


class RandomSection(GeneratorSection):
    """Convex polygons with corners on circles, one in each cell of a grid; the origin is its lower left corner."""

    count: Annotated[Several, Key("", "of blocks, row by row from below")]
    seed: Annotated[Annotated[Index, Field(ge=0)], Key("", "of the random numbers; the same blocks by the same seed")]
    radii: Annotated[tuple[Positive, Positive], Key("m", "least and greatest of the circles")]
    corners: Annotated[tuple[Sides, Sides], Key("", "least and greatest number of a block")] = (3, 7)
    across: Annotated[Several, Key("", "cells in a row")]

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in ("radii", "corners"):
            low, high = getattr(self, name)
            if low > high:
                raise ValueError(f"{name} must be the least and the greatest, got {[low, high]}")
        return self

    def outlines(self) -> Outlines:
        """Yield the blocks; corners keep a share of a full turn over their number apart: none is a splinter."""
        random: Any = np.random.Generator(np.random.PCG64(self.seed))
        cell = 2 * self.radii[1]
        least, most = self.corners
        for number in range(self.count):
            corners = int(random.integers(least, most + 1))
            radius = random.uniform(*self.radii)
            start = random.uniform(0, 2 * math.pi)
            angles = start + 2 * math.pi * (np.arange(corners) + random.uniform(0, 0.5, corners)) / corners
            row, column = divmod(number, self.across)
            x = (column + 0.5) * cell + radius * np.cos(angles)
            y = (row + 0.5) * cell + radius * np.sin(angles)
            yield f"{number + 1}", tuple(zip(x.tolist(), y.tolist(), strict=True)), False
