"""Metrics of modes, from the operator of a step and from the history."""

from __future__ import annotations

import math

import numpy as np

from validation.metrics.measurable import Measurable
from validation.metrics.poles import Pole
from validation.metrics.values import ALIAS, NOT_REPORTED, UNDEFINED
from validation.runs.modes import Mode, contact_index
from validation.runs.row import Value


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
    a = math.log(first.real)
    b = math.log(second.real)
    return -(a + b) / (2 * math.sqrt(a * b)) if a * b > 0 else UNDEFINED


def operator_frequency(eigenvalues: tuple[complex, complex], step: float) -> Value:
    """Numerical undamped frequency w' = |ln l| / dt of a complex pair [rad/s]; undefined for real roots."""
    first = complex(eigenvalues[0])
    return float(abs(np.log(first)) / step) if abs(first.imag) > 1e-14 * abs(first) else UNDEFINED


def sampled_damping(mode: Mode, step: float) -> float:
    """Damping ratio xi = -ln |l| / (w dt) of a motion that is exact in time, whose |l| has no alias."""
    return -math.log(mode.spectral_radius) / (mode.frequency * step) + 0.0


def of_mode(m: Measurable, mode: Mode, part: str) -> Value:
    """Return one number of a mode; `least_root` is the real part of the root next to -1."""
    if mode.alias(m.step) is not None and part in ("numerical_frequency", "damping"):
        return ALIAS if part == "numerical_frequency" else sampled_damping(mode, m.step)
    if part == "damping":
        return operator_damping(mode.eigenvalues)
    if part == "numerical_frequency":
        return operator_frequency(mode.eigenvalues, m.step)
    if part == "least_root":
        return min(root.real for root in mode.eigenvalues)
    return float(getattr(mode, part))


def first_axial(m: Measurable, part: str) -> Value:
    """Return a number of the first axial mode, from the operator."""
    return of_mode(m, m.modes[0], part) if m.modes else NOT_REPORTED


def contact(m: Measurable, part: str) -> Value:
    """Return a number of the contact mode, from the operator."""
    index = contact_index(m.modes)
    return NOT_REPORTED if index is None else of_mode(m, m.modes[index], part)


def measured(m: Measurable, part: str) -> Value:
    """Return frequency or damping of the strongest oscillating pole of the displacement."""
    if m.modes and m.modes[0].alias(m.step) is not None:
        return ALIAS
    return float(getattr(m.pole, part)) if isinstance(m.pole, Pole) else m.pole


def natural(m: Measurable, number: int) -> Value:
    """Return the natural frequency of a number from 1 on, in rising order [Hz]."""
    frequencies = sorted(mode.frequency for mode in m.modes)
    return frequencies[number - 1] / (2 * math.pi) if len(frequencies) >= number else NOT_REPORTED
