"""Judgement of another program by its history: the same, or where and how it departs, why, and what is not known."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from dda.one_block.variants import Column, Variant, histories
from validation.compare import causes, departure, evidence, families, sentences
from validation.compare.causes import CAUSES, DIVERGED, UNEXPLAINED
from validation.compare.decision import Verdict
from validation.compare.departure import Departure
from validation.compare.evidence import Stage
from validation.compare.fits.fit import Interval, fit, intervals, untold
from validation.compare.fits.rectangle import own_variant, rectangle_of
from validation.compare.fits.responses import computed
from validation.compare.fits.target import Target
from validation.compare.other_solvers import Goal, Rival, rivals
from validation.compare.other_verdict import RivalVerdict, judged
from validation.compare.ranking import ranking, row_of
from validation.compare.reading import Foreign, steppings
from validation.compare.readings import Reading, readings_of, slips
from validation.compare.search import paired, simple
from validation.compare.slopes import answer
from validation.compare.slopes.judge import judge
from validation.errors import InputError
from validation.runs.history import Array
from validation.scenes import features
from validation.scenes.scene import Scene

DDA = "dda"
RIVALS = ("bar", "continuum")
MODEL_WORDS = {DDA: "one strain per block (DDA)", "bar": "the exact bar, which fine finite elements converge to"}
PLAIN = 0.3  # relative L2 that one cause leaves, below which no other sign or unit is looked for
RIVAL = 0.25  # share of DDA's misfit below which another solver is the model


@dataclass(frozen=True, eq=False)
class Answer:
    """The answer to `compare`; `as_dict` is what ``--json`` prints."""

    scheme: dict[str, float | None]  # alpha, delta, gg
    ranking: list[dict[str, Any]]  # the best first
    departure: Departure | None
    causes: list[str]
    opened: tuple[int, int] | None  # first step and last
    sentence: str
    notes: tuple[str, ...] = ()
    told: dict[str, Interval] = field(default_factory=dict)  # alpha, delta, gg and what was free with them
    untold: list[dict[str, float]] = field(default_factory=list)
    misfit: float = 0.0  # of the best explanation, relative L2 [-]
    curves: dict[str, tuple[Array, Array]] = field(default_factory=dict)  # name to time [s] and displacement [m]
    values: dict[str, float] = field(default_factory=dict)  # id to number
    unexplained: float = 0.0  # share of the difference that is left [-]
    nearest: dict[str, Any] | None = None  # where nothing explains it
    alike: list[dict[str, Any]] = field(default_factory=list)  # causes that give the same rows
    evidence: tuple[Stage, ...] = ()

    @property
    def departs(self) -> bool:
        """Whether the history is another one than the scene's."""
        return self.departure is not None

    def as_dict(self) -> dict[str, Any]:
        """Return plain data."""
        gone = None if self.departure is None else {"step": self.departure.step, "kind": self.departure.kind}
        return {
            "sentence": self.sentence,
            "causes": self.causes,
            "values": self.values,
            "unexplained": self.unexplained,
            "nearest": self.nearest,
            "alike": self.alike,
            "departure": gone,
            "opened": None if self.opened is None else list(self.opened),
            "scheme": self.scheme,
            "ranking": self.ranking,
            "evidence": [stage.as_dict() for stage in self.evidence],
        }


@dataclass(frozen=True, eq=False)
class Case:
    """A scene, a history, and the reading of it that explains most."""

    scene: Scene
    foreign: Foreign
    reading: Reading
    target: Target
    own: Variant


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
    features.refuse_column(scene, "compare")
    features.refuse_damping(scene, "compare")
    if features.FRICTION in features.of(scene):
        return _with_friction(scene, foreign)
    column = rectangle_of(scene)
    if not features.linear(scene) and column is None:
        raise InputError(
            f"{scene.name}: compare takes linear scenes and centred ones on contact that opens, got one with "
            + ", ".join(features.of(scene))
        )
    features.refuse_sweep(scene)
    if not np.any(foreign.displacement):
        raise InputError(f"{scene.name}: displacement: must not be zero throughout, got zeros only")
    if column is None:
        return _without_rectangle(scene, foreign)
    own = own_variant(scene)
    read = readings_of(scene, column, own, foreign)
    factor = _growth(column, own, read[0])
    if factor is not None:
        return _diverged(_case(scene, foreign, read[0], column, own), factor)
    case, verdict = _best(scene, foreign, read, column, own)
    misfits = [stage.numbers["misfit"] for stage in _stages(case) if "misfit" in stage.numbers] if tolerance else []
    if misfits and all(misfit is not None and misfit <= tolerance for misfit in misfits):
        verdict = Verdict(verdict.own, replace(verdict.best, moves=(), fit=verdict.own), True)
    theirs: RivalVerdict | None = None
    if not (verdict.explained or verdict.reached) and scene.contact.law == "locked":
        names = RIVALS if scene.block.poisson == 0 else ("fem",)
        theirs = judged(scene, case.reading, RIVAL * verdict.best.fit.misfit, names)
        if theirs is not None and theirs.explained:
            return _answer_of_rival(foreign, case.reading, theirs, _stages(case))
        verdict = paired(case.target, own, verdict)
    linear = scene.contact.law == "locked"
    return _answer(case, verdict, _others(scene, case, verdict, theirs.ranked if theirs else ()) if linear else [])


