"""Values of rigid boxes that no rock has."""

from __future__ import annotations

import math
from collections.abc import Iterator

from validation.models.rigid.tables import RigidSection
from validation.scenes.plausibility import Implausible, PlausibilityHooks, friction, judged
from validation.scenes.scene import Scene


class HOOKS(PlausibilityHooks):
    """What the values of boxes are held against."""

    def values(self, scene: Scene) -> Iterator[Implausible]:
        """Yield what friction, times, motions of the ground and sizes say."""
        rigid = scene.table(RigidSection)
        yield from friction("rigid.friction", rigid.friction)
        step = scene.time.step
        if rigid.gravity > 0:
            fall = math.sqrt(2 * max(box.height for box in rigid.box) / rigid.gravity)
            yield from judged("box_step", "time.step", step / fall, step=step)
        rate = 2 * math.pi * rigid.base_frequency
        peak = abs(rigid.base_amplitude) * rate * rate
        motion = {"amplitude": rigid.base_amplitude, "frequency": rigid.base_frequency}
        yield from judged("ground", "rigid.base_amplitude", peak, **motion)
        for number, box in enumerate(rigid.box):
            yield from judged("size", f"rigid.box.{number}.width", box.width)
            yield from judged("size", f"rigid.box.{number}.height", box.height)
        yield from judged("gravity", "rigid.gravity", rigid.gravity)

    def sinks(self, scene: Scene) -> Iterator[Implausible]:
        """Yield the spring of the lowest box if it gives way by a tenth of its height."""
        rigid = scene.table(RigidSection)
        if rigid.stiffness is not None:
            sink = sum(box.mass for box in rigid.box) * abs(rigid.gravity) / (rigid.stiffness or 1.0)
            share = sink / rigid.box[0].height
            yield from judged("box_sink", "rigid.stiffness", share, stiffness=rigid.stiffness, sink=sink)
