"""Which law of contact and friction a recorded motion obeys, at every step of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from validation.diagnosis.causes import round_factor
from validation.diagnosis.fits.bar import norm
from validation.diagnosis.forces.laws import Body, Followed, body_of, follow, motion_of
from validation.diagnosis.forces.runs import (
    NO_RUN,
    SURROUNDINGS,
    Agreement,
    OneChange,
    Surrounded,
    agreement,
    at_step,
    one_number,
    surrounded,
)
from validation.runs.history import Array
from validation.runs.numbers import significant
from validation.scenes.scene import Scene
from validation.scenes.tables import TimeSection
from validation.theory.statics import moduli, size

FITTED = 150  # steps that weight and softness are fitted to: a period of the springs and more
CLOSE = 0.01  # of the mean limit of friction, within which a law gives the force that the motion shows
NOISE = 6.0  # standard deviations, of two steps together, of what digits leave of a force
BLURRED = 0.1  # of the limit: digits that leave more do not show which law it is
MOST, MOST_SLIPS = 0.99, 0.9  # share of the steps, and of those with slip, that a law holds in
MANY, MOST_OF_MANY = 50, 0.97  # steps that tell, from which on a few may be decided otherwise on a softer base
FEWEST, FEW_RIGHT = 2, 0.3  # steps that tell two laws apart, and the share of them that the wrong one may hold in
NORMAL = 0.002  # relative root mean square that the normal law may leave: moving geometry and a base
WHOLE, NONE = 0.05, 0.02  # how near a fitted weight is to the block's own, or to none
YIELDS, BENIGN, HARDER = 5e-4, 0.05, -0.01  # share of the static displacement: what counts as a base, what it may add
POWERS = (0.0, 0.5, 1.5)  # of the factor on the springs across the base, for those along it: what rules it out for them
DEEP = 0.05  # of the mean penetration: what an open corner may show of it before a dead band is in question


@dataclass(frozen=True)
class ContactFinding:
    """What a history shows of its contact."""

    causes: tuple[str, ...]
    values: dict[str, float]
    explained: bool
    lagged: bool  # the law that comes nearest
    shares: dict[str, float]  # law to the share of steps that it holds in
    telling: int  # steps that tell the laws apart
    normal: float  # relative root mean square that the normal law leaves
    tolerance: float  # of the limit of friction, within which a law holds
    first: int | None  # step, from 1, at which the scene's own law is left
    opened: tuple[int, int] | None  # first and last step with both corners open
    run: Agreement = NO_RUN  # what the suite's own run leaves: of the scene, with what surrounds the block or a change
    scene_run: Agreement = NO_RUN  # what the run of the scene as it is leaves, where a change explains the history
    change: str = ""  # the one thing in the scene that explains it, in words
    alike: tuple[OneChange, ...] = ()  # changes of which each does


def judge(scene: Scene, place: Array, step: float, rounding: Array) -> ContactFinding:
    """Judge displacements of the centroid along and across the base against a scene's contact.

    The same is said only of what the scene's own run gives, or its run with what surrounds the block; the laws say how
    another history departs.

    Parameters
    ----------
    scene
        An upright rectangle with friction.
    place
        Displacements at every step [m], (steps, 2).
    step
        The program's time step [s].
    rounding
        Units of their last digits [m], (steps, 2).
    """
    exact = at_step(scene, step, len(place))
    run = agreement(exact, place, rounding)
    by_forces, fitted = _by_laws(exact, place, rounding)
    if run.same and (run.until is None or by_forces.shares[scene.contact.rules] >= MOST_SLIPS):
        lags = scene.contact.rules == "lagged"
        return replace(by_forces, causes=(), values={}, explained=True, lagged=lags, first=None, run=run)
    run = replace(run, same=False)
    scene_run = run
    if by_forces.explained and not set(by_forces.causes) <= SURROUNDINGS:
        return replace(by_forces, run=run)
    if by_forces.explained and by_forces.causes:
        around = surrounded(exact, by_forces.causes, fitted, place, rounding)
        if around.run.same:
            return _springs_or_base(replace(by_forces, explained=True, run=around.run), around, scene_run)
        run = around.run if around.run.left < run.left else run
    change, alike = one_number(exact, place, rounding)
    if change is None:
        return replace(by_forces, explained=False, run=run, alike=tuple(alike))
    values = {} if change.value is None else {change.id: change.value}
    result = replace(by_forces, causes=(change.id,), values=values, explained=True, first=1)
    return replace(result, run=change.run, scene_run=scene_run, change=change.words)


def _springs_or_base(result: ContactFinding, around: Surrounded, scene_run: Agreement) -> ContactFinding:
    """Return a history on a base with the springs that give the same rows: named where their factor is a round one."""
    if "base-compliance" not in result.causes:
        return result
    name = "springs-factor" if around.along else "normal-springs-factor"
    factor = significant(around.springs, 6)
    words = f"the {'springs' if around.along else 'normal springs alone'} are {factor:.4g} times the scene's"
    springs = OneChange(name, factor, words, around.run)
    if not round_factor(around.springs, around.error):
        return replace(result, alike=(springs,))
    rest = {cause: value for cause, value in result.values.items() if cause != "base-compliance"}
    causes = tuple(name if cause == "base-compliance" else cause for cause in result.causes)
    change = words if len(causes) == 1 else ""
    return replace(result, causes=causes, values=rest | {name: factor}, first=1, change=change, scene_run=scene_run)


def _by_laws(scene: Scene, place: Array, rounding: Array) -> tuple[ContactFinding, tuple[float, float]]:
    """Return what the forces of a motion show, and the fitted weight [-] and softness [ln]."""
    time = scene.time
    plain = body_of(scene)
    weight, softness = _fitted(plain, time, place[:FITTED])
    body = plain.heavier(weight).softer(softness)
    soft = _compliance(scene, softness)
    yields = replace(body, shear=body.shear * math.exp(-softness))  # along the base as across it
    bodies = [body, yields] if HARDER <= soft <= BENIGN else [yields]  # else springs of another stiffness, not a base
    followed = [_FollowedBody(body, time, place, rounding) for body in bodies]
    chosen = max(followed, key=lambda each: max(each.shares.values()))
    best = _law(chosen.right, chosen.telling, scene.contact.rules)
    run = chosen.runs[best]
    right = chosen.right[best]
    normal = norm((run.law_forces - run.motion_forces)[:, 1]) / norm(run.motion_forces[:, 1])
    band = float(np.max(-run.gap[chosen.deep(run)])) if chosen.deep(run).sum() >= FEWEST else 0.0
    causes, values = _causes(scene, weight, softness, soft, best, band)
    if "springs-factor" in causes and not _along_too(yields, softness, time, place, best):
        causes[causes.index("springs-factor")] = "springs-factor?"
    telling = int(chosen.telling.sum())
    active = run.settled & np.logical_or(*(law_run.slips for law_run in chosen.runs.values()))
    least = MOST if telling < MANY else MOST_OF_MANY
    is_obeyed = chosen.shares[best] >= least and (not active.any() or float(np.mean(right[active])) >= MOST_SLIPS)
    certain = tuple(name for name in causes if not name.endswith("?"))
    sound = normal <= NORMAL and is_obeyed and chosen.tolerance <= BLURRED and len(certain) == len(causes)
    departing = np.zeros(len(place), dtype=bool)
    if best != scene.contact.rules:
        departing |= chosen.runs[scene.contact.rules].settled & ~chosen.right[scene.contact.rules]
    if "dead-band" in causes:
        departing |= chosen.deep(run).any(axis=1)
    first = 1 if "springs-factor" in causes else None
    if departing.any():
        first = int(np.argmax(departing)) + 1
    both = np.flatnonzero(~run.closed.any(axis=1))
    opened = (int(both[0]) + 1, int(both[-1]) + 1) if len(both) else None
    result = ContactFinding(
        causes=certain,
        values=values,
        explained=sound,
        lagged=best == "lagged",
        shares=chosen.shares,
        telling=telling,
        normal=normal,
        tolerance=chosen.tolerance,
        first=first,
        opened=opened,
    )
    return result, (weight, softness)


class _FollowedBody:
    """A motion followed by both laws: the steps in which each holds, and how often."""

    def __init__(self, body: Body, time: TimeSection, place: Array, rounding: Array) -> None:
        self.body = body
        motion = motion_of(place, time, body)
        self.runs = {name: follow(body, motion, name == "lagged") for name in ("consistent", "lagged")}
        (plain, _) = self.runs.values()
        limit = body.coefficient * plain.scale + body.cohesion or 1.0
        # what printed digits leave of a force: those of random ones
        random = np.random.default_rng(0).uniform(-0.5, 0.5, rounding.shape) * rounding
        shaken = motion_of(random, time, replace(body, load=np.zeros(2)))
        self.tolerance = max(CLOSE, NOISE * body.mass * float(np.std(shaken.acceleration)) / limit)
        # the limit at each step, of the larger resultant there or a step before, or of the mean
        normal = plain.motion_forces[:, 1]
        pressed = np.maximum(normal, np.concatenate(([0.0], normal[:-1])))
        self.limits = body.coefficient * np.maximum(pressed, plain.scale) + body.cohesion
        self.right = {
            name: np.abs(run.law_forces - run.motion_forces)[:, 0] <= self.tolerance * self.limits
            for name, run in self.runs.items()
        }
        self.shares = {name: float(np.mean(self.right[name][run.settled])) for name, run in self.runs.items()}

    @property
    def telling(self) -> np.ndarray:
        """Steps in which the two laws ask for forces that digits tell apart."""
        first, second = self.runs.values()
        apart = np.abs(first.law_forces - second.law_forces)[:, 0] > 3 * self.tolerance * self.limits
        return np.asarray(apart & first.settled & second.settled)

    def deep(self, run: Followed) -> np.ndarray:
        """Return the steps and corners that are open although the springs are pressed."""
        pressed = run.scale / (2 * self.body.stiffness)
        return np.asarray(~run.closed & (-run.gap > DEEP * pressed) & run.settled[:, None])


def _law(right: dict[str, np.ndarray], telling: np.ndarray, scene_rules: str) -> str:
    """Return the law that holds where two differ; the scene's own where nothing tells them apart."""
    if telling.sum() < FEWEST:
        return scene_rules
    shares = {name: float(np.mean(is_right[telling])) for name, is_right in right.items()}
    best = max(shares, key=lambda name: shares[name])
    return best if min(shares.values()) <= FEW_RIGHT else scene_rules


