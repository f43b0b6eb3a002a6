"""A history on a slope beside runs of its scene: as it is, as other programs run it, or with one number changed.

Other programs differ from a scene in habits that go together: friction that lags, a dead band, the block's own weight
straight down, a base that yields. Weight and springs are fitted to the first steps, where no corner has left the base,
then to more of them, since stick and slip amplify a difference. What a base with a mass of its own leaves beside that,
as most programs have it, is told from an error by comparison: it is small, and small beside what the other law of
friction leaves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from validation.diagnosis.answer import Answer
from validation.diagnosis.beside import RunVerdict, SceneSearch, answer_of, rank, verdict_of
from validation.diagnosis.causes import BENIGN_COMPLIANCE, round_factor, words_of
from validation.diagnosis.constants import (
    ARITHMETIC,
    CHANGE,
    FAINT,
    FARTHER,
    ROUNDS,
    SEEN,
    SLIGHT,
    UNIT_POWERS,
    WINDOW,
)
from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.fit import NORMAL_95
from validation.diagnosis.moves import OF_NTDDA
from validation.diagnosis.numbers import CandidateChange, Values, fixed
from validation.diagnosis.one_change import STARTS, Fitted
from validation.diagnosis.reading import SIDEWAYS, Foreign, Stepping, steppings
from validation.diagnosis.readings import NEAR_POWER, Slip, remedy_of, without_slips
from validation.diagnosis.variant import GRAVITY, upright
from validation.errors import InputError
from validation.metrics.values import largest
from validation.runs.history import DISPLACEMENT, Array
from validation.runs.numbers import ROUNDING, share_text
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.dda import model_of
from validation.theory.friction import coefficient
from validation.theory.statics import moduli, size

KNOWN = frozenset(
    {features.FRICTION, features.LAGGED, features.SLOPE, features.WEIGHT, features.OFF_CENTRE}
    | {features.UNILATERAL, features.DEAD_BAND}
)
STAGES = (8, 24, 60, 150)  # steps that numbers are fitted to; in the first no corner has come back to the base
WEIGHTS = (0.0, 1.0)  # given: to begin from: none, or the block's own
SOFTNESSES = (0.0, *map(math.log, STARTS))  # to begin from
BANDS = (0.1, 10.0, 16)  # least, largest and number of dead bands that are tried first, over the mean penetration
SPRINGS = frozenset({"springs-factor", "normal-springs-factor"})
OF_FRICTION = frozenset({"friction-factor", "cohesion", "shear-springs-factor", "lagged-friction"})


# ---- reading ----


def search_of(scene: Scene, foreign: Foreign) -> SlopeSearch:
    """Return a history of a block with friction beside runs of its scene, signs and unit of length corrected.

    Raises
    ------
    InputError
        The history lacks a column or a step, or its steps are not equal.
    """
    stepping = _checked_stepping(scene, foreign)
    columns = dict.fromkeys(SlopeSearch.NAMES, (1.0, 1.0))
    plain = SlopeSearch(scene, without_slips(foreign, stepping, columns))
    first = np.sum(plain.recorded[:, :WINDOW], axis=1)
    signs = np.where(first * model_of(scene).force[1::-1] < 0, -1.0, 1.0).tolist()
    factor = 1.0
    if np.any(plain.scene_run) and np.any(plain.recorded):
        ratio = math.log10(largest(plain.recorded) / largest(plain.scene_run))
        factor = next((10.0**power for power in UNIT_POWERS if abs(ratio - power) < NEAR_POWER), 1.0)
    factors = {name: (sign, factor) for name, sign in zip(columns, signs, strict=True)}
    if factors == columns:
        return plain
    return SlopeSearch(scene, without_slips(foreign, stepping, factors))


def _checked_stepping(scene: Scene, foreign: Foreign) -> Stepping:
    """Return the steps of a history, all of which it shows, and which are equal."""
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
    rows = len(stepping.rows)
    if rows != len(steps):
        last = float(np.max(np.diff(foreign.time)))
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
    if np.ptp(steps) > SEEN * steps[0]:
        raise refused(value="others")
    return stepping


def refuse_other_scenes(scene: Scene) -> None:
    """Refuse what is not a rectangle that lies at rest on its springs."""
    more = sorted(set(features.of(scene)) - KNOWN)
    at_rest = scene.contact.gap == scene.block.velocity == 0
    if more or not upright(scene) or not at_rest or scene.time.alpha == 0:
        refused = ", ".join(more) or ("alpha = 0" if scene.time.alpha == 0 else "another scene")
        raise InputError(
            "with friction compare takes an upright rectangle at rest on its springs", source=scene.name, value=refused
        )


# ---- runs ----


class SlopeSearch(SceneSearch):
    """The search beside runs of a block with friction."""

    NAMES = (DISPLACEMENT, SIDEWAYS)
    CORNERS = tuple(f"{name}_{corner}" for name in ("gap", "state") for corner in "mn")
    WOULD_TELL = "another slope or coefficient of friction"

    def candidates(self) -> Iterator[CandidateChange]:
        """Yield everything that may be changed in the scene, with the normal springs alone and the cohesion."""
        yield from super().candidates()
        c = self.scene.contact

        def normal(u: float) -> Values:
            return {"contact.stiffness": c.stiffness * math.exp(u), "contact.shear_stiffness": c.shear}

        words = "the normal springs alone are {:.4g} times the scene's".format
        yield CandidateChange("normal-springs-factor", words, math.exp, normal, tuple(map(math.log, STARTS)))
        width, _ = size(self.scene)
        limit = coefficient(self.scene) * abs(float(model_of(self.scene).force[1])) / width  # as cohesion [Pa]
        yield CandidateChange(
            "cohesion",
            lambda v: f"the cohesion is {v:.4g} Pa where the scene has {c.cohesion:.4g}",
            lambda u: c.cohesion + limit * math.exp(u),
            lambda u: {"contact.cohesion": c.cohesion + limit * math.exp(u)},
            (math.log(CHANGE),),
        )

    def corners(self, values: Values) -> tuple[Array, Array] | None:
        """Return gaps and closed states of both corners, (2, steps) each; None where there is no such run."""
        columns = self.columns(values, self.scene.time.steps, *self.CORNERS)
        return None if columns is None else (columns[:2], columns[2:])

    def remainder(self, values: Values, steps: int) -> Array:
        """Return what a run leaves of the first steps over the largest displacements there, (2, steps)."""
        first = self.recorded[:, :steps]
        run = self.run(values, first.shape[1])
        if run is None:
            return np.ones(first.shape)
        sizes = np.maximum(np.max(np.abs(first), axis=1, keepdims=True), np.finfo(float).tiny)
        return np.asarray((run - first) / sizes)

    def departure(self, verdict: RunVerdict) -> Departure | None:
        """Return the first step beyond last digits of the scene's run with what surrounds the block without fault."""
        if self.reading.corrected:
            return Departure(1, "offset")
        run = None
        is_base = verdict.explained and "base-compliance" in verdict.causes
        if is_base:
            surroundings = {key: value for key, value in verdict.best.items() if key not in LAW}
            run = self.run(surroundings, self.rows)
        unit = self.allowed
        if is_base:
            unit = unit + verdict.left * np.max(np.abs(self.recorded), axis=1, keepdims=True)
        apart = np.abs(self.recorded - (self.scene_run if run is None else run))[:, : self.rows]
        return Departure(int(np.argmax(np.any(apart > unit, axis=0))) + 1, "offset")


