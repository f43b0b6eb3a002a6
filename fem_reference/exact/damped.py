r"""The damped bar on a spring, M D'' + c M D' + K D = F, from the waves of the undamped one.

Time is in travel times and a = c / 2. A mode of frequency w goes the way 1 - x(t), x = exp(-a t) (cos v t + a sin(v t)
/ v) with v^2 = w^2 - a^2. Both of its parts are integrals over those of the undamped mode (of the telegraph equation,
with xi^2 = t^2 - s^2 and the modified Bessel functions I)::

    sin(v t) / v = integral of I_0(a xi) cos(w s) over s in [0, t],
    cos v t      = cos w t + integral of a t I_1(a xi) / xi cos(w s),

so that in every mode alike, and in their sum y(t) of the undamped bar, the damped history is

    exp(-a t) y(t) + integral of exp(-a t) [a I_0(a xi) + a t I_1(a xi) / xi] y(s) over s in [0, t]

(what stands beside y has the integral 1: a mode with w = 0 keeps x = 1). All is positive, so that no digit of a soft
spring is lost, and the fronts are those of y, in full where exp(-a t) has not damped them away.

y has a front at each arrival and is smooth between them, with rates up to kappa j after j reflections: it is sampled at
Gauss points of cells that shrink towards a front, the same in every round trip. The kernel, which is smooth, is taken
at few points of each trip, with moments of y; of the last trip, which ends at t, at the points of the cells.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from scipy.special import i0e, i1e

from fem_reference.problem.problem import Array

Waves = Callable[[Array, float], Iterator[Array]]
"""From times since the arrivals of the waves, and kappa, to what wave j adds, j = 0, 1, ..., of the waves from j on."""
TRIP = 2.0
"""Time between two arrivals."""
LONGEST = 1000.0
"""Travel times over which the waves of a damped bar are summed: their cost grows with the square, and so does their
rounding, to 2e-11 in a displacement after 650 without damping."""
DEAD = 40.0
"""Exponent at which a decayed term is below rounding."""
POINTS = 20
"""Gauss points of a cell."""
PHASE = 6.0
"""Phase over a cell of what is sampled in it: 20 points leave (3/2)^20 / 20!, 1e-15, of a vibration."""
DECAY = 8.0
"""Exponent over a cell by which the kernel decays: they leave e^-4 2^20 / 20!, 1e-14, of that."""
GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(POINTS)
_BASIS = ((np.arange(POINTS) + 0.5) * np.polynomial.legendre.legvander(GAUSS, POINTS - 1)).T * WEIGHTS
CHUNK = 2**22
"""Entries of a work array."""


def history(waves: Waves, first: float, times: Array, kappa: float, a: float) -> Array:
    """History of the damped bar from the waves of the undamped one, of which one arrives `first`, shape (times,).

    Too many waves until the last instant are a `ValueError`.
    """
    # The kernel falls as exp(-a s^2 / (2 t)): earlier waves have arrived by diffusion alone, and are nothing so far.
    latest = float(np.minimum(times, np.sqrt(2 * DEAD * times / a)).max(initial=0.0))
    if latest > LONGEST:
        raise ValueError(
            f"steps: must end where undecayed waves have taken {LONGEST:g} travel times at most, got {latest:.6g}"
        )
    trips = 1 + max(0, math.floor((latest - first) / TRIP))
    coarse = np.linspace(0.0, TRIP, 1 + math.ceil(TRIP * min(a, math.sqrt(2 * DEAD * a)) / DECAY))
    edges = np.union1d(_edges(kappa, trips), coarse)
    points = _points(edges)
    weights = np.diff(edges)[:, None] / 2 * WEIGHTS
    y = _sampled(waves, points, trips, kappa)
    few = _points(coarse)
    moments = _moments(points, weights[:, :, None] * y, coarse)
    begins = first + TRIP * np.arange(trips)

    def value(t: float) -> float:
        if t <= first:
            return 0.0
        trip = int((t - first) / TRIP)
        whole = min(trip, trips)
        total = float(kernel(t, begins[:whole, None, None] + few, a).ravel() @ moments[:whole].ravel())
        if trip >= trips:  # all that has not arrived by diffusion is dead
            return total
        passed = min(t - begins[trip], TRIP)
        cell = int(np.searchsorted(edges[1:-1], passed, side="right"))
        in_trip = y[:, :, trip]
        total += float((kernel(t, begins[trip] + points[:cell], a) * weights[:cell] * in_trip[:cell]).sum())
        low, high = edges[cell : cell + 2]
        rest = low + (passed - low) * (GAUSS + 1) / 2
        own = lagrange(2 * (np.append(rest, passed) - low) / (high - low) - 1) @ in_trip[cell]
        total += float(kernel(t, begins[trip] + rest, a) * WEIGHTS @ own[:-1]) * (passed - low) / 2
        return float(total + math.exp(-a * t) * own[-1])

    return np.array([value(t) for t in times.tolist()])


def kernel(t: float, s: Array, a: float) -> Array:
    """exp(-a t) [a I_0(a xi) + a t I_1(a xi) / xi]."""
    xi = np.sqrt(np.maximum((t - s) * (t + s), 0.0))
    z = np.maximum(a * xi, np.finfo(float).tiny)
    decayed = np.exp(-a * s * s / (t + xi))  # exp(a xi - a t)
    return np.asarray(a * decayed * (i0e(z) + a * t * i1e(z) / z))


def lagrange(x: Array) -> Array:
    """Values at places in [-1, 1] of the polynomials that are one at one Gauss point each, shape (places, points)."""
    return np.polynomial.legendre.legvander(x, POINTS - 1) @ _BASIS


def _points(edges: Array) -> Array:
    """Gauss points of cells, shape (cells, points)."""
    return edges[:-1, None] + np.diff(edges)[:, None] * (GAUSS + 1) / 2


def _edges(kappa: float, trips: int) -> Array:
    """Edges of the cells of a trip, which shrink towards its arrivals at zero and at half of it.

    After j reflections a wave goes as J_0((8 kappa j t)^(1/2)), whose phase is at most PHASE in each cell, until about
    t = 2 j / kappa, after which it decays as exp(-kappa t).
    """
    fastest = kappa * trips
    ends = np.append(0.0, 0.5 ** np.arange(max(0, math.ceil(math.log2(fastest))), -1.0, -1.0))
    edges = []
    for low, high in pairwise(ends.tolist()):
        phase = math.sqrt(2 * fastest * high) if kappa * low <= 4 * trips else 0.0
        edges.append(np.linspace(low, high, 2 + int(phase / PHASE))[:-1])
    half = np.concatenate(edges)
    return np.concatenate([half, TRIP / 2 + half, [TRIP]])


def _sampled(waves: Waves, points: Array, trips: int, kappa: float) -> Array:
    """The undamped history at points of each trip, shape (cells, points, trips)."""
    since = TRIP * np.arange(trips)[::-1]
    parts = []
    for part in np.array_split(points.ravel(), 1 + points.size * trips // CHUNK):
        total = np.zeros((len(part), trips))
        for j, terms in zip(range(trips), waves(part[:, None] + since, kappa), strict=False):
            total[:, j:] += terms[:, ::-1]  # wave j, which had arrived in trip j
        parts.append(total)
    return np.concatenate(parts).reshape(*points.shape, trips)


def _moments(points: Array, weighted: Array, coarse: Array) -> Array:
    """Integrals over coarse cells of the history times their polynomials, shape (trips, cells, points)."""
    cell = np.searchsorted(coarse, points.mean(axis=1)) - 1
    places = 2 * (points - coarse[cell, None]) / np.diff(coarse)[cell, None] - 1
    moments = np.zeros((len(coarse) - 1, POINTS, weighted.shape[2]))
    np.add.at(moments, cell, np.swapaxes(lagrange(places), 1, 2) @ weighted)
    return np.moveaxis(moments, -1, 0)
