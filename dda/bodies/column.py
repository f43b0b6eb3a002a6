"""A column of blocks: layers from the base upwards, the springs between blocks, and what it stands on.

All points of a level move alike, along the column (pressure) or across it (shear), and nothing moves sideways: a block
has a displacement and one strain, and everything is per unit of area. With strain-free sides the modulus of a pressure
wave is E (1 - mu) / ((1 + mu)(1 - 2 mu)), that of a shear wave E / (2 (1 + mu)).

The springs are bonded, or contacts: unilateral ones open under pressure, frictional ones slip in shear.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from dda.model.arrays import Array
from dda.model.checks import check_finite, check_not_negative, check_positive

Motion = Literal["pressure", "shear"]
SpringLaw = Literal["bonded", "unilateral", "frictional"]
NEAR = 1e-9  # of the column's height: how near a joint must be to a face between blocks


@dataclass(frozen=True)
class Layer:
    """Equal blocks on each other.

    Raises
    ------
    ValueError
        If a number is out of range.
    """

    thickness: float  # [m]
    density: float  # [kg/m^3]
    young: float  # [Pa]; inf: rigid blocks, where the springs are contacts
    poisson: float = 0.0  # [-]
    blocks: int = 1
    velocity: float = 0.0  # of all its blocks at t = 0, where the springs are contacts [m/s]

    def __post_init__(self) -> None:
        """Check the ranges."""
        check_positive(thickness=self.thickness, density=self.density)
        if not self.young > 0:
            raise ValueError(f"young: must be positive, got {self.young!r}")
        check_finite(velocity=self.velocity)
        if not -1 < self.poisson < 0.5:
            raise ValueError(f"poisson: must be above -1 and below 0.5, got {self.poisson!r}")
        if self.blocks < 1:
            raise ValueError(f"blocks: must be at least 1, got {self.blocks!r}")

    def modulus(self, motion: Motion) -> float:
        """Return the modulus of a plane wave [Pa]."""
        shear = self.young / (2 * (1 + self.poisson))
        return shear if motion == "shear" else 2 * shear * (1 - self.poisson) / (1 - 2 * self.poisson)


@dataclass(frozen=True)
class Spring:
    """A joint across the column: a spring between the two faces at some height, or between the base and the column."""

    height: float  # above the base [m]
    stiffness: float  # [Pa/m]; inf: a rigid contact
    gap: float = 0.0  # of a unilateral one at t = 0 [m]
    strength: float = math.inf  # greatest shear stress of a frictional one [Pa]; inf: it never slips

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not self.stiffness > 0:
            raise ValueError(f"stiffness: must be positive, got {self.stiffness!r}")
        if not self.strength >= 0:
            raise ValueError(f"strength: must not be negative, got {self.strength!r}")
        check_not_negative(gap=self.gap)


@dataclass(frozen=True, eq=False)
class Column:
    """Blocks, the springs between them, and the base.

    Raises
    ------
    ValueError
        If there is no layer, a joint is not where two blocks, or block and base, meet, or a number does not go with the
        law of the springs.
    """

    layers: Sequence[Layer]  # from the base upwards
    motion: Motion = "pressure"
    glue: float | None = None  # stiffness where no joint is given [Pa/m]; None: the faces move alike
    joints: Sequence[Spring] = ()
    impedance: float | None = None  # rho c of a half-space below [Pa s/m]; None: the base moves as it is told
    law: SpringLaw = "bonded"  # of the springs; faces without one move alike under each law
    gravity: float = 0.0  # g, against the heights, where the springs are unilateral [m/s^2]
    unsupported: bool = False  # whether nothing is below the column, where the springs are contacts

    def __post_init__(self) -> None:
        """Check what the tables cannot."""
        if not self.layers:
            raise ValueError("layers: must be at least one, got none")
        if self.glue is not None:
            check_positive(glue=self.glue)
        if self.impedance is not None:
            check_positive(impedance=self.impedance)
        if len({self.face_of(joint) for joint in self.joints}) < len(self.joints):
            raise ValueError("joints: must not share a height, got two at one")
        check_not_negative(gravity=self.gravity)
        if self.law == "bonded":
            self._check_bonded()
        else:
            self._check_contacts()

    def _check_bonded(self) -> None:
        """Refuse what only contacts know."""
        for field, values in (
            ("young", [layer.young for layer in self.layers]),
            ("stiffness", [joint.stiffness for joint in self.joints]),
        ):
            if any(math.isinf(value) for value in values):
                raise ValueError(f"{field}: must be finite where the springs are bonded, got inf")
        if self.unsupported:
            raise ValueError("unsupported: does not go with bonded springs, got True")
        moving = [layer.velocity for layer in self.layers if layer.velocity]
        if moving:
            raise ValueError(f"velocity: must be zero where the springs are bonded, got {moving[0]!r}")
        self._check_springs()

    def _check_contacts(self) -> None:
        """Refuse what goes with another motion, and a contact where nothing carries it."""
        motion = "pressure" if self.law == "unilateral" else "shear"
        if self.motion != motion:
            raise ValueError(f"law: {self.law} springs need motion = {motion}, got {self.motion!r}")
        if self.glue is not None:
            raise ValueError(f"glue: goes with bonded springs only, got {self.glue!r}")
        if self.unsupported and self.impedance is not None:
            raise ValueError(f"impedance: does not go with unsupported = True, got {self.impedance!r}")
        if not self.rests_on_base and any(self.face_of(joint) == 0 for joint in self.joints):
            raise ValueError("joints: must lie above a base that is a half-space or absent, got one at the base")
        self._check_springs()

    def _check_springs(self) -> None:
        for field, law, none in (("gap", "unilateral", 0.0), ("strength", "frictional", math.inf)):
            stated = [getattr(joint, field) for joint in self.joints if getattr(joint, field) != none]
            if stated and self.law != law:
                raise ValueError(f"{field}: goes with {law} springs only, got {stated[0]!r}")
        if self.gravity and self.law != "unilateral":
            raise ValueError(f"gravity: goes with unilateral springs only, got {self.gravity!r}")

    @property
    def rests_on_base(self) -> bool:
        """Whether the base moves as it is prescribed and carries the lowest block, by a spring or welded to it."""
        return self.impedance is None and not self.unsupported

    def of_blocks(self, values: Iterable[float]) -> Array:
        """Return the value of its layer for every block, from the base upwards."""
        return np.repeat(list(values), [layer.blocks for layer in self.layers])

    @cached_property
    def heights(self) -> Array:
        """Height of every block [m]."""
        return self.of_blocks(layer.thickness / layer.blocks for layer in self.layers)

    @cached_property
    def faces(self) -> Array:
        """Height above the base of the faces between blocks, base and top included [m], (blocks + 1,)."""
        ends = np.cumsum([0.0, *(layer.thickness for layer in self.layers)])
        inside = [
            low + layer.thickness * np.arange(layer.blocks) / layer.blocks
            for low, layer in zip(ends[:-1], self.layers, strict=True)
        ]
        return np.concatenate([*inside, ends[-1:]])

    @cached_property
    def densities(self) -> Array:
        """Density of every block [kg/m^3]."""
        return self.of_blocks(layer.density for layer in self.layers)

    @cached_property
    def moduli(self) -> Array:
        """Modulus of every block for the motion [Pa]."""
        return self.of_blocks(layer.modulus(self.motion) for layer in self.layers)

    @cached_property
    def velocities(self) -> Array:
        """Velocity of every block at t = 0 [m/s]."""
        return self.of_blocks(layer.velocity for layer in self.layers)

    @cached_property
    def contacts(self) -> list[Spring | None]:
        """The joint below every block, None where faces move alike."""
        contacts: list[Spring | None] = [None] * len(self.heights)
        for joint in self.joints:
            contacts[self.face_of(joint)] = joint
        return contacts

    def face_of(self, joint: Spring) -> int:
        """Return the number of the face that a joint lies on, 0 for the base."""
        number = int(np.argmin(np.abs(self.faces - joint.height)))
        if abs(self.faces[number] - joint.height) > NEAR * self.faces[-1] or number == len(self.heights):
            raise ValueError(f"joints: must lie where blocks meet, below the top, got {joint.height!r} m")
        return number

    def block_at(self, height: float) -> tuple[int, float]:
        """Return the block at a height and the share of its height below; of two that meet there, the lower one.

        Raises
        ------
        ValueError
            If the height is outside the column.
        """
        total = float(self.faces[-1])
        if not 0 <= height <= total * (1 + NEAR):  # a sum of layers in another order is not the same in its last digit
            raise ValueError(f"height: must be between 0 and {total:g} m, got {height!r}")
        below = self.faces + NEAR * total
        block = max(int(np.searchsorted(below, min(height, total), side="left")) - 1, 0)
        return block, (min(height, total) - float(self.faces[block])) / float(self.heights[block])
