"""Scenes whose upright rectangle moves up and down only, as data and variant that fits step with."""

from __future__ import annotations

from validation.diagnosis.variant import Rectangle, Variant
from validation.scenes import features
from validation.scenes.scene import Scene

OPENING = frozenset({features.UNILATERAL, features.DEAD_BAND, features.WEIGHT})  # that opening contact may come with


def rectangle_of(scene: Scene) -> Rectangle | None:
    """Return the data of a scene whose upright rectangle moves up and down only, else None."""
    b, c, load = scene.block, scene.contact, scene.load
    if not features.linear(scene) and not _opens_only(scene):
        return None
    vertical = load.eccentricity == load.traction == load.slope == 0 and load.base_motion is None
    if not (upright(scene) and vertical):
        return None
    (x0, y0), (x1, _), (_, y2), _ = b.outline
    springs = 2 * c.stiffness, 2 * c.shear
    material = b.density, b.young, b.poisson, b.hypothesis == "plane strain"
    return Rectangle(x1 - x0, y2 - y0, *material, *springs, load.pressure, load.gravity)


def upright(scene: Scene) -> bool:
    """Whether a scene's block is one upright rectangle on its lower edge."""
    b = scene.block
    points = b.outline
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = points if len(points) == 4 else ((0.0, 0.0),) * 4
    rectangle = y0 == y1 and x1 == x2 and y2 == y3 and x3 == x0 and x1 > x0 and y2 > y1
    return rectangle and b.base == 0 and b.top == 2 and b.subdivide is None


def _opens_only(scene: Scene) -> bool:
    """Whether a scene is not linear for its contact that opens alone, which touches and is at rest at first."""
    closing, opening = scene.contact.band
    at_rest = scene.contact.gap == 0 and scene.block.velocity == 0
    return set(features.of(scene)) <= OPENING and at_rest and (closing > 0 or opening == 0)


def own_variant(scene: Scene) -> Variant:
    """Return the scene's own scheme and contact, nothing added."""
    t, (closing, opening) = scene.time, scene.contact.band
    opens = scene.contact.law == "unilateral"
    ratio = opening / closing if closing else 0.0
    return Variant(t.alpha, t.delta, t.discount, t.start, opens=opens, band=closing, reopening=ratio)
