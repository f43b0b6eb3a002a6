"""Numbers that follow from blocks in the plane: masses, waves of glued ones, contacts of moving ones."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from validation.models.plane.tables import PlaneSection
from validation.report.scene.numbers import Number, NumberHooks
from validation.scenes.outline import area
from validation.scenes.scene import Scene


class HOOKS(NumberHooks):
    """The numbers of blocks in the plane."""

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield the numbers of one case."""
        plane = scene.table(PlaneSection)
        return glued_numbers(plane) if plane.is_glued else moving_numbers(plane, scene.time.step)


def glued_numbers(plane: PlaneSection) -> Iterator[Number]:
    """Yield the numbers of glued blocks."""
    corners = np.vstack([np.array(polygon) for polygon in plane.polygons])
    size = float(np.max(np.ptp(corners, axis=0)))
    speed = math.sqrt(plane.young / plane.density)
    yield Number("blocks", len(plane.polygons), "", "blocks of one strain")
    yield Number("m", plane.density * sum(map(area, plane.polygons)), "kg", "mass of all blocks")
    yield Number("c", speed, "m/s", "speed of a wave along a bar, sqrt(E/rho)")
    yield Number("L/c", size / speed, "s", "travel time of the wave along the larger side")


def moving_numbers(plane: PlaneSection, step: float) -> Iterator[Number]:
    """Yield the numbers of moving blocks: a corner of the lightest one on the stiffest spring is the fastest motion."""
    assembly = plane.assembly
    moving = [block for block in assembly.blocks if not block.fixed]
    masses = [block.density * area(block.vertices) for block in moving]
    yield Number("blocks", len(moving), "", "blocks that move")
    yield Number("m", sum(masses), "kg", "mass of all that move")
    springs = [*assembly.springs_of_pairs.values(), *([assembly.springs] if assembly.springs else [])]
    if not springs or not masses:
        return
    stiffest = max(contact.stiffness for contact in springs)
    if weight := sum(masses) * math.hypot(*plane.gravity):
        softest = min(contact.stiffness for contact in springs)
        yield Number("W/p", weight / softest, "m", "compression of one spring under the weight of all that moves")
    frequency = math.sqrt(stiffest / min(masses))
    yield Number("wc", frequency, "rad/s", "lightest block on the stiffest spring, sqrt(p/m)")
    yield Number("wc dt", frequency * step, "", "times the step; a period takes 2 pi over this many steps")
