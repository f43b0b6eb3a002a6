"""A history beside any solver of the suite, scheme by scheme, each at its best stiffness or with one wrong number.

The candidates and their fits are those of `one_change`; a mesh error is no noise, so that bars are wider than DDA's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from validation.diagnosis.causes import BENIGN_COMPLIANCE, compliance
from validation.diagnosis.fits.fit import NAMED, fit, named
from validation.diagnosis.fits.target import Bar, Target, norm
from validation.diagnosis.one_change import CandidateChange, Fitted, fitted, nearest_start
from validation.diagnosis.readings import Reading
from validation.diagnosis.variant import Variant
from validation.errors import InputError
from validation.runs.history import PRESSURE, Array
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

SCHEMES_OF = {"continuum": 1, "fem": 1}  # how many are tried: the continuum has none, finite elements take long
NUDGE = 1e-4  # of ln stiffness or ln factor, for the derivative
ROUNDS = 9  # evaluations of a fit: a compliance of some per cent needs two, half the stiffness six
MOST = math.log(1e3)  # no spring is softer or stiffer than that
SLIPS = {  # id to the field of the scene that a factor changes
    "density-factor": "block.density",
    "young-factor": "block.young",
    "load-factor": "load.pressure",
    "gg": "time.gg",
}
DISCOUNTS = (0.998, 0.99, 0.97, 0.94, 0.9, 0.8)
STARTS = tuple(float(f) for f in np.geomspace(0.25, 4.0, 17))
FEW = {"fem": 4}  # of a slow solver every so many of the starts
MESH = 5e-3  # relative L2 that a coarse mesh leaves beside the exact bar: eight linear elements a side at 0.5 ms
SHARE = 0.05  # of what is to be explained, at most, that it may leave
FARTHEST = 1e6  # relative: a run that leaves its bounds is no nearer than that
APART = 3.0  # times more that every other cause must leave: a mesh error is no noise
Answer = tuple[Array, Array]  # scaled rows, and the displacement of every step [m]


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


@dataclass(frozen=True, eq=False)
class Goal:
    """The recorded rows of a history."""

    rows: np.ndarray  # indices of the steps
    displacement: Array  # [m]
    pressure: Array | None  # [Pa]

    def scaled(self, displacement: Array, pressure: Array | None) -> Array:
        """Return columns of the recorded rows over the norms of the history's own."""
        first = displacement / norm(self.displacement)
        if self.pressure is None or pressure is None:
            return np.asarray(first)
        return np.concatenate([first, pressure / norm(self.pressure)]) / math.sqrt(2)

    @property
    def values(self) -> Array:
        """The history's own columns, scaled."""
        return self.scaled(self.displacement, self.pressure)


@dataclass(frozen=True, eq=False)
class RivalVerdict:
    """What the other solvers came to."""

    best: Rival
    ranked: list[Rival]
    causes: list[str]
    values: dict[str, float]
    scene_run: Array  # displacement of the same solver on the scene as it is [m]
    explained: bool
    left: float  # share of the difference [-]


