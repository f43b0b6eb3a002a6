"""Variations of a scene, as keys and values: a datum times a factor; a scheme and blocks that are accurate."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from validation.scenes.scene import Scene

Values = dict[str, Any]
AVERAGE: Values = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
MORE_BLOCKS = 4


def springs(scene: Scene, factor: float) -> Values:
    """Return the springs, the shear springs with them where they are stated."""
    c = scene.contact
    stiffness = {"contact.stiffness": c.stiffness * factor}
    return stiffness | ({"contact.shear_stiffness": c.shear_stiffness * factor} if c.shear_stiffness else {})


def friction(scene: Scene, factor: float) -> Values:
    """Return the angle of friction [deg] whose tangent is larger by a factor."""
    tangent = factor * math.tan(math.radians(scene.contact.friction or 0.0))
    return {"contact.friction": math.degrees(math.atan(tangent))}


def layers(key: str) -> Callable[[Scene, float], Values]:
    """Return the function that makes a datum of all layers of a column larger by a factor."""
    return lambda s, f: {"column.layer": [layer | {key: layer[key] * f} for layer in s.definition()["column"]["layer"]]}


def sized(scene: Scene, wider: float, higher: float) -> Values:
    """Return the outline, stretched."""
    if scene.block.vertices is not None:
        return {"block.vertices": [[x * wider, y * higher] for x, y in scene.block.vertices]}
    width, height = scene.block.outline[2]
    return {"block.width": width * wider, "block.height": height * higher}


def accurate(scene: Scene) -> Values:
    """Return a scheme that does not damp and, of a column, more blocks; the step is left to who asks."""
    if scene.column is None:
        return dict(AVERAGE)
    layers_of_scene = scene.definition()["column"]["layer"]
    return AVERAGE | {"column.layer": [one | {"blocks": MORE_BLOCKS * one.get("blocks", 1)} for one in layers_of_scene]}
