"""The suite's own runs of a scene beside a history of it: the scene, what surrounds its block, one thing changed.

The laws in `laws` hold forces to a share of the limit of friction, and a bias within it, of one sign at every step,
adds up. A run of the scene does not let it pass: creep amplifies a difference some hundred times, and a file tells it
to its last digit. Since stick and slip amplify a difference, a number is fitted to the first steps, then to more and
more of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.diagnosis.fits.bar import ARITHMETIC, outlying, spread_of_most, white
from validation.diagnosis.fits.fit import NORMAL_95
from validation.diagnosis.forces.laws import STANDARD, body_of
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
from validation.diagnosis.reading import SAME_STEP, SIDEWAYS
from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, Array
from validation.runs.numbers import significant
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

WITHIN = 1.0  # last digits, root mean square: rounding alone leaves 0.29, a scene's own rounded data some more
DDA = "dda"
SHAKEN = 1e-12  # relative: what two programs may differ by in a spring or a coefficient, by their arithmetic
APART = 1e-4  # of the largest displacement: where arithmetic alone leaves so much, steps tell nothing more
TOLD = 0.25  # share of the steps that must tell; what amplifies rounding so much amplifies any other difference too
NOISE = 1e-2  # of the largest displacement: more is not put down to noise
NOISY = 100  # rows from which on noise can be told from a shape
FITTED = 150  # steps that weight and springs are fitted to
SURROUNDINGS = frozenset({"own-weight", "base-compliance", "springs-factor"})  # what a scene of the suite can hold
STAGES = (60, 150)  # steps that numbers are fitted to, before all
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


@dataclass(frozen=True)
class Agreement:
    """How a run of the suite compares with a history."""

    same: bool
    left: float  # root mean square over the largest displacement, the worse column; nan without a run
    until: int | None = None  # last step that tells, where the scene amplifies rounding until nothing does


NO_RUN = Agreement(False, math.nan)


def at_step(scene: Scene, step: float, steps: int) -> Scene:
    """Return the scene at a program's step and length; a step within what four printed digits tell is the scene's."""
    near = abs(step - scene.time.step) <= SAME_STEP * scene.time.step
    length = scene.time.step if near else step
    columns = [DISPLACEMENT, SIDEWAYS]
    return scene.with_values({"time.step": length, "time.steps": steps, "run.columns": columns, "run.solvers": [DDA]})


def agreement(scene: Scene, place: Array, rounding: Array) -> Agreement:
    """Return whether the scene's own run gives a history, to its last digits or to noise without shape.

    Parameters
    ----------
    scene
        The scene at the program's step, see `at_step`.
    place
        Displacements along and across the base at every step [m], (steps, 2).
    rounding
        Units of their last digits [m], (steps, 2).
    """
    scene_run = displacements(scene)
    if scene_run is None:
        return NO_RUN
    rest, size = place - scene_run, _size(place)
    misfit = float(np.max(np.sqrt(np.mean(rest**2, axis=0)) / size))
    unit = rounding + ARITHMETIC * size
    is_noise = misfit <= NOISE and len(rest) >= NOISY and all(white(column) for column in rest.T)
    if is_noise:  # a row that is wrong by itself has no shape either
        is_noise = not any(np.any(outlying(x, spread_of_most(x), u)) for x, u in zip(rest.T, unit.T, strict=True))
    if _within(rest / unit) or is_noise:
        return Agreement(True, misfit)
    if not _within((rest / unit)[: max(4, len(rest) // 20)]):
        return Agreement(False, misfit)
    # what the scene makes of other arithmetic up to each step [m], (steps, 2); infinite where it has no run
    c, grown = scene.contact, np.zeros_like(scene_run)
    for name, value in (("contact.stiffness", c.stiffness), ("contact.friction", c.friction or 0.0)):
        shaken = displacements(scene.with_values({name: value * (1 + SHAKEN)}))
        grown = np.maximum(grown, np.inf if shaken is None else np.abs(shaken - scene_run))
    amplified = np.asarray(np.maximum.accumulate(grown, axis=0))
    tells = int(np.sum(np.all(amplified <= APART * size, axis=1)))
    same = tells >= TOLD * len(rest) and _within((rest / (unit + amplified))[:tells])
    return Agreement(same, misfit, tells if same and tells < len(rest) else None)


def _size(place: Array) -> Array:
    """Return the largest displacements along and across the base [m]."""
    return np.asarray(np.maximum(np.max(np.abs(place), axis=0), np.finfo(float).tiny))


@dataclass(frozen=True)
class Surrounded:
    """A run with what surrounds a block: what it leaves, and the springs that it has."""

    run: Agreement = NO_RUN
    springs: float = 1.0  # normal stiffness over the scene's [-]
    error: float = 0.0  # of it: half width of its 95 % interval, relative
    along: bool = True  # whether the springs along the base have the same factor


def surrounded(
    scene: Scene, ids: Sequence[str], fitted: tuple[float, float], place: Array, rounding: Array
) -> Surrounded:
    """Return the run under the block's own weight, on softer or other springs, that comes nearest to a history.

    Parameters
    ----------
    ids
        Which of `SURROUNDINGS` there are; with `springs-factor` the springs along the base change with those across it,
        with `base-compliance` they may as well be the scene's.
    fitted
        Share of the own weight and softness [ln] to start from; both are fitted again, to the first steps.
    """
    free = np.array(["own-weight" in ids, not {"base-compliance", "springs-factor"}.isdisjoint(ids)])
    follow = (True, False) if "base-compliance" in ids else (True,)
    best = Surrounded()
    for follows in follow:
        z, error = _nearest(scene, free, np.where(free, fitted, 0.0), follows, place)
        run = agreement(_changed(scene, z, follows), place, rounding)
        candidate = Surrounded(run, math.exp(-float(z[1])), error, follows)
        if run.same:
            return candidate
        best = candidate if not run.left >= best.run.left else best
    return best


def _within(over: Array) -> bool:
    """Whether both columns are within their units, root mean square."""
    return bool(np.all(np.sqrt(np.mean(over**2, axis=0)) <= WITHIN))


def displacements(scene: Scene) -> Array | None:
    """Return displacements along and across the base; None where the suite has no such run."""
    solver = get_solver(DDA)
    try:
        history = solver.solve(scene).history
    except InputError:
        return None
    if history is None or len(history.time) != scene.time.steps:
        return None
    return np.column_stack([history.columns[SIDEWAYS], history.columns[DISPLACEMENT]])


def _nearest(scene: Scene, free: np.ndarray, start: Array, follows: bool, place: Array) -> tuple[Array, float]:
    """Return the weight and the softness that suit the first steps best, and the 95 % half width of the softness."""
    from scipy.optimize import least_squares

    first = place[:FITTED]
    size = _size(first)
    short = scene.with_values({"time.steps": len(first)})

    def whole(z: Array) -> Array:
        full = start.copy()
        full[free] = z
        return full

    def left(z: Array) -> Array:
        run = displacements(_changed(short, whole(z), follows))
        return np.ones(first.size) if run is None else np.ravel((run - first) / size)

    solution = least_squares(left, start[free], x_scale=np.array([1.0, 0.1])[free], xtol=1e-14, ftol=1e-14, max_nfev=12)
    if not free[1]:
        return whole(solution.x), 0.0
    variance = 2 * solution.cost / max(first.size - len(solution.x), 1)
    softness = -1  # the last of the free numbers
    spread = math.sqrt(variance * float(np.linalg.pinv(solution.jac.T @ solution.jac)[softness, softness]))
    return whole(solution.x), NORMAL_95 * spread


def _changed(scene: Scene, fitted: Array, follows: bool) -> Scene:
    """Return the scene under a share of the own weight [-], straight down on the base, on softer springs [ln]."""
    weight, softness = map(float, fitted)
    angle = math.radians(scene.load.slope)
    g = scene.load.gravity
    pull = np.array([g * math.sin(angle), g * math.cos(angle) + weight * STANDARD])
    c, soft = scene.contact, math.exp(-softness)
    return scene.with_values(
        {
            "load.gravity": float(np.hypot(*pull)),
            "load.slope": math.degrees(math.atan2(*pull)),
            "contact.stiffness": c.stiffness * soft,
            "contact.shear_stiffness": c.shear * (soft if follows else 1.0),
        }
    )


@dataclass(frozen=True)
class OneChange:
    """The candidate that gives a history back.

    Attributes
    ----------
    words
        In words.
    run
        What its run leaves.
    """

    id: str
    value: float | None
    words: str
    run: Agreement


def candidates(scene: Scene) -> list[CandidateChange[Values]]:
    """Return what is tried."""
    c = scene.contact
    normal_springs: CandidateChange[Values] = CandidateChange(
        "normal-springs-factor",
        lambda f: f"the normal springs alone are {f:.4g} times the scene's",
        math.exp,
        lambda u: {"contact.stiffness": c.stiffness * math.exp(u), "contact.shear_stiffness": c.shear},
        tuple(map(math.log, FACTORS)),
    )
    changes = [*of_numbers(scene, FACTORS), normal_springs, of_discount(scene, DISCOUNTS)]
    body = body_of(scene)
    width = body.x[1] - body.x[0]
    limit = body.coefficient * abs(float(body.load[1])) / 2
    changes.append(
        CandidateChange(
            "cohesion",
            lambda v: f"the cohesion is {v:.4g} Pa where the scene has {c.cohesion:.4g}",
            lambda u: c.cohesion + math.exp(u),
            lambda u: {"contact.cohesion": c.cohesion + math.exp(u)},
            tuple(math.log(share * limit / (width / 2)) for share in COHESIONS if limit > 0),
        )
    )
    if c.rules != "lagged":  # the printed digits may show it in the motion and not in its forces
        changes.append(fixed("lagged-friction", "friction lags", {"contact.rules": "lagged"}))
    for scheme in of_schemes(scene):
        values = scheme.changed(0.0)
        if values["time.alpha"]:  # else no acceleration follows from a displacement
            words = "the scheme is " if scheme.id == "scheme" else ""
            changes.append(fixed(scheme.id, f"{words}{scheme.words(0.0)}", values))
    return changes


def one_number(scene: Scene, place: Array, rounding: Array) -> tuple[OneChange | None, list[OneChange]]:
    """Return the one change that gives a history back, if any does, and all that do.

    Parameters
    ----------
    scene
        The scene at the program's step, see `at_step`.
    place, rounding
        Displacements along and across the base at every step, and units of their last digits [m], (steps, 2).
    """
    size = _size(place)

    def residual_over(steps: int, change: CandidateChange[Values]) -> Residual:
        short = scene.with_values({"time.steps": steps})
        first = place[:steps]

        def residual(u: float) -> Array:
            run = displacements(short.with_values(change.changed(u)))
            return np.ones(first.size) if run is None else np.ravel((run - first) / size)

        return residual

    stages = sorted({min(stage, len(place)) for stage in (*STAGES, len(place))})
    best = [nearest_start(residual_over(stages[0], change), change) for change in candidates(scene)]
    best = nearest(best, PURSUED, 0.0)
    for steps in stages:
        fits = [fitted(residual_over(steps, fit.change), fit, ROUNDS, NUDGE, ARRIVED) for fit in best]
        fits.sort(key=lambda fit: fit.remainder)
        best = alike(fits[:NEAREST], lambda fit: fit.remainder, NEAR, ROUNDED * math.sqrt(steps))
        if best[0].remainder > NOISE * math.sqrt(2 * steps):
            return None, []  # no noise is so large
    explanations = []
    for fit in best:
        run = agreement(scene.with_values(fit.change.changed(fit.u)), place, rounding)
        if run.same:
            value = significant(fit.change.value(fit.u), 6) if fit.change.starts else None
            explanations.append(OneChange(fit.change.id, value, fit.change.words(fit.change.value(fit.u)), run))
    clear = alike(explanations, lambda change: change.run.left, CLEAR)
    ids = {change.id for change in clear}
    certain = clear[0] if len(ids) == 1 and not ids & set(OUTSIDE) else None
    return certain, clear