# ---- reading --------------------------------------------------------------------------------------------------------


def _case(scene: Scene, foreign: Foreign, reading: Reading, column: Column, own: Variant) -> Case:
    s = reading.stepping
    columns = reading.displacement, reading.pressure, reading.rounding, reading.pressure_rounding
    return Case(scene, foreign, reading, Target(column, s.steps, s.rows, *columns), own)


def _growth(column: Column, own: Variant, reading: Reading) -> float | None:
    """Return the growth in a step of the displacement or the pressure, None if both are bounded."""
    rows, found = reading.stepping.rows, computed(column, [own], reading.stepping.steps)
    pairs = [(reading.displacement, found.displacement), (reading.pressure, found.pressure)]
    factors = [evidence.growth(values, wanted[rows, 0]) for values, wanted in pairs if values is not None]
    return next((f for f in factors if f is not None), None)


def _best(
    scene: Scene, foreign: Foreign, read: Sequence[Reading], column: Column, own: Variant
) -> tuple[Case, Verdict]:
    """Return the likeliest reading that a cause explains, else the one that one comes nearest to."""
    tried = []
    for reading in read:
        case = _case(scene, foreign, reading, column, own)
        verdict = simple(case.target, own)
        if verdict.reached or verdict.explained:
            return case, verdict
        tried.append((case, verdict))
        if verdict.best.fit.misfit < PLAIN:
            break
    return min(tried, key=lambda pair: pair[1].best.fit.misfit)


def _others(scene: Scene, case: Case, verdict: Verdict, known: Sequence[Rival]) -> list[Rival]:
    """Return the other solvers' best answers, for the ranking."""
    v, steps = verdict.best.fit.variant, case.reading.stepping.steps
    names: tuple[str, ...] = RIVALS if scene.block.poisson == 0 else ("fem",)
    if np.ptp(steps) > 0:
        return []
    schemes: Iterable[tuple[float, float]] = [(v.alpha, v.delta)]
    r = case.reading
    return rivals(r.scene_of(scene), names, Goal(r.stepping.rows, r.displacement, r.pressure), schemes, known)


# ---- answers --------------------------------------------------------------------------------------------------------


def _stages(case: Case, factor: float | None = None) -> list[Stage]:
    rows, found = case.reading.stepping.rows, computed(case.target.column, [case.own], case.target.steps)
    wanted = found.displacement[rows, 0], found.pressure[rows, 0]
    return evidence.stages(case.target, wanted, case.reading.slips, case.reading.stepping.note, factor)


def _answer(case: Case, verdict: Verdict, others: Sequence[Rival]) -> Answer:
    target, own, found = case.target, case.own, verdict.best.fit
    stages = _stages(case)
    named_ = list(case.reading.slips) + causes.causes_of(target, verdict.best.ids, found.variant, own)
    ids = named_ if verdict.explained else [UNEXPLAINED]
    v = found.variant if verdict.explained else own
    steps = _opened(target, found.variant) if verdict.explained else []
    shown = verdict.best.fit if verdict.explained else verdict.own
    expected = departure.expected(target, shown, own)
    gone = departure.departure(target, expected, ids, steps)
    told = fit(target, [(v, tuple(dict.fromkeys(("alpha", "delta", "gg", *shown.free))))])[0]
    values = causes.values_of(target, ids, v)
    soft = causes.compliance(target, v)
    alike = families.as_good(target, verdict) or families.relatives(target, ids, values)
    nearest = None if verdict.explained or verdict.alike else _nearest(target, verdict, named_)
    said = sentences.Said(v, own, ids, values, gone, steps, found.misfit, soft)
    if not verdict.explained:
        sentence = sentences.not_explained(said, nearest, alike, verdict.left, stages)
    else:
        sentence = sentences.sentence(said, alike)
    time = np.cumsum(target.steps)[target.rows]
    best = computed(target.column, [found.variant], target.steps).displacement[target.rows, 0]
    curves = {"the file": target.displacement, DDA: expected[target.rows], "best": best}
    return Answer(
        {"alpha": v.alpha, "delta": v.delta, "gg": v.gg},
        ranking(DDA, target, v, shown.free, others),
        gone,
        ids,
        (steps[0], steps[-1]) if steps else None,
        sentence,
        _notes(case.foreign, case.reading),
        intervals(told) if verdict.explained else {},
        untold(told) if verdict.explained else [],
        found.misfit,
        {name: (time, curve) for name, curve in curves.items()},
        values,
        float(f"{verdict.left:.4g}") if not verdict.explained else 0.0,
        nearest,
        alike,
        tuple(stages),
    )


def _nearest(target: Target, verdict: Verdict, ids: list[str]) -> dict[str, Any]:
    """Return what comes nearest, and how much of the difference it leaves."""
    values = causes.values_of(target, ids, verdict.best.fit.variant)
    return {"causes": ids, "values": values, "left": float(f"{verdict.left:.4g}")}


