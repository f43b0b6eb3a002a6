"""A column whose contacts open or slip, as a problem."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from fem_reference.column.problem import NEAR, Ground
from fem_reference.problem.checks import require


@dataclass(frozen=True)
class ColumnContact:
    """A face across the column that opens or slips, per unit of area."""

    height: float  # above the base [m]
    stiffness: float  # k [Pa/m]; inf: a rigid stop, or faces that move alike until they slip
    gap: float = 0.0  # at t = 0, of one that opens [m]
    strength: float = math.inf  # greatest shear stress of one that slips [Pa]; inf: it never does

    def __post_init__(self) -> None:
        sound = self.height >= 0 and self.stiffness > 0 and self.gap >= 0 and self.strength > 0
        require(sound, "contacts", "must have positive numbers and a gap of 0 or more", self)


@dataclass(frozen=True)
class ContactColumn:
    """A column on contacts."""

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
        upwards = bool(heights) and heights == sorted(set(heights)) and heights[-1] < self.ground.height * (1 - NEAR)
        require(upwards, "contacts", "must be one at least, upwards and below the top", heights)
        require(not self.ground.joints, "joints", "must be contacts where others open or slip", self.ground.joints)
        supported = not self.unsupported and self.ground.impedance is None
        on_base = heights[0] > 0 or supported
        require(on_base, "contacts", "must be above the base where that is a half-space or nothing", heights)
        rests = supported and self.law == "unilateral"
        require(rests or not self.settled, "settled", "must be False but for contacts that open on a base", True)
        each = len(self.velocities) == len(self.ground.strata)
        require(each, "velocities", "must be one for each stratum", self.velocities)

    @property
    def foot_contact(self) -> bool:
        """Whether the column stands on a contact."""
        return self.contacts[0].height == 0
