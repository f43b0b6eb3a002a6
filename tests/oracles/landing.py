"""Closed forms of landing and lifting off: the block that lifts off under its load, rigid contact, the stiff bar."""

from __future__ import annotations

import math
from dataclasses import dataclass

from mpmath import cos, exp, findroot, mp, mpf, sin, sqrt

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


def micro_impacts() -> MicroImpacts:
    """Impacts of a block that comes down unstrained on rigid ground, mu = 0: the limit of stiff springs.

    Its base has the velocity w' = v' - (b / 2) e' and the effective mass m / 4: each impact is elastic for the
    base alone, with the impulse J = m |w'| / 2, after which v' += J / m, e' -= (b / 2) J / (m b^2 / 12), and
    the block flies on and vibrates at sqrt(12) c / b until its base lands again. None of this depends on data.
    """
    with mp.workdps(DIGITS):
        w = sqrt(mpf(12))
        v, e, rate, now = mpf(-1), mpf(0), mpf(0), mpf(0)
        times: list[float] = []
        while True:
            times.append(float(now))
            speed = abs(v - rate / 2)
            v, rate = v + speed / 2, rate - 3 * speed

            def gap(t: mpf, e: mpf = e, v: mpf = v, rate: mpf = rate) -> mpf:
                return e / 2 + v * t - (e * cos(w * t) + rate / w * sin(w * t)) / 2

            # the base swings by less than its amplitude about a line: after this it is down, or up for good
            last = 2 * (abs(e) + abs(rate) / w) / abs(v) + 2
            grid = [last * i / 2000 for i in range(1, 2001)]
            below = next((i for i, t in enumerate(grid) if gap(t) < 0), None)
            if below is None:
                return MicroImpacts(tuple(times), float(v))
            fall = findroot(gap, (grid[below - 1], grid[below]), solver="anderson")
            e, rate = e * cos(w * fall) + rate / w * sin(w * fall), rate * cos(w * fall) - e * w * sin(w * fall)
            now += fall


def stiff_opening() -> float:
    """The x* > 0 with exp(x) = 1 + 2 x^2: a touching bar on a stiff spring opens first at 5 H / c + x* / kappa.

    kappa = k / (W rho c) [1/s]. Its gap then grows at the rate (q / (rho c)) (8 x e^-x - 2).
    """
    with mp.workdps(DIGITS):
        return float(findroot(lambda x: exp(x) - 1 - 2 * x * x, (mpf("0.5"), mpf(1)), solver="anderson"))
