"""The rocking of a rigid block on a rigid base: quarter period, impacts, overturning."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from validation.runs.history import Array


@dataclass(frozen=True)
class Rocking:
    """Motion of a rigid block that rocks."""

    time: Array  # instants [s], shape (times,)
    rotation: Array  # positive about the right corner and towards +x [rad], shape (times,)
    rate: Array  # of the rotation [rad/s], shape (times,)
    impacts: tuple[float, ...]  # instants at which it came down on the other corner [s]
    overturned: bool  # whether it fell on its side


def quarter_period(width: float, height: float, tilt: float, gravity: float = 9.81) -> float:
    """Return the time in which a block that is released at a tilt [rad] comes down [s], its rotation not being small.

    Raises
    ------
    ValueError
        A number is out of its range, such as a tilt beyond atan(width / height).
    """
    from fem_reference.exact.rocking import RockingBlock

    return RockingBlock(width, height, gravity).quarter_period(tilt)


def friction_needed(width: float, height: float, tilt: float) -> float:
    """Return the coefficient of friction that holds a corner until a block that is released at a tilt [rad] comes down.

    With f = alpha - theta from f0 to alpha, the centroid at R (sin f, cos f) from the corner, f'' = p^2 sin f and
    f'^2 = 2 p^2 (cos f0 - cos f), g = 4 R p^2 / 3, it is the greatest |x''| / (g + y'') on the way.
    """
    alpha = math.atan2(width, height)
    f = np.linspace(alpha - tilt, alpha, 1001)
    rate2 = 2 * (np.cos(f[0]) - np.cos(f))
    across = np.cos(f) * np.sin(f) - np.sin(f) * rate2
    return float(np.max(np.abs(across) / (4 / 3 - np.sin(f) ** 2 - np.cos(f) * rate2)))


def rocking(
    width: float,
    height: float,
    tilt: float,
    time: Array,
    restitution: float | None = None,
    gravity: float = 9.81,
) -> Rocking:
    """Return the rocking of a block of a width and a height [m] that is released at rest from a tilt [rad], g in m/s2.

    Instants from 0 on are reported [s], shape (times,), without those after a fall. The restitution is the rate after
    over the rate before an impact [-]; None: Housner's, which keeps the moment of momentum.

    Raises
    ------
    ValueError
        A number is out of its range.
    """
    from fem_reference.exact.rocking import RockingBlock, solve

    motion = solve(RockingBlock(width, height, gravity, restitution), float(time[-1]), tilt)
    instants = time[time <= motion.end]
    return Rocking(instants, *motion.at(instants), motion.impacts, motion.overturned)
