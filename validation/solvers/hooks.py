"""What the room of solvers asks of the kind of a scene."""

from __future__ import annotations

import math
from typing import Any

from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared, Solver


class SolvingHooks(Hooks):
    """How a kind of scene is run by solvers that take several kinds, and what a run of it may need and reach."""

    module = "solving"

    def refusal(self, scene: Scene, solver: str) -> str | None:
        """Return None, or why a solver of several kinds cannot express a scene, apart from its features."""
        return None

    def build(self, scene: Scene, solver: str, full: bool) -> Prepared | None:
        """Return the model of a scene for a solver of several kinds; None of a block, which each builds itself."""
        return None

    def request(self, scene: Scene) -> dict[str, Any] | None:
        """Return the data by which FEniCSx builds the model; None of a block."""
        return None

    def memory(self, scene: Scene, solver: Solver) -> tuple[float, str]:
        """Return the bytes of the model of a scene, and the key that they come from most."""
        return 0.0, "time.steps"

    def reach(self, scene: Scene) -> float:
        """Return the bound of the displacement that load and given energy can drive [m]; infinite where none is known.

        An `InputError` if what drives the scene cannot be read.
        """
        return math.inf

    def time_limit(self, scene: Scene) -> float | None:
        """Return the time that a user's function may take beside what its steps add [s]; None: that of every scene."""
        return None

    def scaled(self, scene: Scene, factor: float) -> dict[str, Any]:
        """Return keys whose values times a factor make another scene of the same size; none where there are none."""
        return {}
