"""Adapter of the columns of `dda`: blocks on each other, welded or glued."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

import dda
from dda.column.column import Column, Layer, Spring
from dda.column.frequency import highest_frequency
from dda.column.response import column_response
from dda.column.stepping import Drive, solve_column
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, Complex
from validation.runs.run import Run
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene
from validation.solvers.columns.names import amplitude, column_of
from validation.solvers.contract import Prepared
from validation.solvers.limits import check_step
from validation.solvers.translation import naming, no_fields, to_run


class BlockColumn(Prepared):
    """A column of DDA blocks."""

    def __init__(self, scene: Scene, scheme: dda.Scheme) -> None:
        self.scene, self.scheme, self.section = scene, scheme, column_of(scene)
        c = self.section
        with naming(scene):
            layers = [Layer(x.thickness, x.density, x.young, x.poisson, x.blocks) for x in c.layer]
            springs = [Spring(joint.height, joint.stiffness) for joint in c.springs]
            self.column = Column(layers, c.motion, c.glue, springs, c.impedance)

    def run(self, fields: Path | None = None) -> Run:
        """Run the scene."""
        no_fields("dda with a column", self.scene, fields)
        check_step(self.scene, dda.spectral.critical_omega, self.highest_frequency)
        instants = self.scheme.step * np.arange(self.scene.time.steps + 1.0)
        drive = Drive(**vars(motion_at(self.scene, instants)))
        with naming(self.scene):
            found = solve_column(self.column, self.scheme, drive, self.scene.run.columns, self.section.heights)
        return to_run(self.scene, found)

    def highest_frequency(self) -> float:
        """Return the highest natural frequency [rad/s], glue, joints and springs of the base included."""
        return highest_frequency(self.column)

    def response(self, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Return the frequency response per metre at the base, or under the pressure on the top."""
        check_step(self.scene, dda.spectral.critical_omega, self.highest_frequency)
        at = self.scene.input.at
        with naming(self.scene):
            found = column_response(self.column, self.scheme, frequencies, at, (DISPLACEMENT, PRESSURE), exact)
        return {name: amplitude(self.scene) * values for name, values in found.items()}
