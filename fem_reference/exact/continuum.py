"""Exact response of an undamped or damped bar on a spring to a step of pressure.

Time is measured in travel times h / c and starts with the load. Without damping the waves are summed
one by one (d'Alembert): a wave that has met the spring j times carries the factor R^j,
R = (s - kappa) / (s + kappa) in the Laplace variable s. With l_j(x) = exp(-x / 2) L_j(x), L_j the
Laguerre polynomials, and x = 2 kappa t, the originals of 2 kappa R^j / (s (s + kappa)) and R^j / s^2 follow
by recurrence::

    I_0 = 2 (1 - exp(-kappa t)),   I_(j+1) = -I_j + 2 (l_j - l_(j+1))
    N_0 = t,                       N_(j+1) = -N_j + I_j / kappa

    pressure / q            =  sum of I_j(t - 2 j - 1)
    -v(h / 2) E / (q h)     =  sum of N_j(t - 2 j - 1/2) + N_(j+1)(t - 2 j - 3/2)

each term from its arrival on. Their integrals over time, which the damped bar needs at a front, are the sums
of K_j and of Q_j + Q_(j+1), K_(j+1) = -K_j + (I_j - I_(j+1)) / kappa and Q_(j+1) = -Q_j + K_j / kappa. The
damped bar itself is in `damped`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem_reference.exact import damped
from fem_reference.problem.problem import Array

CHUNK = 2**20
"""Entries of a work array."""
LONGEST = 700.0
"""Travel times up to which the waves of the undamped bar are summed: their cost grows with the square."""
HUGE = 1e100
"""Laguerre polynomial from which its scale is changed."""


def histories(times: Array, kappa: float, rate: float, columns: tuple[str, ...]) -> Array:
    """Histories over their static values, shape (columns, times).

    Parameters
    ----------
    times
        Instants in travel times, increasing, shape (times,).
    kappa
        Stiffness of the spring over that of the bar, k h / (E W).
    rate
        Damping rate per travel time, c h / (wave speed).
    columns
        Names of the columns.

    Raises
    ------
    ValueError
        If the last instant of the undamped bar is beyond `LONGEST`, or too many late instants of the damped
        bar lie at fronts.
    """
    if rate == 0 and times[-1] > LONGEST:
        raise ValueError(f"steps: must end within {LONGEST} travel times of the wave, got {float(times[-1])!r}")
    rows = []
    for name in columns:
        if name == "horizontal_displacement":
            rows.append(np.zeros_like(times))
        elif rate == 0:
            rows.append(undamped(name, times, kappa)[0])
        else:
            rows.append(damped.history(name, times, kappa, rate / 2, undamped))
    return np.array(rows).reshape(len(columns), len(times))


def undamped(column: str, times: Array, kappa: float) -> Array:
    """History of the undamped bar over its static value and the integral of it, shape (2, times)."""
    if column == "contact_pressure":
        return _in_chunks(_pressure, times, kappa, 1.0)
    return _in_chunks(_displacement, times, kappa, 0.5) / (1 / kappa + 0.5)


def _in_chunks(waves: Callable[[Array, float], Array], times: Array, kappa: float, first: float) -> Array:
    """Sum the waves that arrive at `first` and every round trip later, in chunks of bounded memory."""
    trips = int(max(0.0, np.ceil((times.max(initial=0.0) - first) / 2)))
    arrivals = first + 2 * np.arange(trips)
    parts = np.array_split(times, min(len(times), 8 + len(times) * trips // CHUNK) or 1)
    arrived = [arrivals[: np.count_nonzero(arrivals < part.max(initial=0.0))] for part in parts]
    return np.hstack([waves(np.maximum(t[:, None] - r, 0.0), kappa) for t, r in zip(parts, arrived, strict=True)])


def _pressure(t: Array, kappa: float) -> Array:
    """Sums of I_j(t_j) and K_j(t_j), the recurrence run for all waves at once; `t` has shape (times, waves)."""
    total = np.zeros((2, len(t)))
    laguerre = _Laguerre(2 * kappa * t)
    force, impulse = _first(t, kappa)
    for _ in range(t.shape[1]):
        total += force[:, 0], impulse[:, 0]
        before, force = force[:, 1:], 2 * laguerre.advance() - force[:, 1:]
        impulse = (before - force) / kappa - impulse[:, 1:]
    return total


def _first(t: Array, kappa: float) -> tuple[Array, Array]:
    """I_0 and its integral K_0."""
    force = -2 * np.expm1(-kappa * t)
    return force, 2 * t - force / kappa


def _displacement(t: Array, kappa: float) -> Array:
    """Sums of N_j(t_j) + N_(j+1)(t_j - 1) and of their integrals, N_(j+1) = -N_j + I_j / kappa inserted.

    The wave and its reflection nearly cancel: N_j(t) - N_j(t - 1) has a recurrence of its own.
    """
    total = np.zeros((2, len(t)))
    both = np.array([t, np.maximum(t - 1, 0.0)])
    laguerre = _Laguerre(2 * kappa * both)
    force, impulse = _first(both, kappa)
    step = np.minimum(t, 1.0)
    area = step * (both[0] + both[1]) / 2
    for _ in range(t.shape[1]):
        total += step[:, 0] + force[1, :, 0] / kappa, area[:, 0] + impulse[1, :, 0] / kappa
        step = ((force[0] - force[1]) / kappa - step)[:, 1:]
        area = ((impulse[0] - impulse[1]) / kappa - area)[:, 1:]
        before, force = force[..., 1:], 2 * laguerre.advance() - force[..., 1:]
        impulse = (before - force) / kappa - impulse[..., 1:]
    return total


class _Laguerre:
    """l_j(x) = exp(-x / 2) L_j(x) for the waves that go on beyond reflection j, the last axis of x.

    Where exp(-x / 2) underflows L_j still matters: there the rest of the exponent is held back.
    """

    def __init__(self, x: Array) -> None:
        self._x, self._j = x, 0
        begun = np.minimum(x / 2, 600.0)
        self._before, self._now, self._exponent = np.zeros_like(x), np.exp(-begun), begun - x / 2
        self._scaled = bool(np.any(self._exponent < 0))

    def advance(self) -> Array:
        """Drop the first wave, raise j by one and return l_j - l_(j+1)."""
        j, x, now, before = self._j, self._x[..., 1:], self._now[..., 1:], self._before[..., 1:]
        following = ((2 * j + 1 - x) * now - j * before) / (j + 1)
        self._j, self._x, self._before, self._now = j + 1, x, now, following
        return self._rescaled(now - following) if self._scaled else now - following

    def _rescaled(self, step: Array) -> Array:
        """Return a difference to its scale; take polynomials that have become huge nearer to theirs."""
        self._exponent = self._exponent[..., 1:]
        result: Array = step * np.exp(self._exponent)
        down = np.where(np.abs(self._now) > HUGE, np.minimum(np.log(HUGE), -self._exponent), 0.0)
        if down.any():
            factor = np.exp(-down)
            self._before, self._now, self._exponent = self._before * factor, self._now * factor, self._exponent + down
        return result
