"""Rigid boxes as DDA takes them: blocks of one strain on penalty springs, at a step of DDA's habit.

A box that is alone is a block that may turn by any angle; boxes at rest on each other are a column of blocks.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

import dda
from dda.bodies.turning_block import RollingModel
from validation.models.rigid.tables import RigidSection
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene, parse_scene
from validation.solvers.columns.blocks import ContactColumn
from validation.solvers.contract import Prepared

YOUNG = 1.0e9  # Pa, of the blocks, and N/m, of their springs: p = 1E, where the scene gives no stiffness
OWN_STEP = 2.0e-3  # s: the step of the damping study that this suite began with
ROUNDING = 1e-9


class BlocksOfBoxes(Prepared):
    """Rigid boxes as blocks on springs; a row of the scene is one step of DDA or several."""

    def __init__(self, scene: Scene, rigid: RigidSection, scheme: dda.Scheme) -> None:
        self.scene = scene
        self.rigid = rigid
        self.per_row = max(1, math.ceil(scene.time.step / OWN_STEP - ROUNDING)) * 2**self.rigid.refine
        self.scheme = replace(scheme, step=scene.time.step / self.per_row)
        # A box has two corners on the ground.
        self.corner_stiffness = YOUNG if self.rigid.stiffness is None else self.rigid.stiffness / 2

    def history_run(self) -> Run:
        """Run the scene."""
        return self._alone() if len(self.rigid.box) == 1 else self._pile()

    def _alone(self) -> Run:
        """Run one box as a block that may turn by any angle."""
        box = self.rigid.box[0]
        rough = self.rigid.friction > 0
        contact = dda.Unilateral(
            self.corner_stiffness,
            shear=self.corner_stiffness if rough else 0.0,
            gap=box.lift,
            friction=self.rigid.friction_coefficient if rough else None,
        )
        outline = ((0.0, 0.0), (box.width, 0.0), (box.width, box.height), (0.0, box.height))
        model = RollingModel(
            dda.Block(outline, dda.Material(box.density, YOUNG, 0.0)),
            contact,
            dda.Load(gravity=self.rigid.gravity, slope=self.rigid.slope, motion=self._motion()),
            base=0,
            top=2,
            tilt=math.radians(box.tilt),
            velocity=box.velocity,
            spin=box.spin,
        )
        steps = self.scene.time.steps * self.per_row
        result = dda.solve_unilateral(model, self.scheme, steps, ("displacement", "horizontal_displacement"))
        x, y, angle = self.rigid.starts[0]
        columns = {
            "x_1": x + result.columns["horizontal_displacement"],
            "y_1": y + result.columns["displacement"],
            "angle_1": angle + result.angle,
            "force_1": result.normal.sum(axis=0),
        }
        work = {name: int(getattr(result, name)) for name in ("unknowns", "factorisations", "solves")}
        seconds = {"setup": result.setup_seconds, "stepping": result.stepping_seconds}
        history = History(result.time, columns)
        return self._rows(Run(Outcome(result.outcome), history, work, seconds, result.notes))

    def _motion(self) -> dda.BaseMotion | None:
        """Return the motion of the ground at the steps, None where it rests."""
        if not self.rigid.base_amplitude:
            return None
        instants = self.scheme.step * np.arange(self.scene.time.steps * self.per_row + 1)
        displacement = [(self.rigid.base(float(instant))[0], 0.0) for instant in instants]
        return dda.BaseMotion(instants, np.array(displacement))

    def _pile(self) -> Run:
        """Run several boxes as a column of blocks, whose weight acts from t = 0 on."""
        width = self.rigid.box[0].width
        centres = []
        feet = []
        foot = 0.0
        for box in self.rigid.box:
            feet.append(foot)
            centres.append(foot + box.height / 2)
            foot += box.height
        numbers = range(1, len(centres) + 1)
        column = {
            "motion": "pressure",
            "law": "unilateral",
            "gravity": self.rigid.gravity,
            "stiffness": 2 * self.corner_stiffness / width,
            "layer": [{"thickness": box.height, "density": box.density, "young": YOUNG} for box in self.rigid.box],
            "heights": [*centres, *feet],
        }
        observed = [f"displacement_{number}" for number in numbers]
        observed += [f"force_{len(centres) + number}" for number in numbers]
        time = {"step": self.scheme.step, "steps": self.scene.time.steps * self.per_row}
        data = {"name": self.scene.name, "column": column, "time": time, "run": {"columns": observed}}
        run = ContactColumn(parse_scene(data, self.scene.name), self.scheme).run()
        if run.history is None:
            return run
        still = np.zeros_like(run.history.time)
        columns = {}
        for number, (x, y, angle) in enumerate(self.rigid.starts, start=1):
            columns[f"x_{number}"] = x + still
            columns[f"y_{number}"] = y + run.history.columns[f"displacement_{number}"]
            columns[f"angle_{number}"] = angle + still
            columns[f"force_{number}"] = width * run.history.columns[f"force_{len(centres) + number}"]
        return self._rows(replace(run, history=History(run.history.time, columns)))

    def _rows(self, run: Run) -> Run:
        """Return a run at the rows of the scene, with the columns that it asks for."""
        if run.history is None:
            return run
        last_of_row = slice(self.per_row - 1, None, self.per_row)
        columns = {name: run.history.columns[name][last_of_row] for name in self.scene.run.columns}
        work = {**run.work, "steps": len(run.history.time)}
        return replace(run, history=History(run.history.time[last_of_row], columns), work=work)
