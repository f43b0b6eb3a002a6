"""What drives a column at given instants: pulses in closed form, records read linearly between their rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from validation.errors import InputError
from validation.models.column.tables import InputSection
from validation.runs.history import Array
from validation.scenes.record import read_columns
from validation.scenes.scene import Scene

ORDERS = {"velocity": 1, "acceleration": 2, "pressure": 1}  # column of a record to its derivatives of a displacement
Parts = tuple[Array, Array, Array]  # integral, value and derivative
Signal = Callable[[Array], Parts]


@dataclass(frozen=True)
class Motion:
    """A drive at some instants, each of the shape of the instants."""

    displacement: Array  # of the base, or of the incident wave [m]
    velocity: Array  # [m/s]
    acceleration: Array  # [m/s^2]
    pressure: Array  # on the top [Pa]


def motion_at(scene: Scene, instants: Array) -> Motion:
    """Return the drive of a column's scene at some instants [s].

    Raises
    ------
    InputError
        The record cannot be read, or the scene has no column.
    """
    instants = np.asarray(instants, float)
    still = np.zeros_like(instants)
    if "input" in scene.kind.optional(scene) and scene.stated_input is None:  # weight or velocities move the column
        return Motion(still, still, still, still)
    integral, value, derivative = _signal(scene.input)(instants)
    if scene.input.at == "top":
        return Motion(still, still, still, value)
    return Motion(integral, value, derivative, still)


def _signal(section: InputSection) -> Signal:
    if section.record is not None:
        return partial(recorded, *read_drive(Path(section.record), section.at))
    shapes = {"half-sine": half_sine, "triangle": triangle, "ricker": ricker, "sine": sine, "cosine": cosine}
    return partial(shapes[str(section.shape)], *section.pulse)


def ricker(size: float, frequency: float, time: Array) -> Parts:
    """Return a Ricker pulse, size (1 - 2 b^2) e^(-b^2) with b = pi f (t - 2/f), its integral and its derivative."""
    late = time - 2 / frequency
    b = np.pi * frequency * late
    bell = size * np.exp(-b * b)
    return late * bell, (1 - 2 * b * b) * bell, (4 * b**3 - 6 * b) * np.pi * frequency * bell


def half_sine(size: float, duration: float, time: Array) -> Parts:
    """Return half a period of a sine, size sin(pi t / T) up to t = T, its integral and its derivative."""
    inside = np.clip(time, 0.0, duration)
    turn = np.pi / duration
    running = (time >= 0) & (time < duration)
    rise = np.where(running, size * turn * np.cos(turn * inside), 0.0)
    return size / turn * (1 - np.cos(turn * inside)), np.where(running, size * np.sin(turn * inside), 0.0), rise


def triangle(size: float, duration: float, time: Array) -> Parts:
    """Return a value that falls to zero, size (1 - t / T) up to t = T, its integral and its derivative."""
    inside = np.clip(time, 0.0, duration)
    running = (time >= 0) & (time < duration)
    value = np.where(running, size * (1 - inside / duration), 0.0)
    return size * inside * (1 - inside / (2 * duration)), value, np.where(running, -size / duration, 0.0)


def sine(size: float, frequency: float, time: Array) -> Parts:
    """Return a sine, size sin(2 pi f t), its integral from t = 0 and its derivative."""
    w = 2 * np.pi * frequency
    return size / w * (1 - np.cos(w * time)), size * np.sin(w * time), size * w * np.cos(w * time)


def cosine(size: float, frequency: float, time: Array) -> Parts:
    """Return a cosine, size cos(2 pi f t), its integral from t = 0 and its derivative."""
    w = 2 * np.pi * frequency
    return size / w * np.sin(w * time), size * np.cos(w * time), -size * w * np.sin(w * time)


def read_drive(path: Path, at: str) -> tuple[Array, Array, int]:
    """Return instants and values of a record, and which derivative of a displacement (of an impulse) the values are.

    Before its first and after its last row its column is zero. Raises InputError for what is no such record.
    """
    names = ("velocity", "acceleration") if at == "base" else ("pressure",)
    columns = read_columns(path, [f"time,{name}" for name in names])
    name = next(name for name in names if name in columns)
    if len(columns["time"]) < 2:
        raise InputError("must hold at least two rows", source=path, value=f"{len(columns['time'])} rows")
    return columns["time"], columns[name], ORDERS[name]


def recorded(instants: Array, values: Array, order: int, time: Array) -> Parts:
    """Return displacement, velocity and acceleration of a record of velocities (order 1) or accelerations (2)."""
    from scipy.interpolate import PPoly

    slopes = np.diff(values) / np.diff(instants)
    curve = PPoly(np.array([slopes, values[:-1]]), instants)
    inside = np.clip(time, instants[0], instants[-1])
    running = (time >= instants[0]) & (time <= instants[-1])
    if order == 1:
        value, slope = (np.where(running, curve(inside, nu), 0.0) for nu in (0, 1))
        return curve.antiderivative()(inside), value, slope
    velocity = curve.antiderivative()
    carried = velocity(inside) * (time - inside)  # after the record: at the speed that it ends with
    return velocity.antiderivative()(inside) + carried, velocity(inside), np.where(running, curve(inside), 0.0)
