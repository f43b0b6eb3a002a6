"""How long a run is going to take, from shorter runs of the same scene.

Where contact opens or slips nothing but a run knows how many switches, solves and digits it takes. Two runs, one twice
as long as the other, have the exponent q of T^q; below 1 a fixed part, as the factors of a matrix, is the cause.
"""

from __future__ import annotations

import math
import time

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
PREDICTED = (Role.REFERENCE, Role.LIMIT, Role.TRUTH)  # DDA's own steps take seconds at most


def predicted_seconds(solver: Solver, scene: Scene, full: bool = False) -> float | None:
    """Return about how long a run is going to take [s]; None where it is short, or linear and so known to be.

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
            if seconds > ENOUGH or expected < TOLD:
                break
        earlier = seconds
    return expected if expected is not None and expected >= TOLD else None


def extrapolated(earlier: float, later: float, times: float) -> float:
    """Return the seconds of a run `times` as long as one that took `later`, and `earlier` at half its length [s]."""
    growth = math.log2(later / earlier)
    if growth >= 1:
        return later * times**growth
    return later + 2 * max(later - earlier, 0.0) * (times - 1)
