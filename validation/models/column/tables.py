"""The tables of a column of blocks as a wave guide, `[column]` and `[input]`, which stand in the place of a block."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from validation.scenes.keys import Key, Section
from validation.scenes.tables import (
    Count,
    Flag,
    FrictionAngle,
    NonNegative,
    PoissonRatio,
    Positive,
    Real,
    Stiffness,
)

MOST_HEIGHTS = 99  # at which a history may look
NEAR = 1e-9  # of the column's height: how near a joint or height must be to its face
BlockCount = Annotated[Count, Field(le=100_000)]  # of a layer: lists are made before memory is predicted
THINNEST = 1e-6  # block, of the height: its elements, hundreds at most, must be longer than `NEAR`
OPENS, SLIPS, MOVES = 'law = "unilateral"', 'law = "frictional"', 'law = "unilateral" or "frictional"'


class LayerSection(Section):
    """A layer of equal blocks."""

    thickness: Annotated[Positive, Key("m", "of the layer")]
    density: Annotated[Positive, Key("kg/m3", "mass of a volume")]
    young: Annotated[Stiffness, Key("Pa", "Young's modulus; inf: rigid blocks, where contacts open or slip")]
    poisson: Annotated[PoissonRatio, Key("", "Poisson's ratio")] = 0.0
    blocks: Annotated[BlockCount, Key("", "DDA blocks on each other")] = 1
    velocity: Annotated[Real, Key("m/s", "at t = 0, upwards or with the shear", None, ("column." + MOVES,))] = 0.0


class JointSection(Section):
    """A spring across the column, where two blocks meet, or between base and column."""

    height: Annotated[NonNegative, Key("m", "above the base")]
    stiffness: Annotated[Stiffness, Key("Pa/m", "of the spring; inf: rigid, where contacts open or slip")]
    gap: Annotated[NonNegative, Key("m", "at t = 0", None, ("column." + OPENS,))] = 0.0
    strength: Annotated[
        Positive | None,
        Key("Pa", "greatest shear stress; without, and without friction, it never slips", None, ("column." + SLIPS,)),
    ] = None
    friction: Annotated[
        FrictionAngle | None,
        Key(
            "deg",
            "in place of strength: its tangent times the static normal stress",
            None,
            ("column." + SLIPS, "column.gravity"),
        ),
    ] = None


@dataclass(frozen=True)
class Contact:
    """A face that opens or slips, per unit of area."""

    height: float  # above the base [m]
    stiffness: float  # [Pa/m], inf: rigid
    gap: float  # at t = 0 [m]
    strength: float  # greatest shear stress [Pa], inf: never slips


class ColumnSection(Section):
    """Layers from the base upwards, their joints, what they stand on, and how they move.

    All points of a level move alike and nothing strains sideways; everything is per unit of area.
    """

    motion: Annotated[Literal["pressure", "shear"], Key("", "along the column, or across it")]
    layer: Annotated[tuple[LayerSection, ...], Field(min_length=1)]
    joint: tuple[JointSection, ...] = ()
    glue: Annotated[Positive | None, Key("Pa/m", "between blocks and to the base; absent: their faces move alike")] = (
        None
    )
    law: Annotated[
        Literal["bonded", "unilateral", "frictional"],
        Key("", "of the springs: unilateral ones open under pressure, frictional ones slip in shear"),
    ] = "bonded"
    stiffness: Annotated[
        Stiffness | None,
        Key("Pa/m", "of the contacts at the faces without a joint; absent: these move alike", None, (MOVES,)),
    ] = None
    gap: Annotated[NonNegative, Key("m", "of these contacts at t = 0", None, (OPENS, "stiffness"))] = 0.0
    strength: Annotated[
        Positive | None, Key("Pa", "greatest shear stress of these contacts", None, (SLIPS, "stiffness"))
    ] = None
    friction: Annotated[
        FrictionAngle | None,
        Key(
            "deg",
            "in place of strength: its tangent times the static normal stress",
            None,
            (SLIPS, "stiffness", "gravity"),
        ),
    ] = None
    gravity: Annotated[
        NonNegative, Key("m/s2", "downwards; in shear it makes the static normal stress only", "g", (MOVES,))
    ] = 0.0
    settled: Annotated[Flag, Key("", "whether it is at rest under its weight at t = 0", None, (OPENS, "gravity"))] = (
        False
    )
    solve_limit: Annotated[
        Count | None,
        Key("", "solves of the open-close iteration that end the run; absent: as many as it takes", None, (MOVES,)),
    ] = None
    base: Annotated[Literal["rigid", "springs", "transmitting", "free"], Key("", "what the column stands on")] = "rigid"
    base_stiffness: Annotated[Positive | None, Key("Pa/m", "of base = springs")] = None
    base_density: Annotated[Positive | None, Key("kg/m3", "of the half-space below a transmitting base")] = None
    base_speed: Annotated[Positive | None, Key("m/s", "of its waves")] = None
    heights: Annotated[tuple[NonNegative, ...], Field(max_length=MOST_HEIGHTS), Key("m", "where a history looks")] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        base_keys = sorted(name for name in self.model_fields_set if name.startswith("base_"))
        required = {"springs": ["base_stiffness"], "transmitting": ["base_density", "base_speed"]}.get(self.base, [])
        if wrong := [name for name in base_keys if name not in required]:
            raise ValueError(f"{wrong[0]} does not go with base = {self.base!r}, got {getattr(self, wrong[0])!r}")
        if missing := [name for name in required if getattr(self, name) is None]:
            raise ValueError(f"{missing[0]} is required with base = {self.base!r}, got nothing")
        if self.base == "springs" and any(joint.height == 0 for joint in self.joint):
            raise ValueError("joint.height must be above 0 where the base is springs, got a joint at the base")
        self._check_law()
        for layer in self.layer:
            if not layer.thickness / layer.blocks > THINNEST * self.height:
                rule = f"layer.thickness must be above {THINNEST:g} of the column's height for each block"
                raise ValueError(f"{rule}, got {layer.thickness:g} for {layer.blocks} of {self.height:g}")
        for name, values in (("joint.height", [j.height for j in self.joint]), ("heights", self.heights)):
            outside = [value for value in values if value > self.height * (1 + NEAR)]
            if outside:
                raise ValueError(f"{name} must be at most the column's height {self.height:g}, got {outside[0]:g}")
        return self

    def _check_law(self) -> None:
        motion = {"unilateral": "pressure", "frictional": "shear"}.get(self.law, self.motion)
        if self.motion != motion:
            raise ValueError(f"law = {self.law!r} goes with motion = {motion!r} only, got {self.motion!r}")
        if self.law == "bonded":
            for name, values in (("layer.young", self.layer), ("joint.stiffness", self.joint)):
                if any(math.isinf(getattr(value, name.partition(".")[2])) for value in values):
                    raise ValueError(f"{name} must be finite with law = 'bonded', got inf")
            if self.base == "free":
                raise ValueError("base = 'free' goes with law = 'unilateral' or 'frictional' only, got 'bonded'")
            return
        if self.glue is not None:
            raise ValueError(f"glue goes with law = 'bonded' only, got {self.glue:g}; stiffness is that of contacts")
        if self.base in ("transmitting", "free") and any(joint.height == 0 for joint in self.joint):
            raise ValueError(f"joint.height must be above 0 where the base is {self.base}, got a joint at the base")
        if self.settled and self.base in ("transmitting", "free"):
            raise ValueError(f"settled goes with base = 'rigid' or 'springs' only, got {self.base!r}")
        if not self.contacts:
            raise ValueError(f"stiffness or a joint is required with law = {self.law!r}, got neither")
        strengths = [(self.strength, self.friction), *((joint.strength, joint.friction) for joint in self.joint)]
        if any(strength is not None and friction is not None for strength, friction in strengths):
            raise ValueError("strength and friction exclude each other, got both")

    @property
    def has_rigid_blocks(self) -> bool:
        """Whether the blocks of a layer are rigid."""
        return any(math.isinf(layer.young) for layer in self.layer)

    @property
    def has_rigid_joints(self) -> bool:
        """Whether a contact is rigid."""
        return any(math.isinf(contact.stiffness) for contact in self.contacts)

    @property
    def height(self) -> float:
        """Height of the column [m]."""
        return sum(layer.thickness for layer in self.layer)

    @property
    def springs(self) -> tuple[JointSection, ...]:
        """The joints, with the springs of the base as the lowest."""
        if self.base_stiffness is None:
            return self.joint
        return (JointSection(height=0.0, stiffness=self.base_stiffness), *self.joint)

    @property
    def impedance(self) -> float | None:
        """Impedance rho c of the half-space below [Pa s/m]; None where the base moves as it is told."""
        if self.base_density is None or self.base_speed is None:
            return None
        return self.base_density * self.base_speed

    @property
    def faces(self) -> tuple[float, ...]:
        """Heights of the faces between blocks above the base, base and top included [m]."""
        faces = [0.0]
        for layer in self.layer:
            low = faces[-1]
            faces += [low + layer.thickness * number / layer.blocks for number in range(1, layer.blocks + 1)]
        return tuple(faces)

    @property
    def plain_faces(self) -> list[float]:
        """Heights of the faces without a joint, between blocks or on the base [m]."""
        lowest = 1 if self.base in ("transmitting", "free") else 0
        near = NEAR * self.height
        jointed = [joint.height for joint in self.springs]
        return [face for face in self.faces[lowest:-1] if all(abs(face - joint) > near for joint in jointed)]

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts that open or slip, from the base upwards; none where the column is bonded."""
        if self.law == "bonded":
            return ()
        contacts = [self._contact(joint.height, joint) for joint in self.springs]
        if self.stiffness is not None:
            contacts += [self._contact(height, self) for height in self.plain_faces]
        return tuple(sorted(contacts, key=lambda contact: contact.height))

    def _contact(self, height: float, stated: ColumnSection | JointSection) -> Contact:
        """Return the contact at a height [m] with the numbers that a joint, or else the column, states."""
        strength = math.inf if stated.strength is None else stated.strength
        if stated.friction is not None:
            strength = math.tan(math.radians(stated.friction)) * self.static_stress(height)
        return Contact(height, stated.stiffness or 0.0, stated.gap, strength)

    def static_stress(self, height: float) -> float:
        """Return the weight above a height per unit of area [Pa]."""
        stress, low = 0.0, 0.0
        for layer in self.layer:
            above = low + layer.thickness - height
            stress += self.gravity * layer.density * min(max(above, 0.0), layer.thickness)
            low += layer.thickness
        return stress

    def modulus(self, layer: LayerSection) -> float:
        """Return the modulus of a layer for the motion [Pa]."""
        return plane_modulus(layer.young, layer.poisson, self.motion)


