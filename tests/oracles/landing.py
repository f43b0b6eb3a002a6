"""Closed forms of landing and lifting off: the block that lifts off under its load, rigid contact, the stiff bar."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal

from fem_reference.events.decimals import HALF, ONE, ZERO, root, working
from fem_reference.events.oscillation import Oscillation

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
    with working(DIGITS):
        base = Oscillation((ONE, ZERO, -ONE / 6), ((ONE, -ONE, ZERO),))
        tau = base.first_fall(Decimal(4))
    return float(tau or ZERO) * height * math.sqrt(density / (12 * young))


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
    with working(DIGITS):
        half, w = HALF, Decimal(12).sqrt()
        v, e, rate, now = -ONE, ZERO, ZERO, ZERO
        times: list[Decimal] = []
        fall: Decimal | None = ZERO
        while fall is not None:
            now += fall
            times.append(now)
            speed = abs(v - half * rate)
            v, rate = v + speed / 2, rate - 3 * speed
            base = Oscillation((half * e, v, ZERO), ((w, -half * e, -half * rate / w),))
            fall = base.first_fall(2 * (base.size(ZERO) / abs(v) + 1))
            if fall is not None:
                shape = Oscillation((ZERO, ZERO, ZERO), ((w, e, rate / w),))
                e, rate, _ = shape(fall)
        return MicroImpacts(tuple(map(float, times)), float(v))


def stiff_opening() -> float:
    """The x* > 0 with exp(x) = 1 + 2 x^2: a touching bar on a stiff spring opens first at 5 H / c + x* / kappa.

    kappa = k / (W rho c) [1/s]. Its gap then grows at the rate (q / (rho c)) (8 x e^-x - 2).
    """
    with working(DIGITS):

        def miss(x: Decimal) -> tuple[Decimal, Decimal]:
            return x.exp() - 1 - 2 * x * x, x.exp() - 4 * x

        return float(root(miss, HALF, ONE))
