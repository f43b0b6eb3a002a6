"""DART's adapter: that it states a scene of boxes rightly, by what DART's own integrator and impulses must give."""

import math
import sys
from importlib.util import find_spec

import numpy as np
import pytest
from peers.dart import FINE_STEP, OWN_STEP, AsItComes, Dart, World, program
from programs.rigid_scenes import euler, rigid_scene

# To look for it costs nothing; to import it takes seconds in every process that collects these tests.
installed = pytest.mark.skipif(not find_spec("dartpy"), reason="NOT RUN: DART is not installed")
both = pytest.mark.parametrize("solver", [Dart(), AsItComes()], ids=["chosen", "default"])
SLOPE = math.radians(20.0)
DEPTH = 1e-6  # m: DART lets a resting box sink by about g h^2 before its contact holds


@pytest.mark.parametrize(
    ("rigid", "field"),
    [({"stiffness": 1e6}, "stiffness"), ({"friction": 0.05}, "friction"), ({"restitution": 1e-3}, "restitution")],
)
def test_refuses_what_it_cannot_express(rigid, field):
    with pytest.raises(NotImplementedError, match=f"rigid.{field}"):
        Dart().solve(rigid_scene(**rigid))


def test_a_program_that_is_absent_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "dartpy", None)
    with pytest.raises(NotImplementedError, match="is not installed: pip install"):
        Dart().solve(rigid_scene())


@installed
def test_its_default_step_and_sleeping_are_those_of_a_new_world():
    world = program().simulation.World()
    assert world.getTimeStep() == OWN_STEP
    assert world.getDeactivationOptions().mEnabled


@installed
@both
def test_a_box_falls_and_spins_as_semi_implicit_euler_does(solver):
    scene = rigid_scene({"lift": 50.0, "tilt": 30.0, "velocity": (3.0, 1.0), "spin": 9.0}, slope=20.0)
    _, height, angle = scene.rigid.starts[0]
    columns = solver.solve(scene)
    np.testing.assert_allclose(columns["x_1"], euler(scene, solver.step, 3.0, 9.81 * math.sin(SLOPE)), atol=1e-9)
    fall = euler(scene, solver.step, 1.0, -9.81 * math.cos(SLOPE))
    np.testing.assert_allclose(columns["y_1"], height + fall, atol=1e-9)
    np.testing.assert_allclose(columns["angle_1"], angle + euler(scene, solver.step, 9.0, 0.0), atol=1e-9)


@installed
@both
@pytest.mark.parametrize("friction", [0.0, 15.0])
@pytest.mark.parametrize("density", [1.0, 5000.0])
def test_a_box_slides_as_semi_implicit_euler_does_whatever_its_mass(solver, friction, density):
    scene = rigid_scene({"density": density}, slope=20.0, friction=friction)
    columns = solver.solve(scene)
    along = 9.81 * (math.sin(SLOPE) - math.tan(math.radians(friction)) * math.cos(SLOPE))
    np.testing.assert_allclose(columns["x_1"], euler(scene, solver.step, 0.0, along), atol=DEPTH)
    np.testing.assert_allclose(columns["y_1"], 0.5, atol=9.81 * solver.step**2 + 1e-9)


@installed
@both
@pytest.mark.parametrize("restitution", [0.5, 1.0])
@pytest.mark.parametrize("speed", [0.2, 5.0])
def test_a_box_comes_back_at_e_times_the_speed_it_came_with(solver, restitution, speed):
    """It goes through the ground with v + g h; the second step reverses what gravity has made of it, v + 2 g h."""
    fall = {"velocity": (0.0, -speed), "lift": speed * solver.step / 2}
    scene = rigid_scene(fall, restitution=restitution, step=solver.step, steps=2)
    height = solver.solve(scene)["y_1"]
    rebound = (height[1] - height[0]) / solver.step
    mixing = 2e-5  # DART adds a hundred-thousandth to the diagonal of the impulses' matrix; the jump is up to 2 v
    assert rebound == pytest.approx(restitution * (speed + 2 * 9.81 * solver.step), rel=2 * mixing)


@installed
def test_a_box_below_the_bouncing_speed_of_dart_does_not_bounce():
    """DART leaves restitution away below 0.1 m/s, which nothing sets from Python."""
    scene = rigid_scene({"velocity": (0.0, -0.05)}, restitution=1.0)
    assert np.max(Dart().solve(scene)["y_1"]) < 0.5 + 1e-4


@installed
@both
def test_a_ground_that_moves_takes_a_box_along(solver):
    scene = rigid_scene(friction=45.0, base_amplitude=0.1)
    times = scene.time.step * np.arange(1, scene.time.steps + 1)
    expected = [scene.rigid.base(time)[0] for time in times]
    np.testing.assert_allclose(solver.solve(scene)["x_1"], expected, atol=DEPTH)


@installed
def test_forces_of_a_pile_are_the_weights_above():
    columns = Dart().solve(rigid_scene({}, {"density": 500.0}, {"density": 2000.0}, friction=30.0))
    forces = [columns[f"force_{number}"][-1] for number in (1, 2, 3)]
    assert forces == pytest.approx([9.81 * 3500.0, 9.81 * 2500.0, 9.81 * 2000.0], rel=1e-6)
    assert "force_1" not in AsItComes().solve(rigid_scene(steps=1))


@installed
def test_nothing_leaves_the_plane_though_nothing_holds_it_there():
    world = World(rigid_scene({}, {}, {"lift": 0.1}, friction=30.0), sleeps=False)
    for number in range(1000):
        world.advance(number * FINE_STEP, FINE_STEP)
    for body in world.bodies:
        transform = body.getWorldTransform().matrix()
        assert abs(transform[2, 3]) < DEPTH
        assert np.max(np.abs(transform[2, :2])) < DEPTH
