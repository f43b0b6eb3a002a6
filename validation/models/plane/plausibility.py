"""Values of blocks in the plane that no rock has."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from validation.models.plane.tables import PlaneSection
from validation.scenes.plausibility import Implausible, PlausibilityHooks, friction, judged, material, stepping
from validation.scenes.scene import Scene


class HOOKS(PlausibilityHooks):
    """What the values of blocks in the plane are held against."""

    def values(self, scene: Scene) -> Iterator[Implausible]:
        """Yield what the material under the greatest stress says, and the steps."""
        plane = scene.table(PlaneSection)
        largest = max([*map(abs, plane.stress), *(math.hypot(*traction) for _, traction in plane.tractions)])
        if math.isfinite(plane.young):
            speed = math.sqrt(plane.young / plane.density)
            yield from material("plane", plane.density, plane.young, speed, {"plane.load": largest / plane.young})
        yield from stepping(scene)
        if plane.contact is not None:
            yield from friction("plane.contact.friction", plane.contact.friction)
        yield from judged("gravity", "plane.gravity", math.hypot(*plane.gravity))
        for number, block in enumerate(plane.block):
            yield from judged("size", f"plane.block.{number}", max(np.ptp(block.outline, axis=0)))
