"""A block before anything runs: c = sqrt(E' / rho), h / c, c dt / h, p / E, the modes w with w dt, limits of dt."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

import numpy as np

from validation.advice import contact
from validation.advice.spectra import CONTACT, FIRST, FLIPPING, dda_modes, mode_damping, mode_names, stable_step
from validation.errors import InputError
from validation.report.chapters.text import range_of
from validation.report.scene.drawing import BESIDE, body_height, body_width, box_rows
from validation.report.scene.hooks import Number, Numbers, Rows, ShowingHooks
from validation.runs.texts import Texts
from validation.scenes.keys import described, stated
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.theory import landing, statics

TEXTS = Texts(__file__)
MOST_BLOCKS = 4  # sub-blocks whose modes are found at once; `damping` finds those of more


class HOOKS(ShowingHooks):
    """A block on its springs."""

    first_mode = "w1"

    def drawing(self, scene: Scene, width: int | None) -> tuple[int, Rows]:
        """Return a block on its springs, to scale as far as characters go, with its parameters beside it."""
        b = scene.block
        wide, high = np.ptp(b.outline, axis=0)
        slenderness = wide / high
        across = body_width(slenderness)
        height = body_height(across, slenderness)
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

    def springs(self, scenes: Sequence[Scene], numbers: Numbers) -> str:
        """Return stiffness, law and penetration, and what a step leaves of the contact mode."""
        ratios = [scene.contact.stiffness / scene.block.young for scene in scenes]
        law = scenes[0].contact.law
        text = f"p = {range_of(ratios)} E, {'carrying no tension' if law == 'unilateral' else 'locked'}"
        depths = numbers("dda", "contact.penetration")
        if depths:
            text += f"; at most {range_of(1e3 * depth for depth in depths)}\u00a0mm of penetration"
        left = numbers("dda", "contact.spectral_radius")
        if left:
            text += f". A step leaves {range_of(100 * share for share in left)}\u00a0% of the contact mode"
            if min(numbers("dda", "contact.least_root"), default=0.0) < 0:
                text += ", which changes sign from step to step"
        return f"{text}."

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield mass, speeds and springs, modes, what a landing does, and what a slope needs."""
        for part in (_block, _modes, _opening, _slope):
            yield from part(scene)

    def remarks(self, scene: Scene, values: Mapping[str, float]) -> Iterator[str]:
        """Yield that the contact rings, what a step does to a landing, and that the block slides or topples."""
        for part in (_ringing, _landing, _steep):
            yield from part(scene, values)


def _loads(scene: Scene) -> str:
    load = scene.load
    names = {"pressure": "q"}
    loads = [described(names.get(name, name), value, key) for name, value, key in stated(load) if name != "base_motion"]
    if load.base_motion is not None:
        loads.append(f"base moved by {load.base_motion.rpartition('/')[2]}")
    return ", ".join(loads) or "no load"


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
    if math.prod(scene.block.cuts) > MOST_BLOCKS:
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
    if slope == 0 or scene.contact.law != "unilateral":  # a locked contact holds the block
        return
    friction = math.inf
    if scene.contact.cohesion == 0:
        friction = 0.0 if scene.contact.shear_stiffness == 0 else values.get("tan phi", math.inf)
    if slope > friction:
        yield "tan b > tan phi: the block slides"
    # The friction of a block that slides is tan(phi) N, whose moment does not tip it where tan(phi) < w/h.
    if min(slope, friction) > values.get("w/h", math.inf):
        yield "tan b > w/h: the block topples"
