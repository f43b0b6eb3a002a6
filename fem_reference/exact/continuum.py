"""Exact response of an undamped or damped bar on a spring to a step of pressure.

Time is measured in travel times h / c and starts with the load. Without damping the waves are summed
one by one (d'Alembert): a wave that has met the spring j times carries the factor R^j,
R = (s - kappa) / (s + kappa) in the Laplace variable s. With x = 2 kappa t and the Laguerre polynomials L_j^m,
l_j^m(x) = exp(-x / 2) x^m L_j^m(x) m! j! / (j + m)!, the originals of 2 kappa R^j / (s (s + kappa)) and R^j / s^2
follow by recurrence, without a difference of nearly equal terms on a soft spring::

    I_0 = 2 (1 - exp(-kappa t)),   I_(j+1) = -I_j + 2 l_j^1
    N_0 = t,                       N_(j+1) = -N_j + I_j / kappa

    pressure / q            =  sum of I_j(t - 2 j - 1)
    -v(h / 2) E / (q h)     =  sum of N_j(t - 2 j - 1/2) + N_(j+1)(t - 2 j - 3/2)

each term from its arrival on. Their integrals over time, which the damped bar needs at a front, are the sums
of K_j and of Q_j + Q_(j+1), K_(j+1) = -K_j + D_j and Q_(j+1) = -Q_j + K_j / kappa. Here
D_j = (I_j - I_(j+1)) / kappa, the original of 4 kappa R^j / (s (s + kappa)^2), which on a soft spring keeps its
digits by its own recurrence, D_(j+1) = -D_j + l_j^2 / kappa. The damped bar itself is in `damped`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.special import gammainc

from fem_reference.exact import damped
from fem_reference.problem.problem import Array

CHUNK = 2**20
"""Entries of a work array."""
LONGEST = 700.0
"""Travel times up to which the waves of the undamped bar are summed: their cost grows with the square."""
SOFT = 1.0
"""Stiffness below which D_j has its own recurrence: l_j^2 / kappa grows as kappa, D_j is at most 4 / kappa."""
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
    for _, (force, impulse) in zip(range(t.shape[1]), _forces(t, kappa), strict=False):
        total += force[:, 0], impulse[:, 0]
    return total


def _forces(t: Array, kappa: float) -> Iterator[tuple[Array, Array]]:
    """Yield I_j and K_j for j = 0, 1, ..., of the waves from j on, the last axis of `t`."""
    first = _Laguerre(2 * kappa * t, 1)
    second = _Laguerre(2 * kappa * t, 2)
    begun = -np.expm1(-kappa * t)
    force = 2 * begun
    rise = 4 / kappa * gammainc(2, kappa * t)
    impulse = 2 * t * begun - rise / 2
    while True:
        yield force, impulse
        before = force[..., 1:]
        force = 2 * first.advance() - force[..., 1:]
        if kappa < SOFT:
            impulse = rise[..., 1:] - impulse[..., 1:]
            rise = second.advance() / kappa - rise[..., 1:]
        else:
            impulse = (before - force) / kappa - impulse[..., 1:]


def _displacement(t: Array, kappa: float) -> Array:
    """Sums of N_j(t_j) + N_(j+1)(t_j - 1) and of their integrals, N_(j+1) = -N_j + I_j / kappa inserted.

    The wave and its reflection nearly cancel: N_j(t) - N_j(t - 1) has a recurrence of its own.
    """
    total = np.zeros((2, len(t)))
    both = np.array([t, np.maximum(t - 1, 0.0)])
    step = np.minimum(t, 1.0)
    area = step * (both[0] + both[1]) / 2
    for _, (force, impulse) in zip(range(t.shape[1]), _forces(both, kappa), strict=False):
        total += step[:, 0] + force[1, :, 0] / kappa, area[:, 0] + impulse[1, :, 0] / kappa
        step = ((force[0] - force[1]) / kappa - step)[:, 1:]
        area = ((impulse[0] - impulse[1]) / kappa - area)[:, 1:]
    return total


class _Laguerre:
    """l_j^m(x) for the waves that go on beyond reflection j, the last axis of x.

    P_j = L_j^m m! j! / (j + m)! goes on by (j + 1 + m) (P_(j+1) - P_j) = j (P_j - P_(j-1)) - x P_j. Where exp(-x / 2)
    underflows P_j still matters: there the rest of the exponent is held back.
    """

    def __init__(self, x: Array, order: int = 1) -> None:
        self._x = x
        self._j = 0
        self._order = order
        begun = np.minimum(x / 2, 600.0)
        self._rise = np.zeros_like(x)
        self._now = np.exp(-begun)
        self._exponent = begun - x / 2
        self._scaled = bool(np.any(self._exponent < 0))

    def advance(self) -> Array:
        """Drop the first wave, raise j by one and return l_j^m; for m = 1 that is l_j^0 - l_(j+1)^0."""
        j = self._j
        x = self._x[..., 1:]
        now = self._now[..., 1:]
        self._rise = (j * self._rise[..., 1:] - x * now) / (j + 1 + self._order)
        self._j = j + 1
        self._x = x
        self._now = now + self._rise
        value = x**self._order * now
        return self._rescaled(value) if self._scaled else value

    def _rescaled(self, value: Array) -> Array:
        """Return a value to its scale; take polynomials that have become huge nearer to theirs."""
        self._exponent = self._exponent[..., 1:]
        result: Array = value * np.exp(self._exponent)
        down = np.where(np.abs(self._now) > HUGE, np.minimum(np.log(HUGE), -self._exponent), 0.0)
        if down.any():
            factor = np.exp(-down)
            self._rise = self._rise * factor
            self._now = self._now * factor
            self._exponent = self._exponent + down
        return result
