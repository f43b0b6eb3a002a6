"""What follows from a scene's parameters before anything runs: speeds, frequencies, steps over them, limits.

A block: c = sqrt(E' / rho), h / c, c dt / h, p / E, the modes w of the DDA block with w dt, and the limits of the step.
A column: the same of each layer, its blocks a wavelength, and what the base reflects.
Rigid boxes: masses, slenderness, friction against slope and ground motion, landings, and contacts of given stiffness.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from validation.advice import contact
from validation.advice.coarse import AGREEMENT, SAMPLED, coarse_alarms
from validation.advice.columns import column_alarms, limits
from validation.advice.spectra import CONTACT, FIRST, FLIPPING, dda_modes, mode_damping, mode_names, stable_step
from validation.errors import InputError
from validation.models.rigid.tables import RigidSection
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.theory import boxes, landing, statics
from validation.theory.rocking import Rectangle

MOST_CASES = 200  # of a sweep that are looked at, evenly taken
MOST_BLOCKS = 4  # sub-blocks whose modes are found at once; `damping` finds those of more
OF_STEPS = {  # the alarms of a run, without their numbers, by which the cases of a sweep would differ
    AGREEMENT: "the step damps more than a third of the first mode, or of the input, away in a period",
    SAMPLED: "fewer than two steps per period of the first mode, or of the input: no history can show it",
}


@dataclass(frozen=True)
class Number:
    """One derived number of a case."""

    name: str
    value: float
    unit: str  # "" of a ratio
    says: str


Ranges = dict[str, tuple[float, float, Number]]  # name -> least, greatest, and the number of one case


def cases(scene: Scene) -> list[Scene]:
    """Return the cases of a scene, of very many `MOST_CASES`, first and last among them."""
    every = scene.expand()
    if len(every) <= MOST_CASES:
        return list(every)
    return [every[i] for i in np.linspace(0, len(every) - 1, MOST_CASES).round().astype(int)]


def ranges(numbers_by_case: Sequence[Sequence[Number]]) -> Ranges:
    """Return each number's range over cases, in the order of the case that has most of them."""
    ranges_by_name: Ranges = {}
    for numbers in sorted(numbers_by_case, key=len, reverse=True):
        for number in numbers:
            low, high, first = ranges_by_name.get(number.name, (number.value, number.value, number))
            ranges_by_name[number.name] = (min(low, number.value), max(high, number.value), first)
    return ranges_by_name


def numbers(scene: Scene) -> list[Number]:
    """Return the derived numbers of one case, all of them finite."""
    derived = itertools.chain(NumberHooks.of(scene).numbers(scene), _steps(scene))
    return [number for number in derived if math.isfinite(number.value)]


