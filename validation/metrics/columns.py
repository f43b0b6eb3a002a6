"""Metrics of one column of one run."""

from __future__ import annotations

import numpy as np

from validation.metrics.measurable import Measurable
from validation.metrics.values import NOT_REPORTED, UNDEFINED, largest
from validation.runs.history import PRESSURE, Array
from validation.runs.row import Value

SETTLED = 0.01  # of the static value
NOISE = 1e-9  # of the largest pressure; less is rounding, not tension


def static(m: Measurable, column: str) -> Value:
    """Static value that the solver reports."""
    if m.column(column) is None or column not in m.static or not m.static_reported:
        return NOT_REPORTED
    return m.static[column]


def stress(m: Measurable, name: str) -> Value:
    """Stress at rest, or its error."""
    return m.static.get(name, NOT_REPORTED)


def final(m: Measurable, column: str) -> Value:
    """Value at the last step."""
    x = m.column(column)
    return NOT_REPORTED if x is None else float(x[-1])


def minimum(m: Measurable, column: str) -> Value:
    """Smallest value."""
    x = m.column(column)
    return NOT_REPORTED if x is None else float(np.min(x))


def peak(m: Measurable, column: str, of: str) -> Value:
    """Return the largest value of the first excursion beyond the static value, or its time."""
    x = m.column(column)
    if x is None:
        return NOT_REPORTED
    index = first_peak(x, m.static[column]) if column in m.static else None
    values = m.history.time if of == "time" else x
    return UNDEFINED if index is None else float(values[index])


def settling(m: Measurable, column: str, tolerance: float) -> Value:
    """Return the first step from which the column stays within a tolerance of its static value."""
    x = m.column(column)
    if x is None or column not in m.static:
        return NOT_REPORTED
    return settling_step(x, m.static[column], tolerance)


def settling_step(x: Array, static: float, tolerance: float = SETTLED) -> Value:
    """First step n >= 1 from which |x_n / x_static - 1| <= tolerance from then on; undefined if never."""
    if static == 0 or len(x) == 0:
        return UNDEFINED
    outside = np.nonzero(~(np.abs(x / static - 1) <= tolerance))[0]
    last = int(outside[-1]) + 1 if len(outside) else 0
    return UNDEFINED if last == len(x) else float(last + 1)


def first_peak(x: Array, static: float) -> int | None:
    """Index of the largest value of the first excursion beyond the static value, or None where there is none."""
    beyond = x / static > 1 if static else np.zeros(len(x), bool)
    if not beyond.any():
        return None
    start = int(np.argmax(beyond))
    returns = np.nonzero(~beyond[start:])[0]
    if not len(returns):
        return None
    return start + int(np.argmax(np.abs(x[start : start + int(returns[0])])))


def minimum_time(m: Measurable) -> Value:
    """Time of the largest tension in a locked contact [s]; undefined where there is none."""
    x = m.column(PRESSURE)
    in_tension = _in_tension(m)
    if x is None or in_tension is None:
        return NOT_REPORTED
    return float(m.history.time[np.argmin(x)]) if in_tension.any() else UNDEFINED


def tension_time(m: Measurable) -> Value:
    """Total time a locked contact is in tension [s]; undefined where there is none."""
    in_tension = _in_tension(m)
    if in_tension is None:
        return NOT_REPORTED
    return float(m.step * in_tension.sum()) if in_tension.any() else UNDEFINED


def _in_tension(m: Measurable) -> np.ndarray | None:
    x = m.column(PRESSURE)
    return None if x is None else x < -NOISE * largest(x)
