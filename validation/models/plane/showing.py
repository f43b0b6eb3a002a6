"""Blocks in the plane before anything runs: their number and mass, and the wave along the larger side."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence

import numpy as np

from validation.models.plane.tables import PlaneSection, Segment
from validation.report.scene.drawing import body_height, body_width, box_rows
from validation.report.scene.hooks import Number, Numbers, Rows, ShowingHooks
from validation.report.texts import Texts
from validation.runs.numbers import short
from validation.scenes import outline
from validation.scenes.scene import Scene

TEXTS = Texts(__file__)


class HOOKS(ShowingHooks):
    """The outline of blocks in the plane."""

    no_data = frozenset({"fem.foundation"})

    def bodies(self, scene: Scene, varied: Collection[str]) -> Iterator[str]:
        """Yield the number of blocks."""
        if not {"plane.block", "plane.subdivide"} & {*varied}:
            yield f"{len(scene.table(PlaneSection).polygons)} blocks"

    def drawing(self, scene: Scene, width: int | None) -> tuple[int, Rows]:
        """Return the outline with what the blocks are beside it."""
        plane = scene.table(PlaneSection)
        corners = np.vstack([np.array(polygon) for polygon in plane.polygons])
        wide, high = np.ptp(corners, axis=0)
        slenderness = wide / high
        across = body_width(slenderness)
        cut = TEXTS.text("plane-blocks" if plane.subdivide is None else "cut", plane, len(plane.polygons))
        beside = [TEXTS.text("size", wide, high, cut), TEXTS.text("material", plane), TEXTS.text("glue", plane)]
        if plane.clamp:
            beside.append(f"clamped along {', '.join(_segment(clamp.edge) for clamp in plane.clamp)}")
        if any(plane.stress):
            beside.append(TEXTS.text("stress", plane))
        if any(plane.gravity):
            beside.append(TEXTS.text("gravity", plane))
        beside += [TEXTS.text("traction", load, _segment(load.edge)) for load in plane.load]
        return across, box_rows(across, body_height(across, slenderness), beside)

    def springs(self, scenes: Sequence[Scene], numbers: Numbers) -> str:
        """Return the glue."""
        return f"Glue of {short(scenes[0].table(PlaneSection).glue)} E at each end of a shared edge."

    def first_frequency(self, scene: Scene, of_run: float | None) -> None:
        """Return none: glued blocks are read at rest."""

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield number and mass of the blocks, and the wave."""
        plane = scene.table(PlaneSection)
        corners = np.vstack([np.array(polygon) for polygon in plane.polygons])
        size = float(np.max(np.ptp(corners, axis=0)))
        speed = math.sqrt(plane.young / plane.density)
        area = sum(outline.area(polygon) for polygon in plane.polygons)
        yield Number("blocks", len(plane.polygons), "", "blocks of one strain")
        yield Number("m", plane.density * area, "kg", "mass of all blocks")
        yield Number("c", speed, "m/s", "speed of a wave along a bar, sqrt(E/rho)")
        yield Number("L/c", size / speed, "s", "travel time of the wave along the larger side")


def _segment(edge: Segment) -> str:
    return " to ".join(f"({x:g}, {y:g})" for x, y in edge)
