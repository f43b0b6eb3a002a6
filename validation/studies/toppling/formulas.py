"""The study `toppling`: the cases of the manuals of block codes, and the growth by first-order rotation.

A block on a slope stands, slides or topples: with friction a tenth of a degree above and below the slope, with half of
the friction that it needs, and as a tower whose centroid stands beyond its lower corner.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.optimize import brentq

from validation.metrics.rotation import crossing, increments
from validation.runs.history import History
from validation.runs.row import Metrics
from validation.scenes.scene import Scene
from validation.suite.bands import Band, Bands, about, cases, short
from validation.theory.friction import coefficient, sliding_acceleration
from validation.theory.rocking import rectangle, settlement

TURN = 0.5  # by which falling blocks are timed [rad]


def beyond(scene: Scene) -> float:
    """Return the angle of the centroid beyond the vertical through the lower corner at t = 0 [rad]."""
    return math.radians(scene.load.slope - scene.block.tilt) - rectangle(scene).alpha


def static(scene: Scene, history: History) -> Metrics:
    """Return how far the block moves in the second half of its steps, over what it slides, or its width if it stands.

    A step without velocities moves a sliding block by dt^2 / 2 times its acceleration.
    """
    u = history.columns["horizontal_displacement"]
    steps = scene.time.steps
    displacement = float(u[-1] - u[steps // 2 - 1])
    sliding_distance = (steps - steps // 2) * scene.time.step**2 / 2 * sliding_acceleration(scene)
    return {"moved": displacement / (sliding_distance if sliding_distance > 0 else rectangle(scene).width)}


def slide(scene: Scene, history: History) -> Metrics:
    """Return what the sliding identity leaves, and the run-out over that of a rigid block.

    While both corners slip or are open u + tan(phi) v is a t^2 / 2, a = g (sin b - tan(phi) cos b).
    """
    u = history.columns["horizontal_displacement"]
    v = history.displacement
    sliding_distance = sliding_acceleration(scene) * history.time**2 / 2
    return {
        "identity": np.max(np.abs(u + coefficient(scene) * v - sliding_distance)) / sliding_distance[-1],
        "run-out": u[-1] / sliding_distance[-1],
    }


def fall(scene: Scene, history: History) -> Metrics:
    """Return the time of a turn by `TURN` over a rigid block's, the greatest turn, and the area."""
    rotation = -history.columns["rotation"]
    values = {"turned": np.max(np.abs(rotation))}
    if beyond(scene) > 0:
        exact = rectangle(scene).fall_time(beyond(scene), TURN)
        values["time"] = crossing(history.time, rotation, TURN) / exact
    if "area" in history.columns:
        expected_area = float(np.prod(1 + increments(history) ** 2)) if scene.run.rotation == "first-order" else 1.0
        values["growth"] = float(history.columns["area"][-1]) - 1
        values["area"] = float(history.columns["area"][-1]) / expected_area
    return values


def run_out(case: Scene) -> Band:
    """Return the run-out of a sliding block over a rigid one's."""
    sliding_distance = sliding_acceleration(case) * case.time.duration**2 / 2
    return 1.0, 1 + coefficient(case) * settlement(case) / sliding_distance


def standing(case: Scene) -> Band:
    """Return the turn of a standing tower when gravity begins [rad]."""
    return 0.0, 2 * settlement(case) / rectangle(case).width


def from_rest(case: Scene) -> Band:
    """Return the time in which a tower falls, over a rigid block's."""
    exact = rectangle(case).fall_time(beyond(case), TURN)
    return 1 - lifted(case) / exact, 1 + straight(case)


def lifted(scene: Scene) -> float:
    """Return the time that the impulse of the upper corner can save [s].

    An impulse J gives the turn the rate J a / I, and psi = psi0 cosh(P t) is then ahead by that over psi0 P^2.
    """
    block = rectangle(scene)
    p = scene.contact.stiffness
    m = scene.block.density * block.width * block.height
    impulse = m * block.gravity * math.cos(math.radians(scene.load.slope)) * math.pi * math.sqrt(m / (2 * p))
    inertia = m * (block.width**2 + block.height**2) / 3
    return impulse * block.width / inertia / (beyond(scene) * block.rate2)


def straight(scene: Scene) -> float:
    """Return the error of a straight line within a step, relative to the time of the fall: (dt/T)^2."""
    return (scene.time.step / rectangle(scene).fall_time(beyond(scene), TURN)) ** 2


def let_go(case: Scene) -> Bands:
    """Return time, area and growth of a tower released on its lower corner, by its kind of rotation."""
    block = rectangle(case)
    grown = growth(case)
    strain = 4 * case.block.density * block.gravity * block.height / case.block.young
    slack = 2 * settlement(case) / block.width / beyond(case) + straight(case)
    if case.run.rotation == "first-order":
        slack += grown
    return {
        "time": about(1.0, slack),
        "area": about(1.0, strain),
        "growth": about(grown, 2 * slowed(case) * grown**2 + strain),
    }


def slowed(scene: Scene) -> float:
    """Return P T / 2 + 3/4, by how much of itself the growth lessens the growth [-]."""
    return math.sqrt(rectangle(scene).rate2) * scene.time.duration / 2 + 0.75


def growth(scene: Scene) -> float:
    """Return the growth of the area by first-order rotation of a rigid block, dt times the integral of psi'^2 [-]."""
    return scene.time.step * rectangle(scene).squared_rate(beyond(scene), scene.time.duration)


def data() -> Mapping[str, Any]:
    """Return the fall of the rigid tower from its corner, over the time that is run."""
    (case,) = cases("toppling-fall")
    block = rectangle(case)
    last = brentq(lambda turn: block.fall_time(beyond(case), turn) - case.time.duration, 1e-6, math.pi / 2)
    turns = np.linspace(0.0, last, 101)[1:]
    return {"rigid": {"turn": short(turns), "time": short([block.fall_time(beyond(case), turn) for turn in turns])}}
