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

each term from its arrival on. With a damping rate c per travel time, M D'' + c M D' + K D = F, the
response of every mode, and so their sum y, follows from the undamped one y_0, with a = c / 2::

    y(t) = exp(-a t) [y_0(t) + a int_0^t (I0(a z) + t I1(a z) / z) y_0(u) du],   z = sqrt(t^2 - u^2)

(I0, I1 the modified Bessel functions). Nothing has arrived before the first wave, and y_0 is analytic
between arrivals: there it is held as Legendre series, halved until they are resolved.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from scipy.special import i0e, i1e

from fem_reference.problem import Array

Waves = Callable[[Array, float], Array]

NODES = 24
"""Gauss points and Legendre coefficients of a panel."""
RESOLVED = 1e-12
"""Size of the last Legendre coefficients over the largest history at which a panel is resolved."""
CHUNK = 2**20
"""Entries of a work array."""
LONGEST = 700.0
"""Travel times up to which the waves are summed: then exp(-x / 2) underflows where L_j still matters."""


class Panel(NamedTuple):
    """An interval between arrivals with the undamped history on it."""

    left: float
    """Start [travel times]."""
    right: float
    """End [travel times]."""
    series: Array
    """Legendre coefficients, shape (NODES,)."""


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
        If the last instant is beyond `LONGEST`.
    """
    if times[-1] > LONGEST:
        raise ValueError(f"steps: must end within {LONGEST} travel times of the wave, got {float(times[-1])!r}")
    rows = []
    for name in columns:
        if name == "horizontal_displacement":
            rows.append(np.zeros_like(times))
        else:
            waves, first, gap, static = _parts(name, kappa)
            y = waves(times, kappa) if rate == 0 else damped(times, kappa, rate / 2, waves, first, gap)
            rows.append(y / static)
    return np.array(rows).reshape(len(columns), len(times))


def _parts(column: str, kappa: float) -> tuple[Waves, float, float, float]:
    """Wave sum of a column, its first arrival, the time between arrivals and its static value."""
    if column == "contact_pressure":
        return pressure, 1.0, 2.0, 1.0
    return displacement, 0.5, 1.0, 1 / kappa + 0.5


def pressure(times: Array, kappa: float) -> Array:
    """Contact pressure over q of the undamped bar."""
    return _in_chunks(_pressure, times, kappa, 1.0)


def displacement(times: Array, kappa: float) -> Array:
    """Downward displacement of the middle times E / (q h) of the undamped bar."""
    return _in_chunks(_displacement, times, kappa, 0.5)


def _in_chunks(waves: Callable[[Array, float], Array], times: Array, kappa: float, first: float) -> Array:
    """Sum the waves that arrive at `first` and every round trip later, in chunks of bounded memory."""
    trips = int(max(0.0, np.ceil((times.max(initial=0.0) - first) / 2)))
    arrivals = first + 2 * np.arange(trips)
    parts = np.array_split(times, 1 + len(times) * trips // CHUNK)
    return np.concatenate([waves(np.maximum(part[:, None] - arrivals, 0.0), kappa) for part in parts])


def _pressure(t: Array, kappa: float) -> Array:
    """Sum of I_j(t_j), the recurrence run for all waves at once; `t` has shape (times, waves)."""
    total = np.zeros(len(t))
    laguerre = _Laguerre(2 * kappa * t)
    force = -2 * np.expm1(-kappa * t)
    for _ in range(t.shape[1]):
        total += force[:, 0]
        force = 2 * laguerre.advance() - force[:, 1:]
    return total


def _displacement(t: Array, kappa: float) -> Array:
    """Sum of N_j(t_j) + N_(j+1)(t_j - 1), with N_(j+1) = -N_j + I_j / kappa inserted.

    The wave and its reflection nearly cancel: N_j(t) - N_j(t - 1) has a recurrence of its own.
    """
    total = np.zeros(len(t))
    both = np.array([t, np.maximum(t - 1, 0.0)])
    laguerre = _Laguerre(2 * kappa * both)
    force = -2 * np.expm1(-kappa * both)
    step = np.minimum(t, 1.0)
    for _ in range(t.shape[1]):
        total += step[:, 0] + force[1, :, 0] / kappa
        step = ((force[0] - force[1]) / kappa - step)[:, 1:]
        force = 2 * laguerre.advance() - force[..., 1:]
    return total


class _Laguerre:
    """l_j(x) = exp(-x / 2) L_j(x) for the waves that go on beyond reflection j, the last axis of x."""

    def __init__(self, x: Array) -> None:
        self._x, self._j = x, 0
        self._before, self._now = np.zeros_like(x), np.exp(-x / 2)

    def advance(self) -> Array:
        """Drop the first wave, raise j by one and return l_j - l_(j+1)."""
        j, x, now, before = self._j, self._x[..., 1:], self._now[..., 1:], self._before[..., 1:]
        following = ((2 * j + 1 - x) * now - j * before) / (j + 1)
        self._j, self._x, self._before, self._now = j + 1, x, now, following
        return now - following


def damped(times: Array, kappa: float, a: float, waves: Waves, first: float, gap: float) -> Array:
    """Damped history from the undamped wave sum by the Bessel kernel, shape (times,).

    Parameters
    ----------
    times
        Instants in travel times, increasing.
    kappa
        Stiffness of the spring over that of the bar.
    a
        Half the damping rate per travel time.
    waves
        The undamped wave sum.
    first, gap
        First arrival and time between arrivals in travel times.
    """
    total = np.zeros_like(times)
    nodes, weights = legendre.leggauss(NODES)
    end = float(times[-1])
    scale = float(np.abs(waves(times, kappa)).max())
    # The kernel is no narrower than sqrt(first / a), a panel no wider than a few of its widths.
    widest = min(gap, 4 * np.sqrt(first / a))
    for panel in _panels(waves, kappa, np.arange(first, end, gap), end, widest, scale):
        inside = (times > panel.left) & (times <= panel.right)
        t = times[inside]
        total[inside] += np.exp(-a * t) * _value(panel, t)
        late = times > panel.left
        t = times[late][:, None]
        half = (np.minimum(t, panel.right) - panel.left) / 2
        u = panel.left + half * (1 + nodes)
        total[late] += (half * kernel(t, u, a) * _value(panel, u)) @ weights
    return total


def kernel(t: Array, u: Array, a: float) -> Array:
    """Kernel a exp(-a t) (I0(a z) + t I1(a z) / z) with z = sqrt(t^2 - u^2)."""
    z = np.sqrt(np.maximum((t - u) * (t + u), 0.0))
    ratio = np.divide(i1e(a * z), z, out=np.full_like(z, a / 2), where=z > 0)
    # i0e and i1e carry exp(-a z), and t - z = u^2 / (t + z).
    result: Array = a * np.exp(-a * u * u / (t + z)) * (i0e(a * z) + t * ratio)
    return result


def _panels(waves: Waves, kappa: float, arrivals: Array, end: float, widest: float, scale: float) -> list[Panel]:
    """Panels from the first arrival to the end, each resolved or too narrow to matter."""
    nodes, weights = legendre.leggauss(NODES)
    to_series = (legendre.legvander(nodes, NODES - 1) * weights[:, None]) * (np.arange(NODES) + 0.5)
    left, right = arrivals, np.append(arrivals[1:], end)[: len(arrivals)]
    done = []
    while len(left):
        points = (left + right)[:, None] / 2 + nodes * (right - left)[:, None] / 2
        series = waves(points.ravel(), kappa).reshape(points.shape) @ to_series
        resolved = (np.abs(series[:, -3:]).max(axis=1) <= RESOLVED * scale) & (right - left <= widest)
        resolved |= right - left < RESOLVED * end
        done += [Panel(*item) for item in zip(left[resolved], right[resolved], series[resolved], strict=True)]
        left, right = left[~resolved], right[~resolved]
        middle = (left + right) / 2
        left, right = np.append(left, middle), np.append(middle, right)
    return done


def _value(panel: Panel, t: Array) -> Array:
    local = (2 * t - panel.left - panel.right) / (panel.right - panel.left)
    return np.asarray(legendre.legval(local, panel.series), dtype=np.float64)
