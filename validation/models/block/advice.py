"""What a step must follow of a block, and its rows of sub-blocks as layers of a wave."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

from validation.advice.alarm import Alarm
from validation.advice.block_alarms import block_alarms
from validation.advice.coarse import closed
from validation.advice.hooks import AdviceHooks, Layer, Motion
from validation.advice.spectra import dda_modes
from validation.errors import InputError
from validation.runs.row import Row
from validation.scenes.scene import Scene
from validation.theory import statics

LONG_RAMP = 40.0  # w times the ramp: so slow a load moves the mode by 2 / 40 = 5 % of its static part
MOST_SUB_BLOCKS = 64  # whose modes are found here; those of more come from the run


class HOOKS(AdviceHooks):
    """The first mode of a block that neither slides nor turns."""

    has_budget = True

    def alarms(self, scene: Scene, rows: Mapping[str, Row] | None = None) -> Iterator[Alarm]:
        """Yield the alarms of tension, of a contact that rings, opens or slips, and of the start."""
        return block_alarms(scene, rows or {})

    def motions(self, scene: Scene, frequency: float | None = None) -> Iterator[Motion]:
        """Yield the first mode, unless the block moves as a whole or is driven slowly."""
        if _moves_as_a_whole(scene) or _is_driven_slowly(scene):
            return
        first = _first_frequency(scene) if frequency is None else frequency
        if first is None or not 0 < first < math.inf:
            return
        is_ramped = scene.block.velocity == 0 and first * scene.load.ramp >= LONG_RAMP
        if not is_ramped:
            yield Motion("the first mode", first)

    def layers(self, scene: Scene) -> tuple[Layer, ...]:
        """Return the rows of sub-blocks of an upright rectangle."""
        b = scene.block
        if b.rectangle is None:
            raise InputError(
                "must be an upright rectangle on its lower edge for a wave",
                source=scene.name,
                field="block",
                value="another",
            )
        width, height = statics.size(scene)
        modulus, _ = statics.moduli(scene)
        if b.subdivide is None:
            return (Layer(height, b.density, modulus, 1),)
        columns, rows = b.subdivide
        return (Layer(height, b.density, modulus, rows, 2 * b.glue_ratio * b.young * columns / width),)

    def cut(self, scene: Scene, counts: Sequence[int]) -> Scene:
        """Return the scene with so many rows of sub-blocks."""
        if scene.block.subdivide is None and counts[0] == 1:
            return scene
        columns = 1 if scene.block.subdivide is None else scene.block.subdivide[0]
        return scene.with_values({"block.subdivide": [columns, counts[0]]})


def _moves_as_a_whole(scene: Scene) -> bool:
    """Whether a block may slide or turn, which springs that ring below it do not change."""
    load = scene.load
    slides = scene.contact.friction is not None and (load.slope != 0 or load.base_motion is not None)
    return slides or scene.run.geometry == "updated"


def _is_driven_slowly(scene: Scene) -> bool:
    """Whether a record alone moves the block: its samples hold no more than the step shows."""
    load = scene.load
    return load.base_motion is not None and load.gravity == 0 and load.pressure == 0 and not load.off_centre


def _first_frequency(scene: Scene) -> float | None:
    """Return the frequency of the first mode [rad/s], contacts closed and sticking; None where it is not known."""
    if math.prod(scene.block.cuts) > MOST_SUB_BLOCKS:
        return None
    with suppress(InputError):  # DDA does not take the scene
        return dda_modes(closed(scene))[0].frequency
    return None
