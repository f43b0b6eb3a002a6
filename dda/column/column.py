"""A column of blocks: layers from the base upwards, the springs between blocks, and what it stands on.

All points of a level move alike, along the column (pressure) or across it (shear), and nothing moves sideways: a block
has a displacement and one strain, and everything is per unit of area. With strain-free sides the modulus of a pressure
wave is E (1 - mu) / ((1 + mu)(1 - 2 mu)), that of a shear wave E / (2 (1 + mu)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Motion = Literal["pressure", "shear"]
_NEAR = 1e-9  # of the column's height: how near a joint must be to a face between blocks


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
    young: float  # [Pa]
    poisson: float = 0.0  # [-]
    blocks: int = 1

    def __post_init__(self) -> None:
        """Check the ranges."""
        for field in ("thickness", "density", "young"):
            value = getattr(self, field)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{field}: must be finite and positive, got {value!r}")
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
    stiffness: float  # [Pa/m]

    def __post_init__(self) -> None:
        """Check the stiffness."""
        if not (math.isfinite(self.stiffness) and self.stiffness > 0):
            raise ValueError(f"stiffness: must be finite and positive, got {self.stiffness!r}")


@dataclass(frozen=True, eq=False)
class Column:
    """Blocks, the springs between them, and the base.

    Raises
    ------
    ValueError
        If there is no layer, or a joint is not where two blocks, or block and base, meet.
    """

    layers: Sequence[Layer]  # from the base upwards
    motion: Motion = "pressure"
    glue: float | None = None  # stiffness where no joint is given [Pa/m]; None: the faces move alike
    joints: Sequence[Spring] = ()
    impedance: float | None = None  # rho c of a half-space below [Pa s/m]; None: the base moves as it is told

    def __post_init__(self) -> None:
        """Check what the tables cannot."""
        if not self.layers:
            raise ValueError("layers: must be at least one, got none")
        for field in ("glue", "impedance"):
            value = getattr(self, field)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise ValueError(f"{field}: must be finite and positive, got {value!r}")
        if len({self.face_of(joint) for joint in self.joints}) < len(self.joints):
            raise ValueError("joints: must not share a height, got two at one")

    @cached_property
    def heights(self) -> Array:
        """Height of every block [m], from the base upwards."""
        return np.repeat([x.thickness / x.blocks for x in self.layers], [x.blocks for x in self.layers])

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
        return np.repeat([layer.density for layer in self.layers], [layer.blocks for layer in self.layers])

    @cached_property
    def moduli(self) -> Array:
        """Modulus of every block for the motion [Pa]."""
        return np.repeat([layer.modulus(self.motion) for layer in self.layers], [x.blocks for x in self.layers])

    def face_of(self, joint: Spring) -> int:
        """Return the number of the face that a joint lies on, 0 for the base."""
        number = int(np.argmin(np.abs(self.faces - joint.height)))
        if abs(self.faces[number] - joint.height) > _NEAR * self.faces[-1] or number == len(self.heights):
            raise ValueError(f"joints: must lie where blocks meet, below the top, got {joint.height!r} m")
        return number

    @cached_property
    def springs(self) -> list[float | None]:
        """Stiffness of the spring below every block [Pa/m], None where faces move alike."""
        stiffnesses = [self.glue] * len(self.heights)
        for joint in self.joints:
            stiffnesses[self.face_of(joint)] = joint.stiffness
        return stiffnesses

    def block_at(self, height: float) -> tuple[int, float]:
        """Return the block at a height and the share of its height below; of two that meet there, the lower one.

        Raises
        ------
        ValueError
            If the height is outside the column.
        """
        total = float(self.faces[-1])
        if not 0 <= height <= total:
            raise ValueError(f"height: must be between 0 and {total:g} m, got {height!r}")
        below = self.faces + _NEAR * total
        block = max(int(np.searchsorted(below, height, side="left")) - 1, 0)
        return block, (height - float(self.faces[block])) / float(self.heights[block])
