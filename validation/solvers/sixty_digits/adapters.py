"""The two-block model in sixty-digit arithmetic as an ordinary solver, `dda-60`.

It takes the doubles of a scene as exact and rounds its histories to doubles at the end; they cost up to seconds.

"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from validation.runs import extras
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, Complex, History
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene
from validation.solvers.contract import NotReported, Prepared, Role
from validation.solvers.dda import DDA, OneBlock
from validation.solvers.translation import check_columns

if TYPE_CHECKING:
    from flint import arb

LARGEST = float(np.finfo(float).max)


class PreciseBlock(OneBlock):
    """A whole block in sixty-digit arithmetic; there is nothing to save."""

    def history_run(self) -> Run:
        """Run the scene; what a double cannot hold is infinite from there on."""
        from validation.solvers.sixty_digits import block

        check_columns(self.scene, (DISPLACEMENT, PRESSURE))
        began = time.perf_counter()
        values = block.history(self.scene, self.scene.run.columns)
        columns = {name: _doubles(column) for name, column in values.items()}
        seconds = {"setup": 0.0, "stepping": time.perf_counter() - began}
        steps = self.scene.time.steps
        instants = self.scene.time.step * np.arange(1.0, steps + 1)
        notes = ("sixty-digit arithmetic",)
        return Run(Outcome.COMPLETED, History(instants, columns), {"steps": steps}, seconds, notes)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Raise: doubles are not sixty digits."""
        raise NotReported("sixty digits are stepped only: no frequency response is reported")


def _doubles(values: list[arb]) -> Array:
    doubles: Array = np.fromiter((float(v) if abs(v) <= LARGEST else np.inf for v in values), np.float64, len(values))
    doubles[~np.logical_and.accumulate(np.isfinite(doubles))] = np.inf
    return doubles


class PreciseDDA(DDA):
    """The two-block model in sixty-digit arithmetic."""

    name = "dda-60"
    handles = frozenset()
    sources = ("validation.solvers.sixty_digits",)
    role = Role.REPEAT
    rank = 7.0
    line = None
    libraries = extras.EXACT

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or that the block is no rectangle."""
        return super().applicable(scene) if scene.block.rectangle else "the block is not an upright rectangle"

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return (DISPLACEMENT, PRESSURE)

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the block."""
        return PreciseBlock(scene, full)
