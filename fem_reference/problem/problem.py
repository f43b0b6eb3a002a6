"""The data of the finite-element and bar references: what is solved, and with which scheme."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.material import Elastic
from fem_reference.problem.motion import Motion
from fem_reference.problem.stages import Stage, StageTable, newmark_stage

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

HYPOTHESES = ("plane stress", "plane strain")
FOUNDATIONS = ("distributed", "patch", "corner", "nodes")
CELLS = ("quadrilaterals", "triangles")
STARTS = ("zero", "consistent")
SAME_MATRIX = 1e-15
"""Relative difference of two stages' weights, by rounding, below which they share a matrix."""


@dataclass(frozen=True)
class Problem(Elastic):
    """One elastic block on a locked elastic foundation under loads that come on at t = 0, at once or in a ramp.

    The block occupies a simple polygon. Its base edge rests on springs normal and tangential to it; pressure and
    traction act per unit length of the top edge, gravity on the whole block, and the fixed side of the springs may
    move.
    """

    vertices: tuple[tuple[float, float], ...]  # corners, counter-clockwise [m]; edge i runs from vertex i to i + 1
    base: int  # index of the edge that stands on the springs
    top: int  # index of the loaded edge
    density: float  # rho [kg/m3]
    young: float  # E [Pa]
    poisson: float  # mu [-]
    hypothesis: str  # ``"plane stress"`` or ``"plane strain"``
    stiffness: float  # p of one corner spring, normal [N/m]; the foundation carries 2 p in all
    shear_stiffness: float  # p_s, tangential [N/m]
    pressure: float  # q on the top edge [Pa], downwards
    elements: int = 16  # along each side of a structured mesh [-]
    degree: int = 2  # of the elements [-], 1 or 2
    mesh: str | None = None  # file with the boundary tags ``base`` and ``top``; None meshes the block itself
    foundation: str = "distributed"  # or "patch", "corner"; "nodes": p l/a at each end of a base facet of length l
    patch_width: float | None = None  # w of each of the two end patches [m], 0 < w <= a/2; only with ``"patch"``
    cells: str = "quadrilaterals"  # or "triangles", each cut from lower left to upper right, of a structured mesh
    eccentricity: float = 0.0  # shift towards +x of the middle of the pressed part of the top, L - 2 |e| long [m]
    traction: float = 0.0  # towards +x on the whole top edge [Pa]
    gravity: float = 0.0  # g [m/s2], downwards where there is no slope
    motion: Motion | None = None  # of the fixed side of the foundation
    slope: float = 0.0  # angle b of the incline that the block stands on [deg]: gravity is g (sin b, -cos b) in x, y
    ramp: float = 0.0  # time in which pressure, traction and gravity rise linearly from zero [s]

    def __post_init__(self) -> None:
        self._check_polygon()
        require_numbers(self, ("density", "young", "stiffness"), ("shear_stiffness", "ramp"))
        require(self.hypothesis in HYPOTHESES, "hypothesis", f"must be one of {HYPOTHESES}", self.hypothesis)
        strain = self.hypothesis == "plane strain"
        below = self.poisson < 0.5 or (self.poisson == 0.5 and not strain)
        rule = f"must be above -1 and {'below' if strain else 'at most'} 0.5 in {self.hypothesis}"
        require(self.poisson > -1 and below, "poisson", rule, self.poisson)
        require(self.foundation in FOUNDATIONS, "foundation", f"must be one of {FOUNDATIONS}", self.foundation)
        require(self.cells in CELLS, "cells", f"must be one of {CELLS}", self.cells)
        w = self.patch_width
        if self.foundation == "patch":
            inside = w is not None and 0 < w <= self.base_length / 2
            require(inside, "patch_width", f"must be in (0, a/2] with a = {self.base_length!r}", w)
        else:
            require(w is None, "patch_width", 'belongs to foundation = "patch" only', w)
        require(abs(self.slope) < 90, "slope", "must be between -90 and 90", self.slope)
        inside = 2 * abs(self.eccentricity) < self.top_length or self.eccentricity == 0
        rule = f"must be below half the top edge, {self.top_length / 2:g}"
        require(inside, "eccentricity", rule, self.eccentricity)
        require(self.elements >= 1, "elements", "must be at least 1", self.elements)
        require(self.degree in (1, 2), "degree", "must be 1 or 2", self.degree)

    def _check_polygon(self) -> None:
        count = len(self.vertices)
        require(count >= 3, "vertices", "must hold at least three points", count)
        for x, y in self.vertices:
            require(math.isfinite(x) and math.isfinite(y), "vertices", "must be finite", (x, y))
        for field, index in (("base", self.base), ("top", self.top)):
            require(0 <= index < count, field, f"must be an edge from 0 to {count - 1}", index)
        require(self.base != self.top, "top", "must differ from base", self.top)
        require(self.base_length > 0, "base", "must have a positive length", self.base_length)
        require(self.area > 0, "vertices", "must run counter-clockwise", self.vertices)

    @cached_property
    def outline(self) -> Array:
        """Corners from the start of the base on, relative to that point, shape (count, 2) [m]."""
        corners = np.roll(np.asarray(self.vertices, float), -self.base, axis=0)
        return np.asarray(corners - corners[0])

    @cached_property
    def base_length(self) -> float:
        """Length a of the base [m]."""
        return float(np.hypot(*self.outline[1]))

    @property
    def top_ends(self) -> tuple[Array, Array]:
        """Ends of the top edge relative to the start of the base, each of shape (2,) [m]."""
        index = (self.top - self.base) % len(self.outline)
        return self.outline[index], self.outline[(index + 1) % len(self.outline)]

    @property
    def top_length(self) -> float:
        """Length L of the top edge [m]."""
        start, end = self.top_ends
        return float(np.hypot(*(end - start)))

    @property
    def pressed(self) -> tuple[float, float]:
        """Interval of the arc length of the top edge that carries the pressure [m]."""
        if self.eccentricity == 0:
            return -np.inf, np.inf
        side = self.top_ends[1] - self.top_ends[0]
        along_x = side[0] > 0 or (side[0] == 0 and side[1] > 0)
        shift = self.eccentricity if along_x else -self.eccentricity
        return max(0.0, 2 * shift), min(self.top_length, self.top_length + 2 * shift)

    @property
    def load_size(self) -> float:
        """Size of the constant loads as a stress, one with a moving base, which sets its own scale [Pa]."""
        if self.motion is not None:
            return 1.0
        weight = self.density * self.gravity * float(np.sqrt(self.area))
        return max(abs(self.pressure), abs(self.traction), abs(weight))

    @property
    def unit(self) -> Problem:
        """The problem under its loads over `load_size`; under a pressure of 1 Pa where there is no load."""
        size = self.load_size
        if size == 0:
            return replace(self, pressure=1.0)
        return replace(self, pressure=self.pressure / size, traction=self.traction / size, gravity=self.gravity / size)

    @property
    def pull(self) -> tuple[float, float]:
        """Acceleration of gravity in x and y, g (sin b, -cos b) [m/s2]."""
        angle = math.radians(self.slope)
        return self.gravity * math.sin(angle), -self.gravity * math.cos(angle)

    @property
    def vertical(self) -> bool:
        """Whether all loads are uniform in x and act along y, so that the response may be symmetric."""
        level = self.eccentricity == 0 and self.traction == 0 and self.pull[0] == 0
        return level and not (self.motion is not None and self.motion.sideways)

    @cached_property
    def tangent(self) -> Array:
        """Unit vector along the base, shape (2,)."""
        return np.asarray(self.outline[1] / self.base_length)

    @cached_property
    def normal(self) -> Array:
        """Unit vector normal to the base, into the block, shape (2,)."""
        return np.array([-self.tangent[1], self.tangent[0]])

    @cached_property
    def _cross(self) -> tuple[Array, Array]:
        following = np.roll(self.outline, -1, axis=0)
        cross = self.outline[:, 0] * following[:, 1] - following[:, 0] * self.outline[:, 1]
        return cross, self.outline + following

    @cached_property
    def area(self) -> float:
        """Area of the polygon [m2]."""
        return float(self._cross[0].sum() / 2)

    @cached_property
    def centroid(self) -> Array:
        """Area centroid relative to the start of the base, shape (2,) [m]."""
        cross, sums = self._cross
        return cross @ sums / (6 * self.area)

    @property
    def rectangle(self) -> tuple[float, float] | None:
        """Width and height if the block is an upright rectangle loaded opposite its base, else None."""
        corners = self.outline
        opposite = len(corners) == 4 and (self.top - self.base) % 4 == 2
        if not opposite:
            return None
        width = float(corners[1, 0])
        height = float(corners[3, 1])
        expected = np.array([[0, 0], [width, 0], [width, height], [0, height]])
        # A corner that is off by rounding of its coordinates is still this rectangle's corner.
        slack = 4 * np.finfo(float).eps * max(width, height, float(np.abs(self.vertices).max()))
        upright = width > 0 and height > 0 and bool(np.all(np.abs(corners - expected) <= slack))
        return (width, height) if upright else None


