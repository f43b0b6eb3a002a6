"""The study `creep`: a statically stable block on an incline that moves all the same.

Undamped normal ringing unloads the friction once a period, so that the exact block creeps with a speed that scales with
g / w_n: at 20 degrees under 22 or 30 of friction between a half and twice that. A scheme that damps the ringing lets it
stop; friction that lags by a pass, and dead bands, let it go on, the faster the finer the step.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.runs.history import History
from validation.runs.row import Metrics
from validation.scenes.scene import Scene
from validation.suite.bands import APART, Band, cases, convergence, near
from validation.theory import friction

EXACT = "creep-exact"
STEPS = "creep-steps"
LAGGED = "creep-lagged"
STIFFNESS = "creep-stiffness"
DAMPED = "creep-damped"
DDA = "dda"
# Way of the centroid in a second under lagged friction by an established program [m], by time step [s].
PROGRAM = {0.01: 1.0e-3, 0.002: 2.2e-3, 0.001: 5.2e-3, 0.0002: 499e-3}
DIGIT = 5e-5  # m: half a unit of its last digit
SHUFFLED = 0.2  # of the way: rounding, or 0.2 % on the springs, changes the order of stick and slip at the finest step


def slid(columns: Mapping[str, Any]) -> np.ndarray:
    """Return the mean slide of the two corners [m]."""
    return np.asarray((columns["slide_m"] + columns["slide_n"]) / 2)


def derived() -> DerivedRows:
    """Return the rows that are computed from finished cases."""
    return tuple(map(_nearest, PROGRAM))


def base(scene: Scene, history: History) -> Metrics:
    """Return the corners' mean slide at quarters of the run, and its mean speed over the second half."""
    mean_slide = slid(history.columns)
    n = len(history.time)
    values = {f"way.{k}": float(mean_slide[k * n // 4 - 1]) for k in (1, 2, 3, 4)}
    speed = (mean_slide[-1] - mean_slide[n // 2 - 1]) / (history.time[-1] - history.time[n // 2 - 1])
    mean_speed = mean_slide[-1] / history.time[-1]
    scale = friction.creep_scale(scene)
    return values | {"speed": speed, "mean_speed": mean_speed, "share": mean_speed / scale}


def _nearest(step: float) -> Derived:
    """Return the row that lays the creep of three like springs beside the program's."""
    like_cases = tuple(case for case in cases(LAGGED) if case.time.step == step)
    needs = tuple((case.name, DDA) for case in like_cases)
    return Derived(LAGGED, f"at {1e3 * step:g} ms", needs, functools.partial(_beside, like_cases, PROGRAM[step]))


def _beside(like_cases: tuple[Scene, ...], program_slide: float, finished: Finished) -> Metrics:
    """Return how far the program's way is from those of the springs, over what their spread and digits allow."""
    histories = [finished.needed_history(case.name, DDA) for case in like_cases]
    slides = [float(history.columns["horizontal_displacement"][-1]) for history in histories]
    middle = (min(slides) + max(slides)) / 2
    spread = max(slides) - min(slides)
    allowed = 1.5 * spread + DIGIT
    if program_slide > 0.1:
        allowed = max(allowed, SHUFFLED * program_slide)
    return {"distance": (program_slide - middle) / allowed, "way": middle, "spread": spread}


def order(runs: Sequence[tuple[Scene, History, History]]) -> Metrics:
    """Return the orders in the step of both displacements against the exact block."""
    return convergence(runs, quantities=("displacement", "horizontal"))


def exact_speed(case: Scene) -> Band:
    """Return the speed of the exact block by an independent program [m/s]."""
    return near({30.0: 18.7e-3, 22.0: 27.3e-3}[case.contact.friction or 0.0], 0.05)


def damped_way(case: Scene) -> Band:
    """Return how far a damped block creeps until it stands [m]."""
    hop = friction.creep_scale(case) / friction.normal_frequency(case)
    return hop, 2 * friction.damped_creep(case)


def lagged_creep(case: Scene) -> Band:
    """Return the speed of creep under lagged friction [m/s]."""
    scale = friction.creep_scale(case)
    return 0.01 * scale, 2 * scale


def lag(case: Scene) -> Band:
    """Return how far DDA lags behind the exact block."""
    return APART, friction.lag(case)


def closed(case: Scene) -> Metrics:
    """Return p/E, and the speed g / w_n that the creep scales with [m/s]."""
    return {"p/E": case.contact.stiffness / case.block.young, "scale": friction.creep_scale(case)}


def program(case: Scene) -> Metrics:
    """Return the slip in a second under lagged friction by an established program [m]."""
    return {"slip": PROGRAM[case.time.step]}
