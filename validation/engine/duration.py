"""How long a run is going to take, from shorter runs of the same scene.

Where contact opens or slips nothing but a run knows how many switches, solves and digits it takes. Two runs, one twice
as long as the other, have the exponent q of T^q; below 1 a fixed part, as the factors of a matrix, is the cause.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from validation.engine.measure import completed
from validation.runs.run import Outcome
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Role, Solver

SHARES = (1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4)  # of the steps, that are run for a prediction
FEWEST = 2  # steps of such a run
NOISE = 0.05  # seconds below which a run tells nothing
TOLD = 5.0  # seconds from which on a prediction is of interest
ENOUGH = 1.0  # seconds of a run after which no longer one is made
STEADY = 3.0  # exponent beyond which more switches and digits set in, and a run takes longer than in proportion
PREDICTED = (Role.REFERENCE, Role.LIMIT, Role.TRUTH)  # DDA's own steps take seconds at most


@dataclass(frozen=True)
class Prediction:
    """How long a run is going to take."""

    seconds: float
    is_least: bool = False  # whether that is a lower bound, else about what it takes


def predicted_duration(solver: Solver, scene: Scene, full: bool = False) -> Prediction | None:
    """Return how long a run is going to take; None where it is short, or linear and so known to be.

    Parameters
    ----------
    solver, scene
        What is to be run.
    full
        Whether the numerical savings are off.
    """
    if features.linear(scene) or solver.role not in PREDICTED or solver.refusal(scene):
        return None
    expected = None
    earlier = 0.0  # seconds of the run of half as many steps
    for share in SHARES:
        steps = int(share * scene.time.steps)
        if steps < FEWEST:
            continue
        start = time.perf_counter()
        run = completed(solver, scene.with_values({"time.steps": steps}), full)
        seconds = time.perf_counter() - start
        if run.outcome is not Outcome.COMPLETED:
            return None
        if earlier >= NOISE:
            expected = extrapolated(earlier, seconds, scene.time.steps / steps)
        if seconds > ENOUGH:
            break
        earlier = seconds
    return expected if expected is not None and expected.seconds >= TOLD else None


def extrapolated(earlier: float, later: float, times: float) -> Prediction:
    """Predict a run `times` as long as one that took `later` seconds, and `earlier` at half its length."""
    growth = math.log2(later / earlier)
    if growth > STEADY:
        return Prediction(later * times, is_least=True)
    if growth >= 1:
        return Prediction(later * times**growth)
    return Prediction(later + 2 * max(later - earlier, 0.0) * (times - 1))
