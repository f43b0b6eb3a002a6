"""A history on a slope beside runs of its scene: as it is, as other programs run it, or with one number changed.

Other programs differ from a scene in habits that go together: friction that lags, a dead band, the block's own weight
straight down, a base that yields. Weight and springs are fitted to the first steps, where no corner has left the base,
then to more of them, since stick and slip amplify a difference; so is any single number. A run explains a history
to its digits or to noise. What a base leaves beside that, which has a mass of its own in most programs, is told from an
error by comparison: it is small, and small beside what the other law of friction leaves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from validation.diagnosis import sentences
from validation.diagnosis.answer import Answer
from validation.diagnosis.causes import BENIGN_COMPLIANCE, CAUSES, UNEXPLAINED, all_benign, round_factor, words_of
from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.bar import ARITHMETIC, last_digits, outlying, spread_of_most, white
from validation.diagnosis.fits.fit import NORMAL_95
from validation.diagnosis.numbers import Values
from validation.diagnosis.one_change import (
    CandidateChange,
    Residual,
    alike,
    fitted,
    fixed,
    nearest,
    nearest_start,
    of_discount,
    of_numbers,
    of_schemes,
)
from validation.diagnosis.reading import SAME_STEP, SIDEWAYS, Foreign, steppings
from validation.diagnosis.readings import Slip, remedy_of, words_of_slips
from validation.diagnosis.variant import GRAVITY, upright
from validation.errors import InputError
from validation.metrics.values import largest
from validation.runs.history import DISPLACEMENT, Array
from validation.runs.numbers import remainder_text, share_text, significant
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.dda import model_of
from validation.solvers.registry import get_solver
from validation.theory.friction import coefficient
from validation.theory.statics import moduli, size

KNOWN = frozenset(
    {features.FRICTION, features.LAGGED, features.SLOPE, features.WEIGHT, features.OFF_CENTRE}
    | {features.UNILATERAL, features.DEAD_BAND}
)
DDA = "dda"
UNIT_POWERS = (-6, -3, 3, 6)  # of ten, by which a unit of length may be off
NEAR_POWER = 0.5  # of the exponent: what creeps and slides differs by a factor of a few from program to program
OTHER_SLOPE = "another slope or coefficient of friction"
UNIFORM = 1e-3  # relative; times are often printed with four digits
# of an agreement
WITHIN = 1.0  # last digits, root mean square: rounding alone leaves 0.29, a scene's own rounded data some more
SHAKEN = 1e-12  # relative: what two programs may differ by in a spring or a coefficient, by their arithmetic
APART = 1e-4  # of the largest displacement: where arithmetic alone leaves so much, steps tell nothing more
TOLD = 0.25  # share of the steps that must tell; what amplifies rounding so much amplifies any other difference too
NOISE = 1e-2  # of the largest displacement: more is not put down to noise
NOISY = 100  # rows from which on noise can be told from a shape
# of habits
STAGES = (8, 24, 60, 150)  # steps that numbers are fitted to; in the first no corner has come back to the base
WEIGHTS = (0.0, 1.0)  # to begin from
SOFTNESSES = (0.0, *np.linspace(-1.5, 1.5, 13).tolist())  # ln, to begin from: springs up to 4.5 times as stiff or soft
WHOLE, NONE = 0.05, 0.02  # how near a fitted weight is to the block's own, or to none
YIELDS = 5e-4  # share of the static displacement, that counts as a base
BANDS = (0.1, 10.0, 16)  # dead bands that are tried first, over the mean penetration
BAND_ROUNDS = 4  # times that as many are tried between the neighbours of the best: to a thousandth
LANDING = 8  # share of the rows up to the first that departs, in which a corner is open if a landing is the reason
LANDED = 1e-3  # of the largest displacement: what a landing a step late leaves at least
REOPENS = 1e-3  # gap at which a contact with a dead band opens, over the band, as in ntdda
BAND_GAIN = 3.0  # times less that a dead band must leave, to be there
BESIDE_BASE = 0.03  # of what the other law leaves, and
AT_MOST = 0.01  # of the largest displacement: what a base may leave that has a mass of its own
# of one number
ROUNDS = 8  # evaluations of a fit
FACTORS = (0.8, 0.95, 1.05, 1.25)  # to begin from; a factor of one tells nothing of its own
DISCOUNTS = (0.999, 0.99, 0.95)
COHESIONS = (0.02, 0.1, 0.3)  # over the mean limit of friction of a corner
NUDGE = 1e-4  # of the logarithm of a factor, for the slope at its start
ARRIVED = 1e-15  # relative gain at which a fit ends: stick and slip amplify what is left
PURSUED = 7  # candidates that are fitted at all, those nearest along their slope
NEAREST = 4  # of them, that are fitted to more steps
NEAR = 30.0  # times as much as the best leaves: what may still come out first
ROUNDED = 1e-7  # of the largest displacement, that the best counts as leaving at least
CLEAR = 3.0  # times more that every other candidate must leave
OUTSIDE = ("height-factor", "width-factor")  # computed so that no other is named in their place
SPRINGS = frozenset({"springs-factor", "normal-springs-factor"})
OF_FRICTION = frozenset({"friction-factor", "cohesion", "shear-springs-factor", "lagged-friction"})


# ---- reading --------------------------------------------------------------------------------------------------------


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

    @property
    def size(self) -> Array:
        """Largest displacements along and across the base [m]."""
        return np.asarray(np.maximum(np.max(np.abs(self.place), axis=0), np.finfo(float).tiny))

    def scene_of(self, scene: Scene) -> Scene:
        """Return the scene at the steps of the history; a step within what four printed digits tell is the scene's."""
        return at_step(scene, self.step, len(self.place))


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
        last = float(np.max(np.diff(foreign.time)))
        rows = len(stepping.rows)
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
    signs = np.where(first * model_of(scene).force[:2] < 0, -1.0, 1.0)
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
    return not reading.corrected and agreement(reading.scene_of(scene), reading).same


