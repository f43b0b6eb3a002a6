"""A column as a figure."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from validation.models.column.tables import ColumnSection
from validation.report.figures.drawing import LONGEST, SPRING, FigureHooks, Sketch
from validation.scenes.scene import Scene

MOST_FACES = 60  # of a column; more lines would fill its layers
SLENDEREST = 0.3  # width of a column over its height


class HOOKS(FigureHooks):
    """Layers on each other."""

    def draw(self, axes: Any, scene: Scene) -> None:
        """Draw the layers, the joints, the base and where it is driven."""
        column, excitation = scene.table(ColumnSection), scene.stated_input
        half = SLENDEREST * column.height / 2
        tops = np.cumsum([layer.thickness for layer in column.layer]).tolist()
        layers = [
            ((-half, low), (half, low), (half, high), (-half, high)) for low, high in itertools.pairwise([0.0, *tops])
        ]
        sketch = Sketch(axes, layers)
        for height in column.faces if len(column.faces) <= MOST_FACES else ():
            sketch.line([(-half, height), (half, height)], 0.35)
        for joint in column.joint:
            sketch.line([(-1.25 * half, joint.height), (1.25 * half, joint.height)], 1.2, ls=(0, (2.0, 1.0)))
        if column.base == "springs":
            sketch.spring((-0.7 * half, 0.0))
            sketch.spring((0.7 * half, 0.0))
            sketch.ground(SPRING * sketch.size)
        elif column.base == "transmitting":
            deep = -1.5 * SPRING * sketch.size
            sketch.polygon(
                [(-2 * half, 0.0), (2 * half, 0.0), (2 * half, deep), (-2 * half, deep)], facecolor="#e8e8e4"
            )
        elif column.base == "rigid":
            sketch.ground()
        arrow = LONGEST * sketch.size
        if excitation is not None:
            top = excitation.at == "top"
            level = column.height + 0.3 * arrow if top else -2.4 * SPRING * sketch.size
            words = excitation.shape or "record"
            if column.motion == "shear":
                sketch.arrow((-arrow / 2, level), (arrow, 0.0), words)
            elif top:
                sketch.arrow((0.0, level + arrow), (0.0, -arrow), words)
            else:
                sketch.arrow((0.0, level - arrow / 2), (0.0, arrow), words)
        sketch.fit()