def rivals(
    scene: Scene,
    solvers: Sequence[str],
    goal: Goal,
    schemes: Iterable[tuple[float, float]] = NAMED.values(),
    at_hand: Sequence[Rival] = (),
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
    at_hand
        Rivals of the same scene and the same history that are at hand.
    """
    t = scene.time
    before = {(rival.model, rival.alpha, rival.delta): rival for rival in at_hand}
    every = list(dict.fromkeys([(t.alpha, t.delta), *schemes]))
    ranked = []
    for name in solvers:
        if name == "continuum" and t.discount != 1:  # the damped one takes minutes over long histories
            continue
        for alpha, delta in every[: SCHEMES_OF.get(name, len(every))]:
            scheme = (None, None) if name == "continuum" else (alpha, delta)
            rival = before.get((name, *scheme))
            if rival is None:
                rival = _on_softer_springs(scene.with_values({"time.alpha": alpha, "time.delta": delta}), name, goal)
            if rival is not None:
                ranked.append(rival)
    return sorted(ranked, key=lambda rival: rival.misfit)


def _on_softer_springs(scene: Scene, name: str, goal: Goal) -> Rival | None:
    """Return a solver at its best compliance, None where it does not apply."""
    c = scene.contact  # in shear too if the springs are the same

    def answer(softness: float) -> Answer:
        stiffness = c.stiffness * math.exp(-min(max(softness, -MOST), MOST))
        return _answer(scene.with_values({"contact.stiffness": stiffness}), name, goal)

    if get_solver(name).refusal(scene) is not None:
        return None
    try:
        rows, unsoftened = answer(0.0)
        change = CandidateChange("springs-factor", "{:g}".format, float, answer, (0.0,), NUDGE)
        plain = float(np.linalg.norm(goal.values - rows))
        best = _best(change, Fitted(change, 0.0, plain), goal)
    except InputError:  # the step lies beyond the limit of this scheme
        return None
    alpha, delta, gg = _scheme(scene, name)
    return Rival(name, alpha, delta, gg, best.remainder, best.u, answer(best.u)[1], unsoftened, plain)


def slipped(scene: Scene, name: str, goal: Goal) -> list[Rival]:
    """Return a solver's answers with one number of the scene wrong by a factor, each at its best factor."""
    if get_solver(name).refusal(scene) is not None:
        return []
    b, t = scene.block, scene.time
    data = {"density-factor": b.density, "young-factor": b.young, "load-factor": scene.load.pressure, "gg": t.discount}
    slipped = []
    for slip, key in SLIPS.items():
        largest = 1 / data[slip] if slip == "gg" else math.inf  # a discount ends at one
        starts = DISCOUNTS if slip == "gg" else STARTS[:: FEW.get(name, 1)]

        def answer(u: float, key: str = key, value: float = data[slip], largest: float = largest) -> Answer:
            return _answer(scene.with_values({key: value * min(math.exp(u), largest)}), name, goal)

        change = CandidateChange(slip, "{:g}".format, math.exp, answer, tuple(map(math.log, starts)), NUDGE)
        try:
            best = _best(change, nearest_start(_residual(change, goal), change), goal)
            displacement = answer(best.u)[1]
        except InputError:  # the step lies beyond the limit of the scheme
            continue
        factor = min(math.exp(best.u), largest) * (data[slip] if slip == "gg" else 1.0)
        alpha, delta, gg = _scheme(scene, name)
        misfit = best.remainder
        slipped.append(Rival(name, alpha, delta, gg, misfit, 0.0, displacement, displacement, misfit, slip, factor))
    return slipped


def _scheme(scene: Scene, name: str) -> tuple[float, float, float] | tuple[None, None, None]:
    t = scene.time
    return (None, None, None) if name == "continuum" else (t.alpha, t.delta, t.discount)


def _best(change: CandidateChange[Answer], start: Fitted[Answer], goal: Goal) -> Fitted[Answer]:
    return fitted(_residual(change, goal), start, ROUNDS, NUDGE)


def _residual(change: CandidateChange[Answer], goal: Goal) -> Callable[[float], Array]:
    values = goal.values
    return lambda u: np.nan_to_num(values - change.changed(u)[0], nan=FARTHEST, posinf=FARTHEST, neginf=-FARTHEST)


def _answer(scene: Scene, name: str, goal: Goal) -> Answer:
    """Return the scaled rows and the whole displacement of a solver."""
    run = get_solver(name).solve(scene)
    pressure = None if goal.pressure is None or run.history is None else run.history.columns[PRESSURE][goal.rows]
    return goal.scaled(run.displacement[goal.rows], pressure), run.displacement


# ---- the decision ---------------------------------------------------------------------------------------------------


def judged(scene: Scene, reading: Reading, below: float, names: Sequence[str], exact: str = "") -> RivalVerdict | None:
    """Return what the other solvers explain, None where none applies.

    Parameters
    ----------
    below
        Misfit that they must come below: a share of what DDA leaves.
    exact
        Name of a solver that has no mesh, whose own histories it gives back to their digits.
    """
    if np.ptp(reading.stepping.steps) > 0:
        return None
    same_steps = reading.scene_of(scene)
    goal = Goal(reading.stepping.rows, reading.displacement, reading.pressure)
    ranked = rivals(same_steps, names, goal)
    if not ranked:
        return None
    model = ranked[0].model
    t = scene.time
    plain = next(r for r in ranked if r.model == model and (r.alpha, r.delta) in ((t.alpha, t.delta), (None, None)))
    spread = Bar.of(reading.displacement, reading.rounding).allowed
    mesh = 0.0 if model == exact else MESH
    if plain.plain <= min(max(mesh, spread), below):
        return RivalVerdict(plain, ranked, [], {}, plain.unsoftened, True, 0.0)
    ordered = sorted(ranked + slipped(same_steps, model, goal), key=lambda rival: rival.misfit)
    best = ordered[0]
    causes, values = _causes(scene, best)
    others = [rival for rival in ordered if _causes(scene, rival)[0] != causes]
    is_clear = not others or others[0].misfit > APART * best.misfit
    allowed = spread if get_solver(model).meshed else max(mesh, spread)  # on the scene's own mesh noise alone is left
    is_enough = best.misfit <= min(allowed, max(SHARE * plain.plain, 1e-12), below)
    explained = is_clear and is_enough and len(causes) <= 1
    return RivalVerdict(best, ranked, causes, values, plain.unsoftened, explained, best.misfit / plain.plain)


def _causes(scene: Scene, rival: Rival) -> tuple[list[str], dict[str, float]]:
    """Return the causes by which a solver's answer differs from that on the scene."""
    if rival.slip:
        return [rival.slip], {rival.slip: float(f"{rival.amount:.6g}")}
    t = scene.time
    causes = []
    values = {}
    if rival.alpha is not None and (rival.alpha, rival.delta) != (t.alpha, t.delta):
        causes.append("scheme")
    if abs(rival.softness) > 1e-3:
        name = "base-compliance" if 0 < rival.softness < 2 * BENIGN_COMPLIANCE else "springs-factor"
        causes.append(name)
        values[name] = float(f"{np.exp(-rival.softness):.6g}") if name == "springs-factor" else rival.softness
    return causes, values


# ---- the ranking ----------------------------------------------------------------------------------------------------


def ranking(
    model: str, target: Target, best: Variant, free: Sequence[str], others: Sequence[Rival]
) -> list[dict[str, Any]]:
    """Return every named scheme with what else explains the history, and the other solvers, by misfit."""
    pairs = dict.fromkeys([(best.alpha, best.delta), *NAMED.values()])
    free = tuple(dict.fromkeys(("softness", *(name for name in free if name not in ("alpha", "delta", "gg", "base")))))
    fits = fit(target, [(replace(best, alpha=a, delta=d), free) for a, d in pairs])
    misfits = [each.misfit for each in fits]
    misfits[0] = min(misfits[0], fit(target, [(best, ())])[0].misfit)
    rows = []
    for each, misfit in zip(fits, misfits, strict=True):
        v = each.variant
        rows.append(row_of(model, v.alpha, v.delta, best.gg, misfit, compliance(target.column, v)))
    for rival in others:
        softer = compliance(target.column, replace(best, softness=rival.softness))
        rows.append(row_of(rival.model, rival.alpha, rival.delta, rival.gg, rival.misfit, softer))
    return sorted(rows, key=lambda row: row["misfit"])


def row_of(
    model: str, alpha: float | None, delta: float | None, gg: float | None, misfit: float, soft: float | None
) -> dict[str, Any]:
    """Return a line of the ranking; a scheme that grows has no finite misfit worth a number."""
    name = None if alpha is None or delta is None else named(alpha, delta)
    return {
        "model": model,
        "name": name,
        "alpha": alpha,
        "delta": delta,
        "gg": gg,
        "misfit": float(f"{min(misfit, 1e6):.6g}"),
        "compliance": None if soft is None else float(f"{soft:.4g}"),
    }
