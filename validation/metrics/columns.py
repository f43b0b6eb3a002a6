"""Metrics of one column of one run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from validation.metrics.values import FINELY, NOISE, NOT_REPORTED, QUANTITIES, SETTLED, UNDEFINED, largest
from validation.runs.history import PRESSURE, Array, History
from validation.runs.modes import Mode
from validation.runs.results import Value


@dataclass(frozen=True)
class Measurable:
    """What the metrics of one run see: history, static solution and modes, the last two where reported."""

    history: History
    step: float  # s
    static: Mapping[str, float]
    modes: tuple[Mode, ...]
    static_reported: bool = True  # otherwise `static` is another solver's, and settling is measured from that


def settling_step(x: Array, static: float, tolerance: float = SETTLED) -> Value:
    """First step n >= 1 from which |x_n / x_static - 1| <= tolerance for ever after; undefined if never."""
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
    back = np.nonzero(~beyond[start:])[0]
    if not len(back):
        return None
    return start + int(np.argmax(np.abs(x[start : start + int(back[0])])))


def _solo_quantity(name: str, m: Measurable) -> dict[str, Value]:
    """Metrics of one column of one run."""
    x = m.history.columns.get(QUANTITIES[name])
    names = ("static", "final", "peak", "peak_time", "settling_step", "fine_settling_step", "minimum")
    if x is None:
        return dict.fromkeys((f"{name}.{part}" for part in names), NOT_REPORTED)
    static = m.static.get(QUANTITIES[name])
    found: dict[str, Value] = {
        "static": NOT_REPORTED if static is None or not m.static_reported else static,
        "final": float(x[-1]),
        "minimum": float(np.min(x)),
    }
    peak = first_peak(x, static) if static is not None else None
    found["peak"] = UNDEFINED if peak is None else float(x[peak])
    found["peak_time"] = UNDEFINED if peak is None else float(m.history.time[peak])
    found["settling_step"] = NOT_REPORTED if static is None else settling_step(x, static)
    found["fine_settling_step"] = NOT_REPORTED if static is None else settling_step(x, static, FINELY)
    return {f"{name}.{part}": value for part, value in found.items()}


def _tension_metrics(m: Measurable) -> dict[str, Value]:
    """When a locked contact pulls most, and for how long it pulls in all [s]; both undefined where it never does."""
    names = ("pressure.minimum_time", "pressure.tension_time")
    x = m.history.columns.get(PRESSURE)
    if x is None or len(x) == 0:
        return dict.fromkeys(names, NOT_REPORTED)
    pulls = x < -NOISE * largest(x)
    if not pulls.any():
        return dict.fromkeys(names, UNDEFINED)
    return dict(zip(names, (float(m.history.time[np.argmin(x)]), float(m.step * pulls.sum())), strict=True))
