"""Yade (discrete elements) as a solver: rigid bodies on penalty springs, stepped by its leapfrog.

`yade_block` and `yade_column` say what a scene is to it, `yade_bodies` how it is run, and `yade_program` is the script
that the program `yade` runs, which knows nothing of scenes.
"""

import math
from dataclasses import asdict

import numpy as np

from peers.programs import ExternalProgram
from peers.yade_block import block
from peers.yade_bodies import RECIPE, Motion, run, version
from peers.yade_column import column

FINE, COARSE = 0.05, 1.6  # time step times the highest frequency: chosen, and 0.8 of the critical 2 (Yade's own factor)
LINKED = 1.0  # the same where the highest frequencies are those of hard bonds, which nothing excites, or of a lattice
REPORTED = ("displacement", "contact_pressure", "horizontal_displacement", "rotation")
MOST_STEPS = 10_000_000  # explicit steps of a run, some minutes


class Yade(ExternalProgram):
    """Yade with settings chosen for accuracy: no damping of its own, steps well below the critical one."""

    handles = frozenset(
        {
            *("off-centre load", "own weight", "unilateral contact", "friction", "slope", "large rotation", "column"),
            *("implicit contact", "energy-conserving contact"),  # rules of DDA's steps, which no other program has
        }
    )
    program = "Yade"
    recipe = RECIPE
    model = "rigid bodies on penalty springs; two of them on a bond for the strain; a column of particles"
    damping = 0.0
    fraction = FINE
    linked = LINKED
    staggered = True  # whether the velocities at t = 0 are taken half a step back, where leapfrog has them
    settings = "leapfrog without damping; step times highest frequency at most 0.05, in a column 1"

    def version(self):
        """Return the version of the program."""
        return version()

    def solve(self, scene):
        """Return the columns of a scene that Yade can report."""
        if scene.time.discount != 1:
            raise NotImplementedError("time.gg, DDA's discount of velocities, is no part of the program")
        if scene.damping.present or scene.damping.kinetic != "constant":
            raise NotImplementedError("the damping tables of the scene have no counterpart in the program")
        if not any(name in REPORTED or name.startswith("displacement_") for name in scene.run.columns):
            raise NotImplementedError(f"none of the columns {', '.join(scene.run.columns)} is reported")
        found = column(scene, self) if scene.column is not None else block(scene, self)
        return {name: values for name, values in found.items() if name in scene.run.columns}

    def cut(self, scene, model):
        """Return the number of explicit steps in a step of the scene."""
        fraction = self.fraction if len(model.bodies) < 3 else self.linked
        count = math.ceil(scene.time.step * model.highest() / fraction)
        if count * scene.time.steps > MOST_STEPS:
            raise NotImplementedError(
                f"the explicit scheme would need {count * scene.time.steps:.1e} steps, more than {MOST_STEPS:.0e}"
            )
        return count

    def move(self, scene, model, drive=None):
        """Run the program on a model."""
        request = {
            **asdict(model),
            "drive": None if drive is None else asdict(drive),
            "cut": self.cut(scene, model),
            "steps": scene.time.steps,
            "dt": scene.time.step / self.cut(scene, model),
            "damping": self.damping,
            "staggered": self.staggered,
        }
        answer = run(request)
        return Motion(**{name: np.asarray(values, float) for name, values in answer.items()})


class AsItComes(Yade):
    """Yade with its default damping of 0.2, its step at 0.8 of the critical one, as its own time stepper has it."""

    damping = 0.2
    fraction = linked = COARSE
    staggered = False
    settings = "non-viscous damping 0.2; the step of the scene, or a fraction below 0.8 of the critical one"
