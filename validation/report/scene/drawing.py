"""The model of a scene, drawn in text with its parameters beside it, and these words alone."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Iterator
from operator import itemgetter

import numpy as np

from validation.models.rigid.tables import BoxSection, RigidSection
from validation.report.texts import Texts
from validation.scenes.keys import described, stated
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene

TEXTS = Texts(__file__)
INSIDE = 15  # characters of a block's width in the drawing
NARROWEST = 5  # the same of a tall block
BESIDE = 7  # characters of a line of the drawing besides the block's width, before its text
# keys of a column whose contacts open or slip
OF_CONTACTS = {"law", "stiffness", "gap", "strength", "friction", "gravity", "settled", "solve_limit"}
Rows = list[tuple[str, str]]  # lines of the drawing, and the words beside each


def drawing(scene: Scene, width: int | None) -> Iterator[str]:
    """Yield the model of a scene, drawn in text."""
    across, rows = TextHooks.of(scene).rows(scene, width)
    for art, words in rows:
        yield (art.ljust(across + BESIDE) + words).rstrip()


def model_words(scene: Scene) -> list[str]:
    """Return what stands beside the drawing: loads, sizes, materials, contacts."""
    return [words for _, words in TextHooks.of(scene).rows(scene, None)[1] if words]


class TextHooks(Hooks):
    """How a kind of scenes is drawn in text."""

    module = "words"

    def rows(self, scene: Scene, width: int | None) -> tuple[int, Rows]:
        """Return how many characters the body is wide, and the drawing's lines with their words."""
        if scene.rigid is not None:
            return INSIDE, list(boxes(scene.rigid))
        if scene.column is not None:
            return INSIDE, list(column(scene))
        return block(scene, width)


def across_of(slenderness: float) -> int:
    """Return the characters of a body's width; a tall one has fewer."""
    return INSIDE if slenderness >= 0.5 else max(NARROWEST, round(2 * INSIDE * slenderness))


def block(scene: Scene, width: int | None) -> tuple[int, Rows]:
    """Return a block on its springs, to scale as far as characters go, with its parameters beside it."""
    b = scene.block
    wide, high = np.ptp(b.outline, axis=0)
    slenderness = wide / high
    across = across_of(slenderness)
    height = height_of(across, slenderness)
    c = scene.contact
    shape = "" if b.vertices is None else f", {len(b.vertices)} vertices"
    cut = "" if b.subdivide is None else TEXTS.text("cut", b)
    start = [name for name, value in {"velocity": b.velocity, "tilt": b.tilt, "gap": c.gap}.items() if value]
    beside = [
        TEXTS.text("size", wide, high, f"{shape}{cut}"),
        TEXTS.text("material", b),
        *filter(None, [", ".join(TEXTS.text(name, block=b, contact=c) for name in start)]),
    ]
    *above, last = textwrap.wrap(_loads(scene), (width or 1000) - across - BESIDE, break_on_hyphens=False)
    rows: Rows = [("", text) for text in above]
    mark = ">" if scene.load.traction else ""
    if scene.load.pressure:
        mark = "v"
    arrows = " " + "   ".join([mark] * (across // 4 + 1)) if mark else ""
    rows += [(f"  {arrows}", last), *box_rows(across, height, beside)]
    springs = ["rigid" if math.isinf(c.stiffness) else TEXTS.text("springs", c)]
    if c.shear_stiffness is not None:
        springs.append(TEXTS.text("shear", c))
    holds = ["locked" if c.law == "locked" else TEXTS.text("unilateral", c)]
    if c.friction is not None:
        holds.append(TEXTS.text("cohesive" if c.cohesion else "frictional", c))
    foot = "z" if c.law == "locked" else "x"
    rows += [(f"  {foot}{' ' * across}{foot}", ", ".join(springs)), (f" {'=' * (across + 4)}", ", ".join(holds))]
    return across, rows


def box_rows(across: int, height: int, beside: list[str]) -> Rows:
    """Return a box of so many characters and rows, with words beside its first rows."""
    edge = (f"  +{'-' * across}+", "")
    inside = [(f"  |{' ' * across}|", text) for text in (*beside, *[""] * (height - len(beside)))]
    return [edge, *inside, edge]


def height_of(across: int, slenderness: float) -> int:
    """Return the rows of a body's inside; a row is as high as two columns are wide."""
    return min(max(3, round(across / slenderness / 2)), INSIDE // 2)


def _loads(scene: Scene) -> str:
    load = scene.load
    names = {"pressure": "q"}
    loads = [described(names.get(name, name), value, key) for name, value, key in stated(load) if name != "base_motion"]
    if load.base_motion is not None:
        loads.append(f"base moved by {load.base_motion.rpartition('/')[2]}")
    return ", ".join(loads) or "no load"


def column(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield the layers of a column from the top down, and what it stands on."""
    layered_column = scene.column
    if layered_column is None:
        return
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


def boxes(section: RigidSection) -> Iterator[tuple[str, str]]:
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
        rows = max(len(beside), height_of(across, box.width / box.height) if len(section.box) == 1 else 1)
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
