"""Sixty-digit references as ordinary solvers: `dda-60`, `bar-60` and `fem-60`.

They take the doubles of a scene as exact (`fem-60` those of the mesh's matrices) and share no step with the solvers
that they judge. Their histories are rounded to doubles at the end and cost milliseconds to seconds.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from validation.errors import InputError
from validation.runs.history import Array, Complex, History
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.bar import BAR_COLUMNS, ExactBar, NewmarkBar
from validation.solvers.contract import NotReported, Prepared, Role
from validation.solvers.dda import DDA, OneBlock
from validation.solvers.fem import FiniteElements, Mesh
from validation.solvers.translation import check_columns

if TYPE_CHECKING:
    from flint import arb

LARGEST = float(np.finfo(float).max)
MOST_UNKNOWNS = 60  # beyond it sixty digits would take minutes


def _run(scene: Scene, compute: Callable[[], dict[str, list[arb]]]) -> Run:
    """Round the columns to doubles; what a double cannot hold is infinite from there on."""
    check_columns(scene, BAR_COLUMNS)
    began = time.perf_counter()
    columns = {name: _doubles(values) for name, values in compute().items()}
    seconds = {"setup": 0.0, "stepping": time.perf_counter() - began}
    times = scene.time.step * np.arange(1.0, scene.time.steps + 1)
    work = {"steps": scene.time.steps}
    return Run(Outcome.COMPLETED, History(times, columns), work, seconds, ("sixty-digit arithmetic",))


def _doubles(values: list[arb]) -> Array:
    doubles: Array = np.fromiter((float(v) if abs(v) <= LARGEST else np.inf for v in values), np.float64, len(values))
    doubles[~np.logical_and.accumulate(np.isfinite(doubles))] = np.inf
    return doubles


class _StepsOnly(Prepared):
    """A scene that is stepped in sixty-digit arithmetic, and nothing else."""

    def response(self, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Raise: doubles are not sixty digits."""
        raise NotReported("sixty digits are stepped only: no frequency response is reported")


class PreciseBlock(_StepsOnly, OneBlock):
    """A whole block in sixty-digit arithmetic; there is nothing to save."""

    def history_run(self, fields: Path | None) -> Run:
        """Run the scene."""
        from validation.solvers.sixty_digits import block

        return _run(self.scene, lambda: block.history(self.scene, self.scene.run.columns))


class PreciseDDA(DDA):
    """The two-block model in sixty-digit arithmetic."""

    name = "dda-60"
    handles = frozenset()
    sources = ("validation.solvers.sixty_digits",)
    role = Role.REPEAT
    rank = 7.0
    line = None

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return BAR_COLUMNS

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the block."""
        return PreciseBlock(scene, full)


class PreciseNewmarkBar(_StepsOnly, NewmarkBar):
    """A bar under the Newmark scheme in sixty-digit arithmetic."""

    def history_run(self, fields: Path | None) -> Run:
        """Run the scene."""
        from validation.solvers.sixty_digits import bar

        return _run(self.scene, lambda: bar.history(self.scene, self.scene.run.columns))


class PreciseBar(ExactBar):
    """The bar under the Newmark scheme in sixty-digit arithmetic."""

    name = "bar-60"
    handles = frozenset({features.SUB_BLOCKS})
    sources = ("validation.solvers.sixty_digits",)
    role = Role.REPEAT
    rank = 9.0
    line = None

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the bar."""
        return PreciseNewmarkBar(scene, self.name)


class PreciseMesh(_StepsOnly, Mesh):
    """A mesh whose own matrices are stepped in sixty-digit arithmetic."""

    def history_run(self, fields: Path | None) -> Run:
        """Run the scene on the model with every exact saving, as `fem` does, or on the whole block."""
        from validation.solvers.sixty_digits import matrices

        model = self.model
        scene = self.scene
        if reason := _too_large(len(model.F)):
            raise InputError(reason, source=scene.name, field="fem.elements", value=f"{scene.fem.per_side} a side")
        rows = {name: model.observers[name] for name in scene.run.columns}
        return _run(scene, lambda: matrices.history(scene, model.M, model.K, model.F, rows, self.problem.load_size))


class PreciseFiniteElements(FiniteElements):
    """The mesh's own double matrices, taken as exact, in sixty-digit arithmetic."""

    name = "fem-60"
    handles = frozenset({features.SUB_BLOCKS})
    sources = ("fem_reference", "validation.solvers.sixty_digits")
    role = Role.REPEAT
    rank = 8.0
    line = None

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return BAR_COLUMNS

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why sixty digits are out of reach for the mesh."""
        return _too_large(len(PreciseMesh(scene, full=False).model.F))

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Mesh the block."""
        return PreciseMesh(scene, full)


def _too_large(unknowns: int) -> str | None:
    if unknowns <= MOST_UNKNOWNS:
        return None
    return f"{unknowns} unknowns in sixty-digit arithmetic would take minutes; at most {MOST_UNKNOWNS} are served"