def refuse_other_scenes(scene: Scene) -> None:
    """Refuse what is not a rectangle that lies at rest on its springs."""
    more = sorted(set(features.of(scene)) - KNOWN)
    at_rest = scene.contact.gap == scene.block.velocity == 0
    if more or not upright(scene) or not at_rest or scene.time.alpha == 0:
        refused = ", ".join(more) or ("alpha = 0" if scene.time.alpha == 0 else "another scene")
        raise InputError(
            "with friction compare takes an upright rectangle at rest on its springs", source=scene.name, value=refused
        )


# ---- runs -----------------------------------------------------------------------------------------------------------


def at_step(scene: Scene, step: float, steps: int) -> Scene:
    """Return the scene at a program's step and length."""
    near = abs(step - scene.time.step) <= SAME_STEP * scene.time.step
    length = scene.time.step if near else step
    columns = [DISPLACEMENT, SIDEWAYS, *(f"{name}_{corner}" for name in ("gap", "state") for corner in "mn")]
    return scene.with_values({"time.step": length, "time.steps": steps, "run.columns": columns, "run.solvers": [DDA]})


def columns_of(scene: Scene, *names: str) -> Array | None:
    """Return columns of the suite's own run, one beside the other; None where there is no such run."""
    try:
        history = get_solver(DDA).solve(scene).history
    except InputError:
        return None
    if history is None or len(history.time) != scene.time.steps:
        return None
    return np.column_stack([history.columns[name] for name in names])


def displacements(scene: Scene) -> Array | None:
    """Return displacements along and across the base; None where the suite has no such run."""
    return columns_of(scene, SIDEWAYS, DISPLACEMENT)


@dataclass(frozen=True)
class Agreement:
    """How a run of the suite compares with a history."""

    same: bool
    left: float  # root mean square over the largest displacement, the worse column; inf without a run
    until: int | None = None  # last step that tells, where the scene amplifies rounding until nothing does


NO_RUN = Agreement(False, math.inf)


