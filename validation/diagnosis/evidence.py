"""What can be measured of a history: where it leaves what the scene expects, and what a person would look at in turn.

Every stage puts the file beside the scene's own history; none depends on a fit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from validation.diagnosis.causes import all_benign
from validation.diagnosis.constants import ARITHMETIC, CLEARLY, SEEN, SIGMAS, SLIGHT, UNBOUNDED
from validation.diagnosis.fits.bar import norm
from validation.diagnosis.fits.fit import Fit
from validation.diagnosis.fits.target import Target
from validation.diagnosis.readings import Reading
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Variant
from validation.metrics.poles import swing
from validation.metrics.values import largest
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.numbers import share_text

Kind = Literal["phase", "amplitude", "damping", "offset"]
ROWS_IN_WORDS = 3  # single rows that a sentence tells


@dataclass(frozen=True)
class Departure:
    """The first step at which a history leaves the expected one, and how it does."""

    step: int  # counted from 1
    kind: Kind


def shown(target: Target, v: Variant) -> Array:
    """Return displacement [m] and pressure [Pa] of a variant at the recorded rows, (2, rows)."""
    run = histories(target.column, [v], target.steps)
    return np.array([run.displacement[target.rows, 0], run.pressure[target.rows, 0]])


def expected(target: Target, explanation: Fit, scene: Variant, causes: Sequence[str]) -> Array:
    """Return the same of the scene's own scheme with what a program may add without fault.

    That is the fit's weight, moving geometry and slightly compliant base.
    """
    v = explanation.variant
    yields = "base-compliance" in causes
    softness, base = (v.softness, v.base) if yields else (0.0, 0.0)
    return shown(target, replace(scene, softness=softness, base=base, weight=v.weight, updated=v.updated))


def departure(
    target: Target, expected_columns: Array, causes: Sequence[str], open_steps: Sequence[int]
) -> Departure | None:
    """Return where the history departs; None if there is no cause but benign ones.

    The column that leaves first by more than digits and noise dates it. A contact that opens is a departure from its
    first open step on, even before the displacement shows it.
    """
    if all_benign(causes):
        return None
    if {"sign", "unit"} & set(causes):
        return Departure(int(target.rows[0]) + 1, "amplitude")
    columns = list(zip(target.recorded, expected_columns, target.bars, strict=False))
    departing = [(ours, theirs, bar) for ours, theirs, bar in columns if not bar.holds(ours - theirs)]
    dated = [measured(theirs, ours, target.rows, bar.spread) for ours, theirs, bar in departing or columns[:1]]
    first = replace(dated[0], step=min(one.step for one in dated))
    if open_steps and set(causes) & {"contact-opened"} and first.step > open_steps[0]:
        return Departure(open_steps[0], first.kind)
    return first


def unbounded(expected_values: Array, recorded: Array, rows: np.ndarray) -> Departure:
    """Return the first step at which a history without bounds has left the expected one."""
    away = np.abs(recorded - expected_values) > SEEN * largest(expected_values)
    return Departure(int(rows[int(np.argmax(away))]) + 1, "amplitude")


def measured(expected_values: Array, recorded: Array, rows: np.ndarray, noise: float) -> Departure:
    """Return the first step beyond tolerance and the manner that explains most of the difference.

    The manners are the derivatives of the expected history r about its last value s: a factor on s (offset), a
    factor on r - s (amplitude), a stretch of time (phase), a further decay (damping).
    """
    with np.errstate(all="ignore"):
        size = largest(recorded) or 1.0
        r = np.clip(np.nan_to_num(expected_values), -1e3 * size, 1e3 * size)
    d = recorded - r
    tolerance = max(SEEN * size, SIGMAS * noise)
    beyond = np.flatnonzero(np.abs(d) > tolerance)
    first = int(beyond[0]) if beyond.size else int(np.argmax(np.abs(d)))
    t = (rows + 1) / (rows[-1] + 1)
    static = float(np.mean(r[-max(2, len(r) // 10) :]))
    swing = r - static
    rate = np.gradient(r, t)
    manners: list[tuple[Kind, Array]] = [
        ("offset", np.full_like(r, static)),
        ("amplitude", swing),
        ("damping", t * swing),
        ("phase", t * rate),
        ("phase", rate),
    ]
    shares = [(float(d @ basis) ** 2 / (float(basis @ basis) or 1.0), kind) for kind, basis in manners]
    return Departure(int(rows[first]) + 1, max(shares)[1])


@dataclass(frozen=True)
class Stage:
    """One question, its answer (None: cannot be told) and the numbers that it rests on."""

    name: str
    agrees: bool | None
    words: str
    numbers: dict[str, float | None]


def surrounded(stage: Stage, explained_by: str = "what surrounds the block") -> Stage:
    """Return a stage whose number differs from the scene's for a reason that is no fault."""
    if stage.agrees is not False:
        return stage
    return replace(stage, agrees=None, words=f"{stage.words}; {explained_by} explains it")


