"""Ways of sliding blocks by recursions of the scheme on a rigid mass, written apart from the solvers; in SI units."""

from __future__ import annotations

import math

import numpy as np

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory import friction
from validation.theory.stepping import Stepping

GRAVITY = 9.81
TOLERANCE = 1e-12  # of times, which are multiples of a step
FINE = 1e-5  # s: a step at which a sliding block is exact to four digits


def newmark_step(stepping: Stepping, omega: float) -> Array:
    """Return the map (x, dt v, dt^2 a) of a step of Newmark's scheme on one mode without load, shape (3, 3)."""
    alpha = stepping.alpha
    delta = stepping.delta
    predictor = np.array([1.0, stepping.gg, 0.5 - alpha])
    acceleration = -(omega**2) / (1 + alpha * omega**2) * predictor
    velocity = np.array([0.0, stepping.gg, 1 - delta]) + delta * acceleration
    return np.array([predictor + alpha * acceleration, velocity, acceleration])


def normal_ringing_error(scene: Scene, stiffness: float, step: float, start: float = 0.05, end: float = 0.2) -> float:
    """Return the largest error by ringing of a sliding block between two times, over its exact way.

    The block does not turn and stays closed: u_t = a t^2/2 - tan(phi) u_n, with u_n the normal ringing of the rigid
    block on its springs under its weight by the scheme.
    """
    w = math.sqrt(2 * stiffness / scene.block.mass)
    rest = friction.across(scene) / w**2
    matrix = newmark_step(Stepping(step, scene.time.alpha, scene.time.delta), w * step)
    time = np.arange(1, round(end / step) + 1) * step
    state = np.array([rest, 0.0, -rest * (w * step) ** 2])
    ringing = np.empty(len(time))
    for n in range(len(time)):
        state = matrix @ state
        ringing[n] = state[0] - rest
    way = friction.sliding_acceleration(scene) * time**2 / 2
    within = time >= start - TOLERANCE
    return float(np.max(np.abs(friction.coefficient(scene) * ringing / way)[within]))


def lagging_friction_error(scene: Scene, step: float, time: float) -> float:
    """Return the relative error of a sliding block whose friction is that of the step before, none at first."""
    without_friction = friction.coefficient(scene) * friction.across(scene) * step
    return without_friction * time / (friction.sliding_acceleration(scene) * time**2 / 2)


def shaken_way(step: float, gg: float, slope: float = 20.0, angle: float = 30.0, duration: float = 5.0) -> float:
    """Return the way of a rigid block on a plane shaken along it at 2.66 Hz with 0.28 g, by steps with a discount [m].

    v1 = max(0, gg v + dt a1), x1 = x + dt (gg v + v1)/2; the block does not slide uphill.
    """
    b = math.radians(slope)
    time = np.arange(1, round(duration / step) + 1) * step
    drive = GRAVITY * (math.sin(b) + 0.28 * np.sin(2 * math.pi * 2.66 * time))
    gained = step * (drive - math.tan(math.radians(angle)) * GRAVITY * math.cos(b))
    v = 0.0
    way = 0.0
    for change in gained.tolist():
        u = gg * v
        v = max(0.0, u + change)
        way += step * (u + v) / 2
    return way
