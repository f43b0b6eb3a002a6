"""Rigid boxes as a figure."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from validation.models.rigid.tables import RigidSection
from validation.report.figures.drawing import LONGEST, FigureHooks, Sketch, rotation
from validation.scenes.scene import Scene


class HOOKS(FigureHooks):
    """Boxes on the ground."""

    def draw(self, axes: Any, scene: Scene) -> None:
        """Draw the boxes with their velocities."""
        section = scene.table(RigidSection)
        bodies = []
        for box, (x, y, angle) in zip(section.box, section.starts, strict=True):
            corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * (box.width / 2, box.height / 2)
            bodies.append(corners @ rotation(angle) + (x, y))
        sketch = Sketch(axes, bodies, section.slope)
        sketch.ground(moves=section.base_amplitude != 0)
        for box, (x, y, _) in zip(section.box, section.starts, strict=True):
            speed = math.hypot(*box.velocity)
            if speed:
                sketch.arrow((x, y), LONGEST * sketch.size * np.array(box.velocity) / speed, f"{speed:.3g} m/s")
        sketch.fit()
