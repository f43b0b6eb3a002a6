"""A column before anything runs: c, h and c dt / h of each layer, blocks a wavelength, and what the base reflects."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress

from validation.advice.hooks import AdviceHooks
from validation.advice.spectra import stable_step
from validation.errors import InputError
from validation.models.column.tables import ColumnSection
from validation.report.scene.drawing import INSIDE
from validation.report.scene.hooks import Number, Numbers, Rows, ShowingHooks
from validation.runs.numbers import short
from validation.runs.texts import Texts
from validation.scenes.keys import described, stated
from validation.scenes.scene import Scene
from validation.theory import columns

TEXTS = Texts(__file__)
# keys of a column whose contacts open or slip
OF_CONTACTS = {"law", "stiffness", "gap", "strength", "friction", "gravity", "settled", "solve_limit"}


class HOOKS(ShowingHooks):
    """Layers on each other."""

    def bodies(self, scene: Scene, varied: Collection[str]) -> Iterator[str]:
        """Yield number of blocks and layers, and the height."""
        column = scene.table(ColumnSection)
        if "column.layer" not in varied:
            blocks = sum(layer.blocks for layer in column.layer)
            yield f"{blocks} blocks, layers: {len(column.layer)}, {column.height:g} m high"

    def drawing(self, scene: Scene, width: int | None) -> tuple[int, Rows]:
        """Return the layers from the top down, and what they stand on."""
        return INSIDE, list(_layers(scene))

    def springs(self, scenes: Sequence[Scene], numbers: Numbers) -> str:
        """Return the springs between the blocks, and their law."""
        column = scenes[0].table(ColumnSection)
        stiffness = column.stiffness or column.glue
        return "" if stiffness is None else f"{short(stiffness)} Pa/m between the blocks, {column.law}."

    def first_frequency(self, scene: Scene, of_run: float | None) -> float | None:
        """Return the closed form."""
        return columns.first_frequency(scene.table(ColumnSection))

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield speeds and sizes of the layers, limits of contacts, and impedances."""
        column = scene.table(ColumnSection)
        top_impedance = 0.0
        travel_time = 0.0
        for number, layer in enumerate(column.layer, start=1):
            speed = math.sqrt(column.modulus(layer) / layer.density)
            height = layer.thickness / layer.blocks
            travel_time += layer.thickness / speed
            top_impedance = layer.density * speed
            place = f"{number}: " if len(column.layer) > 1 else ""
            if math.isfinite(speed):
                yield from _layer(scene, place, speed, height)
        yield from _contacts(scene)
        if math.isinf(top_impedance):  # rigid blocks carry no wave
            return
        yield Number("H/c", travel_time, "s", "travel time of the wave through the column")
        if column.law == "bonded":
            with suppress(InputError):  # DDA does not take the column
                yield Number(
                    "dt stable", stable_step(scene), "s", "largest stable step of the blocks, glue and joints included"
                )
        if column.impedance is not None:
            lowest = column.layer[0]
            base_impedance = lowest.density * math.sqrt(column.modulus(lowest) / lowest.density)
            share = abs(column.impedance - base_impedance) / (column.impedance + base_impedance)
            yield Number("reflected", 100 * share, "%", "of the amplitude of a wave that reaches the base")
        yield Number("rho c", top_impedance, "Pa s/m", "impedance of the top layer")


def _layers(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield the layers of a column from the top down, and what it stands on."""
    layered_column = scene.table(ColumnSection)
    excitation = scene.stated_input
    if excitation is None:
        signal = ""
    elif excitation.shape is None:
        signal = f"record {(excitation.record or '').rpartition('/')[2]}"
    else:
        signal = TEXTS.text("pressed" if excitation.velocity is None else "moved", excitation, excitation.pressure or 0)
    driven_end = None if excitation is None else excitation.at
    top = f"{signal} on the top, {layered_column.motion} waves" if driven_end == "top" else "free top"
    yield f"  +{'-' * INSIDE}+", top
    for layer in reversed(layered_column.layer):
        cut = f"{layer.thickness:g} m in {layer.blocks}"[:INSIDE].center(INSIDE)
        velocity = TEXTS.text("layer-velocity", layer) if layer.velocity else ""
        material = "rigid" if math.isinf(layer.young) else TEXTS.text("elastic", layer)
        yield f"  |{cut}|", f"rho = {layer.density:g} kg/m3, {material}{velocity}"
        yield f"  +{'-' * INSIDE}+", ""
    for joint in layered_column.joint:
        numbers = [described(name, value, key) for name, value, key in stated(joint) if name != "height"]
        yield "", f"joint at {joint.height:g} m, {', '.join(numbers)}"
    if layered_column.glue is not None:
        yield "", f"blocks glued by {layered_column.glue:g} Pa/m"
    # the keys of contacts that open or slip and have no joint of their own
    words = [described(name, value, key) for name, value, key in stated(layered_column) if name in OF_CONTACTS]
    if layered_column.law != "bonded" and words:
        yield "", f"contacts: {', '.join(words)}"
    base_motion = f", {signal}, {layered_column.motion} waves" if driven_end == "base" else ""
    yield f" {'=' * (INSIDE + 4)}", f"{layered_column.base} base{base_motion}"


def _layer(scene: Scene, place: str, speed: float, height: float) -> Iterator[Number]:
    yield Number(f"{place}c", speed, "m/s", "wave speed")
    yield Number(f"{place}h", height, "m", "height of a block")
    yield Number(f"{place}c dt/h", speed * scene.time.step / height, "", "share of a block that it crosses per step")
    frequency = None if scene.stated_input is None else scene.stated_input.frequency
    yield Number(f"{place}f10", speed / (10 * height), "Hz", "frequency with ten blocks per wavelength")
    if frequency is not None:
        yield Number(f"{place}blocks", speed / (frequency * height), "", f"per wavelength at {frequency:g} Hz")


def _contacts(scene: Scene) -> Iterator[Number]:
    bounds = AdviceHooks.of(scene).contact_limits(scene)
    if bounds is None:
        return
    yield Number("contacts", bounds.contacts, "", "that open or slip")
    if bounds.solves is not None:
        yield Number("solves", bounds.solves, "", "of the open-close iteration that a step can need at most")
    if bounds.far_face_step > 0:
        yield Number("dt face", bounds.far_face_step, "s", "step below which a block's far face moves the wrong way")
    if bounds.lowest is not None:
        yield Number("w1", bounds.lowest, "rad/s", "lowest frequency of the stack, all contacts closed")
    if bounds.ring_down is not None:
        says = "in which that vibration falls to a thousandth while none opens or slips"
        yield Number("t ring", bounds.ring_down, "s", says)
