"""A block as a figure."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from validation.report.figures.drawing import GROUND, LONGEST, SPRING, FigureHooks, Sketch, along, quantity, rotation
from validation.runs.history import Array
from validation.scenes.scene import Scene


class HOOKS(FigureHooks):
    """A block on its springs."""

    def draw(self, axes: Any, scene: Scene) -> None:
        """Draw a block on its springs, or above them, with the loads on its top."""
        block, load, contact = scene.block, scene.load, scene.contact
        pivot = np.array(block.outline[0])
        outline = (np.array(block.outline) - pivot) @ rotation(math.radians(block.tilt)) + pivot
        sketch = Sketch(axes, [outline], load.slope)
        for cut in _cuts(outline, block.subdivide, block.pattern):
            sketch.line(cut, 0.35)
        length = 0.0 if math.isinf(contact.stiffness) else SPRING * sketch.size
        gap = GROUND * sketch.size if contact.gap or block.velocity > 0 else 0.0  # not to scale
        corners = block.edge(block.base)
        for corner in corners:
            if length:
                sketch.spring((corner[0], corner[1] - gap))
        sketch.ground(length + gap, corners, load.base_motion is not None)
        arrow = LONGEST * sketch.size
        left, right = block.edge(block.top)
        words = quantity(load.pressure, "Pa")
        for place in along((left, right)) if load.pressure else ():
            sketch.arrow(place + np.array([0.0, arrow]), (0.0, -arrow), words)
            words = ""
        if load.traction:
            above = 1.6 * arrow if load.pressure else 0.3 * arrow
            start = (min(left[0], right[0]), max(left[1], right[1]) + above)
            sketch.arrow(start, (2 * arrow, 0.0), quantity(load.traction, "Pa"))
        if load.gravity:  # which turns with the ground
            slope = math.radians(load.slope)
            sketch.arrow(sketch.middle, (arrow * math.sin(slope), -arrow * math.cos(slope)), "g")
        if block.velocity:
            rise = math.copysign(arrow, block.velocity)
            sketch.arrow((sketch.low[0] - 0.5 * arrow, sketch.middle[1]), (0.0, rise), f"{abs(block.velocity):g} m/s")
        sketch.fit()


def _cuts(outline: Array, subdivide: tuple[int, int] | None, pattern: str) -> list[Array]:
    """Return the lines along which a quadrilateral is cut into sub-blocks, its own edges among them."""
    if subdivide is None:
        return []
    across, up = (np.linspace(0.0, 1.0, count + 1) for count in subdivide)
    s = across[:, None, None]
    t = up[None, :, None]
    a, b, c, d = outline
    grid = (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * d + s * c)
    cuts = [*grid, *grid.swapaxes(0, 1)]
    if pattern == "triangles":
        diagonals = np.stack([grid[:-1, :-1], grid[1:, 1:]], axis=2)
        cuts += [*diagonals.reshape(-1, 2, 2)]
    return cuts
