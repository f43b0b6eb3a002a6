"""A layered column as a problem: what it is made of, what it stands on, how it is driven, where it is observed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from fem_reference.problem.checks import require
from fem_reference.problem.material import Elastic
from fem_reference.problem.problem import Array

# of the surface [m], of the base on the column [Pa]
DISPLACEMENT = "displacement"
PRESSURE = "contact_pressure"
PARTS = ("displacement", "stress")  # of a height: [m], [Pa]
NEAR = 1e-9  # of the height, within which two levels are one


@dataclass(frozen=True)
class Stratum(Elastic):
    """A homogeneous layer."""

    thickness: float  # [m]
    density: float  # [kg/m3]
    young: float  # [Pa]
    poisson: float  # [-], below 1/2

    hypothesis = "plane strain"

    def modulus(self, motion: str) -> float:
        """Modulus of a plane wave: mu in shear, lambda + 2 mu in compression [Pa]."""
        return self.shear_modulus if motion == "shear" else self.wave_modulus


@dataclass(frozen=True)
class Ground:
    """A column of strata, laterally uniform and not strained sideways, per unit of area."""

    strata: tuple[Stratum, ...]  # from the base upwards
    motion: Literal["pressure", "shear"]
    joints: tuple[tuple[float, float], ...] = ()  # height above the base [m] and stiffness [Pa/m]
    impedance: float | None = None  # of the half-space below [Pa s/m]; None where the base's motion is prescribed

    def __post_init__(self) -> None:
        for stratum in self.strata:
            positive = stratum.thickness, stratum.density, stratum.young
            sound = all(0 < value < math.inf for value in positive) and -1 < stratum.poisson < 0.5
            require(sound, "layers", "must have positive numbers and poisson in (-1, 1/2)", stratum)
        for joint in self.joints:
            inside = 0 <= joint[0] < self.height * (1 - NEAR) and joint[1] > 0
            require(inside, "joints", "must be positive springs below the top", joint)
        levels = np.sort([height for height, _ in self.joints])
        require(bool(np.all(np.diff(levels) > NEAR * self.height)), "joints", "must not share a height", self.joints)
        sound = bool(self.strata) and (self.impedance is None or self.impedance > 0)
        require(sound, "impedance", "must be positive, with one layer at least", self.impedance)

    @property
    def height(self) -> float:
        """Height of the column [m]."""
        return sum(stratum.thickness for stratum in self.strata)

    @cached_property
    def tops(self) -> Array:
        """Height of the top of each stratum [m]."""
        return np.cumsum([stratum.thickness for stratum in self.strata])

    def check_request(self, columns: Sequence[str], heights: Sequence[float], parts: Sequence[str] = PARTS) -> None:
        """Raise a `ValueError` for a column that is not available, or a height [m] that is not in the column.

        `parts` is what is known of a height.
        """
        known = (DISPLACEMENT, PRESSURE, *(f"{part}_{n + 1}" for part in parts for n in range(len(heights))))
        for name in columns:
            require(name in known, "columns", f"must be among {known}", name)
        for height in heights:
            inside = 0 <= height <= self.height * (1 + NEAR)
            require(inside, "height", f"must be between 0 and {self.height:g} m", height)


@dataclass(frozen=True)
class Excitation:
    """Base motion and surface pressure at the scheme's `stage_times`: t = 0 and the end of every stage of every step.

    Above a half-space `velocity` is the particle velocity of the wave that comes up.
    """

    displacement: Array  # [m]
    velocity: Array  # [m/s]
    acceleration: Array  # [m/s2]
    pressure: Array  # on the surface, towards the base where positive [Pa]

    @property
    def parts(self) -> Array:
        """All of it, one row an instant, shape (instants, 4)."""
        return np.column_stack([self.displacement, self.velocity, self.acceleration, self.pressure])
