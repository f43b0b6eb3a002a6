"""What is said before a run that takes long."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from validation.cli.printing.output import echo, in_minutes

if TYPE_CHECKING:
    from validation.scenes.scene import Scene
    from validation.solvers.contract import Solver


def announced(solver: Solver, scene: Scene, full: bool = False) -> str:
    """Say on standard error, if no progress bar does, how long a long run is going to take; return the words."""
    from validation.engine.duration import predicted_duration

    prediction = predicted_duration(solver, scene, full)
    if prediction is None:
        return ""
    words = f"{'more than' if prediction.is_least else 'about'} {in_minutes(prediction.seconds)}"
    if not sys.stderr.isatty():
        echo(f"{scene.name}, {solver.name}: {scene.time.steps} steps, {words}", err=True)
    return f", {words}"
