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

from validation.runs.history import Array
from validation.scenes.scene import Scene

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

    @property
    def critical_spin(self) -> float:
        """Rate about a corner that just carries the centre above it [rad/s]: I w^2 / 2 = m g (R - h / 2)."""
        radius = math.hypot(self.width, self.height) / 2
        # R - h/2 without the difference of two nearly equal lengths of a slender box
        rise = (self.width / 2) ** 2 / (radius + self.height / 2)
        return math.sqrt(1.5 * self.gravity * rise) / radius

    def greatest_rotation(self, spin: float) -> float:
        """Return the tilt at which a block that was started about a corner turns back [rad]; ValueError if it does not.

        w^2 / 2 + P^2 cos(alpha) = P^2 cos(alpha - theta).
        """
        ratio = spin / self.critical_spin
        if abs(ratio) >= 1:
            raise ValueError(f"spin: must be below that which overturns it, got {abs(ratio):g} of it")
        # 1 - cos(alpha - theta) = (1 - ratio^2) (1 - cos(alpha)), by half angles
        return self.alpha - 2 * math.asin(math.sqrt(1 - ratio**2) * math.sin(self.alpha / 2))

    def quarter_period(self, tilt: float) -> float:
        """Return the time from rest at a tilt [rad] until the base lies flat [s]."""
        return _time(lambda x: 2 * self.rate2 * _less(self.alpha - tilt, x), tilt)

    def landing_rate(self, tilt: float) -> float:
        """Return the rate at which the base of a block that was let go at a tilt comes down [rad/s]."""
        return math.sqrt(2 * self.rate2 * float(_less(self.alpha - tilt, np.array(tilt))))

    def fall_time(self, start: float, turned: float) -> float:
        """Return the time from rest at psi = `start` until it has turned by `turned` [rad], in s."""
        return _time(lambda x: 2 * self.rate2 * _less(start, x), turned)

    def squared_rate(self, start: float, duration: float) -> float:
        """Return the integral of psi'^2 over a time from rest at psi = `start` [rad^2/s]."""
        turned = _root(lambda angle: self.fall_time(start, angle) - duration, 0.0, math.pi - start)
        rates = np.sqrt(2 * self.rate2 * _less(start, turned * (1 + NODES) / 2))
        return float(turned / 2 * np.sum(WEIGHTS * rates))

    def pulse_rate2(self, k: float, theta: Array) -> Array:
        """Return theta'^2 of a block that was at rest when its base began to accelerate by k g [rad^2/s^2]."""
        pushed = 2 * k * np.cos(self.alpha - theta / 2) * np.sin(theta / 2)
        return 2 * self.rate2 * (pushed + _less(self.alpha, -theta))

    def pulse_end(self, k: float, duration: float) -> float:
        """Return the tilt at the end of the pulse [rad]."""
        return _root(lambda theta: _time(lambda x: self.pulse_rate2(k, x), theta) - duration, 0.0, 2 * self.alpha)

    def pulse_threshold(self, duration: float) -> float:
        """Return the least k that overturns the block.

        At the end of such a pulse sin(alpha - theta) = sin(alpha) - (1 - cos(alpha)) / k.
        """

        def spare(k: float) -> float:
            theta = self.alpha - math.asin(math.sin(self.alpha) - (1 - math.cos(self.alpha)) / k)
            return duration - _time(lambda x: self.pulse_rate2(k, x), theta)

        return _root(spare, math.tan(self.alpha) * (1 + 1e-6), 100.0)

    def pulse_peak(self, k: float, duration: float) -> float:
        """Return the greatest tilt after a pulse that does not overturn the block [rad]."""
        end = self.pulse_end(k, duration)
        cosine = float(self.pulse_rate2(k, np.array(end))) / (2 * self.rate2) + math.cos(self.alpha - end)
        return self.alpha - math.acos(cosine)

    def pulse_overturning(self, k: float, duration: float) -> float:
        """Return the time at which the centroid passes over the corner after a pulse that overturns the block [s]."""
        end = self.pulse_end(k, duration)
        rate2 = float(self.pulse_rate2(k, np.array(end)))
        return duration + _time(lambda x: rate2 + 2 * self.rate2 * _less(self.alpha - end, -x), self.alpha - end)


def _less(angle: float, turned: Array) -> Array:
    """Return cos(angle) - cos(angle + turned) without loss of digits."""
    return 2 * np.sin(angle + turned / 2) * np.sin(turned / 2)


def _time(rate2: Callable[[Array], Array], turned: float) -> float:
    """Return the time of a turn by its squared rate over the angle turned; the block may be at rest at first [s]."""
    s = (1 + NODES) / 2
    return float(turned * np.sum(WEIGHTS * s / np.sqrt(rate2(turned * s * s))))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Return where an increasing function passes zero."""
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high) / 2


def rectangle(scene: Scene) -> Rectangle:
    """Return the rigid rectangle of a scene."""
    (x0, y0), _, (x2, y2), _ = scene.block.outline
    return Rectangle(x2 - x0, y2 - y0, scene.load.gravity)


def settlement(scene: Scene) -> float:
    """Return the penetration m g / p of one corner that carries the block at rest [m]."""
    block = rectangle(scene)
    return scene.block.density * block.width * block.height * block.gravity / scene.contact.stiffness
