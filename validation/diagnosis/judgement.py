"""Judgement of another program by its history: the same, or where, how and why it departs, and what is not known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from validation.diagnosis import causes, evidence, families, schemes, sentences, slopes
from validation.diagnosis.answer import Answer, curves, finished
from validation.diagnosis.beside import RunVerdict, answer_of
from validation.diagnosis.causes import CAUSES, DIVERGED, SINGLE_ROWS, SWAPPED, UNEXPLAINED
from validation.diagnosis.constants import ARITHMETIC, CLEARLY, FARTHER, ORDER, SAME_NUMBER
from validation.diagnosis.evidence import Stage
from validation.diagnosis.fits.fit import Fit, explains, fit_one, intervals, untold
from validation.diagnosis.fits.target import Target
from validation.diagnosis.hooks import DiagnosisHooks
from validation.diagnosis.other_solvers import (
    as_they_are,
    judged_without_rectangle,
    not_installed,
    rivals_of,
    searches_beside,
    with_one_change,
)
from validation.diagnosis.reading import SIDEWAYS, Foreign
from validation.diagnosis.readings import (
    Reading,
    exchanged,
    has_swapped_columns,
    readings_of,
    remedy_of,
)
from validation.diagnosis.scene_keys import assignments
from validation.diagnosis.search import Verdict, as_it_is, simple, twofold, with_same_rows
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import OPENING, Flags, Rectangle, Variant, own_variant, rectangle_of
from validation.errors import InputError
from validation.metrics.contact import SHIFT
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.numbers import remainder_text, significant
from validation.scenes import features
from validation.scenes.scene import Scene

NAMES = (DISPLACEMENT, PRESSURE)


@dataclass(frozen=True, eq=False)
class Case:
    """A scene, a history, and the reading of it that explains most."""

    scene: Scene
    foreign: Foreign
    reading: Reading
    column: Rectangle
    scene_variant: Variant
    left_out: Flags | None = None  # single rows of each column that are none of the motion's
    as_read: Reading | None = None  # with those rows as in the file; in `reading` they are as explained

    @cached_property
    def target(self) -> Target:
        """What is to be explained."""
        r = self.reading
        return Target(self.column, r.stepping.steps, r.stepping.rows, r.recorded, r.rounding, self.left_out)

    @property
    def single_rows(self) -> list[tuple[str, int, float]]:
        """Column, step and error over the largest value of each row that is none of the motion's."""
        if self.left_out is None or self.as_read is None:
            return []
        mended = self.target.recorded
        errors = np.abs(self.as_read.recorded - mended) / np.max(np.abs(mended), axis=1, keepdims=True)
        places = np.argwhere(self.left_out).tolist()
        return [(NAMES[i], int(self.target.rows[row]) + 1, float(errors[i, row])) for i, row in places]

    def without_single_rows(self, explanation: Fit) -> Case | None:
        """Return the case without the single rows that stand out of what a fit leaves; None where none do."""
        target = self.target
        left_out = target.outlying(explanation.residual)
        if left_out is None:
            return None
        mended = target.recorded - np.where(left_out, target.parts(explanation.residual), 0.0)
        rounding = np.array([bar.rounding for bar in target.bars])
        reading = replace(self.reading, recorded=mended, rounding=rounding)
        return replace(self, reading=reading, left_out=left_out, as_read=self.reading)

    @property
    def time(self) -> Array:
        """Times of the recorded rows [s]."""
        return np.asarray(np.cumsum(self.target.steps)[self.target.rows])

    @cached_property
    def expected(self) -> Array:
        """Displacement [m] and pressure [Pa] of the scene's own run at the recorded rows, (2, rows)."""
        return evidence.shown(self.target, self.scene_variant)

    @cached_property
    def stages(self) -> list[Stage]:
        """What is seen beside that run, without a cause."""
        return evidence.stages(self.target, self.expected, self.reading)


