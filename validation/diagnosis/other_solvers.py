"""A history beside any solver of the suite, scheme by scheme, each at its best stiffness or with one wrong number.

The candidates and their fits are those of `one_change`; a mesh error is no noise, so that bars are wider than DDA's.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from validation.diagnosis.causes import BENIGN_COMPLIANCE
from validation.diagnosis.fits.bar import Bar, norm
from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.fits.target import joined
from validation.diagnosis.numbers import Values
from validation.diagnosis.one_change import CandidateChange, fitted, nearest_start, of_discount, of_numbers
from validation.diagnosis.readings import Reading
from validation.errors import InputError
from validation.runs.history import Array
from validation.runs.numbers import significant
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

SCHEMES_OF = {"continuum": 1, "fem": 1}  # how many are tried: the continuum has none, finite elements take long
NUDGE = 1e-4  # of ln stiffness or ln factor, for the derivative
ROUNDS = 9  # evaluations of a fit: a compliance of some per cent needs two, half the stiffness six
MOST = math.log(1e3)  # no spring is softer or stiffer than that
SLIPS = {"density-factor", "young-factor", "load-factor", "gg"}  # numbers that are tried besides the springs
DISCOUNTS = (0.998, 0.99, 0.97, 0.94, 0.9, 0.8)
STARTS = tuple(float(f) for f in np.geomspace(0.25, 4.0, 17))
FEW = {"fem": 4}  # of a slow solver every so many of the starts
MESH = 5e-3  # relative L2 that a coarse mesh leaves beside the exact bar: eight linear elements a side at 0.5 ms
SHARE = 0.05  # of what is to be explained, at most, that it may leave
FARTHEST = 1e6  # relative: a run that leaves its bounds is no nearer than that
APART = 3.0  # times more that every other cause must leave: a mesh error is no noise
SOFTER = 1e-3  # of the logarithm of the stiffness, from which on springs count as others than the scene's
NO_SCHEME = frozenset({"continuum"})


@dataclass(frozen=True)
class Rival:
    """A solver under a scheme, with the number at its best that is fitted.

    Attributes
    ----------
    model
        The solver's name.
    alpha, delta, gg
        Of the scheme; None for a solver without one.
    misfit
        Relative L2 [-].
    displacement
        Of every step [m].
    cause
        Id of the cause whose number is fitted.
    value
        That number.
    """

    model: str
    alpha: float | None
    delta: float | None
    gg: float | None
    misfit: float
    displacement: Array
    cause: str = "springs-factor"
    value: float = 1.0

    @property
    def softness(self) -> float:
        """Ln of the scene's spring stiffness over that in effect [-]."""
        return -math.log(self.value) if self.cause == "springs-factor" else 0.0


@dataclass(frozen=True, eq=False)
class RivalVerdict:
    """What the other solvers came to."""

    best: Rival
    causes: list[str]
    values: dict[str, float]
    scene_run: Array  # displacement of the same solver on the scene as it is [m]
    explained: bool
    left: float  # share of the difference [-]


def rivals(scene: Scene, solvers: Sequence[str], recorded: Reading) -> list[Rival]:
    """Return the solvers that apply to the scene, under the scene's own and other schemes, each at its best springs.

    Parameters
    ----------
    scene
        The scene at the history's own time step and number of steps.
    solvers
        Names of solvers; the continuum has no scheme.
    recorded
        The history.
    """
    t = scene.time
    every = list(dict.fromkeys([(t.alpha, t.delta), *NAMED.values()]))
    ranked = []
    for name in solvers:
        if name == "continuum" and t.discount != 1:  # the damped one takes minutes over long histories
            continue
        for alpha, delta in every[: SCHEMES_OF.get(name, len(every))]:
            stepped = scene.with_values({"time.alpha": alpha, "time.delta": delta})
            rival = _fitted(stepped, name, recorded, _springs(stepped))
            if rival is not None:
                ranked.append(rival)
    return sorted(ranked, key=lambda rival: rival.misfit)


def not_installed(scene: Scene, solvers: Iterable[str]) -> tuple[str, ...]:
    """Return a sentence for each solver that applies to a scene and is no candidate here, for want of an extra."""
    adapters = (get_solver(name) for name in solvers)
    absent = {solver.name: solver.missing(scene) for solver in adapters if solver.refusal(scene) is None}
    return tuple(f"{name} is no candidate: it {reason}" for name, reason in absent.items() if reason is not None)


