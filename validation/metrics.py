"""Metrics: what is measured on one run, and what is measured between a run and its reference.

A metric without meaning (the relative error of a zero signal) is ``"undefined"``; one whose column or mode the
solver does not give is ``"not reported"``; no metric ever is NaN.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from validation import stability
from validation.history import DISPLACEMENT, PRESSURE, Array, History, Mode, contact_index
from validation.pencil import Pole, poles
from validation.results import Value

UNDEFINED, NOT_REPORTED = "undefined", "not reported"
SETTLED = 0.01  # of the static value
FINELY = 1e-4  # of the static value: a contact that rings shows here, long after it has settled to one per cent
NOISE = 1e-9  # of the largest pressure; less is rounding, not tension
QUANTITIES = {
    "displacement": DISPLACEMENT,
    "pressure": PRESSURE,
    "horizontal": "horizontal_displacement",
    "rotation": "rotation",
}


@dataclass(frozen=True)
class Measurable:
    """What the metrics of one run see: history, static solution and modes, the last two where reported."""

    history: History
    step: float  # s
    static: Mapping[str, float]
    modes: tuple[Mode, ...]
    static_reported: bool = True  # otherwise `static` is another solver's, and settling is measured from that


def largest(x: Array) -> float:
    """Maximum of |x|."""
    return float(np.max(np.abs(x), initial=0.0))


def norm(x: Array) -> float:
    """Euclidean norm, scaled so that neither 1e300 overflows nor 1e-300 vanishes."""
    top = largest(x)
    return 0.0 if top == 0 else top * float(np.linalg.norm(x / top))


def _ratio(error: float, size: float) -> Value:
    """Relative error; undefined for a zero or non-finite signal."""
    if size == 0 or not math.isfinite(size) or not math.isfinite(error):
        return UNDEFINED
    return error / size


def relative_l2(value: Array, reference: Array) -> Value:
    """||value - reference|| / ||reference|| over the history."""
    return _ratio(norm(value - reference), norm(reference))


def relative_max(value: Array, reference: Array) -> Value:
    """Maximum of |value - reference| over maximum of |reference|, over the history."""
    return _ratio(largest(value - reference), largest(reference))


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


def operator_damping(eigenvalues: tuple[complex, complex]) -> Value:
    """Damping ratio of a mode from the eigenvalues of its one-step operator.

    Complex pair: xi = -Re(ln l) / |ln l|; positive real roots: xi = -(ln l1 + ln l2) / (2 sqrt(ln l1 ln l2));
    a negative or zero real root has none.
    """
    first, second = eigenvalues
    if abs(first.imag) > 1e-14 * abs(first):
        logarithm = np.log(complex(first))
        return float(-logarithm.real / abs(logarithm))
    if first.real <= 0 or second.real <= 0:
        return UNDEFINED
    a, b = math.log(first.real), math.log(second.real)
    return -(a + b) / (2 * math.sqrt(a * b)) if a * b > 0 else UNDEFINED


def operator_frequency(eigenvalues: tuple[complex, complex], step: float) -> Value:
    """Numerical undamped frequency w' = |ln l| / dt of a complex pair [rad/s]; undefined for real roots."""
    first = complex(eigenvalues[0])
    return float(abs(np.log(first)) / step) if abs(first.imag) > 1e-14 * abs(first) else UNDEFINED


def _mode_metrics(m: Measurable) -> dict[str, Value]:
    """Metrics of the first axial mode, from the operator and from the history."""
    names = ("frequency", "damping", "numerical_frequency", "spectral_radius")
    found: dict[str, Value] = dict.fromkeys(names, NOT_REPORTED)
    if m.modes:
        first = m.modes[0]
        found = {
            "frequency": first.frequency,
            "damping": operator_damping(first.eigenvalues),
            "numerical_frequency": operator_frequency(first.eigenvalues, m.step),
            "spectral_radius": first.spectral_radius,
        }
    pole = _measured_pole(m)
    found["measured_frequency"] = pole.frequency if isinstance(pole, Pole) else pole
    found["measured_damping"] = pole.damping if isinstance(pole, Pole) else pole
    return {f"mode1.{part}": value for part, value in found.items()}


