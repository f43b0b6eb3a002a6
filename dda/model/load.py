"""What acts on a block: loads switched on at t = 0, and the motion of the base; a block with loads over its base."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dda.model.arrays import Array, ArrayPair
from dda.model.block import Block
from dda.model.checks import check_finite, check_not_negative, check_number


@dataclass(frozen=True, eq=False)
class BaseMotion:
    """Displacement of the base, linear between the instants of a record and constant beyond them.

    Raises
    ------
    ValueError
        If the instants do not increase, or a number is not finite, or the lengths differ.
    """

    time: Any  # (n,) array_like, kept as an array: instants [s]
    displacement: Any  # (n, 2) array_like, kept as an array: displacement of the base in x and y [m]

    def __post_init__(self) -> None:
        time = np.array(self.time, float)
        moved = np.array(self.displacement, float)
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "displacement", moved)
        if time.ndim != 1 or len(time) < 1 or moved.shape != (len(time), 2):
            raise ValueError(f"displacement: must be one (x, y) for each instant, got shape {moved.shape}")
        if not (np.all(np.isfinite(time)) and np.all(np.isfinite(moved))):
            raise ValueError("displacement: must hold finite numbers only, got NaN or infinity")
        if not np.all(np.diff(time) > 0):
            raise ValueError("time: must increase from instant to instant, got a repeated or decreasing one")

    def at(self, instants: Any) -> Array:
        """Return the displacement at given instants, an array_like, (len(instants), 2) [m]."""
        return np.column_stack([np.interp(instants, self.time, column) for column in self.displacement.T])

    def velocity(self, instants: ArrayLike) -> Array:
        """Return the velocity at given instants between those of the record, (len(instants), 2) [m/s]."""
        slopes = np.diff(self.displacement, axis=0) / np.diff(self.time)[:, None]
        rest = np.zeros((1, 2))
        return np.concatenate([rest, slopes, rest])[np.searchsorted(self.time, instants)]

    def along(self, axes: Array) -> BaseMotion:
        """Return the motion along two axes, the rows of a matrix."""
        return BaseMotion(self.time, self.displacement @ axes.T)


def directions_of(motion: BaseMotion | None) -> Array:
    """Return whether a base moves in x and in y, 1 or 0 each, (2,): in neither without a motion."""
    moved = np.zeros((1, 2)) if motion is None else motion.displacement
    return np.asarray(np.any(moved != 0, axis=0), float)


@dataclass(frozen=True)
class Load:
    """Loads of one block or of a system of blocks, all switched on at t = 0, at once or in a ramp."""

    pressure: float = 0.0  # q, downwards on the top edge [Pa]
    eccentricity: float = 0.0  # shift of the middle of the pressed part towards +x [m]
    traction: float = 0.0  # towards +x, on the whole top edge [Pa]
    gravity: float = 0.0  # g, downwards [m/s^2]
    motion: BaseMotion | None = None  # of the springs' base ends
    slope: float = 0.0  # by which gravity is turned, so that the block stands on its incline [deg]
    ramp: float = 0.0  # time in which pressure, traction and gravity rise linearly from zero; 0: at once [s]

    def __post_init__(self) -> None:
        check_finite(
            pressure=self.pressure, eccentricity=self.eccentricity, traction=self.traction, gravity=self.gravity
        )
        if not -90 < self.slope < 90:
            raise ValueError(f"slope: must be between -90 and 90 degrees, got {self.slope!r}")
        check_not_negative(ramp=self.ramp)

    @property
    def acceleration(self) -> tuple[float, float]:
        """That of gravity, g (sin b, -cos b) for the slope b [m/s^2]."""
        angle = math.radians(self.slope)
        return self.gravity * math.sin(angle), -self.gravity * math.cos(angle)

    def size(self, weight: float) -> float:
        """Return the largest of the constant loads as a stress [Pa]; `weight` is that of gravity, rho h."""
        return max(abs(self.pressure), abs(self.traction), abs(weight * self.gravity))


def at_once(load: Load, what: str) -> None:
    """Raise ValueError for a ramp where something knows loads only that act at once."""
    if load.ramp:
        raise ValueError(f"ramp: does not go with {what}, got {load.ramp!r}")


def pressed_part(start: Array, end: Array, eccentricity: float) -> ArrayPair:
    """Return the ends of the pressed part of the top edge.

    It is the longest part whose middle lies `eccentricity` from the middle of the edge, towards +x (towards +y on a
    vertical edge): the length is L - 2 |eccentricity|, the pressure is the same. A ValueError if nothing is left of the
    edge.
    """
    side = end - start
    length = np.hypot(*side)
    if eccentricity == 0:
        return start, end
    if not 2 * abs(eccentricity) < length:
        raise ValueError(f"eccentricity: must be below half the top edge {length / 2:g}, got {eccentricity!r}")
    forward = side[0] > 0 or (side[0] == 0 and side[1] > 0)
    shift = 2 * (eccentricity if forward else -eccentricity) / length
    return (start + shift * side, end) if shift > 0 else (start, end + shift * side)


@dataclass(frozen=True, eq=False, init=False)
class LoadedBlock:
    """One block over the contacts of its base edge. Edge i runs from corner i to corner i + 1.

    Raises
    ------
    ValueError
        If a number is not finite, the eccentricity leaves nothing of the top edge, or base and top are not two edges
        of the block.
    """

    block: Block
    contact: Any
    load: Load
    base: int  # edge over the corners M (its start) and N (its end)
    top: int  # edge under pressure and traction

    def __init__(
        self, block: Block, contact: Any, load: Load | float = 0.0, base: int = 0, top: int = 2, **others: Any
    ) -> None:
        """Set the fields and check them.

        Parameters
        ----------
        load
            All loads, or a pressure alone [Pa].
        others
            Further fields of the model, and fields of `Load` in place of those in `load`, by name.
        """
        loads = load if isinstance(load, Load) else Load(pressure=load)
        changes = {name: others.pop(name) for name in set(Load.__dataclass_fields__) & set(others)}
        values = {"block": block, "contact": contact, "load": replace(loads, **changes), "base": base}
        values |= {"top": top} | others
        for name in set(values) - {field.name for field in fields(self)}:
            raise TypeError(f"{name}: is no field of {type(self).__name__} or Load")
        for name, value in values.items():
            object.__setattr__(self, name, value)
        self.check()

    def check(self) -> None:
        """Check the loads and the edges."""
        for field in ("base", "top"):
            check_number(field, getattr(self, field), len(self.block.corners))
        if self.base == self.top:
            raise ValueError(f"top: must differ from base, got {self.top!r}")
        pressed_part(*self.block.edge(self.top), self.load.eccentricity)

    def __getattr__(self, name: str) -> Any:
        """Return a field of the loads, which is read as one of the model too."""
        if name in Load.__dataclass_fields__:
            return getattr(self.load, name)
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    @property
    def base_length(self) -> float:
        """Length a of the base edge [m]."""
        start, end = self.block.edge(self.base)
        return float(np.hypot(*(end - start)))