def compare(scene: Scene, foreign: Foreign, tolerance: float = 0.0) -> Answer:
    """Judge a history against the scene.

    Parameters
    ----------
    tolerance
        Relative L2 difference up to which a column counts as the scene's own [-].

    Raises
    ------
    InputError
        The scene has a sweep or a feature that is not known here, or the history is zero throughout or does not fit.
    """
    hooks = DiagnosisHooks.of(scene)
    hooks.check(scene)
    features.refuse_damping(scene, "compare")
    features.refuse_sweep(scene)
    pair = _swapped(scene, foreign)
    if pair is not None:
        foreign = exchanged(foreign, *pair)
    answer = hooks.judged(scene, foreign, tolerance)
    options = [remedy_of(foreign, answer.slips), answer.remedy]
    if pair is not None:
        first, second = (name.replace("_", " ") for name in pair)
        sentence = f"The {first} is in the column of the {second}, and the reverse. Read so: {answer.sentence}"
        ids = answer.causes if UNEXPLAINED in answer.causes else [SWAPPED, *answer.causes]
        answer = replace(answer, causes=ids, sentence=sentence)
        options.insert(0, f"--columns {','.join(f'{name}={place}' for name, place in foreign.header.theirs.items())}")
    return replace(answer, remedy=" ".join(filter(None, options)))


def _swapped(scene: Scene, foreign: Foreign) -> tuple[str, str] | None:
    """Return two columns in each other's place: by their size, with friction where the scene's own run says so."""
    if features.FRICTION not in features.of(scene):
        return (DISPLACEMENT, PRESSURE) if has_swapped_columns(scene, foreign) else None
    pair = (DISPLACEMENT, SIDEWAYS)
    for read, swapped in ((foreign, None), (exchanged(foreign, *pair), pair)):
        search = slopes.search_of(scene, read)
        if search.is_scene() and not search.reading.corrected:
            return swapped
    return None


def check_block(scene: Scene) -> None:
    """Refuse a block that compare does not step, or the solvers beside it, by its scheme."""
    is_frictional = features.FRICTION in features.of(scene)
    is_rectangle = rectangle_of(scene) is not None
    by_newmark_only = {
        "blocks with friction": is_frictional,
        "blocks that are no upright rectangle under a centred load": not is_rectangle,
        "contact that opens under a block with Poisson's ratio": scene.contact.law == "unilateral"
        and scene.block.poisson,
    }
    for what, holds in by_newmark_only.items():
        if holds and scene.time.scheme != "newmark":
            rule = f"compare takes {what} with Newmark's scheme only"
            raise InputError(rule, source=scene.name, field="time.scheme", value=f'"{scene.time.scheme}"')
    if is_frictional or not is_rectangle:
        features.refuse_ramp(scene, "compare, but for upright rectangles without friction,")
    if not (is_frictional or is_rectangle or features.linear(scene)):
        raise InputError(
            "compare takes linear scenes, and centred loads on blocks that rest on unilateral contact",
            source=scene.name,
            value=", ".join(_beyond(scene)),
        )
    if is_frictional:
        slopes.refuse_other_scenes(scene)


