"""Alarms of contact that opens."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict

from validation.advice import contact
from validation.advice.alarm import Alarm, alarm, first_row, number
from validation.runs.numbers import share_text
from validation.runs.row import Row, RowsBySolver
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.contract import Role
from validation.theory import landing
from validation.theory.stepping import Stepping

LARGE_STEP = "step too large for contact"
GAINED = "energy gained by switching"
MAY_GAIN = "energy may be gained"
HIDDEN = "hidden opening"
PENALTY = "peak force of the penalty"
DRAG = "drag in flight"
PULLING = "tension of a dead band"
KINDS = (LARGE_STEP, GAINED, MAY_GAIN, HIDDEN, PENALTY, DRAG, PULLING)
NOTABLE = 0.01  # of the energy given, or of the load
BEYOND = 1.5  # times the peak force of the exact bar from which on a peak is the springs'


def contact_alarms(scene: Scene, rows: RowsBySolver) -> Iterator[Alarm]:
    """Yield the alarms of the judged method's run of a scene with unilateral contact, by its finished rows."""
    row = first_row(rows, Role.JUDGED)
    if row is None or features.UNILATERAL not in features.of(scene):
        return
    lands = number(row, "switches.first_closing") is not None or scene.block.velocity < 0
    omega = contact.omega(scene) if lands and (number(row, "contact.gap") or 0.0) > 0 else 0.0
    landed = contact.restitution(scene) if omega else None
    if landed is not None and landed.error > contact.NOTABLE:
        is_arbitrary = landed.high - landed.low > contact.NOTABLE
        by_phase = ", by where in the step the block lands" if is_arbitrary else ""
        yield alarm(LARGE_STEP, scene.name, {"omega": omega, **asdict(landed)}, by_phase=by_phase)
    yield from gained(scene, row)
    if omega > 1 and not landing.cannot_gain(scene):
        stepping = Stepping.of(scene)
        values = {"omega": omega, "alpha": stepping.alpha, "delta": stepping.delta}
        yield alarm(MAY_GAIN, scene.name, values, scheme=stepping.numbers)
    limit = landing.hidden_from(scene)
    if limit is not None and scene.time.step > limit:
        yield alarm(HIDDEN, scene.name, {"step": scene.time.step, "limit": limit})
    # a peak of the springs, not of the body: beyond the exact bar's, on springs stiffer than a wave
    peak = number(row, "contact.peak_force") or 0.0
    exact = number(first_row(rows, Role.TRUTH), "contact.peak_force")
    quarter = landing.quarter_mass_force(scene, 1.0)
    if exact and peak > BEYOND * exact and quarter > landing.wave_force(scene, 1.0):
        factor = landing.impact_force(scene, 1.0) / quarter
        at_landing = f", {factor:.3g} V sqrt(p m / 2) for an unloaded landing at V" if math.isfinite(factor) else ""
        values = dict(peak=peak, bar=exact)  # noqa: C408 - a number's name, which is no solver's as a string
        yield alarm(PENALTY, scene.name, values, times=peak / exact, landed=at_landing)
    share = number(row, "contact.open_share") or 0.0
    gg = scene.time.discount
    if gg < 1 and share > 0:
        constant = -scene.time.step / math.log(gg) if gg > 0 else 0.0
        yield alarm(DRAG, scene.name, {"gg": gg, "share": share, "constant": constant})
    tension = 2 * scene.contact.stiffness * scene.contact.band[1] if scene.contact.band[1] else 0.0
    load = abs(opened.resultant_load(scene)) or landing.impact_force(scene, scene.block.velocity)
    if tension > NOTABLE * load:
        of_load = f", {share_text(tension / load)} of the load" if load else ""
        yield alarm(PULLING, scene.name, {"pull": tension}, share=of_load)


def gained(scene: Scene, row: Row) -> Iterator[Alarm]:
    """Yield the alarm of a run that has gained energy where its contacts opened and closed.

    What switching gains is an energy of its own where the accelerations have no share in that of the scheme, Newmark's
    with alpha = delta/2. Under any other scheme a switch changes what is stored in them as well: only the sum of all
    that the scheme has taken and given is an energy there.
    """
    gain = number(row, "energy.switching_gain")
    cause = "opening and closing have"
    stepping = Stepping.of(scene)
    if stepping.scheme != "newmark" or 2 * stepping.alpha != stepping.delta:
        lost = [number(row, f"energy.lost_{part}") for part in ("algorithmic", "switching")]
        given = number(row, "energy.given")
        gain = -sum(part or 0.0 for part in lost) / given if given and None not in lost else None
        cause = "the scheme has, with opening and closing,"
    switches = number(row, "switches.count")
    if gain is not None and gain > NOTABLE and switches != 0:
        yield alarm(GAINED, scene.name, {"gain": gain}, cause=cause)
