"""The suite's own run of a scene beside a history of it: what "the same" rests on.

The laws in `laws` hold forces to a share of the limit of friction, and a bias within it, of one sign at every step,
adds up. A run of the scene does not let it pass: creep amplifies a difference some hundred times, and a file tells it
to its last digit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.diagnosis.fits.bar import ARITHMETIC, WITHIN, white
from validation.diagnosis.fits.fit import NORMAL_95
from validation.diagnosis.forces.motion import STANDARD
from validation.diagnosis.reading import SAME_STEP, SIDEWAYS
from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, Array
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

DDA = "dda"
SHAKEN = 1e-12  # relative: what two programs may differ by in a spring or a coefficient, by their arithmetic
APART = 1e-4  # of the largest displacement: where arithmetic alone leaves so much, steps tell nothing more
TOLD = 0.25  # share of the steps that must tell; what amplifies rounding so much amplifies any other difference too
NOISE = 1e-2  # of the largest displacement: more is not put down to noise
NOISY = 100  # rows from which on noise can be told from a shape
FITTED = 150  # steps that weight and springs are fitted to
SURROUNDINGS = frozenset({"own-weight", "base-compliance", "springs-factor"})  # what a scene of the suite can hold


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
    if _within(rest / unit) or (misfit <= NOISE and len(rest) >= NOISY and all(white(column) for column in rest.T)):
        return Agreement(True, misfit)
    if not _within((rest / unit)[: max(4, len(rest) // 20)]):
        return Agreement(False, misfit)
    amplified = _amplified(scene, scene_run)
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


def _amplified(scene: Scene, scene_run: Array) -> Array:
    """Return what the scene makes of other arithmetic up to each step [m], (steps, 2); infinite where it has no run."""
    c, grown = scene.contact, np.zeros_like(scene_run)
    for name, value in (("contact.stiffness", c.stiffness), ("contact.friction", c.friction or 0.0)):
        shaken = displacements(scene.with_values({name: value * (1 + SHAKEN)}))
        grown = np.maximum(grown, np.inf if shaken is None else np.abs(shaken - scene_run))
    return np.asarray(np.maximum.accumulate(grown, axis=0))


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