def _fitted(body: Body, time: TimeSection, place: Array) -> tuple[float, float]:
    """Return the share of the own weight and the softness [ln] that the normal resultants ask for."""
    from scipy.optimize import least_squares

    def remainder(z: Array) -> Array:
        trial = body.heavier(float(z[0])).softer(float(z[1]))
        run = follow(trial, motion_of(place, time, trial), False)
        return np.asarray((run.law_forces - run.motion_forces)[:, 1] / run.scale)

    starts = [np.array([weight, 0.0]) for weight in (0.0, 1.0)]
    start = min(starts, key=lambda z: norm(remainder(z)))
    solution = least_squares(remainder, start, x_scale=(1.0, 0.1), max_nfev=12)
    return float(solution.x[0]), float(solution.x[1])


def _along_too(body: Body, softness: float, time: TimeSection, place: Array, law: str) -> bool:
    """Whether springs along the base by the factor of those across it suit a motion better than by its other powers."""

    def remainder(power: float) -> float:
        trial = replace(body, shear=body.shear * math.exp((1 - power) * softness))
        run = follow(trial, motion_of(place, time, trial), law == "lagged")
        return float(np.mean(np.abs(run.law_forces - run.motion_forces)[run.settled, 0]))

    return remainder(1.0) < 0.5 * min(remainder(power) for power in POWERS)