def agreement(scene: Scene, reading: SlopeReading) -> Agreement:
    """Return whether a run gives a history, to its last digits or to noise without shape."""
    run = displacements(scene)
    if run is None:
        return NO_RUN
    rest = reading.place - run
    largest_values = reading.size
    misfit = float(np.max(np.sqrt(np.mean(rest**2, axis=0)) / largest_values))
    unit = reading.rounding + ARITHMETIC * largest_values
    is_noise = misfit <= NOISE and len(rest) >= NOISY and all(white(column) for column in rest.T)
    if is_noise:  # a row that is wrong by itself has no shape either
        is_noise = not any(np.any(outlying(x, spread_of_most(x), u)) for x, u in zip(rest.T, unit.T, strict=True))
    if _within(rest / unit) or is_noise:
        return Agreement(True, misfit)
    if not _within((rest / unit)[: max(4, len(rest) // 20)]):
        return Agreement(False, misfit)
    # what the scene makes of other arithmetic up to each step [m], (steps, 2); infinite where it has no run
    c = scene.contact
    grown = np.zeros_like(run)
    for name, value in (("contact.stiffness", c.stiffness), ("contact.friction", c.friction or 0.0)):
        shaken = displacements(scene.with_values({name: value * (1 + SHAKEN)}))
        grown = np.maximum(grown, np.inf if shaken is None else np.abs(shaken - run))
    amplified = np.asarray(np.maximum.accumulate(grown, axis=0))
    tells = int(np.sum(np.all(amplified <= APART * largest_values, axis=1)))
    same = tells >= TOLD * len(rest) and _within((rest / (unit + amplified))[:tells])
    return Agreement(same, misfit, tells if same and tells < len(rest) else None)


def _within(over: Array) -> bool:
    """Whether both columns are within their units, root mean square."""
    return bool(np.all(np.sqrt(np.mean(over**2, axis=0)) <= WITHIN))


def _remainder(scene: Scene, reading: SlopeReading, steps: int) -> Array:
    """Return what a run leaves of the first steps over the largest displacements there, one after the other."""
    first = reading.place[:steps]
    run = displacements(scene.with_values({"time.steps": len(first)}))
    if run is None:
        return np.ones(first.size)
    largest_values = np.maximum(np.max(np.abs(first), axis=0), np.finfo(float).tiny)
    return np.ravel((run - first) / largest_values)


# ---- habits of other programs ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Habits:
    """How another program runs a scene.

    Attributes
    ----------
    rules
        Its law of friction.
    band
        Penetration beyond which an open corner closes [m]; None for the scene's.
    weight
        Share of the block's own weight, straight down [-].
    softness
        Ln of the scene's normal stiffness over that in effect.
    along
        Whether the springs along the base are softer by the same factor.
    error
        Half width of the 95 % interval of the softness.
    run
        What its run leaves.
    """

    rules: str
    band: float | None = None
    weight: float = 0.0
    softness: float = 0.0
    along: bool = True
    error: float = 0.0
    run: Agreement = NO_RUN

    def of(self, scene: Scene) -> Scene:
        """Return the scene as it is run so."""
        angle = math.radians(scene.load.slope)
        g = scene.load.gravity
        across = max(g * math.cos(angle) + self.weight * GRAVITY, NONE * GRAVITY)  # a fit may lift the block
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
            values["contact.band"] = [self.band, REOPENS * self.band]
        return scene.with_values(values)

    def compliance(self, scene: Scene) -> float:
        """Return what softer springs add to the static displacement, as a share of it [-]."""
        width, height = size(scene)
        springs = 1 / (2 * scene.contact.stiffness)
        block = height / (4 * moduli(scene)[0] * width)
        return springs * math.expm1(self.softness) / (springs + block)

    @property
    def is_usual(self) -> bool:
        """Whether the weight is the block's own, or none."""
        return self.weight == 0 or abs(self.weight - 1) <= WHOLE

    def causes(self, scene: Scene) -> dict[str, float | None]:
        """Return the ids of what differs from the scene, with their numbers."""
        causes: dict[str, float | None] = {}
        soft = self.compliance(scene)
        is_base = YIELDS < soft <= BENIGN_COMPLIANCE and not round_factor(math.exp(-self.softness), self.error)
        if self.softness and not is_base:
            causes["springs-factor" if self.along else "normal-springs-factor"] = math.exp(-self.softness)
        if self.rules != scene.contact.rules:
            causes["lagged-friction"] = None
        if self.band is not None:
            gaps = columns_of(self.of(scene), "gap_m", "gap_n", "state_m", "state_n")
            # of all bands that give the same rows the least: how deep an open corner is
            causes["dead-band"] = self.band if gaps is None else float(np.max(-gaps[:, :2] * (gaps[:, 2:] == 0)))
        if is_base:
            causes["base-compliance"] = soft
        if self.weight:
            causes["own-weight"] = self.weight
        return causes


def habits_of(scene: Scene, reading: SlopeReading) -> list[Habits]:
    """Return the habits that come nearest to a history, under each law of friction till the scene's own explains it."""
    starts = [Habits(scene.contact.rules, None, weight, soft) for weight in WEIGHTS for soft in SOFTNESSES]
    start = min(starts, key=lambda habits: _size_of(habits, scene, reading, STAGES[0]))
    nearest_habits: list[Habits] = []
    for rules in dict.fromkeys([scene.contact.rules, "lagged"]):
        if nearest_habits and nearest_habits[0].run.same and nearest_habits[0].is_usual:
            break
        nearest_habits.append(_nearest(replace(start, rules=rules), scene, reading))
    return nearest_habits


def _size_of(habits: Habits, scene: Scene, reading: SlopeReading, steps: int) -> float:
    return float(np.linalg.norm(_remainder(habits.of(scene), reading, steps)))


def _nearest(start: Habits, scene: Scene, reading: SlopeReading) -> Habits:
    """Return habits with the weight, the springs and the dead band at which they come nearest to a history."""
    before_landing = [_before_landing(replace(start, along=along), scene, reading) for along in (True, False)]
    banded = _with_band(min(before_landing, key=lambda habits: _early_size(habits, scene, reading)), scene, reading)
    habits = _fitted(banded, (True, True), scene, reading, STAGES[-1])
    nearest_habits = _run(habits, scene, reading)
    has_weight = abs(habits.weight) > NONE
    has_springs = abs(habits.compliance(scene)) > YIELDS
    if has_weight and has_springs:
        return nearest_habits
    fewer = _run(_fitted(habits, (has_weight, has_springs), scene, reading, STAGES[-1]), scene, reading)
    return min(fewer, nearest_habits, key=lambda h: (not h.run.same, h.run.left * (not h.run.same)))


def _before_landing(habits: Habits, scene: Scene, reading: SlopeReading) -> Habits:
    """Return habits fitted to the longest of the first stages that no landing, early or late, has spoiled."""
    for stage in STAGES[:-1]:
        trial = _fitted(habits, (True, True), scene, reading, stage)
        if _size_of(trial, scene, reading, stage) > LANDED * math.sqrt(2 * stage) and stage > STAGES[0]:
            break
        habits = trial
    return habits


def _early_size(habits: Habits, scene: Scene, reading: SlopeReading) -> float:
    """Return the mean logarithm of what a run leaves of the first stages, of which a landing spoils the last alone."""
    sizes = [_size_of(habits, scene, reading, stage) for stage in STAGES[:-1]]
    return float(np.mean(np.log(np.maximum(sizes, ROUNDED**2))))


def _run(habits: Habits, scene: Scene, reading: SlopeReading) -> Habits:
    """Return habits with what their run leaves."""
    return replace(habits, run=agreement(habits.of(scene), reading))


def _fitted(habits: Habits, free: tuple[bool, bool], scene: Scene, reading: SlopeReading, steps: int) -> Habits:
    """Return habits with the weight and the softness, where these are free and else none, fitted to the first steps."""
    from scipy.optimize import least_squares

    is_free = np.array(free)

    def at(z: Array) -> Habits:
        full = np.zeros(2)
        full[is_free] = z
        return replace(habits, weight=float(full[0]), softness=float(full[1]))

    if not any(free):
        return at(np.empty(0))
    solution = least_squares(
        lambda z: _remainder(at(z).of(scene), reading, steps),
        np.array([habits.weight, habits.softness])[is_free],
        x_scale=np.array([1.0, 0.1])[is_free],
        xtol=1e-12,
        ftol=1e-12,
        max_nfev=12,
    )
    variance = 2 * solution.cost / max(len(solution.fun) - len(solution.x), 1)
    spread = math.sqrt(variance * float(np.linalg.pinv(solution.jac.T @ solution.jac)[-1, -1]))
    return replace(at(solution.x), error=NORMAL_95 * spread if free[1] else 0.0)


def _with_band(habits: Habits, scene: Scene, reading: SlopeReading) -> Habits:
    """Return habits with the dead band that comes nearest, if corners open and it leaves far less than none."""
    states = columns_of(habits.of(scene), "state_m", "state_n")
    first = -_nearness(habits, scene, reading)[0]
    if states is None or np.all(states[first - first // LANDING : first + 1]):  # it departs otherwise than by a landing
        return habits
    penetration = abs(float(model_of(habits.of(scene)).force[1])) / (2 * scene.contact.stiffness)
    low, high, number = BANDS
    best = habits
    for _ in range(BAND_ROUNDS):
        shares = np.geomspace(low, high, number).tolist()
        trials = [replace(habits, band=share * penetration) for share in shares]
        nearness = [_nearness(trial, scene, reading) for trial in trials]
        best = trials[nearness.index(min(nearness))]
        longest = [share for share, near in zip(shares, nearness, strict=True) if near[0] == min(nearness)[0]]
        # too wide a band departs where the corner lands, one that is too narrow before: it is at the least of these
        ratio = shares[1] / shares[0]
        low = longest[0] / ratio
        high = longest[0] * ratio
    steps = len(reading.place)
    gain = _size_of(habits, scene, reading, steps) / max(_size_of(best, scene, reading, steps), ROUNDED)
    return best if gain >= BAND_GAIN else habits


def _nearness(habits: Habits, scene: Scene, reading: SlopeReading) -> tuple[int, float]:
    """Return minus the rows up to the first that a run does not give, and the size of what it leaves."""
    left = _remainder(habits.of(scene), reading, len(reading.place))
    beyond = np.flatnonzero(np.abs(left) > LANDED)
    first = int(beyond[0]) // 2 if len(beyond) else len(reading.place)
    return -first, float(np.linalg.norm(left))


# ---- one number -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class OneChange:
    """A candidate that gives the history back, with what its run leaves."""

    id: str
    value: float | None
    words: str
    run: Agreement

    def as_dict(self) -> dict[str, Any]:
        """Return it as one of several that give the same rows."""
        values = {} if self.value is None else {self.id: self.value}
        further = CAUSES["springs-factor"].further_scene if self.id in SPRINGS else OTHER_SLOPE
        return {"causes": [self.id], "values": values, "further_scene": further}


def candidates(scene: Scene) -> Iterator[CandidateChange[Values]]:
    """Yield what is tried."""
    c = scene.contact
    yield from of_numbers(scene, FACTORS)
    yield CandidateChange(
        "normal-springs-factor",
        partial(_words_of_springs, "normal springs alone"),
        math.exp,
        lambda u: {"contact.stiffness": c.stiffness * math.exp(u), "contact.shear_stiffness": c.shear},
        tuple(map(math.log, FACTORS)),
    )
    yield of_discount(scene, DISCOUNTS)
    limit = coefficient(scene) * abs(float(model_of(scene).force[1])) / 2
    yield CandidateChange(
        "cohesion",
        lambda v: f"the cohesion is {v:.4g} Pa where the scene has {c.cohesion:.4g}",
        lambda u: c.cohesion + math.exp(u),
        lambda u: {"contact.cohesion": c.cohesion + math.exp(u)},
        tuple(math.log(share * limit / (size(scene)[0] / 2)) for share in COHESIONS if limit > 0),
    )
    for scheme in of_schemes(scene):
        if scheme.changed(0.0)["time.alpha"]:  # an explicit scheme has no friction
            words = "the scheme is " if scheme.id == "scheme" else ""
            yield fixed(scheme.id, f"{words}{scheme.words(0.0)}", scheme.changed(0.0))


def _words_of_springs(which: str, factor: float) -> str:
    return f"the {which} are {factor:.4g} times the scene's"


def one_number(scene: Scene, reading: SlopeReading) -> tuple[OneChange | None, list[OneChange]]:
    """Return the one change that gives a history back, if any does, and all that do."""

    def residual_over(steps: int, change: CandidateChange[Values]) -> Residual:
        return lambda u: _remainder(scene.with_values(change.changed(u)), reading, steps)

    stages = sorted({min(stage, len(reading.place)) for stage in (*STAGES[2:], len(reading.place))})
    best = [nearest_start(residual_over(stages[0], change), change) for change in candidates(scene)]
    best = nearest(best, PURSUED, 0.0)
    for steps in stages:
        fits = [fitted(residual_over(steps, fit.change), fit, ROUNDS, NUDGE, ARRIVED) for fit in best]
        best = alike(fits, lambda fit: fit.remainder, NEAR, ROUNDED * math.sqrt(steps))[:NEAREST]
        if best[0].remainder > NOISE * math.sqrt(2 * steps):
            return None, []  # no noise is so large
    explanations = []
    for fit in best:
        run = agreement(scene.with_values(fit.change.changed(fit.u)), reading)
        if run.same:
            value = significant(fit.change.value(fit.u), 6) if fit.change.starts else None
            explanations.append(OneChange(fit.change.id, value, fit.change.words(fit.change.value(fit.u)), run))
    clear = alike(explanations, lambda change: change.run.left, CLEAR)
    ids = {change.id for change in clear}
    certain = clear[0] if len(ids) == 1 and not ids & set(OUTSIDE) else None
    return certain, clear


# ---- the verdict ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SlopeVerdict:
    """What a history on a slope came to.

    Attributes
    ----------
    causes
        Ids of what explains it, or comes nearest, with their numbers.
    explained
        Whether that is certain.
    run
        What the run leaves that explains it, or comes nearest.
    scene_run
        What the run of the scene as it is leaves.
    by_rules
        Law of friction to what the nearest habits leave under it.
    habits
        The nearest.
    best
        The scene as it is run.
    words
        Of the one thing changed.
    alike
        Changes that give the same rows.
    """

    causes: dict[str, float | None]
    explained: bool
    run: Agreement
    scene_run: Agreement
    by_rules: dict[str, float]
    habits: Habits
    best: Scene
    words: str = ""
    alike: Sequence[OneChange] = ()


def verdict_of(scene: Scene, reading: SlopeReading) -> SlopeVerdict:
    """Return what explains a history beside a scene at its steps."""
    run = agreement(scene, reading)
    if run.same:
        rules = scene.contact.rules
        return SlopeVerdict({}, True, run, run, {rules: run.left}, Habits(rules), scene)
    ranked = habits_of(scene, reading)
    best = min(ranked, key=lambda h: (not (h.run.same and h.is_usual), h.run.left))
    causes = best.causes(scene)
    by_rules = {habits.rules: habits.run.left for habits in ranked}
    verdict = SlopeVerdict(causes, best.is_usual, best.run, run, by_rules, best, best.of(scene))
    of_springs = _springs_of(best, scene)
    has_springs_alone = {*causes} <= {*SPRINGS, "base-compliance"}
    if best.run.same and best.is_usual and not has_springs_alone:
        return replace(verdict, alike=[one for one in of_springs if one.id not in causes])
    change, others = one_number(scene, reading)
    if best.run.same and best.is_usual and {other.id for other in others} <= SPRINGS:
        named_springs = next((one.words for one in of_springs if one.id in causes), "")
        return replace(verdict, words=named_springs, alike=[one for one in of_springs if one.id not in causes])
    if change is not None:
        changed = {change.id: change.value}
        return replace(verdict, causes=changed, explained=True, run=change.run, words=change.words)
    others_left = min((left for rules, left in by_rules.items() if rules != best.rules), default=math.inf)
    is_base = "base-compliance" in causes and best.is_usual
    bar = min(AT_MOST, BESIDE_BASE * min(others_left, run.left))
    return replace(verdict, explained=is_base and not others and best.run.left <= bar, alike=others)


def _springs_of(habits: Habits, scene: Scene) -> tuple[OneChange, ...]:
    """Return the springs that give the rows of habits on a base without mass, or that the habits have."""
    if not habits.softness:
        return ()
    name = "springs-factor" if habits.along else "normal-springs-factor"
    factor = significant(math.exp(-habits.softness), 6)
    words = _words_of_springs("springs" if habits.along else "normal springs alone", factor)
    return (OneChange(name, factor, words, habits.run),)


def answer_of(scene: Scene, foreign: Foreign, reading: SlopeReading) -> Answer:
    """Return the answer for a block with friction."""
    exact = reading.scene_of(scene)
    verdict = verdict_of(exact, reading)
    ids = [*reading.slips, *verdict.causes] if verdict.explained else [UNEXPLAINED]
    values = {name: significant(value, 6) for name, value in verdict.causes.items() if value is not None}
    departure = None if all_benign(ids) else _departure(exact, reading, verdict)
    t = scene.time
    others = [change.as_dict() for change in verdict.alike]
    evidence = stages(verdict, reading)
    left = 0.0
    nearest_causes: dict[str, Any] | None = None
    if verdict.explained:
        words = {name: verdict.words or words_of(name, values.get(name, 0.0)) for name in verdict.causes}
        scheme = sentences.scheme_words(t.alpha, t.delta, t.discount)
        said = words_of_slips(reading.corrected) | words
        sentence = sentences.sentence(sentences.Subject(scheme, said, departure, _motion(verdict.run)))
    else:
        left = significant(min(1.0, verdict.run.left / verdict.scene_run.left), 4)
        nearest_causes = {"causes": list(verdict.causes), "values": values, "left": left}
        subject = sentences.Subject("", {}, None, "", others)
        sentence = sentences.not_explained(subject, nearest_causes, left, evidence)
    return Answer(
        scheme={"alpha": t.alpha, "delta": t.delta, "gg": t.discount},
        departure=departure,
        causes=ids,
        opened=_opened(verdict.best) if verdict.explained else None,
        sentence=sentence,
        notes=(*foreign.notes, *reading.notes),
        misfit=verdict.run.left,
        curves={"the file": (foreign.time, foreign.displacement)},
        values=values if verdict.explained else {},
        unexplained=left,
        nearest=nearest_causes,
        alike=others,
        evidence=evidence,
        slips=reading.corrected if verdict.explained else (),
    )


def _departure(scene: Scene, reading: SlopeReading, verdict: SlopeVerdict) -> Departure:
    """Return the first step beyond last digits of the scene's own run, on what surrounds the block without fault."""
    expected = scene
    if verdict.explained and not reading.corrected and "base-compliance" in verdict.causes:
        expected = replace(verdict.habits, rules=scene.contact.rules, band=None).of(scene)
    run = displacements(expected)
    if run is None or reading.corrected:
        return Departure(1, "offset")
    apart = np.abs(reading.place - run) / reading.size
    unit = reading.rounding / reading.size + max(ARITHMETIC, 0.0 if verdict.run.same else verdict.run.left)
    return Departure(int(np.argmax(np.any(apart > unit, axis=1))) + 1, "offset")


def _opened(scene: Scene) -> tuple[int, int] | None:
    """Return the first and the last step of a run at whose end both corners are open, counted from 1."""
    states = columns_of(scene, "state_m", "state_n")
    both = [] if states is None else np.flatnonzero(~np.any(states, axis=1)).tolist()
    return (both[0] + 1, both[-1] + 1) if both else None


def stages(verdict: SlopeVerdict, reading: SlopeReading) -> tuple[Stage, ...]:
    """Return what was measured: signs, the scene's own run, the laws of friction."""
    of_scene = verdict.run if all_benign(verdict.causes) and verdict.explained else verdict.scene_run
    left = {rules: None if math.isinf(rest) else rest for rules, rest in verdict.by_rules.items()}
    friction = ", ".join(f"{rules} it leaves {_share(rest)}" for rules, rest in left.items())
    law_holds = None
    if verdict.explained:
        law_holds = OF_FRICTION.isdisjoint(verdict.causes)
    right = "; ".join(slip.words for slip in reading.corrected) or "signs, units and columns are the scene's"
    motion = {"misfit": None if math.isinf(of_scene.left) else of_scene.left}
    return (
        Stage("reading", not reading.slips, right, {}),
        Stage("motion", of_scene.same, _motion(of_scene), motion),
        Stage("friction", law_holds, f"with what surrounds the block, {friction} of the displacements", left),
    )


def _share(left: float | None) -> str:
    return "no run" if left is None else share_text(left, 2)


def _motion(run: Agreement) -> str:
    """Return what a run of the suite leaves of the displacements, in words."""
    if run.same:
        part = f" up to step {run.until}, beyond which the scene amplifies rounding" if run.until else ""
        return f"the suite's own run gives the displacements to their digits or noise{part}"
    if math.isinf(run.left):
        return "the suite has no run of it"
    return f"the suite's own run leaves {remainder_text(run.left, 2)} % of the displacements"
