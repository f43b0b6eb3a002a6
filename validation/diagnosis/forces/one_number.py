"""A history with friction beside the suite's own runs of its scene with one thing changed.

Stick and slip amplify a difference, so that a number is fitted to the first steps, then to more and more of them. It is
named only if the run with it gives the history to its digits or noise, by the same measure as "the same" is said.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.forces.forward import NOISE, Agreement, agreement, displacements
from validation.diagnosis.forces.motion import body_of
from validation.diagnosis.numbers import Values
from validation.diagnosis.one_change import (
    CandidateChange,
    Residual,
    alike,
    fitted,
    nearest,
    nearest_start,
    of_discount,
    of_numbers,
)
from validation.runs.history import Array
from validation.scenes.scene import Scene

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
    width = body_of(scene).x[1] - body_of(scene).x[0]
    limit = body_of(scene).coefficient * abs(float(body_of(scene).load[1])) / 2
    changes.append(
        CandidateChange(
            "cohesion",
            lambda v: f"the cohesion is {v:.4g} Pa where the scene has {c.cohesion:.4g}",
            lambda u: c.cohesion + math.exp(u),
            lambda u: {"contact.cohesion": c.cohesion + math.exp(u)},
            tuple(math.log(share * limit / (width / 2)) for share in COHESIONS if limit > 0),
        )
    )
    if scene.contact.rules != "lagged":  # the printed digits may show it in the motion and not in its forces
        lagged: Values = {"contact.rules": "lagged"}
        changes.append(_fixed("lagged-friction", "friction lags", lagged))
    return [*changes, *_schemes(scene)]


def _schemes(scene: Scene) -> list[CandidateChange[Values]]:
    """Return the other named schemes and starts, which have no number."""
    t, schemes = scene.time, []
    for name, (alpha, delta) in NAMED.items():
        for start in ("zero", "consistent"):
            same = (alpha, delta) == (t.alpha, t.delta)
            if alpha == 0 or (same and start == t.start):
                continue
            values: Values = {"time.alpha": alpha, "time.delta": delta, "time.start": start}
            words = f"the initial acceleration is {start}" if same else f"the scheme is {name}, start {start}"
            schemes.append(_fixed("start" if same else "scheme", words, values))
    return schemes


def _fixed(name: str, words: str, values: Values) -> CandidateChange[Values]:
    return CandidateChange(name, lambda _: words, float, lambda _: values)


def one_number(scene: Scene, place: Array, rounding: Array) -> tuple[OneChange | None, list[OneChange]]:
    """Return the one change that gives a history back, if any does, and all that do.

    Parameters
    ----------
    scene
        The scene at the program's step, see `forward.at_step`.
    place, rounding
        Displacements along and across the base at every step, and units of their last digits [m], (steps, 2).
    """
    size = np.maximum(np.max(np.abs(place), axis=0), np.finfo(float).tiny)

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
            value = float(f"{fit.change.value(fit.u):.6g}") if fit.change.starts else None
            explanations.append(OneChange(fit.change.id, value, fit.change.words(fit.change.value(fit.u)), run))
    clear = alike(explanations, lambda change: change.run.left, CLEAR)
    ids = {change.id for change in clear}
    certain = clear[0] if len(ids) == 1 and not ids & set(OUTSIDE) else None
    return certain, clear
