r"""Half of a truss of two blocks on springs: rest, limit and motion in closed form.

The half, l x h, touches the abutment with its lower outer corner A and the middle with its upper inner corner C, which
is smooth. With D the diagonal, u its inclination, S the distance of both walls, and k = 1/(1/p + 1/c) of the springs
p at A and c at C in series, a crown load Q/2 on C and the half's weight W in its middle are balanced by

    H = k (D cos u - S),      2 H tan u = W + Q,

so that the load has a limit where cos^3 u = S/D, W + Q = 2 k D sin^3 u, beyond which the truss snaps through. A sticks
on a spring p and sinks by (W + Q/2)/p.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from validation.runs.history import Array


@dataclass(frozen=True)
class HalfTruss:
    """A half between abutment and middle, turned clockwise from the level."""

    length: float  # l [m]
    height: float  # h [m]
    mass: float  # kg
    turned: float  # at t = 0 [rad]
    place: tuple[float, float]  # of A at t = 0, from where it touches without force [m]
    span: float  # S [m]
    abutment: float  # p at A, across and along [N/m]
    crown: float  # c at C [N/m]
    gravity: float  # m/s2

    @property
    def diagonal(self) -> float:
        """Length, D [m]."""
        return math.hypot(self.length, self.height)

    @property
    def series(self) -> float:
        """Of both springs in series, k [N/m]."""
        return 1 / (1 / self.abutment + 1 / self.crown)

    @property
    def limit(self) -> tuple[float, float]:
        """Inclination at the limit [rad], and the load on the crown there, W left out [N]."""
        u = math.acos((self.span / self.diagonal) ** (1 / 3))
        return u, 2 * self.series * self.diagonal * math.sin(u) ** 3 - self.mass * self.gravity

    def rest(self, load: float) -> dict[str, float] | None:
        """Return turn [rad] and forces [N] at rest under a load on the whole crown, None where there is no rest."""
        limit, most = self.limit
        if load > most:
            return None
        flat = math.acos(self.span / self.diagonal)  # where the springs carry nothing
        whole = self.mass * self.gravity + load

        def left_over(u: float) -> float:
            return 2 * self.series * (self.diagonal * math.cos(u) - self.span) * math.tan(u) - whole

        u = brentq(left_over, limit, flat, xtol=1e-15, rtol=1e-14)
        thrust = self.series * (self.diagonal * math.cos(u) - self.span)
        return {
            "turn": math.atan2(self.height, self.length) - u,
            "thrust": thrust,
            "shear": self.mass * self.gravity + load / 2,
        }

    def motion(self, times: Array) -> Array:
        """Return x, y [m], turn [rad], N at A and C and the shear at A [N], a row a time, as it falls from t = 0 on.

        The equations of motion with all contacts closed, by Runge and Kutta's method of order 8.
        """
        half = self.diagonal / 2
        beta = math.atan2(self.height, self.length)
        inertia = self.mass * self.diagonal**2 / 12

        def forces(q: Array) -> tuple[float, float, float]:
            u = beta - q[2]
            x = q[0] - half * math.cos(u)
            y = q[1] - half * math.sin(u)
            far = q[0] + half * math.cos(u)
            return -self.abutment * x, self.crown * (far - self.span), -self.abutment * (y - self.place[1])

        def rate(_: float, q: Array) -> list[float]:
            u = beta - q[2]
            near, far, shear = forces(q)
            moment = half * (shear * math.cos(u) - (near + far) * math.sin(u))
            return [*q[3:], (near - far) / self.mass, shear / self.mass - self.gravity, moment / inertia]

        u = beta - self.turned
        start = [self.place[0] + half * math.cos(u), self.place[1] + half * math.sin(u), self.turned, 0.0, 0.0, 0.0]
        solution = solve_ivp(
            rate, (0.0, float(times[-1])), start, method="DOP853", rtol=1e-12, atol=1e-14, t_eval=times
        )
        return np.array([[*q[:3], *forces(q)] for q in solution.y.T])
