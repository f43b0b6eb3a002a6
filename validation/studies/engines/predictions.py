"""What theory predicts of programs: how a box falls freely under the integrator that they document.

A program that falls as its own integrator does states gravity, start and time rightly: its failures at the ground are
its contact's.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping

from validation.engine.finished import Derived, Finished
from validation.gates.gate import Gate
from validation.problems.boxes import box_problems, boxes_of
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.studies.bands import about, gate

LEAD = "lead of a free fall"
FALLEN = 24  # rows: 0.4 s of the 0.45 s that the first fall of the problem lasts
PROBLEM = "bouncing"
# Of g t dt / 2, which is 0.2 mm at the smallest of these steps; positions of single precision are good to 0.1 um.
BAND = 0.01
VELOCITY_FIRST = "it updates the velocity before the position: symplectic Euler falls g t dt / 2 too far"


IN_PARTS = f"{VELOCITY_FIRST}, in each of four parts of a step"
POSITION_FIRST = "it updates the position before the velocity: it falls g t dt / 2 too little"
SECOND_ORDER = "an implicit rule of second order is exact under constant acceleration"
# Of a program: how much further than the exact motion it has fallen after a time t, over g t dt / 2, and why.
# Not among them: bullet-default, whose air slows a fall (0.04 |v| + 0.04 v^2), and what documents no integrator.
FALLS = {
    "mujoco": (1.0, VELOCITY_FIRST),
    "mujoco-default": (1.0, VELOCITY_FIRST),
    "dart": (1.0, VELOCITY_FIRST),
    "dart-default": (1.0, VELOCITY_FIRST),
    "bullet": (1.0, VELOCITY_FIRST),
    "box2d": (0.25, IN_PARTS),
    "box2d-default": (0.25, IN_PARTS),
    "pymunk": (-1.0, POSITION_FIRST),
    "pymunk-default": (-1.0, POSITION_FIRST),
    "exudyn": (0.0, SECOND_ORDER),
    "exudyn-default": (0.0, SECOND_ORDER),
}


def falls_name(program: str) -> str:
    """Return the name of the derived row of a program's fall."""
    return f"{program} falls"


def derived() -> Iterator[Derived]:
    """Yield how the programs fall that are there."""
    scene = box_problems()[PROBLEM].scene()
    for program in FALLS:
        compute = functools.partial(lead, scene, program)
        yield Derived(scene.name, falls_name(program), ((scene.name, program),), compute)


def lead(scene: Scene, program: str, finished: Finished) -> Mapping[str, Value]:
    """Return how much further than the exact motion a program has fallen, over g t dt / 2."""
    rigid = boxes_of(scene)
    history = finished.needed_history(scene.name, program)
    step = scene.time.duration / finished.rows[scene.name, program].work["steps"]
    time = float(history.time[FALLEN - 1])
    exact = rigid.starts[0][1] - rigid.gravity * time**2 / 2
    further = exact - float(history.columns["y_1"][FALLEN - 1])
    return {LEAD: further / (rigid.gravity * time * step / 2)}


def gates() -> Iterator[Gate]:
    """Yield the gates on these falls."""
    scene = box_problems()[PROBLEM].scene()
    for program, (expected, formulas) in FALLS.items():
        why = f"{formulas}; band: single precision of positions"
        yield gate(scene, falls_name(program), LEAD, about(expected, BAND), why)