def slipped(scene: Scene, name: str, recorded: Reading) -> list[Rival]:
    """Return a solver's answers with one number of the scene wrong by a factor, each at its best factor."""
    changes = [*of_numbers(scene, STARTS[:: FEW.get(name, 1)], units=False), of_discount(scene, DISCOUNTS)]
    fits = [_fitted(scene, name, recorded, change) for change in changes if change.id in SLIPS]
    return [rival for rival in fits if rival is not None]


def _springs(scene: Scene) -> CandidateChange[Values]:
    """Return normal springs by a factor e^-u; those in shear go with them if they are the same."""

    def stiffness(u: float) -> Values:
        return {"contact.stiffness": scene.contact.stiffness * math.exp(-min(max(u, -MOST), MOST))}

    return CandidateChange("springs-factor", "{:g}".format, lambda u: math.exp(-u), stiffness, (0.0,))


def _fitted(scene: Scene, name: str, recorded: Reading, change: CandidateChange[Values]) -> Rival | None:
    """Return a solver with a number at its best, None where it does not apply, or no step of its scheme does."""
    solver = get_solver(name)
    if solver.refusal(scene) is not None or solver.missing(scene) is not None:
        return None

    def residual(u: float) -> Array:
        return _remainder(scene.with_values(change.changed(u)), name, recorded)[0]

    try:
        best = fitted(residual, nearest_start(residual, change), ROUNDS, NUDGE)
        displacement = _remainder(scene.with_values(change.changed(best.u)), name, recorded)[1]
    except InputError:  # the step lies beyond the limit of the scheme
        return None
    t = scene.time
    alpha, delta, gg = (None, None, None) if name in NO_SCHEME else (t.alpha, t.delta, t.discount)
    return Rival(name, alpha, delta, gg, best.remainder, displacement, change.id, change.value(best.u))


def _remainder(scene: Scene, name: str, recorded: Reading) -> tuple[Array, Array]:
    """Return what a solver leaves of a history, scaled, and its displacement of every step [m]."""
    run = get_solver(name).solve(scene)
    rows, columns = recorded.stepping.rows, (recorded.displacement, recorded.pressure)
    pressure = None if recorded.pressure is None else run.contact_pressure[rows]
    with np.errstate(all="ignore"):
        left = joined(columns, *columns) - joined(columns, run.displacement[rows], pressure)
    return np.nan_to_num(left, nan=FARTHEST, posinf=FARTHEST, neginf=-FARTHEST), run.displacement


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
    ranked = rivals(same_steps, names, reading)
    if not ranked:
        return None
    model = ranked[0].model
    t = scene.time
    same_scheme = next(
        r for r in ranked if r.model == model and (r.alpha, r.delta) in ((t.alpha, t.delta), (None, None))
    )
    remainder, scene_run = _remainder(same_steps, model, reading)
    plain = norm(remainder)
    spread = Bar.of(reading.displacement, reading.rounding).allowed
    mesh = 0.0 if model == exact else MESH
    if plain <= min(max(mesh, spread), below):
        return RivalVerdict(same_scheme, [], {}, scene_run, True, 0.0)
    ordered = sorted(ranked + slipped(same_steps, model, reading), key=lambda rival: rival.misfit)
    best = ordered[0]
    causes, values = _causes(scene, best)
    others = [rival for rival in ordered if _causes(scene, rival)[0] != causes]
    is_clear = not others or others[0].misfit > APART * best.misfit
    allowed = spread if get_solver(model).meshed else max(mesh, spread)  # on the scene's own mesh noise alone is left
    is_enough = best.misfit <= min(allowed, max(SHARE * plain, 1e-12), below)
    explained = is_clear and is_enough and len(causes) <= 1
    return RivalVerdict(best, causes, values, scene_run, explained, best.misfit / plain)


def _causes(scene: Scene, rival: Rival) -> tuple[list[str], dict[str, float]]:
    """Return the causes by which a solver's answer differs from that on the scene."""
    number = significant(rival.value, 6)
    if rival.cause != "springs-factor":
        return [rival.cause], {rival.cause: number}
    t = scene.time
    causes = []
    values = {}
    if rival.alpha is not None and (rival.alpha, rival.delta) != (t.alpha, t.delta):
        causes.append("scheme")
    if abs(rival.softness) > SOFTER:
        name = "base-compliance" if 0 < rival.softness < 2 * BENIGN_COMPLIANCE else "springs-factor"
        causes.append(name)
        values[name] = number if name == "springs-factor" else rival.softness
    return causes, values
