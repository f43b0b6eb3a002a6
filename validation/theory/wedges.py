r"""An active wedge on a plane that dips by a1 drives a passive one out on a plane that dips by a2, both rigid.

With p the angle of friction below them and q that between them, whose interface is vertical, P the force through it,

    A1 cos a1 = A2 cos a2,
    m1 A1 cos p = W1 sin(a1 - p) - P cos(a1 - p - q),      m2 A2 cos p = P cos(p - a2 + q) - W2 sin(p - a2).

Neither turns where the resultants fit into the faces. With tan p and tan q divided by the factor of safety neither
moves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import brentq


@dataclass(frozen=True)
class Wedges:
    """Two wedges, the active one first."""

    masses: tuple[float, float]  # kg
    dips: tuple[float, float]  # of the planes they slide on [rad]
    below: float  # tan(phi)
    between: float  # tan(delta)
    gravity: float  # m/s2

    def motion(self) -> dict[str, float]:
        """Return accelerations down the planes [m/s2] and normal forces [N] of wedges that slide."""
        (m1, m2), (a1, a2), g = self.masses, self.dips, self.gravity
        p = math.atan(self.below)
        q = math.atan(self.between)

        def active(P: float) -> float:
            return (m1 * g * math.sin(a1 - p) - P * math.cos(a1 - p - q)) / (m1 * math.cos(p))

        def left_over(P: float) -> float:
            A2 = (P * math.cos(p - a2 + q) - m2 * g * math.sin(p - a2)) / (m2 * math.cos(p))
            return A2 * math.cos(a2) - active(P) * math.cos(a1)

        P = brentq(left_over, 0.0, (m1 + m2) * g, xtol=1e-6, rtol=1e-14)
        return {
            "active": active(P),
            "passive": active(P) * math.cos(a1) / math.cos(a2),
            "interface": P * math.cos(q),
            "active base": m1 * g * math.cos(a1) + P * math.sin(a1 - q),
            "passive base": m2 * g * math.cos(a2) - P * math.sin(a2 - q),
        }

    @property
    def factor_of_safety(self) -> float:
        """F by which tan(phi) and tan(delta) are divided where the wedges are at their limit.

        What the active one pushes with is what the passive one resists, for p between a2 and a1:
        m1 sin(a1 - p) / cos(a1 - p - q) = m2 sin(p - a2) / cos(p - a2 + q).
        """
        (m1, m2), (a1, a2) = self.masses, self.dips

        def left_over(F: float) -> float:
            p = math.atan(self.below / F)
            q = math.atan(self.between / F)
            push = m1 * math.sin(a1 - p) / math.cos(a1 - p - q)
            return push - m2 * math.sin(p - a2) / math.cos(p - a2 + q)

        least = self.below / math.tan(a1) * (1 + 1e-9)
        most = self.below / math.tan(a2)
        return float(brentq(left_over, least, most, xtol=1e-15, rtol=1e-14))
