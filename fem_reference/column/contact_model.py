"""A column whose contacts open or slip, as a problem."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from fem_reference.column.problem import NEAR, Ground


@dataclass(frozen=True)
class ColumnContact:
    """A face across the column that opens or slips, per unit of area.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    height: float  # above the base [m]
    stiffness: float  # k [Pa/m]; inf: a rigid stop, or faces that move alike until they slip
    gap: float = 0.0  # at t = 0, of one that opens [m]
    strength: float = math.inf  # greatest shear stress of one that slips [Pa]; inf: it never does

    def __post_init__(self) -> None:
        if not (self.height >= 0 and self.stiffness > 0 and self.gap >= 0 and self.strength > 0):
            raise ValueError(f"contacts: must have positive numbers and a gap of 0 or more, got {self!r}")


@dataclass(frozen=True)
class ContactColumn:
    """A column on contacts.

    Raises
    ------
    ValueError
        For numbers that do not go together.
    """

    ground: Ground  # its joints are bonded springs; an impedance makes a half-space
    law: Literal["unilateral", "frictional"]
    contacts: tuple[ColumnContact, ...]  # from the base upwards
    velocities: tuple[float, ...]  # of the strata at t = 0 [m/s]
    gravity: float = 0.0  # downwards [m/s2]
    unsupported: bool = False  # whether nothing is below
    settled: bool = False  # whether it begins at rest under its weight, all contacts closed
    solve_limit: int | None = None  # solves of the open-close iteration that end the run; None: as many as it takes

    def __post_init__(self) -> None:
        heights = [contact.height for contact in self.contacts]
        if heights != sorted(set(heights)) or not heights or heights[-1] >= self.ground.height * (1 - NEAR):
            raise ValueError(f"contacts: must be one at least, upwards and below the top, got {heights!r}")
        if self.ground.joints:
            raise ValueError(f"joints: must be contacts where others open or slip, got {self.ground.joints!r}")
        supported = not self.unsupported and self.ground.impedance is None
        if heights[0] == 0 and not supported:
            raise ValueError("contacts: must be above the base where that is a half-space or nothing, got one at it")
        if self.settled and not (supported and self.law == "unilateral"):
            raise ValueError("settled: must be False but for contacts that open on a base, got True")
        if len(self.velocities) != len(self.ground.strata):
            raise ValueError(f"velocities: must be one for each stratum, got {self.velocities!r}")

    @property
    def foot_contact(self) -> bool:
        """Whether the column stands on a contact."""
        return self.contacts[0].height == 0
