"""What joins blocks in the plane and what drives them: contacts by pair, stated contacts, bonds and loads."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from validation.models.plane.blocks import Point
from validation.scenes.keys import Key, Section
from validation.scenes.tables import FrictionAngle, Index, NonNegative, Positive, Real, Share, Stiffness

Corner = Annotated[Index, Field(ge=0)]
Pair = tuple[str, str]
Segment = tuple[Point, Point]


class PlaneContactSection(Section):
    """Springs of a corner on an edge, of every pair of blocks that has none of its own.

    Contacts are found as the blocks move, unless `[[plane.touch]]` states them. A corner carries no tension beyond
    `tension`; it sticks by its shear spring until the force along the edge exceeds cohesion and friction.
    """

    stiffness: Annotated[
        Stiffness,
        Key("N/m", "of the normal spring of a corner; inf: rigid, and whoever has springs takes its own", "p"),
    ]
    shear_stiffness: Annotated[NonNegative | None, Key("N/m", "that of stiffness if absent; 0 is frictionless")] = None
    restitution: Annotated[
        Share | None, Key("", "rebound over approach speed; absent: as the contact's model has it", "e")
    ] = None
    friction: Annotated[FrictionAngle | None, Key("deg", "angle of friction; absent: it never slips", "φ")] = None
    cohesion: Annotated[NonNegative, Key("N", "of a corner that may slip")] = 0.0
    tension: Annotated[NonNegative, Key("N", "that a corner carries before it opens for the first time")] = 0.0

    @property
    def shear(self) -> float:
        """Stiffness of the shear spring [N/m]: none where nothing is rough."""
        if self.friction == 0 and not self.cohesion:
            return 0.0
        return self.stiffness if self.shear_stiffness is None else self.shear_stiffness

    @property
    def friction_coefficient(self) -> float | None:
        """tan(phi), None where a corner never slips."""
        return None if self.friction is None else math.tan(math.radians(self.friction))

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.cohesion and self.friction is None:
            raise ValueError(f"cohesion goes with friction only, got {self.cohesion:g} without it")
        if self.friction and self.shear_stiffness == 0:
            raise ValueError("shear_stiffness must be greater than 0 with friction, got 0")
        mu = self.friction_coefficient or 0.0
        if self.tension * mu > self.cohesion:
            most = self.cohesion / mu
            raise ValueError(f"tension must be at most cohesion / tan(friction) = {most:g} N, got {self.tension:g}")
        return self


class PlanePairSection(Section):
    """Springs between two blocks, or all blocks of a name: what it states replaces that of `[plane.contact]`."""

    blocks: Annotated[Pair, Key("", "names of two blocks, or of what is cut, stacked or generated")]
    stiffness: Annotated[Positive | None, Key("N/m", "of the normal spring of a corner", "p")] = None
    shear_stiffness: Annotated[NonNegative | None, Key("N/m", "0 is frictionless")] = None
    friction: Annotated[FrictionAngle | None, Key("deg", "angle of friction", "φ")] = None
    cohesion: Annotated[NonNegative | None, Key("N", "of a corner")] = None
    tension: Annotated[NonNegative | None, Key("N", "that a corner carries before it opens for the first time")] = None

    def over(self, contact: PlaneContactSection) -> PlaneContactSection:
        """Return the springs of the pair."""
        stated = {name: getattr(self, name) for name in self.model_fields_set - {"blocks"}}
        return PlaneContactSection(**{**contact.model_dump(exclude_unset=True), **stated})


class PlaneTouchSection(Section):
    """A contact that is stated: a corner of a block that may press on an edge of another one."""

    block: Annotated[str, Key("", "whose corner it is")]
    corner: Annotated[Corner, Key("", "of it, from 0 in the order of its corners")]
    on: Annotated[str, Key("", "the block that it may press on")]
    edge: Annotated[Corner, Key("", "of that block, numbered as the corner that it begins at")]


class PlaneBondSection(Section):
    """Glue at both ends of every edge that two blocks share; it never opens."""

    blocks: Annotated[Pair, Key("", "names of two blocks")]
    stiffness: Annotated[Positive, Key("N/m", "of the normal spring at an end")]
    shear_stiffness: Annotated[NonNegative | None, Key("N/m", "that of stiffness if absent")] = None

    @property
    def shear(self) -> float:
        """Stiffness of the shear spring [N/m]."""
        return self.stiffness if self.shear_stiffness is None else self.shear_stiffness


class PlaneLoadSection(Section):
    """A force on a block, or a uniform traction on a straight part of the outline."""

    block: Annotated[str | None, Key("", "name of the block that it acts on")] = None
    force: Annotated[tuple[Real, Real] | None, Key("N", "in x and y, whose direction does not turn")] = None
    at: Annotated[Point | None, Key("m", "where the force acts at t = 0; the centroid if absent")] = None
    traction: Annotated[tuple[Real, Real] | None, Key("Pa", "in x and y")] = None
    edge: Annotated[Segment | None, Key("m", "of the traction, from a point to a point of the outline at t = 0")] = None
    ramp: Annotated[NonNegative, Key("s", "over which it grows from zero, linearly")] = 0.0

    @property
    def vector(self) -> tuple[float, float]:
        """The force [N] or the traction [Pa]."""
        return self.force or self.traction or (0.0, 0.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.force is None) == (self.traction is None):
            raise ValueError(f"needs a force or a traction, got {'neither' if self.force is None else 'both'}")
        if self.force is not None and (self.block is None or self.edge is not None):
            raise ValueError(
                f"force goes with block and not with edge, got {'no block' if self.block is None else 'edge'}"
            )
        if self.traction is not None and (self.edge is None or self.at is not None):
            raise ValueError(f"traction goes with edge and not with at, got {'no edge' if self.edge is None else 'at'}")
        return self
