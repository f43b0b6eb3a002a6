"""Whether another solver than DDA with one strain a block made a history, as it is or with one slip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.diagnosis.causes import BENIGN_COMPLIANCE
from validation.diagnosis.fits.target import Bar
from validation.diagnosis.other_solvers import Goal, Rival, rivals, slipped
from validation.diagnosis.readings import Reading
from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

MESH = 5e-3  # relative L2 that a coarse mesh leaves beside the exact bar: eight linear elements a side at 0.5 ms
SHARE = 0.05  # of what is to be explained, at most, that it may leave
APART = 3.0  # times more that every other cause must leave: a mesh error is no noise


@dataclass(frozen=True, eq=False)
class RivalVerdict:
    """What the other solvers came to."""

    best: Rival
    ranked: list[Rival]
    causes: list[str]
    values: dict[str, float]
    own: Array  # displacement of the same solver on the scene as it is [m]
    explained: bool
    left: float  # share of the difference [-]


def judged(scene: Scene, reading: Reading, below: float, names: Sequence[str], exact: str = "") -> RivalVerdict | None:
    """Return what the other solvers explain, None where none applies.

    Parameters
    ----------
    below
        Misfit that they must come below: a share of what DDA leaves.
    exact
        Name of a solver that has no mesh, whose own histories it gives back to their digits.
    """
    steps = reading.stepping.steps
    if np.ptp(steps) > 0:
        return None
    same = reading.scene_of(scene)
    goal = Goal(reading.stepping.rows, reading.displacement, reading.pressure)
    ranked = rivals(same, names, goal)
    if not ranked:
        return None
    bars = [Bar.of(reading.displacement, reading.rounding)]
    spread = bars[0].allowed
    near = ranked + slipped(same, ranked[0].model, goal)
    mesh = 0.0 if ranked[0].model == exact else MESH
    on_mesh = get_solver(ranked[0].model).meshed  # the scene's own: with the right slip it leaves noise alone
    allowed = spread if on_mesh else max(mesh, spread)
    return _decided(scene, near, ranked, max(mesh, spread), allowed, below)


def _decided(
    scene: Scene, tried: Sequence[Rival], ranked: list[Rival], bar: float, allowed: float, below: float
) -> RivalVerdict:
    """Return the verdict: the solver as it is below `bar`, with one slip below `allowed`, or not explained."""
    t = scene.time
    model = ranked[0].model
    own = next(r for r in ranked if r.model == model and (r.alpha, r.delta) in ((t.alpha, t.delta), (None, None)))
    plain = own.plain
    if plain <= min(bar, below):
        return RivalVerdict(own, ranked, [], {}, own.unsoftened, True, 0.0)
    ordered = sorted(tried, key=lambda r: r.misfit)
    best = ordered[0]
    causes, values = _causes(scene, best)
    others = [r for r in ordered if _causes(scene, r)[0] != causes]
    clear = not others or others[0].misfit > APART * best.misfit
    enough = best.misfit <= min(allowed, max(SHARE * plain, 1e-12), below)
    one = len(causes) <= 1
    return RivalVerdict(best, ranked, causes, values, own.unsoftened, clear and enough and one, best.misfit / plain)


def _causes(scene: Scene, rival: Rival) -> tuple[list[str], dict[str, float]]:
    """Return the causes by which a solver's answer differs from that on the scene."""
    t, values = scene.time, {}
    if rival.slip:
        return [rival.slip], {rival.slip: float(f"{rival.amount:.6g}")}
    causes = []
    if rival.alpha is not None and (rival.alpha, rival.delta) != (t.alpha, t.delta):
        causes.append("scheme")
    if abs(rival.softness) > 1e-3:
        name = "base-compliance" if 0 < rival.softness < 2 * BENIGN_COMPLIANCE else "springs-factor"
        causes.append(name)
        values[name] = float(f"{np.exp(-rival.softness):.6g}") if name == "springs-factor" else rival.softness
    return causes, values