def _contact_metrics(m: Measurable) -> dict[str, Value]:
    """Metrics of the contact mode from the operator; `least_root` is the real part of the root next to -1."""
    index = contact_index(m.modes)
    names = ("frequency", "damping", "spectral_radius", "least_root")
    if index is None:
        return {f"contact.{part}": NOT_REPORTED for part in names}
    mode = m.modes[index]
    least = min(root.real for root in mode.eigenvalues)
    values = (mode.frequency, operator_damping(mode.eigenvalues), mode.spectral_radius, least)
    return {f"contact.{part}": value for part, value in zip(names, values, strict=True)}


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


def _measured_pole(m: Measurable) -> Pole | str:
    """Strongest oscillating pole of the displacement about its static value."""
    x, static = m.history.columns.get(DISPLACEMENT), m.static.get(DISPLACEMENT)
    if x is None or static is None:
        return NOT_REPORTED
    if static == 0 or not np.all(np.isfinite(x)):
        return UNDEFINED
    found = poles(x / static - 1, m.step)
    return found[0] if found else UNDEFINED


def solo(m: Measurable, modes: bool = True) -> dict[str, Value]:
    """Return the metrics of one run, those of its first axial mode if asked."""
    found: dict[str, Value] = {}
    with np.errstate(all="ignore"):
        for name in QUANTITIES:
            found |= _solo_quantity(name, m)
        found |= _tension_metrics(m)
        found |= _mode_metrics(m) | _contact_metrics(m) if modes else {}
    return {key: _finite(value) for key, value in found.items()}


def _finite(value: Value) -> Value:
    """Replace what is not a finite number by its name."""
    return value if not isinstance(value, float) or math.isfinite(value) else UNDEFINED


PAIR: dict[str, tuple[str, Callable[[Array, Array], Value]]] = {
    f"{name}.{part}": (column, function)
    for name, column in QUANTITIES.items()
    for part, function in (("l2", relative_l2), ("max", relative_max))
}


SCALED = {f"{name}.scaled": name for name in QUANTITIES}
WORST = "worst.max"
PAIRS = (*PAIR, *SCALED, WORST)


def pair(metric: str, history: History, reference: History, static: Mapping[str, Value] | None = None) -> Value:
    """Return a metric between a run and its reference, on their common steps.

    Parameters
    ----------
    metric
        Of `PAIR`; or `<quantity>.scaled`, the maximum error over the larger of the reference's maximum and the static
        value (a wave that has not arrived leaves nothing to divide by); or `worst.max`, the larger of the two `.max`.
    history, reference
        The run and what it is compared with.
    static
        Metrics of the run, for the static values of `.scaled`.
    """
    if metric == WORST:
        both = [pair(f"{name}.max", history, reference) for name in ("displacement", "pressure")]
        return next((value for value in both if not isinstance(value, float)), max(both, key=_as_number))
    if metric in SCALED:
        name = SCALED[metric]
        still = (static or {}).get(f"{name}.static")
        return _scaled(QUANTITIES[name], history, reference, still) if isinstance(still, float) else NOT_REPORTED
    column, function = PAIR[metric]
    if column not in history.columns or column not in reference.columns:
        return NOT_REPORTED
    n = min(len(history.time), len(reference.time))
    with np.errstate(all="ignore"):
        return _finite(function(history.columns[column][:n], reference.columns[column][:n]))


def _as_number(value: Value) -> float:
    return float(value) if isinstance(value, float) else math.inf


def _scaled(column: str, history: History, reference: History, static: float) -> Value:
    if column not in history.columns or column not in reference.columns:
        return NOT_REPORTED
    value, exact = history.columns[column], reference.columns[column]
    with np.errstate(all="ignore"):
        return _finite(_ratio(largest(value - exact), max(largest(exact), abs(static))))


def ratio(value: Value, reference: Value) -> Value:
    """Return value / reference - 1 for two metrics of single runs."""
    for part in (value, reference):
        if not isinstance(part, float | int):
            return part
    return _ratio(float(value) - float(reference), float(reference))  # type: ignore[arg-type]


SOLO = tuple(solo(Measurable(History(np.zeros(0), {}), 1.0, {}, ())))
METRICS = (*SOLO, *stability.METRICS, stability.GROWTH, stability.LIMIT, stability.DRIFT, *PAIRS)