def growth(values: Array, expected: Array) -> float | None:
    """Return the factor by which a diverging history grows in a step, None if it is bounded."""
    bounded = np.nan_to_num(expected, posinf=1e300, neginf=-1e300)
    thirds, theirs = ([largest(part) for part in np.array_split(each, 3)] for each in (values, bounded))
    if thirds[2] <= UNBOUNDED * max(theirs):
        grows = thirds[2] > CLEARLY**2 * thirds[0] * max(1.0, theirs[2] / (theirs[0] or 1.0))
        if not (grows and thirds[2] > thirds[1] and thirds[2] > CLEARLY**2 * max(theirs)):
            return None
    return math.exp((math.log(thirds[2]) - math.log(thirds[1] or thirds[2])) / (len(values) / 3))


def reading_stage(reading: Reading) -> Stage:
    """Return whether a history reads as the scene's: its errors of sign and unit, what differs in its times."""
    note = reading.stepping.note
    words = ", ".join(reading.slips) or "units, signs and columns are the scene's"
    return Stage("reading", not reading.slips, words + (f"; {note}" if note else ""), {})


def words_of_rows(single_rows: Sequence[tuple[str, int, float]]) -> str:
    """Return single rows by column and step, with errors over the column's largest value."""
    words = [
        f"{name.replace('_', ' ')} in step {step}, {share_text(error, 2)} off" for name, step, error in single_rows
    ]
    more = len(words) - ROWS_IN_WORDS
    return "; ".join(words[:ROWS_IN_WORDS]) + (f"; and {more} more" if more > 0 else "")


def single_rows_stage(single_rows: Sequence[tuple[str, int, float]]) -> Stage:
    """Return the stage of single rows that stand out of the rest of the history."""
    return Stage("rows", False, words_of_rows(single_rows), {"rows": float(len(single_rows))})


def earlier(departure: Departure | None, single_rows: Sequence[tuple[str, int, float]]) -> Departure:
    """Return the first departure, of the motion or of a single row."""
    first = min(step for _, step, _ in single_rows)
    if departure is None or first <= departure.step:
        return Departure(first, "amplitude")
    return departure


def stages(target: Target, expected: Array, reading: Reading) -> list[Stage]:
    """Return the stages up to the damping, with the scene's own displacement and pressure at the recorded rows."""
    measured = [reading_stage(reading)]
    for name, values, expected_values, bar in zip(
        (DISPLACEMENT, PRESSURE), target.recorded, expected, target.bars, strict=False
    ):
        with np.errstate(all="ignore"):
            misfit = min(norm(values - expected_values) / (bar.norm or 1.0), 1e6)
        agrees = bar.holds(values - expected_values)
        beside = f" (digits and noise: {share_text(bar.allowed, 1)})"
        measured.append(column_stage(name, agrees, misfit, beside, {"allowed": bar.allowed}))
    return measured + _motion(target, expected[0])


def horizon(time: float) -> str:
    """Return the words for the end of what is judged of a motion that enlarges differences [s]."""
    return f"two correct codes agree up to t = {time:.6g} s only; later rows are not judged"


def column_stage(name: str, agrees: bool, misfit: float, beside: str, numbers: dict[str, float | None]) -> Stage:
    """Return whether a column alone is the scene's, with its relative L2 difference."""
    what = "is the scene's" if agrees else f"is {share_text(misfit)} off{beside}"
    return Stage(name, agrees, f"the {name.replace('_', ' ')} alone {what}", {"misfit": misfit, **numbers})


def _motion(target: Target, expected: Array) -> list[Stage]:
    """Return where file and scene come to rest, and how their strongest motion swings."""
    steps = np.diff(target.rows)
    if np.ptp(target.steps) > ARITHMETIC * target.steps[0] or np.ptp(steps) > 0:
        return [Stage(name, None, "not told by unequal rows", {}) for name in ("statics", "frequency", "damping")]
    step = float(target.steps[0]) * float(steps[-1])
    theirs = swing(target.displacement, step)
    ours = swing(expected, step)
    close = target.bars[0].allowed
    stages = [_beside("statics", "comes to rest at", "m", theirs.static, ours.static, max(close, SEEN))]
    for name, verb, unit, least in (
        ("frequency", "swings at", "rad/s", SEEN),
        ("damping", "is damped by", "of critical", SLIGHT),
    ):
        file, scene = (None if each.pole is None else float(getattr(each.pole, name)) for each in (theirs, ours))
        stages.append(_beside(name, verb, unit, file, scene, max(close, least)))
    return stages


def _beside(name: str, verb: str, unit: str, file: float | None, scene: float | None, close: float) -> Stage:
    if file is None or scene is None:
        return Stage(name, None, "not told by these rows", {"file": file, "scene": scene, "ratio": None})
    least = SEEN if name == "damping" else 0.0
    agrees = abs(file - scene) <= max(close * abs(scene), least)
    ratio = file / scene if abs(scene) > 1e-12 and abs(file / scene) < 1e6 else None
    words = f"{verb} {file:.5g} {unit}, " + ("as the scene" if agrees else f"the scene {scene:.5g}")
    return Stage(name, agrees, words, {"file": file, "scene": scene, "ratio": ratio})
