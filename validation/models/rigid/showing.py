"""Rigid boxes before anything runs: masses, slenderness, friction, landings, and contacts of given stiffness."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator, Mapping
from operator import itemgetter

from validation.advice.plain import Line
from validation.models.rigid.tables import BoxSection, RigidSection
from validation.report.chapters.text import NEWMARK_DATA, UNITS, written
from validation.report.scene.drawing import INSIDE, NARROWEST, body_height
from validation.report.scene.hooks import Number, Rows, ShowingHooks
from validation.report.texts import Texts
from validation.scenes.keys import described, keys_of, stated
from validation.scenes.scene import Scene
from validation.theory import boxes
from validation.theory.rocking import Rectangle

TEXTS = Texts(__file__)


class HOOKS(ShowingHooks):
    """Boxes on the ground."""

    chooses_steps = False
    no_data = frozenset({*NEWMARK_DATA, "time.start", "fem.degree", "fem.foundation"})

    def bodies(self, scene: Scene, varied: Collection[str]) -> Iterator[str]:
        """Yield the number of boxes, and what all of them are."""
        if "rigid.box" in varied:
            return
        section = scene.table(RigidSection)
        count = len(section.box)
        yield f"{count} boxes" if count > 1 else "a box"
        boxes = [{name: value for name, value, _ in stated(box)} for box in section.box]
        for name, _, key in keys_of(BoxSection):
            values = [box.get(name) for box in boxes]
            if values[0] is not None and len(set(values)) == 1:
                yield f"{name} = {written(values[0])} {key.unit.translate(UNITS)}".replace(" deg", "°")
            elif any(values):
                yield f"{name} by box"

    def drawing(self, scene: Scene, width: int | None) -> tuple[int, Rows]:
        """Return the boxes from the top down, and the ground."""
        return INSIDE, list(_boxes(scene.table(RigidSection)))

    def stepping(self, scene: Scene) -> Iterator[Line]:
        """Yield the rows: programs choose their steps for themselves."""
        t = scene.time
        refine = scene.table(RigidSection).refine
        halved = f", halved {refine} times" if refine else ""
        yield "rows", f"{t.steps}, one each {t.step:g} s; between them a program takes its own steps{halved}"

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield masses, slenderness, what turns a box over, landings, motions of the ground and times of contact."""
        section = scene.table(RigidSection)
        masses = [box.mass for box in section.box]
        lowest = section.box[0]
        slenderness = min(box.width / box.height for box in section.box)
        yield Number(
            "m", sum(masses), "kg", "mass of the box" if len(masses) == 1 else f"mass of the {len(masses)} boxes"
        )
        if len(masses) > 1:
            ratio = max(above / below for below, above in itertools.pairwise(masses))
            yield Number("m2/m1", ratio, "", "mass of a box over that of the box below it, the greatest")
        yield Number("w/h", slenderness, "", "slenderness: the tan b beyond which a box topples, unless it slides")
        yield Number("tan phi", section.friction_coefficient, "", "coefficient of friction")
        if section.slope:
            yield Number(
                "tan b", math.tan(math.radians(abs(section.slope))), "", "of the slope: what rest needs at least"
            )
        yield from _turning(section)
        yield from _falling(section)
        if section.base_amplitude:
            ground = boxes.ShakenBox(section.base_amplitude, section.base_frequency, 0.0, section.gravity)
            yield Number("a ground", ground.peak, "m/s2", "greatest acceleration of the ground, A (2 pi f)^2")
            yield Number("v ground", ground.peak / ground.rate, "m/s", "its greatest velocity")
        if section.stiffness is not None:
            period = 2 * math.pi * math.sqrt(lowest.mass / section.stiffness)
            yield Number(
                "t contact", period / 2, "s", "half a period of box 1 on its contact: of an impact without weight"
            )
            yield Number("m g/k", -sum(masses) * section.pull[1] / section.stiffness, "m", "penetration at rest")

    def remarks(self, scene: Scene, values: Mapping[str, float]) -> Iterator[str]:
        """Yield that boxes slide or topple, and that rows miss the peak of a force."""
        section = scene.table(RigidSection)
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


def _boxes(section: RigidSection) -> Iterator[tuple[str, str]]:
    """Yield rigid boxes on each other from the top down, equal neighbours as one, and the ground."""
    left = min(box.x - box.width / 2 for box in section.box)
    right = max(box.x + box.width / 2 for box in section.box)
    characters_per_metre = INSIDE / (right - left)
    stack = [list(equal) for _, equal in itertools.groupby(enumerate(section.box, start=1), key=itemgetter(1))]
    for equal in reversed(stack):
        first, box = equal[0]
        last = equal[-1][0]
        across = max(NARROWEST, round(characters_per_metre * box.width))
        shift = min(INSIDE - across, round(characters_per_metre * (box.x - box.width / 2 - left)))
        beside = _box(box, last - first + 1)
        rows = max(len(beside), body_height(across, box.width / box.height) if len(section.box) == 1 else 1)
        margin = " " * (2 + shift)
        edge = f"{margin}+{'-' * across}+"
        yield edge, ""
        for row in range(rows):
            label = f"{first}" if first == last else f"{first}-{last}"
            inside = (label if row == rows // 2 else "").center(across)
            words = beside[row] if row < len(beside) else ""
            yield f"{margin}|{inside}|", words
        yield edge, ""
    slope = "level ground"
    if section.slope:
        slope = TEXTS.text("slope", abs(section.slope), "right" if section.slope > 0 else "left")
    friction = "frictionless" if section.friction == 0 else TEXTS.text("friction", section)
    springs = TEXTS.text("own-springs" if section.stiffness is None else "lowest-spring", section)
    yield f" {'=' * (INSIDE + 4)}", TEXTS.text("contacts", section, friction, springs)
    yield "", TEXTS.text("ground", section, slope)
    if section.base_amplitude:
        yield "", TEXTS.text("base-motion", section)


def _box(box: BoxSection, count: int) -> list[str]:
    """Return size and start of a box, or of each of some equal boxes, a line each."""
    each = "each " if count > 1 else ""
    lines = [TEXTS.text("box", box, each)]
    start = [
        described(name, value, key) for name, value, key in stated(box) if name not in ("width", "height", "density")
    ]
    return [*lines, ", ".join(start)] if start else lines


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
