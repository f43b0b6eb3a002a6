"""A history on a slope as it is read, and the answer to it in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from validation.diagnosis import sentences
from validation.diagnosis.answer import Answer
from validation.diagnosis.causes import CAUSES, UNEXPLAINED, all_benign, words_of
from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.bar import last_digits
from validation.diagnosis.forces.judge import BLURRED, MOST, NORMAL, ContactFinding, judge
from validation.diagnosis.forces.laws import body_of
from validation.diagnosis.forces.runs import DDA, Agreement, OneChange, agreement, at_step, displacements
from validation.diagnosis.other_solvers import row_of
from validation.diagnosis.reading import SIDEWAYS, Foreign, steppings
from validation.diagnosis.readings import Slip, remedy_of, words_of_slips
from validation.diagnosis.variant import upright
from validation.errors import InputError
from validation.metrics.values import largest
from validation.runs.history import DISPLACEMENT, Array
from validation.runs.numbers import remainder_text, share_text, significant
from validation.scenes import features
from validation.scenes.scene import Scene

KNOWN = frozenset(
    {features.FRICTION, features.LAGGED, features.SLOPE, features.WEIGHT, features.OFF_CENTRE}
    | {features.UNILATERAL, features.DEAD_BAND}
)
UNIT_POWERS = (-6, -3, 3, 6)  # of ten, by which a unit of length may be off
NEAR_POWER = 0.5  # of the exponent: what creeps and slides differs by a factor of a few from program to program
FRICTION_CAUSES = frozenset({"friction-factor", "cohesion", "shear-springs-factor"})
NORMAL_CAUSES = frozenset({"springs-factor", "normal-springs-factor"})
OTHER_SLOPE = "another slope or coefficient of friction"
UNIFORM = 1e-3  # relative; times are often printed with four digits


@dataclass(frozen=True, eq=False)
class SlopeReading:
    """Displacements of the centroid along and across the base at every step, signs corrected."""

    place: Array  # m, (steps, 2)
    rounding: Array  # m, (steps, 2)
    step: float  # s
    corrected: tuple[Slip, ...]
    notes: tuple[str, ...]

    @property
    def slips(self) -> tuple[str, ...]:
        """Ids of the errors of sign and unit that were corrected, each once."""
        return tuple(sorted({slip.cause for slip in self.corrected}))


def read(scene: Scene, foreign: Foreign) -> SlopeReading:
    """Return what a history holds of a block with friction.

    Raises
    ------
    InputError
        The history lacks a column or a step, or its steps are not equal.
    """
    if foreign.sideways is None:
        raise InputError(
            "a history with friction must have it",
            source=scene.name,
            field=SIDEWAYS,
            value="none",
            advice=f"name it with --columns {SIDEWAYS}=NAME",
        )
    stepping = steppings(foreign, scene.time.step)[0]
    steps = stepping.steps
    if len(stepping.rows) != len(steps):
        last, rows = float(np.max(np.diff(foreign.time))), len(stepping.rows)
        raise InputError(
            "with friction a history must show every step",
            source=scene.name,
            field="time",
            value=f"one of {len(steps) // rows} or so: its rows are {last:.6g} s apart, the scene's step is "
            f"{scene.time.step:.6g} s",
            advice=f"if that is the program's step, use --set time.step={last:.6g}",
        )
    refused = partial(InputError, "with friction all steps must be equal, in seconds", source=scene.name, field="time")
    if stepping.factor != 1:
        value = f"{stepping.factor:g} times the scene's"
        raise refused(value=value, advice=f"use {remedy_of(foreign, [Slip('unit', 'time', stepping.factor)])}")
    if np.ptp(steps) > UNIFORM * steps[0]:
        raise refused(value="others")
    place = np.column_stack([foreign.sideways, foreign.displacement])
    units = [
        last_digits(column) if unit is None else unit
        for column, unit in zip(place.T, (foreign.sideways_rounding, foreign.rounding), strict=True)
    ]
    # a column goes with its load at first
    first = np.sum(place[: max(4, len(place) // 50)], axis=0)
    signs = np.where(first * body_of(scene).load < 0, -1.0, 1.0)
    names = SIDEWAYS, DISPLACEMENT
    corrected = [Slip("sign", name, -1.0) for name, sign in zip(names, signs, strict=True) if sign < 0]
    step = float(np.mean(steps))
    factor = 1.0
    run = displacements(at_step(scene, step, len(place)))
    if run is not None and np.any(run) and np.any(place):
        ratio = math.log10(largest(place) / largest(run))
        factor = next((10.0**power for power in UNIT_POWERS if abs(ratio - power) < NEAR_POWER), 1.0)
    if factor != 1:
        corrected += [Slip("unit", name, factor) for name in names]
    notes = (stepping.note,) if stepping.note else ()
    return SlopeReading(place * signs / factor, np.column_stack(units) / factor, step, tuple(corrected), notes)


def is_scene(scene: Scene, reading: SlopeReading) -> bool:
    """Whether a history is the scene's own as it is read, no sign or unit corrected."""
    exact = at_step(scene, reading.step, len(reading.place))
    return not reading.corrected and agreement(exact, reading.place, reading.rounding).same


