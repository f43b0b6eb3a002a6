"""Scenes whose upright rectangle moves up and down only, as the data that fits step with."""

from __future__ import annotations

from dda.one_block.variants import Column
from validation.scenes.scene import Scene


def rectangle_of(scene: Scene) -> Column | None:
    """Return the data of a scene whose upright rectangle moves up and down only, else None."""
    b, c, load = scene.block, scene.contact, scene.load
    points = b.outline
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = points if len(points) == 4 else ((0.0, 0.0),) * 4
    upright = y0 == y1 and x1 == x2 and y2 == y3 and x3 == x0 and x1 > x0 and y2 > y1
    vertical = load.eccentricity == load.traction == 0 and load.base_motion is None
    if not (upright and vertical and b.base == 0 and b.top == 2 and b.subdivide is None):
        return None
    modulus, mu = b.young, b.poisson
    if b.hypothesis == "plane strain":
        modulus, mu = modulus / (1 - mu**2), mu / (1 - mu)
    c11 = modulus / (1 - mu**2)
    springs = 2 * c.stiffness, 2 * c.shear
    return Column(x1 - x0, y2 - y1, b.density, c11, mu * c11, *springs, load.pressure, load.gravity)
