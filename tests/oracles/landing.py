"""Closed forms of landing and lifting off: the block that lifts off under its load, rigid contact, the stiff bar."""

from __future__ import annotations

import math
from dataclasses import dataclass

from mpmath import cos, findroot, mp, mpf

DIGITS = 40
"""Decimal digits of the computation."""


def first_landing(height: float, density: float, young: float) -> float:
    """Instant at which a touching block under a pressure lands after it has lifted off at t = 0 [s].

    With h = b / 2 the base of the free block stands at v - h e, v = -(q / (2 rho b)) t^2 and
    e = -(q / 2E) (1 - cos w t), w = sqrt(12 E / rho) / b, mu = 0: it lands at w t = tau, tau^2 / 6 = 1 - cos tau,
    whatever the pressure and the springs are.

    Parameters
    ----------
    height, density, young
        Height b [m], density [kg/m3] and Young's modulus [Pa], all positive.
    """
    with mp.workdps(DIGITS):
        tau = findroot(lambda x: x * x / 6 - 1 + cos(x), (mpf(2), mpf(4)), solver="anderson")
    return float(tau) * height * math.sqrt(density / (12 * young))


@dataclass(frozen=True)
class MicroImpacts:
    """Impacts of an unloaded block of one strain on rigid ground."""

    times: tuple[float, ...]  # instants of the impacts over b / c, c = sqrt(E / rho) [-]
    restitution: float  # momentum after the last impact over that before the first [-]