def refuse_other_scenes(scene: Scene) -> None:
    """Refuse what is not a rectangle that lies at rest on its springs."""
    more = sorted(set(features.of(scene)) - KNOWN)
    at_rest = scene.contact.gap == scene.block.velocity == 0
    if more or not upright(scene) or not at_rest or scene.time.alpha == 0:
        refused = ", ".join(more) or ("alpha = 0" if scene.time.alpha == 0 else "another scene")
        raise InputError(
            "with friction compare takes an upright rectangle at rest on its springs", source=scene.name, value=refused
        )


def answer_of(scene: Scene, foreign: Foreign, reading: SlopeReading) -> Answer:
    """Return the answer for a block with friction: its laws are held against the forces that the motion shows."""
    result = judge(scene, reading.place, reading.step, reading.rounding)
    ids = [*reading.slips, *result.causes] if result.explained else [UNEXPLAINED]
    departure = None
    if not all_benign(ids):
        first = 1 if reading.corrected and result.explained else result.first
        departure = Departure(first or 1, "offset")
    t = scene.time
    alike = [_alone(change) for change in result.alike]
    evidence = stages(result, reading)
    left = 0.0
    nearest: dict[str, Any] | None = None
    if result.explained:
        words = {name: result.change or words_of(name, result.values.get(name, 0.0)) for name in result.causes}
        law = "lagged" if result.lagged else "consistent"
        remainder = f"{law} friction gives the force of {share_text(result.shares[law], 4)} of the steps"
        if result.change or all_benign(ids):
            remainder = _motion(result.run)
        scheme = sentences.scheme_words(t.alpha, t.delta, t.discount)
        subject = sentences.Subject(scheme, words_of_slips(reading.corrected) | words, departure, remainder)
        sentence = sentences.sentence(subject)
    else:
        left = significant(min(1.0, np.nanmax([1 - max(result.shares.values()), result.run.left])), 4)
        nearest = {"causes": list(result.causes), "values": result.values, "left": left}
        sentence = sentences.not_explained(sentences.Subject("", {}, None, "", alike), nearest, left, evidence)
    return Answer(
        scheme={"alpha": t.alpha, "delta": t.delta, "gg": t.discount},
        ranking=[row_of(DDA, t.alpha, t.delta, t.discount, result.normal, result.values.get("base-compliance", 0.0))],
        departure=departure,
        causes=ids,
        opened=result.opened if result.explained else None,
        sentence=sentence,
        notes=(*foreign.notes, *reading.notes),
        misfit=result.normal,
        curves={"the file": (foreign.time, foreign.displacement)},
        values=result.values if result.explained else {},
        unexplained=left,
        nearest=nearest,
        alike=alike,
        evidence=evidence,
        slips=reading.corrected if result.explained else (),
    )


def _alone(change: OneChange) -> dict[str, Any]:
    """Return one of several changes that give the same rows, as plain data."""
    values = {} if change.value is None else {change.id: change.value}
    further = CAUSES["springs-factor"].further_scene if "springs" in change.id else OTHER_SLOPE
    return {"causes": [change.id], "values": values, "further_scene": further}


def stages(result: ContactFinding, read: SlopeReading) -> tuple[Stage, ...]:
    """Return what was measured: signs, the scene's own run, normal law, friction."""
    consistent, lagged = (share_text(result.shares[law]) for law in ("consistent", "lagged"))
    friction = (
        f"within {remainder_text(result.tolerance, 2)} % of the limit it is consistent in {consistent} of the steps, "
    )
    friction += f"lagged in {lagged}; {result.telling} steps tell which"
    if result.tolerance > BLURRED:
        friction += "; the digits of the file do not show it"
    of_scene = result.scene_run if result.change else result.run
    causes = {*result.causes} if result.explained else set()
    # whether the scene's own law gives the forces; not known where the forces suit it and the motion does not
    law_holds = True if result.run.same else None
    if result.change:
        law_holds = None if causes.isdisjoint(FRICTION_CAUSES) else False
    elif result.first is not None or max(result.shares.values()) < MOST:
        law_holds = False
    if result.tolerance > BLURRED:
        law_holds = None
    right = "; ".join(slip.words for slip in read.corrected) or "signs, units and columns are the scene's"
    pressed = f"the normal forces are those of the springs to {remainder_text(result.normal, 2)} %"
    is_normal = result.normal <= NORMAL and causes.isdisjoint(NORMAL_CAUSES)
    misfit = None if math.isnan(of_scene.left) else of_scene.left
    shares: dict[str, float | None] = {**result.shares, "telling": result.telling, "allowed": result.tolerance}
    return (
        Stage("reading", not read.slips, right, {}),
        Stage("motion", result.run.same and not result.change, _motion(of_scene), {"misfit": misfit}),
        Stage("normal forces", is_normal, pressed, {"misfit": result.normal, "allowed": NORMAL}),
        Stage("friction", law_holds, friction, shares),
    )


def _motion(run: Agreement) -> str:
    """Return what a run of the suite leaves of the displacements, in words."""
    if run.same:
        part = f" up to step {run.until}, beyond which the scene amplifies rounding" if run.until else ""
        return f"the suite's own run gives the displacements to their digits or noise{part}"
    if math.isnan(run.left):
        return "the suite has no run of it"
    return f"the suite's own run leaves {remainder_text(run.left, 2)} % of the displacements"
