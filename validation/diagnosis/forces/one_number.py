"""A history with friction beside the suite's own runs of its scene with one thing changed.

Stick and slip amplify a difference, so that a number is fitted to the first steps, then to more and more of them. It is
named only if the run with it gives the history to its digits or noise, by the same measure as "the same" is said.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from validation.diagnosis.changes import Values
from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.forces.forward import Agreement, agreement, displacements
from validation.diagnosis.forces.motion import body_of
from validation.diagnosis.one_change import CandidateChange, alike, fitted, nearest_start, of_discount, of_numbers
from validation.runs.history import Array
from validation.scenes.scene import Scene

STAGES = (60, 150)  # steps that numbers are fitted to, before all
ROUNDS = 8  # evaluations of a fit
FACTORS = (0.8, 0.95, 1.05, 1.25)  # to begin from; a factor of one tells nothing of its own
DISCOUNTS = (0.999, 0.99, 0.95)
COHESIONS = (0.02, 0.1, 0.3)  # over the mean limit of friction of a corner
NUDGE = 1e-4  # of the logarithm of a factor, for the slope at its start
ARRIVED = 1e-15  # relative gain at which a fit ends: stick and slip amplify what is left
NEAREST = 4  # candidates that are fitted further
NEAR = 3.0  # times as much as the best leaves: what may still come out first
CLEAR = 3.0  # times more that every other candidate must leave
OUTSIDE = ("height-factor", "width-factor")  # computed so that no other is named in their place


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
    found = [*of_numbers(scene, FACTORS), normal_springs, of_discount(scene, DISCOUNTS)]
    width = body_of(scene).x[1] - body_of(scene).x[0]
    limit = body_of(scene).coefficient * abs(float(body_of(scene).load[1])) / 2
    found.append(
        CandidateChange(
            "cohesion",
            lambda v: f"the cohesion is {v:.4g} Pa where the scene has {c.cohesion:.4g}",
            lambda u: c.cohesion + math.exp(u),
            lambda u: {"contact.cohesion": c.cohesion + math.exp(u)},
            tuple(math.log(share * limit / (width / 2)) for share in COHESIONS if limit > 0),
        )
    )
    return [*found, *_schemes(scene)]


def _schemes(scene: Scene) -> list[CandidateChange[Values]]:
    """Return the other named schemes and starts, which have no number."""
    t, found = scene.time, []
    for name, (alpha, delta) in NAMED.items():
        for start in ("zero", "consistent"):
            same = (alpha, delta) == (t.alpha, t.delta)
            if alpha == 0 or (same and start == t.start):
                continue
            values: Values = {"time.alpha": alpha, "time.delta": delta, "time.start": start}
            words = f"the initial acceleration is {start}" if same else f"the scheme is {name}, start {start}"
            found.append(
                CandidateChange("start" if same else "scheme", lambda _, said=words: said, float, lambda _, v=values: v)  # type: ignore[misc]
            )
    return found


def one_number(scene: Scene, place: Array, rounding: Array) -> tuple[OneChange | None, list[OneChange]]:
    """Return the one change that gives a history back, if any does, and all that do.

    Parameters
    ----------
    scene
        The scene at the program's step, see `forward.at_step`.
    place, rounding
        Displacements along and across the base at every step, and units of their last digits [m], (steps, 2).
    """
    tried = [(one, one.starts[0] if one.starts else 0.0, math.inf) for one in candidates(scene)]
    for stage in (*STAGES, len(place)):
        steps = min(stage, len(place))
        first = stage == STAGES[0]
        fits = [_fitted(scene, one, u, place[:steps], first) for one, u, _ in tried]
        ordered = sorted(fits, key=lambda item: item[2])
        bar = NEAR * ordered[min(NEAREST, len(ordered)) - 1][2]
        tried = [item for item in ordered if item[2] <= bar] if first else ordered[:NEAREST]
        if steps == len(place):
            break
    found = []
    for one, u, _ in tried:
        run = agreement(scene.with_values(one.changed(u)), place, rounding)
        if run.same:
            value = float(f"{one.value(u):.6g}") if one.starts else None
            found.append(OneChange(one.id, value, one.words(one.value(u)), run))
    clear = alike(found, lambda change: change.run.left, CLEAR)
    ids = {change.id for change in clear}
    best = clear[0] if len(ids) == 1 and not ids & set(OUTSIDE) else None
    return best, clear


def _fitted(
    scene: Scene, one: CandidateChange[Values], u: float, place: Array, first: bool
) -> tuple[CandidateChange[Values], float, float]:
    """Return a candidate's number that comes nearest over some steps, and what it leaves."""
    size = np.maximum(np.max(np.abs(place), axis=0), np.finfo(float).tiny)
    short = scene.with_values({"time.steps": len(place)})

    def residual(number: float) -> Array:
        run = displacements(short.with_values(one.changed(number)))
        return np.ones(place.size) if run is None else np.ravel((run - place) / size)

    if not one.starts:
        return one, u, float(np.linalg.norm(residual(u)))
    at = nearest_start(residual, one.starts) if first else u
    return one, *fitted(residual, at, ROUNDS, NUDGE, ARRIVED)