def judged_block(scene: Scene, foreign: Foreign, tolerance: float) -> Answer:
    """Judge a history of a block that `compare` steps."""
    if features.FRICTION in features.of(scene):
        return slopes.answer_on(slopes.search_of(scene, foreign), foreign)
    foreign = replace(foreign, notes=(*foreign.notes, *not_installed(scene, rivals_of(scene))))
    column = rectangle_of(scene)
    unloaded = scene.load.gravity and not scene.load.pressure  # nothing moves where a program leaves gravity out
    if not (np.any(foreign.displacement) or (unloaded and column is not None)):
        raise InputError("must not be zero throughout", source=scene.name, field="displacement", value="zeros only")
    if column is None:
        return judged_without_rectangle(scene, foreign)
    scene_variant = own_variant(scene)
    read = readings_of(scene, column, scene_variant, foreign)
    cases = [Case(scene, foreign, reading, column, scene_variant) for reading in read]
    for values, expected in zip(read[0].recorded, cases[0].expected, strict=False):
        growth = evidence.growth(values, expected)
        if growth is not None:
            return _diverged(cases[0], growth)
    case, verdict = _best([_until_horizon(case) for case in cases] if scene_variant.opens else cases)
    misfits = [stage.numbers["misfit"] for stage in case.stages if "misfit" in stage.numbers] if tolerance else []
    if misfits and all(misfit is not None and misfit <= tolerance for misfit in misfits):
        verdict = Verdict(verdict.scene_fit, replace(verdict.best, moves=(), fit=verdict.scene_fit), True)
    if not verdict.explains:
        case, verdict = _without_single_rows(case, verdict)
    if verdict.explains:
        return _answer(case, verdict)
    single_misfit = verdict.best.fit.misfit
    has_rivals = scene.contact.law == "locked" and scene.time.scheme == "newmark" and np.ptp(case.target.steps) == 0
    rivals = searches_beside(scene, [case.reading], rivals_of(scene)) if has_rivals else []
    theirs = as_they_are(rivals) or with_one_change([rival for rival in rivals if not rival.solver.meshed])
    if theirs is None or not theirs.explained or FARTHER * theirs.left > single_misfit:
        verdict = twofold(case.target, scene_variant, verdict)
        # runs of a mesh take longest
        theirs = None if verdict.explains else with_one_change([rival for rival in rivals if rival.solver.meshed])
    if theirs is not None and theirs.explained and FARTHER * theirs.left <= single_misfit:
        return _of_rival(case, theirs)
    return _answer(case, verdict)


def _until_horizon(case: Case) -> Case:
    """Return the case with the rows up to which two correct codes agree on the scene.

    Contact that opens enlarges a difference at every landing: rounding in time makes another motion of it. A horizon
    before the first few rows cuts none: nothing could be told of these alone.
    """
    target, v = case.target, case.scene_variant
    shifted = [replace(v, **{name: getattr(v, name) + SHIFT}) for name in ("softness", "density", "young")]
    runs = histories(target.column, [v, *shifted], target.steps)
    columns = np.array([runs.displacement, runs.pressure])[:, target.rows]
    # rounding of another program is up to a tenth of `SHIFT`, 450 last bits: before the horizon it stays below
    # `ARITHMETIC`, as `SHIFT` does below ten times that
    most = CLEARLY * ARITHMETIC * np.max(np.abs(columns[..., 0]), axis=1)[:, None, None]
    beyond = np.flatnonzero(np.any(np.abs(columns - columns[..., :1]) > most, axis=(0, 2)))
    if not len(beyond) or beyond[0] < ORDER:
        return case
    rows = int(beyond[0])
    reading = case.reading
    stepping = reading.stepping
    horizon = evidence.horizon(float(case.time[rows - 1]))
    kept = replace(
        stepping,
        steps=stepping.steps[: int(stepping.rows[rows - 1]) + 1],
        rows=stepping.rows[:rows],
        note="; ".join(filter(None, [stepping.note, horizon])),
    )
    rounding = None if reading.rounding is None else reading.rounding[:, :rows]
    recorded = reading.recorded[:, :rows]
    return replace(case, reading=replace(reading, stepping=kept, recorded=recorded, rounding=rounding))


def _beyond(scene: Scene) -> list[str]:
    """Return what `compare` does not take of a scene whose contact opens."""
    stated = {"contact.gap": scene.contact.gap, "block.velocity": scene.block.velocity}
    numbers = [f"{key} = {value:g}" for key, value in stated.items() if value]
    others = [name for name in features.of(scene) if name not in OPENING]
    return numbers or others or ["another contact.band"]


