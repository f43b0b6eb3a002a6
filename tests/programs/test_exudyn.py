"""Exudyn's adapter: that it states a scene of boxes rightly, by what its integrator and its springs must give."""

import importlib.util
import math
import sys

import numpy as np
import pytest
from peers.exudyn import SINKS, AsItComes, Exudyn
from programs.rigid_scenes import rigid_scene

installed = pytest.mark.skipif(importlib.util.find_spec("exudyn") is None, reason="NOT RUN: Exudyn is not installed")
both = pytest.mark.parametrize("solver", [Exudyn(), AsItComes()], ids=["chosen", "default"])
SLOPE = math.radians(20.0)
DEFAULT_ZONE = 1e-3  # m/s, frictionProportionalZone of ObjectContactSphereTriangle


def zone(solver):
    """Return the slip below which friction is proportional to it [m/s]."""
    return solver.friction_zone or DEFAULT_ZONE


def sink(solver, pull):
    """Return how far a box of 1 m sinks into its contact by what presses it [m]."""
    if isinstance(solver, AsItComes):
        return SINKS * pull / 9.81
    return pull / (solver.angle / solver.own_step) ** 2


def test_a_program_that_is_absent_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "exudyn", None)
    with pytest.raises(NotImplementedError, match="is not installed: pip install"):
        Exudyn().solve(rigid_scene())


@installed
def test_its_default_step_is_that_of_its_settings():
    import exudyn

    time = exudyn.SimulationSettings().timeIntegration
    assert time.endTime / time.numberOfSteps == AsItComes.own_step


@installed
@both
def test_a_box_falls_and_spins_as_generalised_alpha_does(solver):
    """A constant acceleration, which it starts from, is integrated exactly whatever its spectral radius."""
    scene = rigid_scene({"lift": 50.0, "tilt": 30.0, "velocity": (3.0, 1.0), "spin": 9.0}, slope=20.0)
    x, height, angle = scene.rigid.starts[0]
    t = scene.time.step * np.arange(1, scene.time.steps + 1)
    columns = solver.solve(scene)
    np.testing.assert_allclose(columns["x_1"], x + 3 * t + 9.81 * math.sin(SLOPE) * t**2 / 2, atol=1e-9)
    np.testing.assert_allclose(columns["y_1"], height + t - 9.81 * math.cos(SLOPE) * t**2 / 2, atol=1e-9)
    np.testing.assert_allclose(columns["angle_1"], angle + 9 * t, atol=1e-9)
    assert not columns["force_1"].any()


@installed
@pytest.mark.parametrize(
    "solver", [Exudyn()], ids=["chosen"]
)  # as it comes it shortens steps, and then v is off by 1e-3
@pytest.mark.parametrize(("friction", "density"), [(0.0, 1000.0), (15.0, 1000.0), (15.0, 10.0)])
def test_a_box_slides_but_for_its_first_sinking_and_the_slip_at_which_friction_is_whole(solver, friction, density):
    """While it sinks by s the friction misses mu N of what it will be, m mu s'' in all: the box is mu s further.

    Below the slip v0 it is N mu v / v0, for a time of about v0 over the acceleration.
    """
    scene = rigid_scene({"density": density}, slope=20.0, friction=friction)
    pressing = 9.81 * math.cos(SLOPE)
    held = math.tan(math.radians(friction)) * pressing
    along = 9.81 * math.sin(SLOPE) - held
    columns = solver.solve(scene)
    t = scene.time.step * np.arange(1, scene.time.steps + 1)
    late = held / pressing * sink(solver, pressing) + held * zone(solver) / along * t[-1]
    np.testing.assert_allclose(columns["x_1"], along * t**2 / 2, atol=2 * late + 1e-9)
    np.testing.assert_allclose(columns["y_1"][-1], 0.5 - sink(solver, pressing), atol=0.1 * sink(solver, pressing))
    assert columns["force_1"][-1] == pytest.approx(density * pressing, rel=1e-2)


@installed
@both
def test_a_box_that_stands_creeps_at_the_slip_that_its_proportional_friction_asks_for(solver):
    """At rest friction is N tan(phi) v / v0 = N tan(slope), where it settles; to a tenth, after its first sinking."""
    scene = rigid_scene(slope=20.0, friction=25.0, steps=500)
    columns = solver.solve(scene)
    creep = (columns["x_1"][-1] - columns["x_1"][-101]) / (100 * scene.time.step)
    assert creep == pytest.approx(zone(solver) * math.tan(SLOPE) / math.tan(math.radians(25.0)), rel=0.1)


@installed
@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.5, 0.8, 1.0])
@pytest.mark.parametrize("density", [10.0, 5000.0])
def test_a_box_comes_back_at_e_times_the_speed_it_came_with(restitution, density):
    """Impact model 2 is a fit within 0.005 of e; 60 steps in an impact err by less than that."""
    box = {"velocity": (0.0, -1.0), "lift": 0.01, "density": density}
    scene = rigid_scene(box, restitution=restitution, gravity=0.0, step=0.01, steps=10)
    height = Exudyn().solve(scene)["y_1"]
    assert np.diff(height)[-1] / scene.time.step == pytest.approx(restitution, abs=0.01)


@installed
@both
def test_the_peak_force_is_that_of_a_mass_on_the_stiffness_of_the_scene(solver):
    scene = rigid_scene({"lift": 0.1}, stiffness=1e6, step=0.001, steps=300)
    weight = 9810.0
    expected = weight + math.sqrt(weight**2 + 2 * weight * 0.1 * 1e6)
    # Half a quarter of a row from the peak at most, and at 10 ms a third of a radian in a step.
    coarse = (math.sqrt(1e6 / 1000.0) * solver.own_step) ** 2 / 2
    assert solver.solve(scene)["force_1"].max() == pytest.approx(expected, rel=coarse + 1e-3)


@installed
@both
def test_a_ground_that_moves_takes_a_box_along(solver):
    scene = rigid_scene(friction=45.0, base_amplitude=0.1)
    t = scene.time.step * np.arange(1, scene.time.steps + 1)
    expected = [scene.rigid.base(time)[0] for time in t]
    slip = zone(solver) * t[-1] + sink(solver, 9.81)
    np.testing.assert_allclose(solver.solve(scene)["x_1"], expected, atol=slip)


@installed
def test_a_box_without_friction_is_not_moved_sideways():
    columns = Exudyn().solve(rigid_scene({"tilt": 20.0, "lift": 0.2}, restitution=1.0))
    np.testing.assert_allclose(columns["x_1"], 0.0, atol=1e-6)


@installed
def test_forces_of_a_pile_are_the_weights_above():
    boxes = ({}, {"density": 500.0, "width": 0.5, "x": 0.1}, {"density": 2000.0, "height": 0.3})
    columns = Exudyn().solve(rigid_scene(*boxes, friction=30.0))
    forces = [columns[f"force_{number}"][-1] for number in (1, 2, 3)]
    assert forces == pytest.approx([9.81 * 1850.0, 9.81 * 850.0, 9.81 * 600.0], rel=1e-6)
    assert columns["y_3"][-1] == pytest.approx(2.15, abs=1e-4)