# ---- habits of other programs ----

LAW = ("contact.rules", "contact.band")


@dataclass(frozen=True)
class Habits:
    """How another program runs a scene."""

    rules: str  # its law of friction
    band: float | None = None  # penetration beyond which an open corner closes [m]; None for the scene's
    weight: float = 0.0  # share of the block's own weight, straight down [-]
    softness: float = 0.0  # ln of the scene's normal stiffness over that in effect
    along: bool = True  # whether the springs along the base are softer by the same factor
    error: float = 0.0  # half width of the 95 % interval of the softness

    def values(self, scene: Scene) -> Values:
        """Return what of the scene is so."""
        angle = math.radians(scene.load.slope)
        g = scene.load.gravity
        across = max(g * math.cos(angle) + self.weight * GRAVITY, SLIGHT * GRAVITY)  # a fit may lift the block
        pull = np.array([g * math.sin(angle), across])
        c = scene.contact
        soft = math.exp(-self.softness)
        values: Values = {
            "contact.rules": self.rules,
            "load.gravity": float(np.hypot(*pull)),
            "load.slope": math.degrees(math.atan2(*pull)),
            "contact.stiffness": c.stiffness * soft,
            "contact.shear_stiffness": c.shear * (soft if self.along else 1.0),
        }
        if self.band is not None:
            values["contact.band"] = [self.band, OF_NTDDA * self.band]
        return values

    def compliance(self, scene: Scene) -> float:
        """Return what softer springs add to the static displacement, as a share of it [-]."""
        width, height = size(scene)
        springs = 1 / (2 * scene.contact.stiffness)
        block = height / (4 * moduli(scene)[0] * width)
        return springs * math.expm1(self.softness) / (springs + block)

    @property
    def is_usual(self) -> bool:
        """Whether the weight is the block's own, or none."""
        return self.weight == 0 or abs(self.weight - 1) <= SLIGHT

    @property
    def springs(self) -> str:
        """The cause that has these springs, or that gives the rows of a base without mass."""
        return "springs-factor" if self.along else "normal-springs-factor"

    def causes(self, search: SlopeSearch) -> dict[str, float | None]:
        """Return the ids of what differs from the scene, with their numbers."""
        scene = search.scene
        causes: dict[str, float | None] = {}
        soft = self.compliance(scene)
        is_base = SEEN < soft <= BENIGN_COMPLIANCE and not round_factor(math.exp(-self.softness), self.error)
        if self.softness and not is_base:
            causes[self.springs] = math.exp(-self.softness)
        if self.rules != scene.contact.rules:
            causes["lagged-friction"] = None
        if self.band is not None:
            corners = search.corners(self.values(scene))
            # the least of all bands that give the same rows: how deep an open corner is
            causes["dead-band"] = self.band if corners is None else float(np.max(-corners[0] * (corners[1] == 0)))
        if is_base:
            causes["base-compliance"] = soft
        if self.weight:
            causes["own-weight"] = self.weight
        return causes