def _compliance(scene: Scene, softness: float) -> float:
    """Return what softer springs add to the static displacement, as a share of it [-]."""
    width, height = size(scene)
    springs, block = 1 / (2 * scene.contact.stiffness), height / (4 * moduli(scene)[0] * width)
    return springs * math.expm1(softness) / (springs + block)


def _causes(
    scene: Scene, weight: float, softness: float, soft: float, law: str, band: float
) -> tuple[list[str], dict[str, float]]:
    """Return the ids of what differs from the scene, and their numbers; a question mark where none fits."""
    names, scene_band = [], scene.contact.band[0]
    values: dict[str, float] = {}
    if not HARDER <= soft <= BENIGN:
        names.append("springs-factor")
        values["springs-factor"] = math.exp(-softness)
    if law != scene.contact.rules:
        names.append("lagged-friction" if law == "lagged" else "lagged-friction?")
    if band > 0 and not 0.8 * scene_band <= band <= 1.2 * scene_band:
        names.append("dead-band")
        values["dead-band"] = band
    if YIELDS < soft <= BENIGN:
        names.append("base-compliance")
        values["base-compliance"] = soft
    if abs(weight) > NONE:
        names.append("own-weight" if abs(weight - 1) <= WHOLE else "own-weight?")
        values["own-weight"] = weight
    return names, {name: significant(value, 4) for name, value in values.items()}
