"""The exact motion of a layered column, as a solver."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import fem_reference
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, Complex
from validation.runs.run import Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.columns.names import OF_COLUMN, amplitude, column_of
from validation.solvers.contract import OF_SCHEMES, LineStyle, Prepared, Role, Solver
from validation.solvers.translation import to_run

STILL = 1e-9  # Hz, for a frequency of zero, at which transfer matrices divide by zero


def time_of(scene: Scene) -> fem_reference.Scheme:
    """Return the step and the discount of a scene, for what is exact in time and knows no scheme."""
    t = scene.time
    d = scene.damping
    return fem_reference.Scheme(0.25, 0.5, t.discount, t.step, "consistent", d.mass, d.stiffness)


class ExactColumn(Prepared):
    """A column exact in space and time."""

    def __init__(self, scene: Scene) -> None:
        from validation.solvers.columns.elements import ground_of

        self.scene = scene
        self.ground = ground_of(scene)
        self.scheme = time_of(scene)

    def history_run(self) -> Run:
        """Run the scene."""
        from fem_reference.exact.layers import solve_layers
        from validation.solvers.columns.elements import excitation

        steps = self.scene.time.steps
        columns = self.scene.run.columns
        heights = column_of(self.scene).heights
        result = solve_layers(self.ground, self.scheme, steps, lambda t: excitation(self.scene, t), columns, heights)
        return to_run(self.scene, result)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Return the frequency response, exact in space and time; at rest it is that of next to nothing."""
        from fem_reference.exact.layers import amplitudes
        from fem_reference.scheme.harmonic import answering

        f = np.maximum(np.atleast_1d(np.asarray(frequencies, float)), STILL)
        ((W2, _),) = answering(f, self.scheme, exact=True)
        w = 2 * np.pi * f
        names = (DISPLACEMENT, PRESSURE)
        under_base_motion, under_pressure = amplitudes(self.ground, w, names, squared=W2)
        if self.scene.input.at == "top":
            return {name: amplitude(self.scene) * under_pressure[name] for name in names}
        return {name: 1j * w * under_base_motion[name] for name in names}


class ExactLayers(Solver):
    """A layered column by transfer matrices, exact in space and time."""

    name = "layers"
    handles = features.SCHEMES | {features.COLUMN}
    only = features.COLUMN
    unread = ("column.glue", *OF_SCHEMES)
    sources: tuple[str, ...] = ("fem_reference",)
    role = Role.TRUTH
    rank = 6.5
    line = LineStyle("#999999", (), 0.7, 1)
    own_columns = OF_COLUMN

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why there is no exact motion for this scene."""
        from fem_reference.exact.layers import applicable

        return applicable(time_of(scene))

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the layers."""
        return ExactColumn(scene)