def _best(cases: Sequence[Case]) -> tuple[Case, Verdict]:
    """Return the likeliest reading that a cause explains, else the nearest."""
    for case in cases:  # a slip of sign or unit needs nothing else that is changed
        verdict = as_it_is(case.target, case.scene_variant)
        if verdict.same:
            return case, verdict
    fewest = min(len(case.reading.corrected) for case in cases)
    verdicts: list[tuple[Case, Verdict]] = []
    for case in cases:
        verdict = simple(case.target, case.scene_variant)
        verdicts.append((case, verdict))
        # a slip of sign or unit beside another cause is less likely than one of a datum alone
        if verdict.explains and len(case.reading.corrected) == fewest:
            return case, verdict
        is_fewest_judged = any(len(other.reading.corrected) == fewest for other, _ in verdicts)
        if verdict.best.fit.misfit < 1 / FARTHER and is_fewest_judged:
            break
    sound = [pair for pair in verdicts if pair[1].explains]
    return sound[0] if sound else min(verdicts, key=lambda pair: pair[1].best.fit.misfit)


def _without_single_rows(case: Case, verdict: Verdict) -> tuple[Case, Verdict]:
    """Return case and verdict without single rows that stand out, if a cause, or none, then explains the history."""
    for explanation in (verdict.scene_fit, verdict.best.fit):
        rest = case.without_single_rows(explanation)
        if rest is None:
            continue
        verdict_on_rest = simple(rest.target, rest.scene_variant)
        if verdict_on_rest.explains:
            return rest, verdict_on_rest
    return case, verdict


# ---- answers ----


def _answer(case: Case, verdict: Verdict) -> Answer:
    target, scene_variant, reading = case.target, case.scene_variant, case.reading
    verdict = with_same_rows(target, scene_variant, verdict)
    best = verdict.best.fit
    error = intervals(best)["softness"].half_width if "softness" in best.free else 0.0
    single_rows = case.single_rows
    found = [SINGLE_ROWS] if single_rows else []
    found += causes.causes_of(target.column, verdict.best.ids, best.variant, scene_variant, error)
    ids = [*reading.slips, *found]
    either = families.sign_or_gravity(target, ids, reading.corrected) if verdict.explained else []
    explained = verdict.explained and not either
    v, undecided = _told_apart(target, best.variant) if explained else (best.variant, {})
    values = causes.values_of(target.column, found, v)
    alike = either or families.as_good(target, verdict)
    words: dict[str, str] = {}
    further: dict[str, Any] = {}
    steps: list[int] = []
    if explained:
        steps = _opened(target, best.variant)
        ends = causes.intervals_of(target, best, found)
        between = {name: ends[name] for name in causes.BAND_FIELDS if name in ends}
        values |= {name: causes.roundest(*limits) for name, limits in between.items()}
        if single_rows:
            values[SINGLE_ROWS] = min(step for _, step, _ in single_rows)
        alike = alike or families.relatives(target, scene_variant, verdict, ids, v)
        more = undecided | {"scheme": sentences.scheme_of(scene_variant), "rows": evidence.words_of_rows(single_rows)}
        if steps:
            more["open_steps"] = f" in steps {sentences.span(steps)}"
        for name, (low, high) in between.items():
            unit = "m" if name == "dead-band" else "Pa"
            more["between"] = f" ({low:.3g} to {high:.3g} {unit} give the same rows)"
        words = {name: causes.words_of(name, values.get(name, 0.0), v, scene_variant, **more) for name in found}
        of_scheme = ("alpha", "delta", "gg") if v.family == "newmark" else ("gg",)
        refitted = fit_one(target, v, tuple(dict.fromkeys((*of_scheme, *best.free))))
        further = {
            "opened": (steps[0], steps[-1]) if steps else None,
            "told": intervals(refitted),
            "untold": untold(refitted),
            "intervals": ends,
            "remedy": assignments(ids, v, scene_variant),
        }
    stages = list(case.stages)
    named = ids if verdict.explained else [UNEXPLAINED]
    expected = evidence.expected(target, best if verdict.explained else verdict.scene_fit, scene_variant, named)
    departure = evidence.departure(target, expected, named, steps)
    if single_rows:
        stages.insert(1, evidence.single_rows_stage(single_rows))
        departure = evidence.earlier(departure, single_rows)
    as_read = case.as_read or reading
    columns = NAMES[: len(as_read.recorded)]
    stated = v if explained else scene_variant
    answer = Answer(
        causes=found,
        values=values,
        scheme=schemes.scheme_numbers(stated),
        departure=departure,
        notes=(*case.foreign.notes, *reading.notes),
        misfit=best.misfit,
        curves=curves(case.time, columns, as_read.recorded, expected, evidence.shown(target, best.variant)),
        unexplained=0.0 if verdict.explained else significant(verdict.left, 4),
        alike=alike,
        evidence=tuple(stages),
        **further,
    )
    others = schemes.other_names(v) if explained and any(CAUSES[name].integrator for name in ids) else ""
    return finished(answer, reading, explained, words, sentences.scheme_of(stated) + others)


