r"""What a time step makes of the impact of a rigid mass: its rebound by scheme, contact and phase.

A mass comes down at the speed V, unloaded, on a contact that carries no tension. In units of V and of the step, with
W = sqrt(k/m) dt and zeta = c/(2 sqrt(k m)), the contact presses at the end of a stage (`validation.theory.stages`) with

    N1 = max(0, -(W^2 x1 + 2 zeta W v1)) = max(0, -(W^2 x_f + 2 zeta W v_f) / (1 + W^2 C + 2 zeta W D)) where x_f < 0,

x_f and v_f those of the stage without N1, C and D what a unit of it adds. It is closed by the *free* gap x_f: by the
gap at the end there is no answer where the dashpot alone stops the mass. W = inf is the rigid stop in displacements
(a linear complementarity problem, LCP), N1 = max(0, -x_f / C), and the limit of augmented Lagrangian passes.

The phase theta is the overshoot of the first step that would end below the contact, over V dt: uniform from 0 to 1.
The rebound e is the speed after it over that before it. Under generalised alpha v goes on changing in flight, by the
powers of am/(am - 1): it is read `FLIGHT` steps after the last force, or when a is 0. There is no discount: it would
change flights.

Kane's rule is Newmark's (1/2, 1) here (a rigid mass has nothing but the contact's force), symplectic Euler is
leapfrog, and a soft constraint is implicit Euler with zeta.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from validation.runs.history import Array
from validation.theory.stages import Stages

FLIGHT = 80
"""Steps without force after which e is read where an acceleration is left."""
LONGEST = 200_000
"""Steps after which a mass that is still pressed counts as stuck."""
REST = 1e-18
"""Position, speed, acceleration and force below which the mass has come to rest, in units of V and the step."""


class Motion(NamedTuple):
    """State of the mass in all phases at the end of a step, in units of V and the step."""

    x: Array
    v: Array
    a: Array
    N: Array  # contact force
    pressed: Array  # greatest contact force at the end of any stage of the step


class ReboundStatistics(NamedTuple):
    """Restitution over the phases."""

    mean: float
    least: float
    most: float
    mean_square: float  # share of the energy that is left


Advance = Callable[[Motion], Motion]


def midpoints(count: int) -> Array:
    """Return the phases at the middles of equal parts, (i + 1/2) / count."""
    return (np.arange(count) + 0.5) / count


def spring_steps(stages: Stages, omega: float | Array, zeta: float = 0.0) -> Advance:
    """Return the step on a spring, with a dashpot if zeta > 0, or on a rigid stop if omega is infinite.

    W = omega is finite in an explicit scheme, or an array of finite numbers, one for each phase.
    """
    is_rigid = bool(np.any(np.isinf(omega)))

    def advance(start: Motion) -> Motion:
        u = start.v
        before = start._replace(pressed=np.zeros_like(start.N))
        for stage in stages:
            x, v = stage.ahead(start.x, u, start.a, before.v, before.a)
            a = (stage.af * before.N - stage.am * before.a) / (1 - stage.am)
            x = x + stage.beta * a
            v = v + stage.gamma * a
            weight = stage.equilibrium_weight
            N = pressing_force(omega, zeta, x, v, stage.beta * weight, stage.gamma * weight)
            x = x + stage.beta * weight * N
            if is_rigid:
                x = np.where(N > 0, 0.0, x)  # and not the rounding of a difference, which would close it again
            before = Motion(x, v + stage.gamma * weight * N, a + weight * N, N, np.maximum(before.pressed, N))
        return before

    return advance


def pressing_force(omega: float | Array, zeta: float, x: Array, v: Array, C: float, D: float) -> Array:
    """Return N1 from the free gap and rate at the end of a stage, and what a unit of force adds to both."""
    if np.any(np.isinf(omega)):
        force = -x / C
    else:
        k = omega * omega
        c = 2 * zeta * omega
        force = -(k * x + c * v) / (1 + k * C + c * D)
    return np.where(x < 0, np.maximum(force, 0.0), 0.0)


def conserving_steps(omega: float | Array) -> Advance:
    """Return the step of energy-conserving contact (Armero and Petocz 1998), N = -(U1 - U0)/(x1 - x0).

    Raises ValueError for infinite omega: a rigid stop stores no energy.
    """
    if np.any(np.isinf(omega)):
        raise ValueError("omega: must be finite with energy-conserving contact, got inf")
    k = omega * omega

    def advance(start: Motion) -> Motion:
        u = start.v
        w0 = start.x
        free = w0 + u
        # pressed before and after, then lifting off, then landing with the penetration d
        pressed = -(free + w0) / (0.5 + 2 / k)
        rise = free - w0
        lifting = np.sqrt(rise**2 + k * w0**2) - rise
        above = np.maximum(w0, 0.0)
        half = (above + free) / (k / 2 + 2)
        d = np.sqrt(half**2 + 2 * np.maximum(-free, 0.0) * above / (k / 2 + 2)) - half
        way = np.where(above + d > 0, above + d, 1.0)
        landing = k * d**2 / (2 * way)
        N = np.where(w0 < 0, np.where(2 * pressed >= -k * w0, pressed, lifting), np.where(free < 0, landing, 0.0))
        return Motion(free + N / 2, u + N, 0 * u, N, N)

    return advance


def rebounds(advance: Advance, theta: ArrayLike) -> Array:
    """Return e at the phases theta, from 0 to 1; 0 where the mass comes to rest on the contact."""
    phases = np.atleast_1d(np.asarray(theta, float))
    e = np.zeros_like(phases)
    zero = np.zeros_like(phases)
    motion = Motion(1 - phases, zero - 1, zero, zero, zero)
    is_over = phases < 0
    flight = np.full(len(phases), -math.inf)  # steps without force since the last one with it
    for _ in range(LONGEST):
        motion = advance(motion)
        flight = np.where(motion.pressed > 0, 0, flight + 1)
        is_free = (flight >= FLIGHT) | (flight > 0) & (motion.a == 0)
        leaves = ~is_over & is_free & (motion.v >= 0)
        e[leaves] = motion.v[leaves]
        is_over |= leaves | (sum(map(np.abs, motion)) < REST)
        if is_over.all():
            break
    return e


def rebound_statistics(advance: Advance, count: int = 100) -> ReboundStatistics:
    """Return the statistics of the rebound over `count` phases at the middles of equal parts."""
    e = rebounds(advance, midpoints(count))
    return ReboundStatistics(float(e.mean()), float(e.min()), float(e.max()), float((e * e).mean()))