@dataclass(frozen=True)
class Scheme:
    """A time scheme with kinetic damping: Newmark's (paper, eq. (5) to (7)), or one given by a table of stages."""

    alpha: float  # Newmark's weight of the new acceleration in the displacement [-]; NaN for a scheme with a table
    delta: float  # the same in the velocity [-]
    gg: float  # factor on the velocity at the start of each step [-], 0 to 1
    step: float  # dt [s]
    start: Literal["zero", "consistent"] | str = "zero"  # initial acceleration: A0 = 0 as the paper, or M A0 = F
    mass_damping: float = 0.0  # a0 of C = a0 M + a1 K [1/s]
    stiffness_damping: float = 0.0  # a1 [s]
    table: StageTable | None = None  # stages of a scheme other than Newmark's: see `named_scheme`

    def __post_init__(self) -> None:
        if self.table is None:
            require_numbers(self, ("step",), ("alpha", "delta", "mass_damping", "stiffness_damping"))
        require(0 <= self.gg <= 1, "gg", "must be from 0 to 1", self.gg)
        require(math.isfinite(self.step) and self.step > 0, "step", "must be positive", self.step)
        require(self.start in STARTS, "start", f"must be one of {STARTS}", self.start)
        for field in ("mass_damping", "stiffness_damping"):
            value = getattr(self, field)
            require(self.table is None or value == 0, field, "must be 0 for a scheme other than Newmark's", value)
        consistent = self.start == "consistent" or not self.staggered
        require(consistent, "start", f"must be 'consistent' for {self.name!r}", self.start)

    @property
    def name(self) -> str:
        """Name of the scheme, among `fem_reference.SCHEMES`."""
        return "newmark" if self.table is None else self.table.name

    @cached_property
    def stages(self) -> tuple[Stage, ...]:
        """Stages of a step, in their order."""
        return (newmark_stage(self.alpha, self.delta),) if self.table is None else self.table.stages

    @cached_property
    def stage_matrices(self) -> tuple[int, ...]:
        """Number of the first stage that has the matrix of each stage: each is factorised once."""
        weights = np.array([(stage.stiffness_weight, stage.damping_weight) for stage in self.stages])
        alike = np.isclose(weights[:, None], weights, rtol=SAME_MATRIX, atol=0).all(axis=2)
        return tuple(alike.argmax(axis=1).tolist())

    @property
    def staggered(self) -> bool:
        """Whether the velocity is that of the half step before, and the first step has a discount of 1."""
        return self.table is not None and self.table.staggered

    @property
    def explicit(self) -> bool:
        """Whether a stage needs no stiffness in its matrix."""
        return any(stage.beta == 0 for stage in self.stages)

    @property
    def damped(self) -> bool:
        """Whether there is viscous damping."""
        return self.mass_damping > 0 or self.stiffness_damping > 0

    def stage_times(self, steps: int) -> Array:
        """Instants at which the stages of so many steps end, the first one t = 0, shape (steps * stages + 1,) [s]."""
        ends = np.array([stage.end for stage in self.stages])
        return np.append(0.0, (self.step * (np.arange(float(steps))[:, None] + ends)).ravel())
