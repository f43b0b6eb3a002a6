"""A layered column as a problem: what it is made of, what it stands on, how it is driven, where it is observed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from fem_reference.problem.problem import Array

# of the surface [m], of the base on the column [Pa]
DISPLACEMENT = "displacement"
PRESSURE = "contact_pressure"
NEAR = 1e-9  # of the height, within which two levels are one


@dataclass(frozen=True)
class Stratum:
    """A homogeneous layer."""

    thickness: float  # [m]
    density: float  # [kg/m3]
    young: float  # [Pa]
    poisson: float  # [-], below 1/2

    def modulus(self, motion: str) -> float:
        """Modulus of a plane wave by Lame's constants: mu in shear, lambda + 2 mu in compression [Pa]."""
        mu = self.young / (2 + 2 * self.poisson)
        lame = self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))
        return mu if motion == "shear" else lame + 2 * mu


@dataclass(frozen=True)
class Ground:
    """A column of strata, laterally uniform and not strained sideways, per unit of area.

    Raises
    ------
    ValueError
        For a number out of range, or a joint outside of the column.
    """

    strata: tuple[Stratum, ...]  # from the base upwards
    motion: Literal["pressure", "shear"]
    joints: tuple[tuple[float, float], ...] = ()  # height above the base [m] and stiffness [Pa/m]
    impedance: float | None = None  # of the half-space below [Pa s/m]; None where the base's motion is prescribed

    def __post_init__(self) -> None:
        for stratum in self.strata:
            positive = stratum.thickness, stratum.density, stratum.young
            if not (np.all(np.isfinite(positive)) and min(positive) > 0 and -1 < stratum.poisson < 0.5):
                raise ValueError(f"layers: must have positive numbers and poisson in (-1, 1/2), got {stratum!r}")
        for height, stiffness in self.joints:
            if not (0 <= height < self.height * (1 - NEAR) and stiffness > 0):
                raise ValueError(f"joints: must be positive springs below the top, got {(height, stiffness)!r}")
        levels = sorted(height for height, _ in self.joints)
        if np.any(np.diff(levels) <= NEAR * self.height):
            raise ValueError("joints: must not share a height, got two at one")
        if not self.strata or (self.impedance is not None and not self.impedance > 0):
            raise ValueError(f"impedance: must be positive, with one layer at least, got {self.impedance!r}")

    @property
    def height(self) -> float:
        """Height of the column [m]."""
        return sum(stratum.thickness for stratum in self.strata)

    @cached_property
    def tops(self) -> Array:
        """Height of the top of each stratum [m]."""
        return np.cumsum([stratum.thickness for stratum in self.strata])

    def check_heights(self, heights: Sequence[float]) -> None:
        """Raise for a height that is not in the column.

        Raises
        ------
        ValueError
            If it is not.
        """
        for height in heights:
            if not 0 <= height <= self.height * (1 + NEAR):
                raise ValueError(f"height: must be between 0 and {self.height:g} m, got {height!r}")


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


def asked_columns(heights: Sequence[float]) -> tuple[str, ...]:
    """Names that a history may have: surface, base, then displacement [m] and stress [Pa] of every height."""
    numbers = range(1, len(heights) + 1)
    return (DISPLACEMENT, PRESSURE, *(f"displacement_{n}" for n in numbers), *(f"stress_{n}" for n in numbers))


def check_columns(columns: Sequence[str], heights: Sequence[float]) -> None:
    """Raise for a column that is not available.

    Raises
    ------
    ValueError
        If one is unknown.
    """
    for name in columns:
        if name not in asked_columns(heights):
            raise ValueError(f"columns: must be among {asked_columns(heights)}, got {name!r}")
