r"""A rigid rectangle that turns about a corner of its base: times, thresholds and peaks by quadrature.

With alpha = atan(a/h), R = sqrt(a^2 + h^2)/2 and P^2 = m g R / I = 3 g / (4 R) the tilt theta about a corner on a plane
base obeys theta'' = -P^2 sin(alpha - theta), so that theta'^2 / 2 + P^2 cos(alpha - theta) is kept; on an incline b the
angle of the centroid beyond the vertical through the lower corner, psi = b - alpha + theta, obeys psi'' = P^2 sin psi.
While the base accelerates by k g the tilt gains P^2 k (sin alpha - sin(alpha - theta)).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(80)
HALVINGS = 60


@dataclass(frozen=True)
class Rectangle:
    """A rigid rectangle."""

    width: float  # a [m]
    height: float  # h [m]
    gravity: float  # g [m/s^2]

    @property
    def alpha(self) -> float:
        """Tilt at which the centroid stands over the corner [rad]."""
        return math.atan(self.width / self.height)

    @property
    def rate2(self) -> float:
        """P^2 = 3 g / (4 R) [1/s^2]."""
        return 1.5 * self.gravity / math.hypot(self.width, self.height)

    @property
    def housner(self) -> float:
        """Rate after over rate before an impact that keeps the angular momentum about the new corner [-]."""
        return 1 - 1.5 * math.sin(self.alpha) ** 2

    def quarter_period(self, tilt: float) -> float:
        """Return the time from rest at a tilt [rad] until the base lies flat [s]."""

        def rate2(theta: Array) -> Array:
            return 2 * self.rate2 * _cosines(self.alpha - tilt, self.alpha - theta)

        return _time(rate2, tilt, 0.0)

    def fall_time(self, start: float, turned: float) -> float:
        """Return the time from rest at psi = `start` until it has turned by `turned` [rad], in s."""

        def rate2(psi: Array) -> Array:
            return 2 * self.rate2 * _cosines(start, psi)

        return _time(rate2, start, start + turned)

    def squared_rate(self, start: float, duration: float) -> float:
        """Return the integral of psi'^2 over a time from rest at psi = `start` [rad^2/s]."""
        turned = _root(lambda angle: self.fall_time(start, angle) - duration, 0.0, math.pi - start)
        rates = np.sqrt(2 * self.rate2 * _cosines(start, start + turned * (1 + NODES) / 2))
        return float(turned / 2 * np.sum(WEIGHTS * rates))

    def pulse_rate2(self, k: float, theta: Array) -> Array:
        """Return theta'^2 of a block that was at rest when its base began to accelerate by k g [rad^2/s^2]."""
        rise = k * (math.sin(self.alpha) - np.sin(self.alpha - theta)) - _cosines(self.alpha - theta, self.alpha)
        return np.asarray(2 * self.rate2 * rise)

    def pulse_end(self, k: float, duration: float) -> float:
        """Return the tilt at the end of the pulse [rad]."""
        return _root(lambda theta: _time(lambda x: self.pulse_rate2(k, x), 0.0, theta) - duration, 0.0, 2 * self.alpha)

    def pulse_threshold(self, duration: float) -> float:
        """Return the least k that overturns the block.

        At the end of such a pulse sin(alpha - theta) = sin(alpha) - (1 - cos(alpha)) / k.
        """

        def spare(k: float) -> float:
            theta = self.alpha - math.asin(math.sin(self.alpha) - (1 - math.cos(self.alpha)) / k)
            return duration - _time(lambda x: self.pulse_rate2(k, x), 0.0, theta)

        return _root(spare, math.tan(self.alpha) * (1 + 1e-6), 100.0)

    def pulse_peak(self, k: float, duration: float) -> float:
        """Return the greatest tilt after a pulse that does not overturn the block [rad]."""
        end = self.pulse_end(k, duration)
        held = float(self.pulse_rate2(k, np.array(end))) / (2 * self.rate2) + math.cos(self.alpha - end)
        return self.alpha - math.acos(held)

    def pulse_overturning(self, k: float, duration: float) -> float:
        """Return the time at which the centroid passes over the corner after a pulse that overturns the block [s]."""
        end = self.pulse_end(k, duration)
        held = float(self.pulse_rate2(k, np.array(end)))

        def rate2(theta: Array) -> Array:
            return np.asarray(held + 2 * self.rate2 * _cosines(self.alpha - end, self.alpha - theta))

        return duration + _time(rate2, end, self.alpha)


def _cosines(one: float | Array, other: float | Array) -> Array:
    """Return cos(one) - cos(other) without loss of digits."""
    first, second = np.asarray(one), np.asarray(other)
    return np.asarray(2 * np.sin((first + second) / 2) * np.sin((second - first) / 2))


def _time(rate2: Callable[[Array], Array], start: float, end: float) -> float:
    """Return the time between two angles, at the first of which the block may be at rest [s]."""
    s = (1 + NODES) / 2
    rates = np.sqrt(rate2(start + (end - start) * s * s))
    return float(abs(end - start) * np.sum(WEIGHTS * s / rates))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Return where an increasing function passes zero."""
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high) / 2
