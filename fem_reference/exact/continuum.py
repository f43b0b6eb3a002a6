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

each term from its arrival on. The damped bar, which is made of the same waves, is in `damped`.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

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
    """Histories over their static values, shape (columns, times), at increasing times in travel times.

    Instants too late for the waves to be summed are a `ValueError`.

    Parameters
    ----------
    kappa
        Stiffness of the spring over that of the bar, k h / (E W).
    rate
        Damping rate per travel time, c h / (wave speed).
    """
    if rate == 0 and times[-1] > LONGEST:
        raise ValueError(f"steps: must end within {LONGEST} travel times of the wave, got {float(times[-1])!r}")
    rows = np.zeros((len(columns), len(times)))
    for row, name in zip(rows, columns, strict=True):
        if name == "horizontal_displacement":
            continue
        first, waves, static = (1.0, pressure_waves, 1.0)
        if name == "displacement":
            first, waves, static = (0.5, displacement_waves, 1 / kappa + 0.5)
        if rate == 0:
            row[:] = undamped(waves, times - first, kappa) / static
        else:
            row[:] = damped.history(waves, first, times, kappa, rate / 2) / static
    return rows


def undamped(waves: damped.Waves, times: Array, kappa: float) -> Array:
    """Sum of the waves, of which one arrives at zero and one more every round trip, in chunks of bounded memory."""
    trips = int(max(0.0, np.ceil(times.max(initial=0.0) / damped.TRIP)))
    sums = []
    for part in np.array_split(times, min(len(times), 8 + len(times) * trips // CHUNK) or 1):
        arrivals = damped.TRIP * np.arange(np.count_nonzero(damped.TRIP * np.arange(trips) < part.max(initial=0.0)))
        total = np.zeros(len(part))
        elapsed = np.maximum(part[:, None] - arrivals, 0.0)
        for _, terms in zip(arrivals, waves(elapsed, kappa), strict=False):
            total += terms[:, 0]
        sums.append(total)
    return np.concatenate(sums)


def pressure_waves(t: Array, kappa: float) -> Iterator[Array]:
    """Yield I_j for j = 0, 1, ..., of the waves from j on, the last axis of `t`."""
    force = -2 * np.expm1(-kappa * t)
    yield force
    for value in _laguerre(2 * kappa * t):
        force = 2 * value - force[..., 1:]
        yield force


def displacement_waves(t: Array, kappa: float) -> Iterator[Array]:
    """Yield N_j(t) + N_(j+1)(t - 1) of the waves from j on, N_(j+1) = -N_j + I_j / kappa inserted.

    The wave and its reflection nearly cancel: N_j(t) - N_j(t - 1) has a recurrence of its own.
    """
    both = np.array([t, np.maximum(t - 1, 0.0)])
    step = np.minimum(t, 1.0)
    for force in pressure_waves(both, kappa):
        yield step + force[1] / kappa
        step = ((force[0] - force[1]) / kappa - step)[..., 1:]


def _laguerre(x: Array) -> Iterator[Array]:
    """Yield l_j(x), exp(-x / 2) (L_j - L_(j+1)), j = 0, 1, ..., of the waves that go on beyond reflection j.

    They are the last axis of x, of which each step drops the first. P_j = L_j^1 / (j + 1) goes on by
    (j + 2) (P_(j+1) - P_j) = j (P_j - P_(j-1)) - x P_j. Where exp(-x / 2) underflows P_j still matters: there the rest
    of the exponent is held back.
    """
    begun = np.minimum(x / 2, 600.0)
    rise = np.zeros_like(x)
    now = np.exp(-begun)
    exponent = begun - x / 2
    is_scaled = np.any(exponent < 0)
    scale = np.exp(exponent)
    for j in itertools.count():
        x = x[..., 1:]
        now = now[..., 1:]
        rise = (j * rise[..., 1:] - x * now) / (j + 2)
        value = x * now
        now = now + rise
        if is_scaled:
            # The value returns to its scale; polynomials that have become huge are taken nearer to theirs.
            exponent = exponent[..., 1:]
            scale = scale[..., 1:]
            value = value * scale
            is_huge = np.abs(now) > HUGE
            if is_huge.any():
                down = np.minimum(np.log(HUGE), -exponent[is_huge])
                factor = np.exp(-down)
                rise[is_huge] *= factor
                now[is_huge] *= factor
                exponent[is_huge] += down
                scale[is_huge] = np.exp(exponent[is_huge])
        yield value