Judged = tuple[Habits, Fitted]


def habits_of(search: SlopeSearch) -> list[Judged]:
    """Return the habits nearest to a history under each law of friction, until the scene's own explains it."""
    own_rules = search.scene.contact.rules
    starts = [Habits(own_rules, None, weight, soft) for weight in WEIGHTS for soft in SOFTNESSES]
    start = min(starts, key=lambda habits: _size_of(habits, search, STAGES[0]))
    ranked: list[Judged] = []
    for rules in dict.fromkeys([own_rules, "lagged"]):
        if ranked and ranked[0][1].explains and ranked[0][0].is_usual:
            break
        ranked.append(_nearest(replace(start, rules=rules), search))
    return ranked


def _size_of(habits: Habits, search: SlopeSearch, steps: int) -> float:
    return float(np.linalg.norm(search.remainder(habits.values(search.scene), steps)))


def _nearest(start: Habits, search: SlopeSearch) -> Judged:
    """Return habits with weight, springs and dead band at which they come nearest to a history."""

    def judged(habits: Habits) -> Judged:
        return habits, search.judged(Fitted(fixed("habits", "", habits.values(search.scene))))

    def early_size(habits: Habits) -> float:
        """Return the mean logarithm of what is left of the first stages; a landing spoils the last alone."""
        sizes = [_size_of(habits, search, stage) for stage in STAGES[:-1]]
        return float(np.mean(np.log(np.maximum(sizes, ARITHMETIC**2))))

    before_landing = min(
        (_before_landing(replace(start, along=along), search) for along in (True, False)), key=early_size
    )
    # a dead band may have stood in for weight and springs, not yet fitted to so many steps
    trials = (before_landing, _with_band(before_landing, search))
    plain, banded = (_fitted(trial, search, STAGES[-1]) for trial in trials)
    left, left_with_band = (_size_of(habits, search, search.scene.time.steps) for habits in (plain, banded))
    habits = banded if left >= FARTHER * max(left_with_band, ARITHMETIC) else plain
    fewer = replace(
        habits,
        weight=habits.weight if abs(habits.weight) > SLIGHT else 0.0,
        softness=habits.softness if abs(habits.compliance(search.scene)) > SEEN else 0.0,
    )
    few, many = judged(fewer), judged(habits)
    return few if few[1].explains else min(few, many, key=lambda each: rank(each[1]))


def _before_landing(habits: Habits, search: SlopeSearch) -> Habits:
    """Return habits fitted to the longest of the first stages that no landing, early or late, has spoiled."""
    for stage in STAGES[:-1]:
        trial = _fitted(habits, search, stage)
        if _size_of(trial, search, stage) > SEEN * math.sqrt(2 * stage) and stage > STAGES[0]:
            break
        habits = trial
    return habits


def _fitted(habits: Habits, search: SlopeSearch, steps: int) -> Habits:
    """Return habits with weight and softness fitted to the first steps."""
    from scipy.optimize import least_squares

    def at(numbers: Array) -> Habits:
        weight, softness = numbers.tolist()
        return replace(habits, weight=weight, softness=softness)

    solution = least_squares(
        lambda numbers: search.remainder(at(numbers).values(search.scene), steps).ravel(),
        [habits.weight, habits.softness],
        x_scale=[1.0, CHANGE],
        xtol=ROUNDING,
        ftol=ROUNDING,
        max_nfev=ROUNDS,
    )
    variance = 2 * solution.cost / (len(solution.fun) - len(solution.x))
    spread = math.sqrt(variance * float(np.linalg.pinv(solution.jac.T @ solution.jac)[-1, -1]))
    return replace(at(solution.x), error=NORMAL_95 * spread)


