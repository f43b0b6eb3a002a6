r"""Motions in closed form or by quadrature: a strained block that spins, and a rigid one that tips over a ledge.

A block of one strain whose centroid rests maps its outline by F (four numbers), with the density times the second
moments S of the unstrained outline. In axes that do not turn its kinetic energy is tr(F' S F'^T) / 2, and

    F'' S = -A dw/dF,     w = G |U - I|^2 + L/2 (tr U - 2)^2,     U^2 = F^T F,     L = E nu / (1 - nu^2)

for the linear law in Biot's strain under plane stress. In the plane tr U = t = sqrt(|F|^2 + 2 det F) and
|U - I|^2 = |F|^2 - 2 t + 2, so that with dt/dF = (F + cof F) / t the stress is

    dw/dF = 2 G F + (L (t - 2) - 2 G) (F + cof F) / t:

no polar decomposition, no turning axes and no inertia that depends on the strain.

A square that spins at H has the strain at which its stress holds the centrifugal force, w0^2 / s^3 = wb^2 (s - 1).

A rigid block b x h slides on a ledge, its face on the corner; s is the place of its centre along the face beyond the
corner, theta its turn clockwise, sigma the sign of s', N the normal force over the mass, r^2 = (b^2 + h^2) / 12:

    N = (g cos th - 2 s' th' - h th'^2 / 2) / (1 + s q / r^2),   q = s + sigma mu h / 2
    th'' = N q / r^2,     s'' = g sin th - sigma mu N - h th'' / 2 + s th'^2

It tips when q = 0: friction moves the reaction forward by mu h / 2.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from validation.runs.history import Array

TOLERANCE = 1e-13


@dataclass(frozen=True)
class Spinning:
    """A free rectangle of one strain that is set spinning without strain."""

    width: float  # m
    height: float  # m
    density: float  # kg/m3
    young: float  # Pa
    poisson: float
    spin: float  # rad/s

    @property
    def moments(self) -> Array:
        """Density times the second moments of the outline, of x and y [kg m2]."""
        mass = self.density * self.width * self.height
        return mass * np.array([self.width**2, self.height**2]) / 12

    @property
    def momentum(self) -> float:
        """Angular momentum [kg m2/s]."""
        return self.spin * float(np.sum(self.moments))

    @functools.lru_cache(maxsize=16)  # noqa: B019  # a run of a refinement ends where the others do
    def motion(self, end: float) -> Any:
        """Return F, row by row, and its rates as a function of the time up to an end [s]."""
        area = self.width * self.height
        shear = self.young / (2 * (1 + self.poisson))
        lame = self.young * self.poisson / (1 - self.poisson**2)

        along, across = (float(area / moment) for moment in self.moments)

        def rate(_: float, state: Array) -> list[float]:
            a, b, c, d, *rates = state.tolist()  # F = [[a, b], [c, d]]
            t = math.hypot(a + d, b - c)
            apart = (lame * (t - 2) - 2 * shear) / t
            of_diagonal = apart * (a + d)  # F + cof F has one number on its diagonal, and one beside it twice
            beside = apart * (b - c)
            return [
                *rates,
                -along * (2 * shear * a + of_diagonal),
                -across * (2 * shear * b + beside),
                -along * (2 * shear * c - beside),
                -across * (2 * shear * d + of_diagonal),
            ]

        start = np.array([1.0, 0.0, 0.0, 1.0, 0.0, -self.spin, self.spin, 0.0])
        return solve_ivp(rate, (0.0, end), start, "DOP853", dense_output=True, rtol=TOLERANCE, atol=1e-15).sol

    def at(self, times: Array) -> dict[str, Array]:
        """Return angle [rad] and strains of the block's own axes at some times [s]."""
        a, b, c, d = self.motion(float(times[-1]))(times)[:4]  # F = [[a, b], [c, d]] = Q U
        angle = np.unwrap(np.arctan2(c - b, a + d))
        cosine = np.cos(angle)
        sine = np.sin(angle)
        return {
            "angle": angle,
            "ex": cosine * a + sine * c - 1,
            "ey": cosine * d - sine * b - 1,
            "gxy": (cosine * b + sine * d) + (cosine * c - sine * a),
        }

    @property
    def steady_strain(self) -> float:
        """The strain of a square that has come to spin steadily with the momentum that it started with."""
        stiffness = self.young / (1 - self.poisson)
        wb2 = 12 * stiffness / (self.density * self.width**2)
        return float(brentq(lambda s: self.spin**2 / s**3 - wb2 * (s - 1), 1.0, 2.0, xtol=1e-16, rtol=1e-15)) - 1


@dataclass(frozen=True)
class Slide:
    """A rigid block that slides over a table, and over its ledge at x = 0 if it comes so far."""

    width: float  # b [m]
    height: float  # h [m]
    friction: float  # mu
    start: float  # place of the centre at t = 0, below 0 [m]
    speed: float  # at t = 0 [m/s]
    gravity: float = 9.81

    @property
    def stopping_distance(self) -> float:
        """The way to rest [m]; without end where it is frictionless."""
        return self.speed**2 / (2 * self.friction * self.gravity) if self.friction else math.inf

    @property
    def tips(self) -> tuple[float, float] | None:
        """When it tips [s] and how fast it is then [m/s]; None where it stops before."""
        way = -self.friction * self.height / 2 - self.start
        if way >= self.stopping_distance:
            return None
        slowing = self.friction * self.gravity
        speed = math.sqrt(self.speed**2 - 2 * slowing * way)
        return 2 * way / (self.speed + speed), speed

    def turn(self, time: float) -> float:
        """Return the turn, clockwise, at a time before the slide over the ledge ends [rad]."""
        tips = self.tips
        if tips is None or time <= tips[0]:
            return 0.0
        mu = self.friction
        h = self.height
        g = self.gravity
        r2 = (self.width**2 + h**2) / 12

        def rate(_: float, state: Array) -> list[float]:
            s, theta, ds, dtheta = state
            q = s + mu * h / 2
            N = (g * math.cos(theta) - 2 * ds * dtheta - h * dtheta**2 / 2) / (1 + s * q / r2)
            faster = N * q / r2
            return [ds, dtheta, g * math.sin(theta) - mu * N - h * faster / 2 + s * dtheta**2, faster]

        begin = [-mu * h / 2, 0.0, tips[1], 0.0]
        solution = solve_ivp(rate, (tips[0], time), begin, "DOP853", rtol=TOLERANCE, atol=1e-15)
        if solution.y[2, -1] <= 0:
            raise ValueError(f"time: must be before the slide ends, got {time:g}")
        return float(solution.y[1, -1])