class NumberHooks(Hooks):
    """The numbers that follow from a scene of a kind."""

    module = "numbers"

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield the numbers of one case, steps aside."""
        parts_of_kind = {"block": (_block, _modes, _opening, _slope), "column": (_column,), "rigid": (_rigid,)}
        return itertools.chain(*(part(scene) for part in parts_of_kind[scene.kind.name]))


def remarks(scene: Scene, derived: Sequence[Number]) -> list[str]:
    """Return in words the limits that a case with these numbers lies beyond."""
    values = {number.name: number.value for number in derived}
    of_columns = (alarm.sentence for alarm in column_alarms(scene))
    frequency = values.get("w1") if scene.kind.name == "block" else None
    of_step = (OF_STEPS[alarm.kind] for alarm in coarse_alarms(scene, frequency))
    parts = (part(scene, values) for part in (_unstable, _ringing, _landing, _steep, _of_boxes))
    return [*of_step, *itertools.chain(*parts), *of_columns]


# ---- a block ------------------------------------------------------------------------------------------------------


def _block(scene: Scene) -> Iterator[Number]:
    b = scene.block
    dt = scene.time.step
    height = b.extent[1]
    speed = math.sqrt(statics.moduli(scene)[0] / b.density)
    yield Number("m", scene.block.mass, "kg", "mass of the block")
    yield Number("p/E", scene.contact.stiffness / b.young, "", "springs over Young's modulus, unit thickness")
    yield Number("c", speed, "m/s", "speed of an axial wave, sqrt(E'/rho)")
    yield Number("h/c", height / speed, "s", "travel time of the wave through the block")
    yield Number("c dt/h", speed * dt / height, "", "share of the block that the wave crosses per step")
    if load := opened.resultant_load(scene):
        yield Number("F/2p", load / (2 * scene.contact.stiffness), "m", "compression of the springs at rest")


def _modes(scene: Scene) -> Iterator[Number]:
    if math.prod(scene.block.subdivide or (1,)) > MOST_BLOCKS:
        return
    with suppress(InputError):  # no modes: the motion is not linear, or DDA does not take the scene
        modes = dda_modes(scene)
        modes_by_name = dict(zip(mode_names(modes), modes, strict=True))
        for short, name in (("w1", FIRST), ("wc", CONTACT)):
            if name in modes_by_name:
                yield from _mode(scene, short, name, modes_by_name[name].frequency)
        if not scene.damping.present:
            yield Number("dt stable", stable_step(scene), "s", "largest stable step of the DDA block")


def _mode(scene: Scene, short: str, name: str, frequency: float) -> Iterator[Number]:
    analysis = mode_damping(scene, name, frequency)
    yield Number(short, frequency, "rad/s", f"{name} mode of the DDA block")
    yield Number(f"{short} dt", analysis.omega_dt, "", "times the step; a period takes 2 pi over this many steps")
    if analysis.damping is not None:
        yield Number(f"{short} xi", 100 * analysis.damping, "%", "its damping ratio by scheme, gg and tables")
    if name == CONTACT:
        yield Number("least root", analysis.least_root, "", "of a step; near -1 the contact force rings")


def _opening(scene: Scene) -> Iterator[Number]:
    if scene.contact.law != "unilateral":
        return
    yield Number("Omega", contact.omega(scene), "", "w_c dt of a landing, w_c = pi over its first contact")
    if (landed := contact.restitution(scene)) is not None:
        yield Number("e own", landed.own, "", "restitution of an unloaded landing of this block, without a step")
        yield Number("e least", landed.low, "", "restitution under this step, least over where in it the block lands")
        yield Number("e most", landed.high, "", "restitution under this step, greatest")
    hidden = landing.hidden_from(scene)
    if hidden is not None:
        yield Number("dt seen", hidden, "s", "largest step that shows the block leave its springs at t = 0")


def _slope(scene: Scene) -> Iterator[Number]:
    friction = scene.contact.friction
    slope = math.tan(math.radians(scene.load.slope))
    if friction is not None:
        yield Number("tan phi", math.tan(math.radians(friction)), "", "coefficient of friction")
    if slope:
        yield Number("tan b", abs(slope), "", "of the slope: friction coefficient that it needs at rest")
        if scene.block.vertices is None:
            width, height = statics.size(scene)
            yield Number("w/h", width / height, "", "slenderness: the tan b beyond which it topples, unless it slides")


def _steps(scene: Scene) -> Iterator[Number]:
    t = scene.time
    yield Number("n dt", t.duration, "s", "simulated time")
    if 0 < t.discount < 1:
        yield Number("-ln gg/dt", -math.log(t.discount) / t.step, "1/s", "rate at which gg reduces velocity")


# ---- a column -----------------------------------------------------------------------------------------------------


def _column(scene: Scene) -> Iterator[Number]:
    column = scene.column
    if column is None:
        return
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
    if math.isinf(top_impedance) or travel_time == 0:  # rigid blocks carry no wave
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


def _layer(scene: Scene, place: str, speed: float, height: float) -> Iterator[Number]:
    yield Number(f"{place}c", speed, "m/s", "wave speed")
    yield Number(f"{place}h", height, "m", "height of a block")
    yield Number(f"{place}c dt/h", speed * scene.time.step / height, "", "share of a block that it crosses per step")
    frequency = None if scene.stated_input is None else scene.stated_input.frequency
    yield Number(f"{place}f10", speed / (10 * height), "Hz", "frequency with ten blocks per wavelength")
    if frequency is not None:
        yield Number(f"{place}blocks", speed / (frequency * height), "", f"per wavelength at {frequency:g} Hz")


def _contacts(scene: Scene) -> Iterator[Number]:
    """Yield what is known of contacts that open or slip."""
    bounds = limits(scene)
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


# ---- rigid boxes --------------------------------------------------------------------------------------------------


def _rigid(scene: Scene) -> Iterator[Number]:
    section = scene.rigid
    if section is None:
        return
    masses = [box.mass for box in section.box]
    lowest = section.box[0]
    slenderness = min(box.width / box.height for box in section.box)
    yield Number("m", sum(masses), "kg", "mass of the box" if len(masses) == 1 else f"mass of the {len(masses)} boxes")
    if len(masses) > 1:
        ratio = max(above / below for below, above in itertools.pairwise(masses))
        yield Number("m2/m1", ratio, "", "mass of a box over that of the box below it, the greatest")
    yield Number("w/h", slenderness, "", "slenderness: the tan b beyond which a box topples, unless it slides")
    yield Number("tan phi", section.friction_coefficient, "", "coefficient of friction")
    if section.slope:
        yield Number("tan b", math.tan(math.radians(abs(section.slope))), "", "of the slope: what rest needs at least")
    yield from _turning(section)
    yield from _falling(section)
    if section.base_amplitude:
        ground = boxes.ShakenBox(section.base_amplitude, section.base_frequency, 0.0, section.gravity)
        yield Number("a ground", ground.peak, "m/s2", "greatest acceleration of the ground, A (2 pi f)^2")
        yield Number("v ground", ground.peak / ground.rate, "m/s", "its greatest velocity")
    if section.stiffness is not None:
        period = 2 * math.pi * math.sqrt(lowest.mass / section.stiffness)
        yield Number("t contact", period / 2, "s", "half a period of box 1 on its contact: of an impact without weight")
        yield Number("m g/k", -sum(masses) * section.pull[1] / section.stiffness, "m", "penetration at rest")


def _turning(section: RigidSection) -> Iterator[Number]:
    """Yield what turns a box over that is alone on level ground and does not slide (Housner)."""
    box = section.box[0]
    is_alone_on_level = len(section.box) == 1 and section.slope == 0 and section.gravity > 0
    if not is_alone_on_level or section.friction_coefficient < box.width / box.height:
        return
    turned = Rectangle(box.width, box.height, section.gravity)
    yield Number("alpha", math.degrees(turned.alpha), "deg", "rotation at which the box stands on its edge")
    yield Number("p", math.sqrt(turned.rate2), "rad/s", "sqrt(3 g / 4R), frequency parameter of rocking")
    yield Number("w over", boxes.critical_spin(turned), "rad/s", "rate about its edge that just turns it over")


def _falling(section: RigidSection) -> Iterator[Number]:
    """Yield when and how fast a lifted first box lands that does not turn."""
    box = section.box[0]
    pull = -section.pull[1]
    if box.lift == 0 or box.spin != 0 or pull <= 0:
        return
    speed = math.sqrt(box.velocity[1] ** 2 + 2 * pull * box.lift)
    yield Number("v landing", speed, "m/s", "speed at which box 1 lands for the first time")
    yield Number("t landing", (box.velocity[1] + speed) / pull, "s", "when it does")


# ---- limits -------------------------------------------------------------------------------------------------------


def _unstable(scene: Scene, values: Mapping[str, float]) -> Iterator[str]:
    if scene.time.step > values.get("dt stable", math.inf) * (1 + 1e-12):
        yield "dt is beyond the stability limit: the solution grows without bound"


def _ringing(scene: Scene, values: Mapping[str, float]) -> Iterator[str]:
    stable = scene.time.step <= values.get("dt stable", math.inf)
    if stable and values.get("least root", 0.0) <= FLIPPING:
        yield "the contact mode changes sign in every step: the contact force rings"


def _landing(scene: Scene, values: Mapping[str, float]) -> Iterator[str]:
    if scene.time.step > values.get("dt seen", math.inf):
        yield "dt is too large to show that the block leaves its springs at t = 0"
    least = values.get("e least", math.nan)
    most = values.get("e most", math.nan)
    without_step = values.get("e own", math.nan)
    if most - least > contact.NOTABLE:
        yield f"the restitution of a landing, {least:.2g} to {most:.2g}, depends on where in the step the block lands"
    elif max(abs(least - without_step), abs(most - without_step)) > contact.NOTABLE:
        yield f"the step changes the restitution of a landing from {without_step:.2g} to {least:.2g}"


def _steep(scene: Scene, values: Mapping[str, float]) -> Iterator[str]:
    slope = values.get("tan b", 0.0)
    if (
        scene.kind.name != "block" or slope == 0 or scene.contact.law != "unilateral"
    ):  # a locked contact holds the block
        return
    friction = math.inf
    if scene.contact.cohesion == 0:
        friction = 0.0 if scene.contact.shear_stiffness == 0 else values.get("tan phi", math.inf)
    if slope > friction:
        yield "tan b > tan phi: the block slides"
    # The friction of a block that slides is tan(phi) N, whose moment does not tip it where tan(phi) < w/h.
    if min(slope, friction) > values.get("w/h", math.inf):
        yield "tan b > w/h: the block topples"


def _of_boxes(scene: Scene, values: Mapping[str, float]) -> Iterator[str]:
    section = scene.rigid
    if section is None:
        return
    friction = section.friction_coefficient
    slope = values.get("tan b", 0.0)
    if slope > friction:
        yield "tan b > tan phi: the boxes slide"
    if min(slope, friction) > values["w/h"]:
        yield "tan b > w/h: a box topples"
    if values.get("a ground", 0.0) > friction * -section.pull[1]:
        yield "the ground's acceleration exceeds tan phi g: the lowest box slips on it"
    # A program's rows must tell the contact from the flight.
    if values.get("t contact", math.inf) < 2 * scene.time.step:
        yield "time.step is more than half a contact: its rows miss the peak of the force"
