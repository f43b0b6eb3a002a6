"""Rigid boxes by other programs: that each is asked the scene as it stands, by what its own integrator must give.

Without contact, and with contacts whose impulses follow from the step alone, the answer of a program is known exactly,
whatever its contact is good for. What its contact is good for is no matter of these tests.
"""

import importlib.util
import math
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from oracles.absent import answer_of
from oracles.box_scenes import box_scene
from peers import (
    box2d,
    bullet,
    dart,
    exudyn,
    mujoco,
    mujoco_boxes,
    pymunk,
    siconos,
    siconos_boxes,
)
from peers.boxes import SLOW_CORRECTION, substeps
from peers.spatial import Rotation

from validation.models.plane.boxes import boxes_of

DOUBLE = 1e-9
SINGLE = 3e-4  # m or rad: 400 sub-steps, each rounded by half a unit in the last place of 10 m


@dataclass(frozen=True)
class Program:
    """What is known of a program.

    Attributes
    ----------
    solver
        Class of the adapter.
    package
        What it imports, and what `importlib` calls it.
    own_step
        Its step [s]; a row has a whole number of them.
    inner
        Steps of its integrator in one of these.
    late
        1 where velocities move first and bodies by the new ones, -1 the other way round.
    rounding
        How far it may be from its formula [m, rad].
    linear_turns
        Whether it turns a direction by adding to it and scaling it to its length: by atan(w h) and not w h.
    """

    solver: type
    package: str
    own_step: float
    inner: int = 1
    late: int = 1
    rounding: float = DOUBLE
    linear_turns: bool = False

    @property
    def is_present(self):
        """Whether it can be imported; Siconos is another Python's."""
        return self.package == "siconos" or importlib.util.find_spec(self.package) is not None

    def solve(self, scene):
        """Return the columns that the program answers."""
        return answer_of(self.solver(), scene)

    def step(self, scene):
        """Return the step of its integrator in a scene [s]."""
        return scene.time.step / substeps(scene, self.own_step) / self.inner

    def turn(self, scene, spin):
        """Return by how much its integrator turns a body, a value a row [rad]."""
        step = self.step(scene)
        count = round(scene.time.step / step) * np.arange(1, scene.time.steps + 1)
        return count * (math.atan(spin * step) if self.linear_turns else spin * step)

    def way(self, scene, velocity, acceleration):
        """Return how far its integrator takes a body at constant acceleration, a value a row."""
        step = self.step(scene)
        per_row = round(scene.time.step / step)
        count = per_row * np.arange(1, scene.time.steps + 1)
        return velocity * count * step + acceleration * step**2 * count * (count + self.late) / 2


PROGRAMS = {
    "pymunk": Program(pymunk.Pymunk, "pymunk", pymunk.STEP, late=-1),
    "pymunk-default": Program(pymunk.AsItComes, "pymunk", pymunk.USUAL_STEP, late=-1),
    "box2d": Program(box2d.Box2D, "pyb2d3", box2d.STEP, inner=box2d.SUB_STEPS, rounding=SINGLE, linear_turns=True),
    "box2d-default": Program(
        box2d.AsItComes, "pyb2d3", box2d.USUAL_STEP, inner=box2d.SUB_STEPS, rounding=SINGLE, linear_turns=True
    ),
    "bullet": Program(bullet.Bullet, "pybullet", bullet.STEP),
    "bullet-default": Program(bullet.AsItComes, "pybullet", bullet.USUAL_STEP),
    "mujoco": Program(mujoco.MuJoCo, "mujoco", mujoco_boxes.STEP),
    "mujoco-default": Program(mujoco.AsItComes, "mujoco", mujoco_boxes.USUAL_STEP),
    "dart": Program(dart.Dart, "dartpy", dart.FINE_STEP),
    "dart-default": Program(dart.AsItComes, "dartpy", dart.OWN_STEP),
    "exudyn": Program(exudyn.Exudyn, "exudyn", exudyn.Exudyn.own_step, late=0),
    "exudyn-default": Program(exudyn.AsItComes, "exudyn", exudyn.AsItComes.own_step, late=0),
    "siconos": Program(siconos.Siconos, "siconos", siconos_boxes.CHOSEN_STEP, late=0),
    "siconos-default": Program(siconos.AsItComes, "siconos", siconos_boxes.DEFAULT_STEP, late=0),
}
DAMPED = "bullet-default"  # whose bodies lose 4 % of their velocity a second
WITH_RESTITUTION = [name for name in PROGRAMS if name not in ("mujoco-default", "exudyn-default")]


def without(*names):
    """Return all other programs as parameters."""
    return of(*(name for name in PROGRAMS if name not in names))


