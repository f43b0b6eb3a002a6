"""Exudyn's adapter: that it states a scene of boxes rightly, by what its integrator and its springs must give."""

import importlib.util
import math

import numpy as np
import pytest
from oracles.box_scenes import box_scene
from peers.exudyn import SINKS, AsItComes, Exudyn

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


@installed
def test_its_default_step_is_that_of_its_settings():
    import exudyn

    time = exudyn.SimulationSettings().timeIntegration
    assert time.endTime / time.numberOfSteps == AsItComes.own_step


@installed
@pytest.mark.parametrize(
    "solver", [Exudyn()], ids=["chosen"]
)  # as it comes it shortens steps, and then v is off by 1e-3
@pytest.mark.parametrize(("friction", "density"), [(0.0, 1000.0), (15.0, 1000.0), (15.0, 10.0)])
def test_a_box_slides_but_for_its_first_sinking_and_the_slip_at_which_friction_is_whole(solver, friction, density):
    """While it sinks by s the friction misses mu N of what it will be, m mu s'' in all: the box is mu s further.

    Below the slip v0 it is N mu v / v0, for a time of about v0 over the acceleration.
    """
    scene = box_scene({"density": density}, slope=20.0, friction=friction)
    pressing = 9.81 * math.cos(SLOPE)
    held = math.tan(math.radians(friction)) * pressing
    along = 9.81 * math.sin(SLOPE) - held
    columns = solver.solve(scene)
    t = scene.time.step * np.arange(1, scene.time.steps + 1)
    late = held / pressing * sink(solver, pressing) + held * zone(solver) / along * t[-1]
    np.testing.assert_allclose(columns["box_1.x"], along * t**2 / 2, atol=2 * late + 1e-9)
    np.testing.assert_allclose(columns["box_1.y"][-1], 0.5 - sink(solver, pressing), atol=0.1 * sink(solver, pressing))
    assert columns["box_1-ground.normal"][-1] == pytest.approx(density * pressing, rel=1e-2)


@installed
@both
def test_a_box_that_stands_creeps_at_the_slip_that_its_proportional_friction_asks_for(solver):
    """At rest friction is N tan(phi) v / v0 = N tan(slope), where it settles; to a tenth, after its first sinking."""
    scene = box_scene(slope=20.0, friction=25.0, steps=500)
    columns = solver.solve(scene)
    creep = (columns["box_1.x"][-1] - columns["box_1.x"][-101]) / (100 * scene.time.step)
    assert creep == pytest.approx(zone(solver) * math.tan(SLOPE) / math.tan(math.radians(25.0)), rel=0.1)


@installed
@both
def test_the_peak_force_is_that_of_a_mass_on_the_stiffness_of_the_scene(solver):
    scene = box_scene({"lift": 0.1}, stiffness=1e6, step=0.001, steps=300)
    weight = 9810.0
    expected = weight + math.sqrt(weight**2 + 2 * weight * 0.1 * 1e6)
    # Half a quarter of a row from the peak at most, and at 10 ms a third of a radian in a step.
    coarse = (math.sqrt(1e6 / 1000.0) * solver.own_step) ** 2 / 2
    assert solver.solve(scene)["box_1-ground.normal"].max() == pytest.approx(expected, rel=coarse + 1e-3)
