r"""The bar on a spring with stiffness-proportional damping, M D'' + (c M + a1 K) D' + K D = F, mode by mode.

Time is in travel times. A mode goes the way 1 - x(w, t) of an oscillator with half the rate a = (c + a1 w^2) / 2: there
are no fronts, since beyond w = 2 / a1 the modes creep. The sum over the modes is cut off smoothly and enlarged until it
no longer changes.
"""

from __future__ import annotations

import numpy as np

from fem_reference.exact.bar_modes import cut_off, shares, wave_numbers
from fem_reference.problem.problem import Array

FIRST = 256
LAST = 2**15
"""Modes of the first and of the last attempt."""
TARGET = 1e-12
"""Change of the history over its maximum at which no more modes are added."""
ROUNDING = 16 * np.finfo(float).eps
"""Of a sum over modes, over the sum of their moduli."""
BLOCK = 2**20
"""Entries of a work array."""


def histories(times: Array, kappa: float, rate: float, lag: float, columns: tuple[str, ...]) -> tuple[Array, float]:
    """Histories over their static values, shape (columns, times), and the change by the last enlargement.

    `times` are in travel times; `rate` is c times the travel time, `lag` a1 over it.
    """
    count = FIRST
    histories = _summed(times, kappa, rate, lag, columns, FIRST)
    while True:
        count *= 2
        finer = _summed(times, kappa, rate, lag, columns, count)
        change = float(np.max(np.abs(finer - histories)) / max(float(np.max(np.abs(finer))), np.finfo(float).tiny))
        histories = finer
        if change <= TARGET or count >= LAST:
            return histories, change


def _summed(times: Array, kappa: float, rate: float, lag: float, columns: tuple[str, ...], count: int) -> Array:
    b = wave_numbers(kappa, count)
    weights = np.array([shares(name, b, kappa) for name in columns]) * cut_off(count, count)
    half = (rate + lag * b * b) / 2
    parts = np.array_split(times, 1 + len(times) * count // BLOCK)
    sums = []
    for part in parts:
        ways = 1 - response(part[:, None], b, half).T
        total = weights @ ways
        # What only rounding leaves, before a wave has come, is nothing.
        sums.append(np.where(np.abs(total) <= ROUNDING * (np.abs(weights) @ np.abs(ways)), 0.0, total))
    return np.concatenate(sums, axis=1)


def response(t: Array, w: Array, a: float | Array) -> Array:
    """Free response x(w, t) from x = 1 at rest, also overdamped and critical; `t` is a column.

    Half the damping rate a is one, or one for each mode.
    """
    a = np.broadcast_to(a, w.shape)
    square = (a - w) * (a + w)
    q = np.sqrt(np.abs(square))
    swing = np.where(square <= 0, q, 0.0) * t
    x = np.exp(-a * t) * (np.cos(swing) + a * t * np.sinc(swing / np.pi))
    over = square > 0
    if over.any():
        v = q[over]
        a = a[over]
        slow = w[over] ** 2 / (a + v)
        # exp(-slow t) (1 + exp(-2 v t)) / 2 + a (exp(-slow t) - exp(-(2 a - slow) t)) / (2 v)
        fall = -np.expm1(-2 * v * t)
        x[:, over] = np.exp(-slow * t) * (1 - fall / 2 + a * fall / (2 * v))
    return x