def plane_modulus(young: float, poisson: float, motion: str) -> float:
    """Return the modulus of a plane wave [Pa]: E / (2 (1 + mu)), or E (1 - mu) / ((1 + mu) (1 - 2 mu)) of pressure."""
    shear = young / (2 * (1 + poisson))
    return shear if motion == "shear" else 2 * shear * (1 - poisson) / (1 - 2 * poisson)


class InputSection(Section):
    """What drives a column: a pulse or a record, at the base or on the top.

    At the base it is the velocity of the base itself, above a transmitting base that of the wave that comes up, which
    is half of what an outcrop shows. On the top it is a pressure towards the base (a shear stress against the motion).
    """

    at: Annotated[Literal["base", "top"], Key("", "where the column is driven")] = "base"
    shape: Annotated[
        Literal["ricker", "half-sine", "triangle", "sine", "cosine"] | None,
        Key("", "of the velocity, or of the pressure; triangle: from its greatest value at t = 0 to zero"),
    ] = None
    velocity: Annotated[Real | None, Key("m/s", "greatest of a pulse at the base")] = None
    pressure: Annotated[Real | None, Key("Pa", "greatest of a pulse on the top")] = None
    frequency: Annotated[
        Positive | None,
        Key("Hz", "of a sine or cosine; of a Ricker pulse's greatest content, whose middle comes at 2 / frequency"),
    ] = None
    duration: Annotated[Positive | None, Key("s", "of a half-sine or triangle")] = None
    record: Annotated[
        str | None, Key("", "CSV file: time,velocity or time,acceleration at the base, time,pressure on the top")
    ] = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.shape is None) == (self.record is None):
            raise ValueError(f"one of shape and record is required, got {'both' if self.shape else 'neither'}")
        needed = set()
        if self.shape is not None:
            needed = {"velocity" if self.at == "base" else "pressure"}
            needed |= {"duration" if self.shape in ("half-sine", "triangle") else "frequency"}
        stated_keys = self.model_fields_set & {"velocity", "pressure", "frequency", "duration"}
        what = f"{self.shape or 'a record'} at the {self.at}"
        if missing := sorted(needed - stated_keys):
            raise ValueError(f"{missing[0]} is required with {what}, got nothing")
        if more := sorted(stated_keys - needed):
            raise ValueError(f"{more[0]} does not go with {what}, got {getattr(self, more[0])!r}")
        return self

    @property
    def pulse(self) -> tuple[float, float]:
        """Greatest value, and duration [s] or frequency [Hz] as the shape has it; zeros of a record."""
        return self.velocity or self.pressure or 0.0, self.duration or self.frequency or 0.0