def _opened(target: Target, v: Variant) -> list[int]:
    """Return the steps, counted from 1, at whose end the contact of a variant is open."""
    if not v.opens:
        return []
    return [int(i) + 1 for i in np.flatnonzero(computed(target.column, [v], target.steps).open[:, 0])]


def _diverged(case: Case, factor: float) -> Answer:
    """Return the answer to a history without bounds: no cause beyond that is looked for."""
    target, stages = case.target, _stages(case, factor)
    expected = histories(target.column, [case.own], target.steps).displacement[:, 0]
    gone = departure.unbounded(expected[target.rows], target.displacement, target.rows)
    time = np.cumsum(target.steps)[target.rows]
    v = case.own
    return Answer(
        {"alpha": v.alpha, "delta": v.delta, "gg": v.gg},
        [],
        gone,
        [DIVERGED],
        None,
        sentences.diverged(gone, factor),
        _notes(case.foreign, case.reading),
        curves={"the file": (time, target.displacement), DDA: (time, expected[target.rows])},
        values={DIVERGED: float(f"{factor:.6g}")},
        evidence=tuple(stages),
    )


def _notes(foreign: Foreign, reading: Reading) -> tuple[str, ...]:
    said = (reading.stepping.note,) if reading.stepping.note else ()
    slipped = tuple(CAUSES[name].words for name in reading.slips)
    return (*foreign.notes, *said, *slipped)


def _answer_of_rival(foreign: Foreign, reading: Reading, verdict: RivalVerdict, stages: Sequence[Stage] = ()) -> Answer:
    """Return the answer where another solver than DDA, or the linear DDA of any polygon, explains the history best."""
    best, rows = verdict.best, reading.stepping.rows
    ids = [*reading.slips, *verdict.causes] if verdict.explained else [UNEXPLAINED]
    gone = None
    if any(not CAUSES[name].benign for name in ids):
        gone = departure.measured(verdict.own[rows], reading.displacement, rows, 0.0)
    time = np.cumsum(reading.stepping.steps)[rows]
    return Answer(
        {"alpha": best.alpha, "delta": best.delta, "gg": best.gg},
        [row_of(r.model, r.alpha, r.delta, r.gg, r.misfit, None) for r in verdict.ranked],
        gone,
        ids,
        None,
        sentences.rival_sentence(verdict, ids, gone, MODEL_WORDS),
        _notes(foreign, reading),
        misfit=best.misfit,
        curves={"the file": (time, reading.displacement), best.model: (time, best.displacement[rows])},
        values=verdict.values if verdict.explained else {},
        unexplained=0.0 if verdict.explained else verdict.left,
        evidence=tuple(stages),
    )


def _with_friction(scene: Scene, foreign: Foreign) -> Answer:
    """Return the answer for a block with friction: its laws are held against the forces that the motion shows."""
    read = answer.read(scene, foreign)
    found = judge(scene, read.place, read.step, read.rounding)
    ids = answer.ids_of(found, read)
    t = scene.time
    left = float(f"{min(1.0, np.nanmax([1 - max(found.shares.values()), found.run.left])):.4g}")
    near = {"causes": list(found.causes), "values": found.values, "left": left}
    return Answer(
        {"alpha": t.alpha, "delta": t.delta, "gg": t.discount},
        [row_of(DDA, t.alpha, t.delta, t.discount, found.normal, found.values.get("base-compliance", 0.0))],
        answer.departure_of(found, ids),
        ids,
        found.opened if found.explained else None,
        answer.sentence(scene, found, ids),
        (*foreign.notes, *read.notes),
        misfit=found.normal,
        curves={"the file": (foreign.time, foreign.displacement)},
        values=found.values if found.explained else {},
        unexplained=0.0 if found.explained else left,
        nearest=None if found.explained else near,
        evidence=tuple(answer.stages(found, read)),
    )


def _without_rectangle(scene: Scene, foreign: Foreign) -> Answer:
    """Return the answer for a block that is no upright rectangle, or that turns: linear models alone are tried."""
    from validation.solvers.registry import get_solver

    tried = []
    for stepping in steppings(foreign, scene.time.step):
        if np.ptp(stepping.steps) > 0:
            continue
        plain = Reading(stepping, foreign.displacement, foreign.pressure, ())
        run = get_solver(DDA).solve(plain.scene_of(scene))
        rows = stepping.rows
        for reading in slips(foreign, stepping, run.displacement[rows], run.contact_pressure[rows]):
            verdict = judged(scene, reading, 1.0, (DDA, "fem"), DDA)
            tried += [(reading, verdict)] if verdict is not None else []
    if not tried:
        raise InputError(f"{scene.name}: the times of the history are not uniform, which this scene needs")
    reading, verdict = min(tried, key=lambda pair: (not pair[1].explained, pair[1].best.misfit))
    note = "the block is not an upright rectangle: opening and updated geometry are not tried"
    return _answer_of_rival(replace(foreign, notes=(*foreign.notes, note)), reading, verdict)
