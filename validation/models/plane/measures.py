"""What is measured on the positions of rigid boxes: nothing else of a program is needed or taken on trust."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from validation.models.plane.boxes import Box, BoxesOnGround
from validation.runs.history import Array, History

Rows = NDArray[np.bool_]
SAME_FALL = 0.05  # of g h^2: error of the second difference of a free flight, air damping of programs included
LATE = 1.0  # s at the end of a run, over which its last energy is taken; longer than the flight from 1 m


def column(history: History, box: Box, part: str) -> Array:
    """Return a column of a box."""
    return history.columns[f"{box.name}.{part}"]


def in_flight(history: History, ground: BoxesOnGround) -> Rows:
    """Return at which rows a box flies freely, both its neighbours being of the same flight; never at the ends.

    In free flight y is a parabola, x and the angle are straight: whatever the time step, the second differences over
    rows h apart are -g h^2 and zero. An impact between two rows changes the second differences at both by v h together,
    so that one of them may look free: a row counts where its own and those at its two neighbours are of a flight.
    """
    box = ground.boxes[0]
    interval = float(history.time[1] - history.time[0])
    fall = ground.gravity * interval**2
    off_fall = np.abs(np.diff(column(history, box, "y"), 2) + fall)
    off_straight = np.abs(np.diff(column(history, box, "x"), 2))
    off_spin = math.hypot(box.width, box.height) / 2 * np.abs(np.diff(column(history, box, "angle"), 2))
    free = np.zeros(len(history.time), dtype=bool)
    free[1:-1] = np.maximum(np.maximum(off_fall, off_straight), off_spin) <= SAME_FALL * fall
    flying = np.zeros(len(free), dtype=bool)
    flying[1:-1] = free[:-2] & free[1:-1] & free[2:]
    return flying


def energies(history: History, ground: BoxesOnGround) -> Array:
    """Return the energy of a box at the rows over its mass [m2/s2], its potential energy being none where it lies flat.

    g (y - y_flat) + |v|^2 / 2 + (I / m) w^2 / 2 with central differences over the rows, NaN at the ends: on a parabola
    these are its slopes exactly.
    """
    box = ground.boxes[0]
    interval = float(history.time[1] - history.time[0])
    energy = np.full(len(history.time), np.nan)
    weights = (1.0, 1.0, box.inertia / box.mass)
    kinetic = np.zeros(len(energy) - 2)
    for part, weight in zip(("x", "y", "angle"), weights, strict=True):
        values = column(history, box, part)
        kinetic += weight * ((values[2:] - values[:-2]) / (2 * interval)) ** 2 / 2
    energy[1:-1] = ground.gravity * (column(history, box, "y")[1:-1] - lowest_centre(box)) + kinetic
    return energy


def lowest_centre(box: Box) -> float:
    """Return the height of the centre of a box that lies on its longer side [m]."""
    return min(box.width, box.height) / 2


def first_energy(ground: BoxesOnGround) -> float:
    """Return the energy of a box at t = 0 over its mass [m2/s2], as `energies` has it."""
    box = ground.boxes[0]
    height = box.y - lowest_centre(box)
    speed2 = box.velocity[0] ** 2 + box.velocity[1] ** 2
    return ground.gravity * height + speed2 / 2 + box.inertia / box.mass * box.spin**2 / 2


def last_energy(history: History, ground: BoxesOnGround) -> float:
    """Return the energy over the mass in the end [m2/s2]: the middle one of the last free flights.

    Of a box that flies no more, that of all of the last rows.
    """
    energy = energies(history, ground)
    late = (history.time > history.time[-1] - LATE) & np.isfinite(energy)
    flying = late & in_flight(history, ground)
    return float(np.median(energy[flying if flying.any() else late]))


def largest_gain(history: History, ground: BoxesOnGround) -> float | None:
    """Return by how much the energy of a free flight exceeds that at t = 0, over that; None where it never flies."""
    flying = in_flight(history, ground)
    if not flying.any():
        return None
    first = first_energy(ground)
    return max(0.0, float(np.max(energies(history, ground)[flying])) / first - 1)


def speed_between(history: History, box: Box, part: str, start: float) -> float:
    """Return the mean velocity along a direction from an instant to the end [m/s]."""
    values = column(history, box, part)
    first = int(np.searchsorted(history.time, start * (1 - 1e-9)))
    return float((values[-1] - values[first]) / (history.time[-1] - history.time[first]))


def creep(history: History, box: Box) -> float:
    """Return the mean speed of the centre over the second half of a run [m/s]."""
    half = len(history.time) // 2 - 1
    moved = [float(column(history, box, part)[-1] - column(history, box, part)[half]) for part in ("x", "y")]
    return math.hypot(*moved) / float(history.time[-1] - history.time[half])


def peak(values: Array) -> float:
    """Return the largest value of a smooth curve, by the parabola through the largest one and its neighbours."""
    top = int(np.argmax(values))
    if top in (0, len(values) - 1):
        return float(values[top])
    before, middle, after = (float(value) for value in values[top - 1 : top + 2])
    curvature = before - 2 * middle + after
    if curvature == 0:
        return middle
    return middle - (after - before) ** 2 / (8 * curvature)


def contact_time(history: History, gap: Array) -> float | None:
    """Return how long a gap, linear between rows, is closed for the first time [s].

    None where it does not close and open again.
    """
    closed = gap < 0
    if not closed.any():
        return None
    first = int(np.argmax(closed))
    opened = np.flatnonzero(~closed[first:])
    if first == 0 or not len(opened):
        return None
    rows = np.array([first, first + int(opened[0])])
    places = rows - 1 + gap[rows - 1] / (gap[rows - 1] - gap[rows])
    start, end = np.interp(places, np.arange(len(gap)), history.time)
    return float(end - start)