def _told_apart(target: Target, v: Variant) -> tuple[Variant, dict[str, str]]:
    """Return the usual one of variants that give the same rows, and in words what these leave open.

    That is the smaller split of a composite scheme, a dashpot that is clipped, and the form of a contact's force.
    """
    words = {}
    if v.family == "composite":
        first, other = sorted((schemes.split_of(v), schemes.companion_split(v)))
        words["split"] = f"split {schemes.split_of(v):.4g}"
        if other - first >= SAME_NUMBER and explains(target, replace(v, split=schemes.companion_split(v))):
            words["split"] = f"split {first:.4g} or {other:.4g}, which give the same rows while contact stays closed"
            v = replace(v, split=first)
    if v.contact == "dashpot":
        words["clipping"] = ", clipped" if v.clipped else ", not clipped: it pulls before the contact opens"
        if explains(target, replace(v, clipped=not v.clipped)):
            words["clipping"] = "; these rows do not tell whether it is clipped" if v.opens else ""
            v = replace(v, clipped=True)
    if v.opens and schemes.stages(v)[-1].af > 0:
        is_of_gaps = v.contact == "mean gap"
        if not explains(target, replace(v, contact="springs" if is_of_gaps else "mean gap")):
            of = "that of the mean gap" if is_of_gaps else "the mean of those at both ends"
            words["form"] = f", the contact force {of}"
    return v, words


def _opened(target: Target, v: Variant) -> list[int]:
    """Return the steps, from 1, at whose end the contact of a variant is open."""
    if not v.opens:
        return []
    return [int(i) + 1 for i in np.flatnonzero(histories(target.column, [v], target.steps).open[:, 0])]


def _diverged(case: Case, growth: float) -> Answer:
    """Return the answer to a history without bounds: no cause beyond that is looked for."""
    target = case.target
    first = evidence.unbounded(case.expected[0], target.displacement, target.rows)
    return Answer(
        scheme=schemes.scheme_numbers(case.scene_variant),
        departure=first,
        causes=[DIVERGED],
        sentence=f"Departs from step {first.step} on: the run diverged, by a factor of {growth:.4g} a step; "
        "nothing else can be told from it.",
        notes=(*case.foreign.notes, *case.reading.notes),
        curves=curves(case.time, NAMES[:1], target.recorded, case.expected),
        values={DIVERGED: significant(growth, 6)},
        evidence=(evidence.reading_stage(case.reading),),
    )


def _of_rival(case: Case, verdict: RunVerdict) -> Answer:
    """Return the answer where another solver than DDA explains a history."""
    answer = answer_of(case.foreign, verdict)
    displacement = case.reading.displacement
    off = float(np.linalg.norm(case.expected[0] - displacement) / np.linalg.norm(displacement))
    sentence = f"{answer.sentence[:-1]}; the scene's own run by DDA is {remainder_text(off, 2)} % off."
    stages = tuple(evidence.surrounded(stage, "another model") for stage in case.stages)
    return replace(answer, sentence=sentence, evidence=stages)
