"""The tables of a column of blocks as a wave guide, `[column]` and `[input]`, which stand in the place of a block."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from validation.scenes.keys import Key, Section
from validation.scenes.tables import Count, NonNegative, Positive, Real

MOST_HEIGHTS = 9  # whose displacement and stress a history may hold
NEAR = 1e-9  # of the column's height: how near a joint or height must be to the face that is meant
PoissonRatio = Annotated[Real, Field(gt=-1, lt=0.5)]


class LayerSection(Section):
    """A layer of equal blocks."""

    thickness: Annotated[Positive, Key("m", "of the layer")]
    density: Annotated[Positive, Key("kg/m3", "mass of a volume")]
    young: Annotated[Positive, Key("Pa", "Young's modulus")]
    poisson: Annotated[PoissonRatio, Key("", "Poisson's ratio")] = 0.0
    blocks: Annotated[Count, Key("", "DDA blocks on each other")] = 1


class JointSection(Section):
    """A spring across the column, where two blocks meet, or between base and column."""

    height: Annotated[NonNegative, Key("m", "above the base")]
    stiffness: Annotated[Positive, Key("Pa/m", "of the spring")]


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
    base: Annotated[Literal["rigid", "springs", "transmitting"], Key("", "what the column stands on")] = "rigid"
    base_stiffness: Annotated[Positive | None, Key("Pa/m", "of base = springs")] = None
    base_density: Annotated[Positive | None, Key("kg/m3", "of the half-space below a transmitting base")] = None
    base_speed: Annotated[Positive | None, Key("m/s", "of its waves; or base_young")] = None
    base_young: Annotated[Positive | None, Key("Pa", "Young's modulus of the half-space")] = None
    base_poisson: Annotated[PoissonRatio, Key("", "with base_young")] = 0.0
    heights: Annotated[tuple[NonNegative, ...], Field(max_length=MOST_HEIGHTS), Key("m", "where a history looks")] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        self._check_base()
        for name, values in (("joint.height", [j.height for j in self.joint]), ("heights", self.heights)):
            outside = [value for value in values if value > self.height * (1 + NEAR)]
            if outside:
                raise ValueError(f"{name} must be at most the column's height {self.height:g}, got {outside[0]:g}")
        return self

    def _check_base(self) -> None:
        given = sorted(name for name in self.model_fields_set if name.startswith("base_"))
        allowed = {"rigid": (), "springs": ("base_stiffness",)}.get(
            self.base, ("base_density", "base_speed", "base_young", "base_poisson")
        )
        if wrong := [name for name in given if name not in allowed]:
            raise ValueError(f"{wrong[0]} does not go with base = {self.base!r}, got it")
        if self.base == "springs" and self.base_stiffness is None:
            raise ValueError("base_stiffness is required with base = 'springs', got nothing")
        if self.base == "transmitting":
            if self.base_density is None or (self.base_speed is None) == (self.base_young is None):
                raise ValueError(
                    "base_density and either base_speed or base_young are required with base = 'transmitting', got "
                    f"{', '.join(given) or 'nothing'}"
                )
            if self.base_speed is not None and "base_poisson" in given:
                raise ValueError("base_poisson goes with base_young only, got it with base_speed")
        if self.base == "springs" and any(joint.height == 0 for joint in self.joint):
            raise ValueError("joint.height must be above 0 where the base is springs, got a joint at the base")

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
        if self.base != "transmitting" or self.base_density is None:
            return None
        if self.base_speed is not None:
            return self.base_density * self.base_speed
        modulus = plane_modulus(self.base_young or 0.0, self.base_poisson, self.motion)
        return math.sqrt(self.base_density * modulus)

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
    shape: Annotated[Literal["ricker", "half-sine"] | None, Key("", "of the velocity, or of the pressure")] = None
    velocity: Annotated[Real | None, Key("m/s", "greatest of a pulse at the base")] = None
    pressure: Annotated[Real | None, Key("Pa", "greatest of a pulse on the top")] = None
    frequency: Annotated[
        Positive | None, Key("Hz", "of a Ricker pulse's greatest content; its middle comes at 2 / frequency")
    ] = None
    duration: Annotated[Positive | None, Key("s", "of a half-sine")] = None
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
            needed |= {"frequency" if self.shape == "ricker" else "duration"}
        given = self.model_fields_set & {"velocity", "pressure", "frequency", "duration"}
        what = f"{self.shape or 'a record'} at the {self.at}"
        if missing := sorted(needed - given):
            raise ValueError(f"{missing[0]} is required with {what}, got nothing")
        if more := sorted(given - needed):
            raise ValueError(f"{more[0]} does not go with {what}, got it")
        return self
