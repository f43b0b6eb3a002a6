"""A history beside any solver of the suite, scheme by scheme, each with one free compliance of the springs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from validation.diagnosis.fits.fit import NAMED
from validation.errors import InputError
from validation.runs.history import PRESSURE, Array
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

SCHEMES_OF = {"continuum": 1, "fem": 1}  # how many are tried: the continuum has none, finite elements take long
NUDGE = 1e-4  # of ln stiffness, for the derivative
ROUNDS = 9  # of Gauss-Newton at most: a compliance of some per cent needs two, half the stiffness six
MOST = math.log(1e3)  # no spring is softer or stiffer than that


@dataclass(frozen=True)
class Rival:
    """A solver under a scheme, at its best compliance."""

    model: str  # the solver's name
    alpha: float | None  # None for a solver without a scheme
    delta: float | None
    gg: float | None
    misfit: float  # relative L2 [-]
    softness: float  # ln of the scene's spring stiffness over that in effect [-]
    displacement: Array  # of every step [m]
    unsoftened: Array  # the same on the scene's own springs [m]
    plain: float = np.inf  # misfit on the scene's own springs [-]
    slip: str = ""  # id of another cause than scheme and springs
    amount: float = 1.0  # its number


def rivals(
    scene: Scene,
    solvers: Sequence[str],
    goal: Goal,
    schemes: Iterable[tuple[float, float]] = NAMED.values(),
    known: Sequence[Rival] = (),
) -> list[Rival]:
    """Return the solvers that apply to the scene, under the scene's own and other schemes.

    Parameters
    ----------
    scene
        The scene at the history's own time step and number of steps.
    solvers
        Names of solvers; the continuum has no scheme.
    goal
        The history.
    schemes
        Pairs (alpha, delta), the likeliest first; by default the named ones.
    known
        What was found before for the same scene and the same history.
    """
    t, found = scene.time, []
    before = {(r.model, r.alpha, r.delta): r for r in known}
    every = dict.fromkeys([(t.alpha, t.delta), *schemes])
    for name in solvers:
        if name == "continuum" and t.discount != 1:  # the damped one takes minutes over long histories
            continue
        pairs = list(every)[: SCHEMES_OF.get(name, len(every))]
        for alpha, delta in pairs:
            scheme = (None, None) if name == "continuum" else (alpha, delta)
            rival = before.get((name, *scheme))
            if rival is None:
                rival = _fitted(scene.with_values({"time.alpha": alpha, "time.delta": delta}), name, goal)
            if rival is not None:
                found.append(rival)
    return sorted(found, key=lambda r: r.misfit)


@dataclass(frozen=True, eq=False)
class Goal:
    """The recorded rows of a history."""

    rows: np.ndarray  # indices of the steps
    displacement: Array  # [m]
    pressure: Array | None  # [Pa]

    def scaled(self, displacement: Array, pressure: Array | None) -> Array:
        """Return columns of the recorded rows over the norms of the history's own."""
        first = displacement / (np.linalg.norm(self.displacement) or 1.0)
        if self.pressure is None or pressure is None:
            return np.asarray(first)
        second = pressure / (np.linalg.norm(self.pressure) or 1.0)
        return np.concatenate([first, second]) / math.sqrt(2)


def _fitted(scene: Scene, name: str, goal: Goal) -> Rival | None:
    """Return a solver at its best compliance, None where it does not apply."""
    if get_solver(name).refusal(scene) is not None:
        return None
    wanted, softness = goal.scaled(goal.displacement, goal.pressure), 0.0
    try:
        best, shown = _response(scene, name, goal, softness)
        plain, first = shown, float(np.linalg.norm(wanted - best))
        for _ in range(ROUNDS):
            slope = (_response(scene, name, goal, softness + NUDGE)[0] - best) / NUDGE
            change = float(slope @ (wanted - best)) / (float(slope @ slope) or 1.0)
            trial = min(max(softness + change, -MOST), MOST)
            answer, curve = _response(scene, name, goal, trial)
            if not np.linalg.norm(wanted - answer) < np.linalg.norm(wanted - best):
                break
            softness, best, shown = trial, answer, curve
            if abs(change) < NUDGE**2:
                break
    except InputError:  # the step lies beyond the limit of this scheme
        return None
    t, misfit = scene.time, float(np.linalg.norm(wanted - best))
    if name == "continuum":
        return Rival(name, None, None, None, misfit, softness, shown, plain, first)
    return Rival(name, t.alpha, t.delta, t.discount, misfit, softness, shown, plain, first)


