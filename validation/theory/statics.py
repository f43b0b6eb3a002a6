"""Statics of an upright rectangle on its corner springs under a vertical pressure."""

from __future__ import annotations

from validation.scenes.scene import Scene


def moduli(scene: Scene) -> tuple[float, float]:
    """Return (E', mu') that turn the plane-stress formulas into the scene's hypothesis.

    Plane strain: E' = E / (1 - mu^2), mu' = mu / (1 - mu).
    """
    E, mu = scene.block.young, scene.block.poisson
    return (E, mu) if scene.block.hypothesis == "plane stress" else (E / (1 - mu * mu), mu / (1 - mu))


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
