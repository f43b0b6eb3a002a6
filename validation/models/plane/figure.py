"""Blocks in the plane as a figure."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from validation.models.plane.tables import PlaneSection
from validation.report.figures.drawing import LONGEST, FigureHooks, Sketch, along
from validation.scenes.scene import Scene


class HOOKS(FigureHooks):
    """Blocks as they are cut."""

    def draw(self, axes: Any, scene: Scene) -> None:
        """Draw blocks as they are cut, clamps hatched, loads as arrows."""
        plane = scene.table(PlaneSection)
        sketch = Sketch(axes, plane.polygons)
        for clamp in plane.clamp:
            sketch.hatched(clamp.edge)
        largest = max([math.hypot(*load.traction) for load in plane.load], default=0.0)
        for load in plane.load:
            vector = LONGEST * sketch.size * np.array(load.traction) / largest
            for tail in along(load.edge):
                sketch.arrow(tail, vector)
        if any(plane.gravity):
            sketch.arrow(
                sketch.middle, LONGEST * sketch.size * np.array(plane.gravity) / math.hypot(*plane.gravity), "g"
            )
        sketch.fit()
