"""Modes of the damped bar on a spring, M D'' + c M D' + K D = F, with the fronts of its waves.

Time is in travel times and a = c / 2. With the shares of the modes (`bar_modes`) a history over its static
value is the sum of share * (1 - x): on a soft spring all of it is small, and nothing is subtracted from one. And::

    x(w, t) = exp(-a t) (cos v t + a sin(v t) / v),   v = sqrt(w^2 - a^2)
            = exp(-a t) (cos w t + (a + a^2 t / 2) sin(w t) / w) + O(1 / w^2)

Away from the fronts the sum is cut off smoothly. Near a front its tail is that of the leading terms,
and these are summed over all modes at once: they are the undamped history and its integral, which the waves
give (the shares of all modes sum to one). Fronts have died once exp(-a t) is below rounding; strong damping
leaves diffusion, a few modes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fem_reference.exact.bar_modes import cut_off, shares, wave_numbers
from fem_reference.problem.problem import Array

Undamped = Callable[[str, Array, float], Array]

MODES = 2**14
"""Modes away from the fronts."""
FRONT_MODES = 2**18
"""Modes near a front at a = 1 and above; in proportion to a below, as the terms beyond the leading ones are."""
LEAST_MODES = 2**15
"""Fewest modes near a front."""
WORK = 2**26
"""Modes times instants near fronts."""
WAVE_WORK = 2**27
"""Steps of the waves' recurrences for all instants near fronts."""
REACH = 42.0
"""Distance from a front times modes from which the smooth cut-off leaves less than 1e-12."""
NOTHING = 1e-13
"""Tail of a sum over the history's maximum that need not be looked after."""
DEAD = 40.0
"""Exponent at which a decayed term is below rounding."""
GAUSS = 20
"""Points of a quadrature over an arc of one."""
BLOCK = 2**20
"""Entries of a work array."""