SLIPS = {  # id to the field of the scene that a factor changes
    "density-factor": "block.density",
    "young-factor": "block.young",
    "load-factor": "load.pressure",
    "gg": "time.gg",
}
DISCOUNTS = (0.998, 0.99, 0.97, 0.94, 0.9, 0.8)
STARTS = tuple(float(f) for f in np.geomspace(0.25, 4.0, 17))
FEW = {"fem": 4}  # of a slow solver every so many of the starts


def slipped(scene: Scene, name: str, goal: Goal) -> list[Rival]:
    """Return a solver's answers with one number of the scene wrong by a factor, each at its best factor."""
    if get_solver(name).refusal(scene) is not None:
        return []
    b, t = scene.block, scene.time
    own = {"density-factor": b.density, "young-factor": b.young, "load-factor": scene.load.pressure, "gg": t.discount}
    wanted = goal.scaled(goal.displacement, goal.pressure)
    found = []
    for slip, key in SLIPS.items():
        most = 1 / own[slip] if slip == "gg" else np.inf  # a discount ends at one

        def answer(factor: float, key: str = key, value: float = own[slip], most: float = most) -> tuple[Array, Array]:
            return _response(scene.with_values({key: value * min(factor, most)}), name, goal, 0.0)

        try:
            factor, (best, shown) = _best_factor(
                answer, wanted, DISCOUNTS if slip == "gg" else STARTS[:: FEW.get(name, 1)]
            )
            factor = min(factor, most) * (own[slip] if slip == "gg" else 1.0)
        except InputError:  # the step lies beyond the limit of the scheme
            continue
        misfit = float(np.linalg.norm(wanted - best))
        alpha, delta, gg = (None, None, None) if name == "continuum" else (t.alpha, t.delta, t.discount)
        found.append(Rival(name, alpha, delta, gg, misfit, 0.0, shown, shown, misfit, slip, factor))
    return found


def _best_factor(
    answer: Callable[[float], tuple[Array, Array]], wanted: Array, starts: Sequence[float]
) -> tuple[float, tuple[Array, Array]]:
    """Return the factor whose answer is nearest, by trial and Gauss and Newton's method."""
    tried = [(f, answer(f)) for f in starts]
    factor, best = min(tried, key=lambda pair: float(np.linalg.norm(wanted - pair[1][0])))
    for _ in range(ROUNDS):
        slope = (answer(factor * (1 + NUDGE))[0] - best[0]) / NUDGE
        change = float(slope @ (wanted - best[0])) / (float(slope @ slope) or 1.0)
        trial = factor * (1 + min(max(change, -0.3), 0.3))
        new = answer(trial)
        if not np.linalg.norm(wanted - new[0]) < np.linalg.norm(wanted - best[0]):
            break
        factor, best = trial, new
    return factor, best


def _response(scene: Scene, name: str, goal: Goal, softness: float) -> tuple[Array, Array]:
    """Return the scaled rows and the whole displacement of a solver with softer springs."""
    springs = {"contact.stiffness": scene.contact.stiffness * math.exp(-softness)}  # in shear too if they are the same
    done = get_solver(name).solve(scene.with_values(springs))
    pressure = None if goal.pressure is None or done.history is None else done.history.columns[PRESSURE][goal.rows]
    return goal.scaled(done.displacement[goal.rows], pressure), done.displacement
