"""Blocks in the plane, what joins them and what drives them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dda.contact.unilateral import Unilateral
from dda.model.arrays import Array
from dda.model.block import Block
from dda.model.checks import check_finite, check_not_negative, check_number
from dda.model.load import BaseMotion
from dda.model.material import Hypothesis, Material
from dda.plane.bodies import as_complex

NEAR = 1e-6  # of an edge's length, by which points that are to lie on it may be beside it


@dataclass(frozen=True, eq=False)
class PlaneBlock:
    """A homogeneous polygon of unit thickness, rigid or of one strain, that moves, is fixed or is driven.

    Raises
    ------
    ValueError
        If the corners form no simple counter-clockwise polygon, a number is out of its range, or a fixed or driven
        block is to have a velocity of its own.
    """

    vertices: ArrayLike  # (n, 2) corners at t = 0, counter-clockwise, need not be convex [m]
    density: float  # [kg/m^3]
    young: float = math.inf  # [Pa]; infinite: rigid, three unknowns in place of six
    poisson: float = 0.0  # [-]
    hypothesis: Hypothesis = "plane stress"  # or "plane strain"
    fixed: bool = False  # carries contacts and does not move
    motion: BaseMotion | None = None  # of a block that is driven, in x and y
    velocity: tuple[float, float] = (0.0, 0.0)  # of the centroid at t = 0 [m/s]
    spin: float = 0.0  # at t = 0, counter-clockwise [rad/s]
    name: str = ""

    def __post_init__(self) -> None:
        if len(self.velocity) != 2 or not np.all(np.isfinite(self.velocity)):
            raise ValueError(f"velocity: must be two finite numbers, got {self.velocity!r}")
        check_finite(spin=self.spin)
        if self.held and (any(self.velocity) or self.spin):
            raise ValueError(
                "velocity: must be zero of a block that is fixed or driven, "
                f"got {self.velocity!r} and spin = {self.spin!r}"
            )
        _ = self.block

    @property
    def rigid(self) -> bool:
        """Whether it has no strain."""
        return math.isinf(self.young) and self.young > 0

    @property
    def held(self) -> bool:
        """Whether it has no unknowns: it is fixed, or driven."""
        return self.fixed or self.motion is not None

    @cached_property
    def block(self) -> Block:
        """Outline and material; the modulus of a rigid block is any."""
        young = 1.0 if self.rigid else self.young
        return Block(self.vertices, Material(self.density, young, self.poisson, self.hypothesis))


@dataclass(frozen=True)
class ContactSprings:
    """The law of a contact that opens, sticks and slips: |T| <= tan(phi) N + c, N >= -tension.

    Raises
    ------
    ValueError
        If a number is out of its range, or strength has no spring along the edge.
    """

    stiffness: float  # p of a corner across the edge [N/m]; infinite: rigid
    shear: float = 0.0  # p_s along the edge [N/m]; zero: frictionless
    friction: float | None = None  # tan(phi) [-]; None: a closed contact never slips
    cohesion: float = 0.0  # [N]
    tension: float = 0.0  # [N]

    def __post_init__(self) -> None:
        Unilateral(self.stiffness, self.shear, friction=self.friction, cohesion=self.cohesion)  # which checks these
        check_not_negative(tension=self.tension)
        if self.friction and self.tension * self.friction > self.cohesion:
            most = f"cohesion / friction = {self.cohesion / self.friction:g}"
            raise ValueError(f"tension: must not exceed {most}, got {self.tension!r}")


@dataclass(frozen=True)
class CornerOnEdge:
    """A contact that a scene states: a corner of one block on an edge of another."""

    block: int
    corner: int
    on: int
    edge: int  # from this corner of `on` to the next
    springs: ContactSprings


@dataclass(frozen=True)
class EdgeBond:
    """Glue at both ends of a part of edges that two blocks share: one spring each across and along.

    Raises
    ------
    ValueError
        If a stiffness is not positive, or the part has no length.
    """

    first: int
    second: int  # block whose edge has the directions of the springs
    start: tuple[float, float]  # [m]
    end: tuple[float, float]
    stiffness: float  # of each end across the edge [N/m]; infinite: rigid
    shear: float  # the same along it

    def __post_init__(self) -> None:
        for name in ("stiffness", "shear"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name}: must be positive, got {getattr(self, name)!r}")
        if not (np.all(np.isfinite([self.start, self.end])) and math.dist(self.start, self.end) > 0):
            raise ValueError(f"end: must be finite and apart from the start, got {self.start!r} and {self.end!r}")


@dataclass(frozen=True)
class PlaneLoad:
    """A dead force on a block, or a uniform traction on a part of one of its edges; it keeps size and direction.

    Raises
    ------
    ValueError
        If a number is not finite, or both a place and an edge are given.
    """

    block: int
    force: tuple[float, float]  # [N]; on an edge a traction [Pa]
    place: tuple[float, float] | None = None  # material point at t = 0 [m]; None: the centroid
    edge: tuple[tuple[float, float], tuple[float, float]] | None = None  # both ends of the part at t = 0 [m]
    ramp: float = 0.0  # time in which it rises from zero [s]

    def __post_init__(self) -> None:
        check_not_negative(ramp=self.ramp)
        for name in ("force", "place", "edge"):
            value = getattr(self, name)
            if value is not None and not np.all(np.isfinite(value)):
                raise ValueError(f"{name}: must be finite, got {value!r}")
        if self.place is not None and self.edge is not None:
            raise ValueError(f"edge: goes without a place, got {self.edge!r} and {self.place!r}")

    @property
    def resultant(self) -> tuple[Array, Array | None]:
        """The whole force [N] and where it acts [m]; None: at the centroid."""
        force = np.array(self.force, dtype=float)
        if self.edge is not None:
            ends = np.array(self.edge, dtype=float)
            return np.hypot(*(ends[1] - ends[0])) * force, ends.mean(axis=0)
        return force, None if self.place is None else np.array(self.place, dtype=float)


@dataclass(frozen=True, eq=False)
class PlaneModel:
    """Blocks, their contacts, glue and loads.

    Raises
    ------
    ValueError
        If a contact, bond or load names what is not there, a bond lies on no edge of a block, or nothing can move.
    """

    blocks: Sequence[PlaneBlock]
    contacts: Sequence[CornerOnEdge] = ()
    bonds: Sequence[EdgeBond] = ()
    loads: Sequence[PlaneLoad] = ()
    gravity: tuple[float, float] = (0.0, 0.0)  # [m/s^2]
    found: Any = None  # contacts that are found; None: those that are stated alone

    def __post_init__(self) -> None:
        if all(block.held for block in self.blocks):
            raise ValueError("blocks: at least one must move, got none")
        if len(self.gravity) != 2 or not np.all(np.isfinite(self.gravity)):
            raise ValueError(f"gravity: must be two finite numbers, got {self.gravity!r}")
        for number, contact in enumerate(self.contacts):
            field = f"contacts[{number}]"
            self._check_pair(field, "block", contact.block, "on", contact.on)
            check_number(f"{field}.corner", contact.corner, len(self.blocks[contact.block].block.corners))
            check_number(f"{field}.edge", contact.edge, len(self.blocks[contact.on].block.corners))
        for number, bond in enumerate(self.bonds):
            field = f"bonds[{number}]"
            self._check_pair(field, "first", bond.first, "second", bond.second)
            for name in ("first", "second"):
                self.edge_of(getattr(bond, name), bond.start, bond.end, f"{field}.{name}")
        for number, load in enumerate(self.loads):
            field = f"loads[{number}]"
            check_number(f"{field}.block", load.block, len(self.blocks))
            if self.blocks[load.block].held:
                raise ValueError(f"{field}.block: must move, got {self.name_of(load.block)}")
            if load.edge is not None:
                self.edge_of(load.block, *load.edge, f"{field}.edge")

    def name_of(self, block: int) -> str:
        """Return the name of a block, or its number."""
        return self.blocks[block].name or f"block {block}"

    def edge_of(self, block: int, start: ArrayLike, end: ArrayLike, field: str = "edge") -> int:
        """Return the edge on which two points lie, by its first corner; a ValueError names the field if none."""
        corners = as_complex(self.blocks[block].block.corners)
        along = np.roll(corners, -1) - corners
        beside = np.zeros(len(corners))  # of the edges' lengths
        for place in as_complex([start, end]):
            ahead = (place - corners) / along  # of an edge from 0 to 1
            beside = np.maximum(beside, np.abs(ahead - np.clip(ahead.real, 0.0, 1.0)))
        edge = int(np.argmin(beside))
        if beside[edge] > NEAR:
            raise ValueError(f"{field}: must lie on one edge of {self.name_of(block)}, got {start!r} to {end!r}")
        return edge

    def _check_pair(self, field: str, first: str, i: int, second: str, j: int) -> None:
        check_number(f"{field}.{first}", i, len(self.blocks))
        check_number(f"{field}.{second}", j, len(self.blocks))
        if i == j:
            raise ValueError(f"{field}.{second}: must be another block than {first}, got {j!r}")
        if self.blocks[i].held and self.blocks[j].held:
            raise ValueError(f"{field}.{second}: one of two blocks must move, got {self.name_of(i)}, {self.name_of(j)}")