def _with_band(habits: Habits, search: SlopeSearch) -> Habits:
    """Return habits with the dead band that comes nearest."""
    scene = search.scene.with_values(habits.values(search.scene))
    penetration = abs(float(model_of(scene).force[1])) / (2 * search.scene.contact.stiffness)
    low, high, number = BANDS
    best = habits
    ratio = math.inf
    while ratio > 1 + SEEN:  # as many between the neighbours of the best
        shares = np.geomspace(low, high, number).tolist()
        nearness = {share: _nearness(replace(habits, band=share * penetration), search) for share in shares}
        share = min(nearness, key=lambda share: nearness[share])
        best = replace(habits, band=share * penetration)
        ratio = shares[1] / shares[0]
        low, high = share / ratio, share * ratio
    return best


def _nearness(habits: Habits, search: SlopeSearch) -> tuple[int, float]:
    """Return minus the rows up to the first that a run does not give, and the size of what it leaves."""
    left = search.remainder(habits.values(search.scene), search.scene.time.steps)
    beyond = np.flatnonzero(np.any(np.abs(left) > SEEN, axis=0))
    first = int(beyond[0]) if len(beyond) else left.shape[1]
    return -first, float(np.linalg.norm(left))


# ---- the verdict ----


def verdict_on(search: SlopeSearch, ranked: list[Judged]) -> RunVerdict:
    """Return what explains a history not its scene's: habits (nearest under each law), one number, a base with mass."""
    habits, run = min(ranked, key=lambda each: (not (each[1].explains and each[0].is_usual), each[1].left))
    causes = habits.causes(search)
    words = {name: words_of(name, value or 0.0) for name, value in causes.items()}
    springs: list[dict[str, Any]] = []
    if habits.softness:  # those that give the rows of habits on a base without mass, or that the habits have
        (change,) = (change for change in search.changes if change.id == habits.springs)
        alike = Fitted(change, -habits.softness)
        springs = [] if habits.springs in causes else [search.as_dict(alike)]
        words |= dict.fromkeys({habits.springs} & causes.keys(), alike.words)
    of_habits = RunVerdict(search, True, causes, words, run.values, springs)
    is_explained = run.explains and habits.is_usual
    if is_explained and not causes.keys() <= {*SPRINGS, "base-compliance"}:
        return of_habits
    verdict = verdict_of(search, search.explanations())
    others = {name for one in verdict.alike for name in one["causes"]}
    if is_explained and (others if not verdict.explained else verdict.causes.keys()) <= SPRINGS:
        return of_habits
    if verdict.explained:
        return verdict
    others_left = min((each.left for _, each in ranked if each is not run), default=math.inf)
    bar = min(FAINT, SLIGHT * min(others_left, search.left(search.scene_run)))
    is_base = "base-compliance" in causes and habits.is_usual and not others and run.left <= bar
    return replace(of_habits, explained=is_base, alike=springs if is_base else verdict.alike)


def answer_on(search: SlopeSearch, foreign: Foreign) -> Answer:
    """Return the answer for a block with friction."""
    if search.is_scene():
        return answer_of(foreign, RunVerdict(search, True))
    ranked = habits_of(search)
    verdict = verdict_on(search, ranked)
    answer = answer_of(foreign, verdict, [_friction_stage(verdict, ranked)])
    corners = search.corners(verdict.best) if verdict.explained else None
    both_open = [] if corners is None else (np.flatnonzero(~np.any(corners[1], axis=0)) + 1).tolist()
    return replace(answer, opened=(both_open[0], both_open[-1]) if both_open else None)


def _friction_stage(verdict: RunVerdict, ranked: list[Judged]) -> Stage:
    """Return whether the law of friction is the scene's, with what the nearest habits leave under each law."""
    left = {habits.rules: run.left if math.isfinite(run.left) else None for habits, run in ranked}
    laws = ", ".join(
        f"{rules} it leaves {'no run' if rest is None else share_text(rest, 2)}" for rules, rest in left.items()
    )
    holds = OF_FRICTION.isdisjoint(verdict.causes) if verdict.explained else None
    return Stage("friction", holds, f"with what surrounds the block, {laws} of the displacements", left)
