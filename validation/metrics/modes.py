"""Metrics of modes, from the operator of a step and from the history."""

from __future__ import annotations

import math

import numpy as np

from validation.metrics.columns import Measurable
from validation.metrics.poles import Pole, poles
from validation.metrics.values import NOT_REPORTED, UNDEFINED
from validation.runs.history import DISPLACEMENT
from validation.runs.modes import contact_index
from validation.runs.results import Value


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


def _measured_pole(m: Measurable) -> Pole | str:
    """Strongest oscillating pole of the displacement about its static value."""
    x, static = m.history.columns.get(DISPLACEMENT), m.static.get(DISPLACEMENT)
    if x is None or static is None:
        return NOT_REPORTED
    if static == 0 or not np.all(np.isfinite(x)):
        return UNDEFINED
    found = poles(x / static - 1, m.step)
    return found[0] if found else UNDEFINED
