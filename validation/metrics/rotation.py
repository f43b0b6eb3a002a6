"""When a block that turns passes an angle or lands, read from its history."""

from __future__ import annotations

import math

import numpy as np

from validation.runs.history import Array, History


def crossing(time: Array, values: Array, level: float) -> float:
    """Return when values first exceed a level, on straight lines between steps [s]; NaN if never."""
    above = np.flatnonzero(values > level)
    if not len(above) or above[0] == 0:
        return math.nan
    n = above[0]
    share = (level - values[n - 1]) / (values[n] - values[n - 1])
    return float(time[n - 1] + share * (time[n] - time[n - 1]))


def landing(time: Array, gap: Array) -> float:
    """Return when a gap closes, on the straight line of its last two open steps [s]; NaN if never."""
    closed = np.flatnonzero(gap <= 0)
    if not len(closed) or closed[0] < 2:
        return math.nan
    n = closed[0]
    return float(time[n - 1] + gap[n - 1] / (gap[n - 2] - gap[n - 1]) * (time[n - 1] - time[n - 2]))


def increments(history: History) -> Array:
    """Return the rotation of every step [rad]."""
    return np.diff(history.columns["rotation"], prepend=0.0)