def history(column: str, times: Array, kappa: float, a: float, undamped: Undamped) -> Array:
    """History of a column over its static value, shape (times,).

    Parameters
    ----------
    column
        ``"contact_pressure"`` or ``"displacement"``.
    times
        Equally spaced instants in travel times, the first one step after the load.
    kappa
        Stiffness of the spring over that of the bar.
    a
        Half the damping rate per travel time.
    undamped
        Undamped history and its integral, as `continuum.undamped`.

    Raises
    ------
    ValueError
        If too many late instants lie at fronts that have not died.
    """
    first, gap = (1.0, 2.0) if column == "contact_pressure" else (0.5, 1.0)
    # Diffusion reaches the distance `first` as exp(-a first^2 / (2 t)): before this there is nothing to sum.
    begin = max(first, a * first**2 / (2 * DEAD))
    result = np.zeros_like(times)
    arrived = times > begin
    live = arrived & (a * times < DEAD)
    distance = np.abs((times - first + gap / 2) % gap - gap / 2)
    b = wave_numbers(kappa, MODES)
    tail = MODES * abs(shares(column, b, kappa)[MODES // 4])
    size = min(1.0, float(slowest(times, b[0], a).max(initial=0.0)))
    near = live & (distance * MODES < REACH) & (np.exp(-np.minimum(a * times, DEAD)) * tail > NOTHING * size)
    _check_waves(times[near])
    result[arrived] = _away(column, times, kappa, a, begin)[arrived]
    if near.any():
        result[near] = _near(column, times[near], kappa, a, undamped)
    return result


def mode_counts(a: float, begin: float) -> tuple[int, int]:
    """How many modes are summed one by one (slow or overdamped) and how many in all, from `begin` on."""
    if a * begin >= DEAD:  # diffusion alone
        count = int(np.sqrt(2 * DEAD * a / begin) / np.pi) + 8
        return count, count
    return int(2 * a / np.pi) + 2, MODES


def _away(column: str, times: Array, kappa: float, a: float, begin: float) -> Array:
    """Sum of the modes, cut off smoothly."""
    low, count = mode_counts(a, begin)
    b = wave_numbers(kappa, MODES)
    weights = shares(column, b, kappa) * cut_off(MODES, MODES)
    result: Array = weights[low:].sum() + _by_blocks(times, b[:low], weights[:low], lambda t, w: gone(t, w, a))
    if low < count:
        last = int(np.searchsorted(times, DEAD / a, side="right"))
        v = np.sqrt((b[low:] - a) * (b[low:] + a))
        result[:last] -= np.exp(-a * times[:last]) * _turns(v, weights[low:] * (1 - 1j * a / v), times[:last])
    return result


def _turns(v: Array, amplitude: NDArray[np.complex128], times: Array) -> Array:
    """Real part of the sum of amplitude * exp(i v t) at equally spaced times, as a product of two tables."""
    if not len(times):
        return np.zeros(0)
    side = int(np.ceil(np.sqrt(len(times))))
    rows = times[::side]
    offsets = times[:side] - times[0]
    total = np.zeros((len(rows), len(offsets)))
    for part in np.array_split(np.arange(len(v)), 1 + len(v) * side // BLOCK):
        rotated = np.exp(1j * np.outer(rows, v[part])) * amplitude[part]
        right = np.exp(1j * np.outer(v[part], offsets))
        total += rotated.real @ right.real - rotated.imag @ right.imag
    return total.ravel()[: len(times)]


def _check_waves(times: Array) -> None:
    """Raise for instants at fronts whose waves would take too long to sum."""
    work = float(np.sum((times / 2) ** 2))
    if work > WAVE_WORK:
        raise ValueError(
            "steps: the sum of (t / 2)^2 over instants t at undecayed wave fronts, in travel times of the wave, must "
            f"be at most {WAVE_WORK}, got {work:.6g}; choose a time step that falls on the fronts less often"
        )


def _near(column: str, times: Array, kappa: float, a: float, undamped: Undamped) -> Array:
    """Sum of the modes less their leading terms, which the undamped waves give for all modes at once."""
    count = max(LEAST_MODES, int(min(FRONT_MODES * min(a, 1.0), WORK // len(times))))
    b = wave_numbers(kappa, count)
    weights = shares(column, b, kappa) * cut_off(count, count)
    value, integral = undamped(column, times, kappa)
    leading = np.exp(-a * times) * (value + (a + a * a * times / 2) * integral)
    return np.asarray(leading + _by_blocks(times, b, weights, lambda t, w: _beyond(t, w, a)))


def _beyond(t: Array, w: Array, a: float) -> Array:
    """Way 1 - x that modes have gone less its leading terms; `t` is a column."""
    lead = a + a * a * t / 2
    return np.asarray(gone(t, w, a) - np.exp(-a * t) * (2 * np.sin(w * t / 2) ** 2 + lead * lag(t, w)))


def lag(t: Array, w: Array) -> Array:
    """T - sin(w t) / w, which is w^2 t^3 / 6 for slow modes, with all its digits."""
    z = np.minimum(w * t, 1.0) ** 2
    series = np.ones_like(z)
    for divisor in (342, 272, 210, 156, 110, 72, 42, 20):
        series = 1 - z / divisor * series
    return np.asarray(np.where(w * t < 1, t * z / 6 * series, t - np.sin(w * t) / w))


def gone(t: Array, w: Array, a: float) -> Array:
    """Way 1 - x(w, t) of modes; the first one's, which is slow on a soft spring, with all its digits."""
    y = 1 - response(t, w, a)
    y[:, :1] = slowest(t[:, 0], w[0], a)[:, None]
    return np.asarray(y)


def slowest(t: Array, w: float, a: float) -> Array:
    """Way 1 - x(w, t) of one mode, which is w^2 t^2 / 2 at first and w^2 t / (2 a) where damping is strong.

    It is w^2 times the integral of exp(-a u) sin(v u) / v, whose integrand does not cancel before w t or a t is one.
    """
    y = 1 - response(t[:, None], np.array([w]), a)[:, 0]
    early = (w * t < 1) & (a * t < 1)
    u, weights = np.polynomial.legendre.leggauss(GAUSS)
    s = t[early, None] * (1 + u) / 2
    v = np.sqrt(complex(w * w - a * a))
    y[early] = w * w * t[early] / 2 * (np.exp(-a * s) * s * np.sinc(v * s / np.pi).real @ weights)
    if w < a / 2:
        q = np.sqrt((a - w) * (a + w))
        slow = w * w / (a + q)
        fast = a + q
        late = t[~early]
        y[~early] = (slow * np.expm1(-fast * late) - fast * np.expm1(-slow * late)) / (2 * q)
    return np.asarray(y)


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
    return np.asarray(x)


def _by_blocks(times: Array, w: Array, weights: Array, term: Callable[[Array, Array], Array]) -> Array:
    """Sum of weights * term(t, w) over the modes, in blocks of bounded memory."""
    parts = np.array_split(times, 1 + len(times) * len(w) // BLOCK)
    return np.concatenate([term(part[:, None], w) @ weights for part in parts])