def of(*names):
    """Return programs as parameters, but those that are absent; of Siconos, a process for each scene, few are short."""
    return [
        pytest.param(PROGRAMS[name], id=name, marks=[pytest.mark.long] * name.startswith("siconos"))
        for name in names
        if PROGRAMS[name].is_present
    ]


def scene(box=None, rows=30, row=1 / 60, **values):
    """Return boxes of 1000 kg on a ground, one of 1 m by 1 m where nothing else is stated."""
    boxes = box if isinstance(box, list) else [box or {}]
    return box_scene(*boxes, step=row, steps=rows, **values)


@pytest.mark.parametrize("program", without(DAMPED))
def test_flies_as_its_integrator_does_and_turns_over_without_a_fold(program):
    """Gravity has a component along the plane; the box turns by more than a full turn."""
    box = {"lift": 6.0, "x": -1.0, "velocity": (0.3, 2.0), "tilt": 10.0, "spin": -14.0, "width": 0.6, "height": 1.4}
    posed = scene(box, slope=25.0, gravity=8.0)
    answer = program.solve(posed)
    x, y, angle = boxes_of(posed).starts[0]
    along, up = boxes_of(posed).pull
    np.testing.assert_allclose(answer["box_1.x"], x + program.way(posed, 0.3, along), rtol=0, atol=program.rounding)
    np.testing.assert_allclose(answer["box_1.y"], y + program.way(posed, 2.0, up), rtol=0, atol=program.rounding)
    expected = angle + program.turn(posed, -14.0)
    np.testing.assert_allclose(answer["box_1.angle"], expected, rtol=0, atol=10 * program.rounding)


@pytest.mark.parametrize("program", without(DAMPED))
def test_slides_down_by_what_friction_leaves_of_gravity(program):
    """The friction angle is that of the pair: a = g (sin(slope) - cos(slope) tan(phi)), to the integrator's order."""
    posed = scene(slope=30.0, friction=20.0, rows=30)
    duration = posed.time.step * posed.time.steps
    acceleration = 9.81 * (math.sin(math.radians(30)) - math.cos(math.radians(30)) * math.tan(math.radians(20)))
    band = 2 * program.own_step / duration  # twice what a first-order integrator loses or gains
    answer = program.solve(posed)
    assert answer["box_1.x"][-1] == pytest.approx(acceleration * duration**2 / 2, rel=band)


@pytest.mark.parametrize("program", of(*WITH_RESTITUTION))
@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_returns_the_asked_share_of_the_velocity_above_every_threshold(program, restitution):
    """On a corner below its centre a box does not turn, and one contact is all that there is; no gravity."""
    posed = scene({"tilt": 45.0, "lift": 0.5, "velocity": (0.0, -2.0)}, gravity=0.0, restitution=restitution)
    answer = program.solve(posed)
    velocity = (answer["box_1.y"][-1] - answer["box_1.y"][-6]) * 60 / 5
    # Overlap, at most a step of approach, is corrected by a velocity in Bullet and in MuJoCo; of the former as it comes
    # by a fifth a step, beside 8 % of damping. MuJoCo's impedance is not quite 1.
    shares = {
        bullet.Bullet: program.own_step * SLOW_CORRECTION,
        bullet.AsItComes: 0.2,
        mujoco.MuJoCo: program.own_step * SLOW_CORRECTION + 2 * (1 - mujoco_boxes.REBOUND_IMPEDANCE),
        dart.Dart: 4e-5,
        dart.AsItComes: 4e-5,
        exudyn.Exudyn: 0.005,
        siconos.AsItComes: 2e-3,
    }
    within = 2.0 * shares.get(program.solver, 0.0) + max(program.rounding, 1e-5)
    assert velocity == pytest.approx(2.0 * restitution, abs=within)


REFUSED = tomllib.loads(Path(__file__).with_name("refusals.toml").read_text(encoding="utf-8"))["boxes"]


def test_refuses_what_a_program_cannot_express_before_it_is_imported(monkeypatch):
    for program in PROGRAMS.values():
        monkeypatch.setitem(sys.modules, program.package, None)
    for name, values, words in REFUSED:
        with pytest.raises(NotImplementedError, match=words):
            PROGRAMS[name].solver().solve(scene(**values))


def test_an_angle_goes_on_beyond_half_a_turn_both_ways():
    angles = np.concatenate([np.arange(0.5, 20.0, 2.9), np.arange(20.0, -20.0, -2.9)])
    rotation = Rotation(0.5)
    followed = [rotation.follow(math.atan2(math.sin(angle), math.cos(angle))) for angle in angles]
    assert followed == pytest.approx(angles, abs=1e-9)
