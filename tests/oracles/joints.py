"""One joint between elastic bars or half-spaces: what passes it, what it tears off, and how far it slips.

Velocities and stresses are those of waves f(t - x/c) and g(t + x/c) in bars of impedance z = rho c; a joint that is
closed or sticks is rigid unless a stiffness is named. Sources: Graff, Wave Motion in Elastic Solids (1975), sections
2.4 to 2.6, for impacts and spalls; Miller, An approximate method of analysis of the transmission of elastic waves
through a frictional boundary, J. Appl. Mech. 44 (1977), for the joint that slips.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

QUADRATURE_POINTS = 200  # of Gauss, for smooth functions over less than half a period
ROOT_TOLERANCE = 1e-15  # of the angle at which a sticking joint begins to slip [rad]


class Passage(NamedTuple):
    """Amplitudes of a wave at a joint over that of the incident wave, by energy: T^2 + R^2 + A^2 = 1."""

    transmitted: float  # T
    reflected: float  # R
    absorbed: float  # A, the root of the share of the energy that the slip takes


def spall_of_half_sine(
    pressure: float, duration: float, density: float, speed: float, depth: float
) -> tuple[float, float]:
    """Return when a joint at a depth below a free end opens, and the velocity of the piece that leaves.

    A pulse P sin(pi t / td) comes from below: the joint opens td / 2 + a / c after its arrival at the joint, when the
    wave that the free end has reflected outweighs what still arrives, and the piece takes its trapped momentum along,
    V = 2 P td / (pi rho a) sin(pi a / (c td)), for 2 a / c < td.

    Parameters
    ----------
    pressure
        P, greatest of the pulse [Pa].
    duration
        td [s].
    density, speed
        Of the bar [kg/m3] and its wave [m/s].
    depth
        a, length of the piece [m].
    """
    velocity = 2 * pressure * duration / (math.pi * density * depth) * math.sin(math.pi * depth / (speed * duration))
    return duration / 2 + depth / speed, velocity


def spall_of_triangle(
    pressure: float, duration: float, density: float, speed: float, depth: float
) -> tuple[float, float]:
    """Return the same for a pulse with a steep front, P (1 - t / td): 2 a / c, and P/(rho a) 2a/c (1 - a/(c td))."""
    velocity = pressure / (density * depth) * 2 * depth / speed * (1 - depth / (speed * duration))
    return 2 * depth / speed, velocity


def slipping_joint(strength_ratio: float) -> Passage:
    """Return what a joint of strength s passes of a sine of stress z v0, with a = s / (z v0).

    T = clip(z v_i, -s, s); with th = asin a and q = pi/2 - th::

        T^2 = (2/pi)(th - a cos th + 2 a^2 q),   R^2 = (4/pi)(q/2 - 3 a cos(th)/2 + a^2 q)
    """
    a = min(strength_ratio, 1.0)
    th = math.asin(a)
    q = math.pi / 2 - th
    transmitted = 2 / math.pi * (th - a * math.cos(th) + 2 * a * a * q)
    reflected = 4 / math.pi * (q / 2 - 1.5 * a * math.cos(th) + a * a * q)
    return _passage(transmitted, reflected)


def slipping_spring_joint(strength_ratio: float, stiffness_ratio: float) -> Passage:
    """Return the same for a joint of stiffness kj, with kap = 2 kj / (z w), once transients have gone.

    While it sticks tau = T / (z v0) follows d tau / d(w t) = kap (sin w t - tau); it slips at tau = +-a until the
    incident wave falls below the strength. Below a = kap / sqrt(1 + kap^2) only.
    """
    from scipy.optimize import brentq

    a, kap = strength_ratio, stiffness_ratio
    share = kap / math.hypot(1, kap)
    if a >= share:
        return _passage(share * share, 1 - share * share)
    stop = math.pi - math.asin(a)  # where the slip with tau = a ends

    def steady(angle: ArrayLike) -> Array:
        return np.asarray(kap / (1 + kap * kap) * (kap * np.sin(angle) - np.cos(angle)))

    def sticking(angle: ArrayLike) -> Array:
        return steady(angle) + (a - steady(stop)) * np.exp(-kap * (np.asarray(angle) - stop))

    # tau falls from a as the incident wave does, and meets -a before that has its least value
    last = 1.5 * math.pi + math.atan(1 / kap)
    start = brentq(lambda angle: float(sticking(angle)) + a, stop, last, xtol=ROOT_TOLERANCE)
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE_POINTS)

    def integral(low: float, high: float, values_at: Callable[[Array], Array]) -> float:
        half = (high - low) / 2
        return float(half * weights @ values_at(low + half * (1 + nodes)))

    slipping = stop + math.pi - start
    transmitted = integral(stop, start, lambda x: sticking(x) ** 2) + a * a * slipping
    reflected = integral(stop, start, lambda x: (np.sin(x) - sticking(x)) ** 2)
    reflected += integral(start, stop + math.pi, lambda x: (np.sin(x) + a) ** 2)
    return _passage(2 / math.pi * transmitted, 2 / math.pi * reflected)


def _passage(transmitted: float, reflected: float) -> Passage:
    """Roots of the shares of the energy."""
    return Passage(*(math.sqrt(max(share, 0.0)) for share in (transmitted, reflected, 1 - transmitted - reflected)))


def residual_slip(velocity: float, duration: float, strength: float, impedance: float) -> float:
    """Return what a rigid joint in an infinite medium has slipped after a half-sine pulse of the particle velocity [m].

    It slips while z v0 sin(pi t / td) > s, from t1 to t2 = td - t1, by
    2 v0 / w (cos w t1 - cos w t2) - 2 s (t2 - t1) / z.

    Parameters
    ----------
    velocity
        v0, greatest of the pulse [m/s].
    duration
        td [s].
    strength
        s [Pa].
    impedance
        z of the medium [Pa s/m].
    """
    ratio = strength / (impedance * velocity)
    if ratio >= 1:
        return 0.0
    w = math.pi / duration
    first = math.asin(ratio) / w
    last = duration - first
    return 2 * velocity / w * (math.cos(w * first) - math.cos(w * last)) - 2 * strength * (last - first) / impedance
