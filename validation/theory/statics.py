"""Statics of an upright rectangle on its corner springs under a vertical pressure."""

from __future__ import annotations

import numpy as np

from validation.runs.history import Array
from validation.scenes.scene import Scene


def moduli(scene: Scene) -> tuple[float, float]:
    """Return (E', mu') that turn the plane-stress formulas into the scene's hypothesis."""
    return plane_moduli(scene.block.young, scene.block.poisson, scene.block.hypothesis)


def plane_moduli(young: float, poisson: float, hypothesis: str) -> tuple[float, float]:
    """Return (E', mu') of a material; plane strain: E' = E / (1 - mu^2), mu' = mu / (1 - mu)."""
    if hypothesis == "plane stress":
        return young, poisson
    return young / (1 - poisson * poisson), poisson / (1 - poisson)


def elasticity(young: float, poisson: float) -> Array:
    """Return the stresses over the strains (ex, ey, gxy) of plane stress [Pa], shape (3, 3)."""
    return young / (1 - poisson**2) * np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, (1 - poisson) / 2]])


def size(scene: Scene) -> tuple[float, float]:
    """Width and height of the rectangle [m]."""
    (x0, y0), (x1, _), (_, y2), _ = scene.block.outline
    return x1 - x0, y2 - y0


def height(scene: Scene) -> float:
    """Return the height of the block [m]."""
    return scene.block.extent[1]


def static_displacement(scene: Scene) -> float:
    """Static v of the centroid on corner springs [m].

    Square, p = ps, plane stress: -(a q / 2 p) [2 E^2 + 3 E p + (1 - mu^2) p^2] / [E (2 E + p)]; here from the three
    equations of equilibrium of (v, ex, ey) on a w x h rectangle, with the lateral strain eliminated.
    """
    E, mu = moduli(scene)
    w, h = size(scene)
    q, p, ps = scene.load.pressure, scene.contact.stiffness, scene.contact.shear
    plate = E / (1 - mu * mu)
    lateral = plate + ps * w / (2 * h)  # stress per ex, springs included
    strain = -q / (plate * (1 - mu * mu * plate / lateral))
    return -q * w / (2 * p) + h / 2 * strain
