"""Adapter of the columns of `dda`: blocks on each other, welded or glued."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

import dda
from dda.column.column import Column, Layer, Spring
from dda.column.response import column_response, highest_frequency
from dda.column.stepping import Drive, solve_column
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, Complex
from validation.runs.run import Run
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene
from validation.solvers.blocks.closed import dda_limit
from validation.solvers.columns.names import amplitude, column_of
from validation.solvers.contract import Prepared
from validation.solvers.limits import StepLimit, check_step
from validation.solvers.translation import naming, no_fields, to_run


class BlockColumn(Prepared):
    """A column of DDA blocks."""

    def __init__(self, scene: Scene, scheme: dda.Scheme) -> None:
        self.scene = scene
        self.scheme = scheme
        self.section = column_of(scene)
        section = self.section
        with naming(scene):
            layers = [
                Layer(layer.thickness, layer.density, layer.young, layer.poisson, layer.blocks)
                for layer in section.layer
            ]
            springs = [Spring(joint.height, joint.stiffness) for joint in section.springs]
            self.column = Column(layers, section.motion, section.glue, springs, section.impedance)

    def step_limit(self) -> StepLimit:
        """Return the limit of the scheme at the column's highest frequency: glue, joints and base springs included."""
        return dda_limit(lambda: highest_frequency(self.column))

    def history_run(self, fields: Path | None) -> Run:
        """Run the scene."""
        no_fields("dda with a column", self.scene, fields)
        instants = self.scheme.step * np.arange(self.scene.time.steps + 1.0)
        drive = Drive(**vars(motion_at(self.scene, instants)))
        with naming(self.scene):
            result = solve_column(self.column, self.scheme, drive, self.scene.run.columns, self.section.heights)
        return to_run(self.scene, result)

    def response(self, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Return the frequency response per metre at the base, or under the pressure on the top."""
        check_step(self.scene, self.step_limit())
        excited_end = self.scene.input.at
        with naming(self.scene):
            amplitudes = column_response(
                self.column, self.scheme, frequencies, excited_end, (DISPLACEMENT, PRESSURE), exact
            )
        return {name: amplitude(self.scene) * values for name, values in amplitudes.items()}
