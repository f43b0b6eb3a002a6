"""Adapter of the columns of `fem_reference`: line elements."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.problem.problem import Array, Scheme
from validation.runs.history import DISPLACEMENT, PRESSURE, Complex
from validation.runs.run import Run
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene
from validation.solvers.columns.names import amplitude, column_of
from validation.solvers.contract import Prepared
from validation.solvers.limits import StepLimit, check_step
from validation.solvers.translation import naming, no_fields, to_run


def ground_of(scene: Scene) -> Ground:
    """Return the layered column of a scene; how its blocks are glued is no part of it."""
    c = column_of(scene)
    strata = tuple(Stratum(x.thickness, x.density, x.young, x.poisson) for x in c.layer)
    joints = tuple((joint.height, joint.stiffness) for joint in c.springs)
    with naming(scene):
        return Ground(strata, c.motion, joints, c.impedance)


def excitation(scene: Scene, instants: Array) -> Excitation:
    """Return the drive of a scene at some instants [s]."""
    return Excitation(**vars(motion_at(scene, instants)))


class LineColumn(Prepared):
    """A column of line elements, `fem.elements` of them for each block."""

    def __init__(self, scene: Scene, scheme: Scheme) -> None:
        self.scene = scene
        self.scheme = scheme
        self.ground = ground_of(scene)
        c = column_of(scene)
        self.elements = [layer.blocks * scene.fem.per_side for layer in c.layer]
        self.heights = c.heights

    def step_limit(self) -> StepLimit:
        """Return the limit of the scheme at the largest frequency of the elements."""
        from fem_reference.column.frequency import highest_frequency
        from fem_reference.scheme.limits import critical_omega

        degree = self.scene.fem.degree
        return StepLimit(critical_omega, lambda: highest_frequency(self.ground, self.elements, degree))

    def history_run(self, fields: Path | None) -> Run:
        """Run the scene."""
        from fem_reference.column.stepping import solve_line

        no_fields("fem with a column", self.scene, fields)
        degree = self.scene.fem.degree
        columns = self.scene.run.columns
        instants = self.scheme.step * np.arange(self.scene.time.steps + 1.0)
        drive = excitation(self.scene, instants)
        with naming(self.scene):
            result = solve_line(self.ground, self.elements, degree, self.scheme, drive, columns, self.heights)
        return to_run(self.scene, result)

    def response(self, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Return the frequency response per metre at the base, or under the pressure on the top."""
        from fem_reference.column.vibration import line_response

        degree = self.scene.fem.degree
        on_top = self.scene.input.at == "top"
        columns = (DISPLACEMENT, PRESSURE)
        check_step(self.scene, self.step_limit())

        with naming(self.scene):
            amplitudes = line_response(
                self.ground, self.elements, degree, self.scheme, frequencies, on_top, columns, exact
            )
        return {name: amplitude(self.scene) * values for name, values in amplitudes.items()}
