"""What theory predicts of programs: how a box falls freely under the integrator that they document.

A program that falls as its own integrator does states gravity, start and time rightly: its failures at the ground are
its contact's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from validation.engine.finished import Derived, Finished
from validation.gates.gate import Gate
from validation.problems.boxes import box_problems, boxes_of
from validation.runs.row import Value

LEAD = "lead of a free fall"
FALLEN = 24  # rows: 0.4 s of the 0.45 s that the first fall of the problem lasts
PROBLEM = "bouncing"
# Of g t dt / 2, which is 0.2 mm at the smallest of these steps; positions of single precision are good to 0.1 um.
BAND = 0.01
VELOCITY_FIRST = "it updates the velocity before the position: symplectic Euler falls g t dt / 2 too far"


@dataclass(frozen=True)
class Fall:
    """How a program falls.

    Attributes
    ----------
    program
        Its name.
    lead
        How much further than the exact motion it has fallen after a time t, over g t dt / 2.
    why
        The formulas that say so.
    """

    program: str
    lead: float
    why: str


# Not among them: bullet-default, whose air slows a fall (0.04 |v| + 0.04 v^2), and what documents no integrator.
FALLS = (
    Fall("mujoco", 1.0, VELOCITY_FIRST),
    Fall("mujoco-default", 1.0, VELOCITY_FIRST),
    Fall("dart", 1.0, VELOCITY_FIRST),
    Fall("dart-default", 1.0, VELOCITY_FIRST),
    Fall("bullet", 1.0, VELOCITY_FIRST),
    Fall("box2d", 0.25, f"{VELOCITY_FIRST}, in each of four parts of a step"),
    Fall("box2d-default", 0.25, f"{VELOCITY_FIRST}, in each of four parts of a step"),
    Fall("pymunk", -1.0, "it updates the position before the velocity: it falls g t dt / 2 too little"),
    Fall("pymunk-default", -1.0, "it updates the position before the velocity: it falls g t dt / 2 too little"),
    Fall("exudyn", 0.0, "an implicit rule of second order is exact under constant acceleration"),
    Fall("exudyn-default", 0.0, "an implicit rule of second order is exact under constant acceleration"),
)


def falls_name(program: str) -> str:
    """Return the name of the derived row of a program's fall."""
    return f"{program} falls"


def derived() -> Iterator[Derived]:
    """Yield how the programs fall that are there."""
    scene = box_problems()[PROBLEM].scene().name
    for fall in FALLS:
        yield Derived(scene, falls_name(fall.program), ((scene, fall.program),), _lead(scene, fall.program))


def _lead(scene_name: str, program: str) -> Callable[[Finished], Mapping[str, Value]]:
    def compute(finished: Finished) -> Mapping[str, Value]:
        scene = box_problems()[PROBLEM].scene()
        rigid = boxes_of(scene)
        history = finished.needed_history(scene_name, program)
        steps = finished.rows[scene_name, program].work["steps"]
        step = scene.time.duration / steps
        time = float(history.time[FALLEN - 1])
        exact = rigid.starts[0][1] - rigid.gravity * time**2 / 2
        lead = exact - float(history.columns["y_1"][FALLEN - 1])
        return {LEAD: lead / (rigid.gravity * time * step / 2)}

    return compute


def gates() -> Iterator[Gate]:
    """Yield the gates on these falls."""
    scene = box_problems()[PROBLEM].scene().name
    for fall in FALLS:
        why = f"{fall.why}; band: single precision of positions"
        yield Gate(scene, (falls_name(fall.program),), LEAD, fall.lead - BAND, fall.lead + BAND, why)
