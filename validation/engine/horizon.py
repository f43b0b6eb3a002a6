"""The horizon of a unilateral contact: how long two correct codes agree before the switches amplify rounding.

A run with p (1 + 1e-12), of a column with its densities so, stands for the other code. Its distance from the run is at
first that of rounding, some digits enlarged, and grows with every switch; where it exceeds
`validation.metrics.contact.AGREED`, histories tell nothing any more, and only what holds for every history (momentum,
energy, complementarity) is left to judge.
"""

from __future__ import annotations

from validation.metrics.contact import SHIFT
from validation.runs.history import History
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver
from validation.solvers.hooks import SolvingHooks


def shadow(solver: Solver, scene: Scene, full: bool) -> History | None:
    """Return the history with p (1 + 1e-12), of a rigid stop or a column with its density so; None if it fails."""
    run = solver.prepare(scene.with_values(SolvingHooks.of(scene).scaled(scene, 1 + SHIFT)), full).run()
    return run.history if run.outcome is Outcome.COMPLETED else None
