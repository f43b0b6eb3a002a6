"""The study `boxes`: boxes on a ground by `dda` beside `rigid-exact`, and what springs and steps may add.

A box has two corners on what is below it, each on a spring p. Where a scene asks for rigid contact, springs and steps
are DDA's own; a history keeps the rows alone.
"""

from __future__ import annotations

import math

import numpy as np

from validation.models.plane.canon import friction_of, moving_blocks, stiffness_of
from validation.models.plane.tables import OWN_STEP, OWN_STIFFNESS, PlaneSection
from validation.runs.history import History
from validation.runs.row import Metrics
from validation.scenes.scene import Scene
from validation.suite.bands import Band


def masses(case: Scene) -> list[float]:
    """Return the masses of the boxes from below [kg]."""
    return [block.mass for block in moving_blocks(case)]


def slide(case: Scene, own: History, exact: History) -> Metrics:
    """Return the box's lead at the end [m], and its normal force over the exact one, less one."""
    force = "box-ground.normal"
    return {
        "lead": own.columns["box.x"][-1] - exact.columns["box.x"][-1],
        "force": own.columns[force][-1] / exact.columns[force][-1] - 1,
    }


def rock(case: Scene, own: History, exact: History) -> Metrics:
    """Return the greatest rotation over the exact one, less one."""
    angle = "box.angle"
    return {"rotation": np.max(own.columns[angle]) / np.max(exact.columns[angle]) - 1}


def stack(case: Scene, own: History, exact: History) -> Metrics:
    """Return the sinking of the top over that of all springs, and the force below the lowest, each less one."""
    above = np.cumsum(masses(case)[::-1])
    springs = float(np.sum(above)) * -case.table(PlaneSection).gravity[1] / (2 * OWN_STIFFNESS)
    force = "A-ground.normal"
    return {
        "sinking": float(exact.columns["E.y"][-1] - own.columns["E.y"][-1]) / springs - 1,
        "force": own.columns[force][-1] / exact.columns[force][-1] - 1,
    }


def land(case: Scene, own: History, exact: History) -> Metrics:
    """Return the greatest force over the exact one, less one, and its size."""
    force = "box-ground.normal"
    error = float(np.max(own.columns[force]) / np.max(exact.columns[force]) - 1)
    return {"peak force": error, "peak size": abs(error)}


def settlement(case: Scene) -> Band:
    """Return the lead of a box that slides [m]: 0 to twice tan(phi) W/(2p), W across the slope."""
    plane = case.table(PlaneSection)
    settles = masses(case)[0] * -plane.gravity[1] / (2 * OWN_STIFFNESS)
    return 0.0, 2 * friction_of(plane) * settles


def corner_gives_way(case: Scene) -> Band:
    """Return 2 W/(p w) of a box of width w over the rotation at which it turns back."""
    plane = case.table(PlaneSection)
    block = next(block for block in plane.block if not block.fixed)
    width, height = block.rectangle or (0.0, 0.0)
    gravity = -plane.gravity[1]
    radius = math.hypot(width, height) / 2
    # cos(alpha - theta) = cos(alpha) + w^2 / (2 P^2), P^2 = 3 g / (4 R), alpha the slenderness
    alpha = math.atan2(width, height)
    rotation = alpha - math.acos(math.cos(alpha) + block.spin**2 * 2 * radius / (3 * gravity))
    half = 2 * masses(case)[0] * gravity / (OWN_STIFFNESS * width) / rotation
    return -half, half


def ringing(case: Scene) -> Band:
    """Return exp(-w^2 h T/4): the slowest vibration of the pile after T, damped by w h/4 of critical."""
    # Dunkerley: 1/w^2 is at most the sum of each mass alone on the springs below it.
    slowest = 1 / sum(mass * number / (2 * OWN_STIFFNESS) for number, mass in enumerate(masses(case), start=1))
    half = math.exp(-slowest * OWN_STEP * case.time.duration / 4)
    return -half, half


def closing(case: Scene) -> Band:
    """Return (w h)^2, w^2 = 2p/m."""
    half = 2 * stiffness_of(case) / masses(case)[0] * case.time.step**2
    return -half, half
