"""Two finite-element codes of different families on one mesh: scikit-fem and FEniCSx, on one rank and on two."""

from __future__ import annotations

import math

from validation.scenes.scene import Scene
from validation.suite.bands import Band, near

SAME = 1e-10  # of the maximum


def carried(scene: Scene) -> float:
    """Static contact pressure [Pa]: the vertical load q L on the top, resolved normal to the base, over its length."""
    (x0, y0), (x1, y1) = scene.block.edge(scene.block.top)
    (ax, _), (bx, _) = scene.block.edge(scene.block.base)
    return scene.load.pressure * math.hypot(x1 - x0, y1 - y0) * (bx - ax) / scene.block.base_length**2


def equilibrium(case: Scene) -> Band:
    """Return the static contact pressure of a polygon, which no elasticity enters [Pa]."""
    return near(carried(case), SAME)
