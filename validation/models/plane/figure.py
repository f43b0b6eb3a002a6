"""Blocks in the plane as they are drawn: names, what is fixed, contacts, loads; and frames of a motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from validation.models.plane.assembly import Assembly
from validation.models.plane.blocks import centroid
from validation.models.plane.geometry import inside
from validation.models.plane.motion import forces_at, outlines_at
from validation.models.plane.tables import PlaneSection, Segment
from validation.report.figures.curves import GREY, style_of
from validation.report.figures.drawing import FACE, LONGEST, FigureHooks, Sketch, along, quantity
from validation.report.figures.histories import Margins, axes_grid, house_style, size_of
from validation.runs.history import Array, History
from validation.scenes.scene import Scene

MOVING: dict[str, Any] = {"facecolor": FACE, "edgecolor": "black", "lw": 0.35}
FIXED: dict[str, Any] = {
    "facecolor": "#f4f4f2",
    "edgecolor": GREY,
    "hatch": "////",
    "lw": 0.4,
}  # look of what does not move
LETTER = 1.1  # mm, width of a letter of a block's name, amply
NAME_HEIGHT = 2.0  # mm
MARGINS = Margins(11.0, 3.0, 5.0, 9.0, 5.0)  # mm, of frames


class HOOKS(FigureHooks):
    """How blocks in the plane are drawn."""

    def draw(self, axes: Any, scene: Scene) -> None:
        """Draw the blocks of a scene, what joins them and what drives them."""
        plane = scene.table(PlaneSection)
        sketch = Sketch(axes, plane.polygons)
        for clamp in plane.clamp:
            sketch.hatched(clamp.edge)
        if plane.is_glued:
            _draw_tractions(sketch, plane.tractions)
        else:
            _draw_moving(sketch, plane.assembly)
        if any(plane.gravity):
            vector = LONGEST * sketch.size * np.array(plane.gravity) / math.hypot(*plane.gravity)
            place = sketch.middle if plane.is_glued else (sketch.low[0] - 0.3 * LONGEST * sketch.size, sketch.middle[1])
            sketch.arrow(place, vector, "g")
        sketch.fit()
        if not plane.is_glued:
            _name_blocks(axes, plane.assembly)

    def frames(self, scene: Scene, history: History, steps: Sequence[int], solver: str, height: float) -> Any:
        """Draw moving blocks at some steps side by side to one scale, with contact forces in the solver's colour.

        The longest arrow of all frames is the largest force, which the first title states; axes are in metres.
        """
        plane = scene.table(PlaneSection)
        if not plane.moves:
            return None
        assembly = plane.assembly
        arrow = {"arrowstyle": "-|>,head_width=0.12,head_length=0.28", "color": style_of(solver).color, "lw": 0.8}
        forces = {step: list(forces_at(assembly, history, step)) for step in steps}
        largest = max((float(np.hypot(*force)) for frame in forces.values() for _, force in frame), default=0.0)
        outlines = {step: outlines_at(assembly, history, step) for step in steps}
        low, high = _limits(assembly, [*outlines.values()])
        size = float(np.max(high - low))
        with house_style():
            figure, ((*row,),) = axes_grid([(height, 0.0)], len(steps), MARGINS)
            for number, (axes, step) in enumerate(zip(row, steps, strict=True)):
                for block, outline in zip(assembly.blocks, outlines[step], strict=True):
                    axes.fill(*outline.T, **(FIXED if block.held else MOVING))
                for place, force in forces[step]:
                    if np.any(force):
                        tail = place - LONGEST * size * force / largest
                        look = {**arrow, "shrinkA": 0, "shrinkB": 0}
                        axes.annotate("", tuple(place), tuple(tail), arrowprops=look, zorder=4)
                force_words = f", largest force {quantity(largest, 'N')}" if largest and number == 0 else ""
                axes.set_title(f"t = {float(history.time[step]):.3g} s{force_words}")
                axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x [m]", aspect="equal")
                axes.tick_params(labelleft=number == 0)
            row[0].set_ylabel("y [m]")
        return figure


def _draw_tractions(sketch: Sketch, loads: Sequence[tuple[Segment, tuple[float, float]]]) -> None:
    largest = max([math.hypot(*vector) for _, vector in loads], default=0.0)
    for edge, vector in loads:
        for tail in along(edge) if largest else ():
            sketch.arrow(tail, LONGEST * sketch.size * np.array(vector) / largest)


def _draw_moving(sketch: Sketch, assembly: Assembly) -> None:
    """Draw what is fixed, stated contacts, forces, tractions and velocities."""
    for block in assembly.blocks:
        if block.held:
            sketch.polygon(block.vertices, **FIXED)
        if block.motion is not None:
            travel = np.array([LONGEST * sketch.size, 0.0])
            sketch.arrow(block.centroid - travel / 2, travel, head="<|-|>")
    for contact in assembly.contacts:
        sketch.dot(assembly.blocks[contact.block].vertices[contact.corner])
    _draw_tractions(sketch, [(load.edge, load.vector) for load in assembly.loads if load.edge is not None])
    length = LONGEST * sketch.size
    for load in assembly.loads:
        size = math.hypot(*load.vector)
        if load.edge is None and size:
            place = centroid(assembly.blocks[load.block].vertices) if load.place is None else load.place
            vector = length * np.array(load.vector) / size
            sketch.arrow(np.subtract(place, vector), vector, quantity(size, "N"))
    for block in assembly.blocks:
        speed = math.hypot(*block.velocity)
        if speed:
            vector = length * np.array(block.velocity) / speed
            va = "top" if block.velocity[1] < 0 else "bottom"  # of an arrow downwards the name stands above
            sketch.arrow(block.centroid, vector, f"{speed:.3g} m/s", va=va)


def _name_blocks(axes: Any, assembly: Assembly) -> None:
    """Write the name of each block into it, where it fits: beside the arrows that begin or end at its centroid."""
    millimetre = np.ptp(axes.get_xlim()) / size_of(axes)[0]  # of the drawing, in metres
    loaded = {load.block for load in assembly.loads if load.edge is None}
    for number, block in enumerate(assembly.blocks):
        x, y = block.centroid
        if number in loaded or any(block.velocity):  # an arrow downwards leaves room above
            y += (0.28 if block.velocity[1] < 0 else -0.28) * block.thickness
        half = LETTER * len(block.name) / 2 * millimetre
        heights = y + np.array([-0.5, 0.0, 0.5]) * NAME_HEIGHT * millimetre
        places = np.array([(x + side, height) for side in (-half, 0.0, half) for height in heights])
        if inside(places, block.vertices).all():
            axes.text(x, y, block.name, fontsize=5.5, ha="center", va="center", zorder=5)


def _limits(assembly: Assembly, frames: Sequence[Sequence[Array]]) -> tuple[Array, Array]:
    """Return the lower left and the upper right corner of what moves, with room for arrows about it [m]."""
    moving = [number for number, block in enumerate(assembly.blocks) if not block.held]
    corners = np.vstack([outlines[number] for outlines in frames for number in moving] or frames[0])
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = LONGEST * float(np.max(high - low))
    return low - room, high + room
