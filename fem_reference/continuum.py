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
    total = np.zeros_like(times)
    for j in range(_count(times, 1.0)):
        late = times > 2 * j + 1
        total[late] += _reflections(times[late] - (2 * j + 1), kappa, j).force
    return total


def displacement(times: Array, kappa: float) -> Array:
    """Downward displacement of the middle times E / (q h) of the undamped bar."""
    total = np.zeros_like(times)
    for j in range(_count(times, 0.5)):
        late = times > 2 * j + 0.5
        t = times[late] - (2 * j + 0.5)
        # The wave and its reflection nearly cancel: N_(j+1) = -N_j + I_j / kappa is inserted.
        down, up = _reflections(t, kappa, j), _reflections(np.maximum(t - 1, 0.0), kappa, j)
        total[late] += down.step + up.force / kappa
    return total


def _count(times: Array, first: float) -> int:
    """Number of round trips that have arrived."""
    return int(max(0.0, np.ceil((times.max(initial=0.0) - first) / 2)))


class Reflection(NamedTuple):
    """What a wave brings after it has met the spring j times."""

    force: Array
    """I_j, its pressure on the spring."""
    step: Array
    """N_j(t) - N_j(t - 1), its displacement less that of one travel time before."""


def _reflections(t: Array, kappa: float, j: int) -> Reflection:
    """Pressure and displacement at times since the wave's arrival."""
    x = 2 * kappa * np.array([t, np.maximum(t - 1, 0.0)])
    before, laguerre = np.zeros_like(x), np.exp(-x / 2)
    force, step = -2 * np.expm1(-x / 2), np.minimum(t, 1.0)
    for i in range(j):
        following = ((2 * i + 1 - x) * laguerre - i * before) / (i + 1)
        step = -step + (force[0] - force[1]) / kappa
        force = -force + 2 * (laguerre - following)
        before, laguerre = laguerre, following
    return Reflection(force[0], step)


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
    """a exp(-a t) (I0(a z) + t I1(a z) / z) with z = sqrt(t^2 - u^2)."""
    z = np.sqrt(np.maximum((t - u) * (t + u), 0.0))
    ratio = np.divide(i1e(a * z), z, out=np.full_like(z, a / 2), where=z > 0)
    # i0e and i1e carry exp(-a z), and t - z = u^2 / (t + z).
    result: Array = a * np.exp(-a * u * u / (t + z)) * (i0e(a * z) + t * ratio)
    return result


def _panels(waves: Waves, kappa: float, arrivals: Array, end: float, widest: float, scale: float) -> list[Panel]:
    """Panels from the first arrival to the end, each resolved or too narrow to matter."""
    nodes, weights = legendre.leggauss(NODES)
    to_series = (legendre.legvander(nodes, NODES - 1) * weights[:, None]).T * (np.arange(NODES)[:, None] + 0.5)
    waiting = list(zip(arrivals, np.append(arrivals[1:], end), strict=True))
    done = []
    while waiting:
        left, right = waiting.pop()
        middle = (left + right) / 2
        series = to_series @ waves(middle + nodes * (right - left) / 2, kappa)
        resolved = np.abs(series[-3:]).max() <= RESOLVED * scale and right - left <= widest
        if resolved or right - left < RESOLVED * end:
            done.append(Panel(left, right, series))
        else:
            waiting += [(left, middle), (middle, right)]
    return done


def _value(panel: Panel, t: Array) -> Array:
    local = (2 * t - panel.left - panel.right) / (panel.right - panel.left)
    value: Array = legendre.legval(local, panel.series)
    return value
