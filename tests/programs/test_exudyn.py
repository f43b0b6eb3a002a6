"""Exudyn's adapter: that it states a scene of boxes rightly, by what its integrator and its springs must give."""

import math
from importlib.util import find_spec

import pytest
from oracles.box_scenes import box_scene
from peers.exudyn import AsItComes, Exudyn

if not find_spec("exudyn"):  # to import it takes seconds in every process that collects these tests
    pytest.skip("NOT RUN: Exudyn is not installed", allow_module_level=True)
both = pytest.mark.parametrize("solver", [Exudyn(), AsItComes()], ids=["chosen", "default"])
SLOPE = math.radians(20.0)
DEFAULT_ZONE = 1e-3  # m/s, frictionProportionalZone of ObjectContactSphereTriangle


def zone(solver):
    """Return the slip below which friction is proportional to it [m/s]."""
    return solver.friction_zone or DEFAULT_ZONE


def test_its_default_step_is_that_of_its_settings():
    import exudyn

    time = exudyn.SimulationSettings().timeIntegration
    assert time.endTime / time.numberOfSteps == AsItComes.own_step


@both
def test_a_box_that_stands_creeps_at_the_slip_that_its_proportional_friction_asks_for(solver):
    """At rest friction is N tan(phi) v / v0 = N tan(slope), where it settles; to a tenth, after its first sinking."""
    scene = box_scene(slope=20.0, friction=25.0, steps=500)
    columns = solver.solve(scene)
    creep = (columns["box_1.x"][-1] - columns["box_1.x"][-101]) / (100 * scene.time.step)
    assert creep == pytest.approx(zone(solver) * math.tan(SLOPE) / math.tan(math.radians(25.0)), rel=0.1)


@both
def test_the_peak_force_is_that_of_a_mass_on_the_stiffness_of_the_scene(solver):
    scene = box_scene({"lift": 0.1}, stiffness=1e6, step=0.001, steps=300)
    weight = 9810.0
    expected = weight + math.sqrt(weight**2 + 2 * weight * 0.1 * 1e6)
    # Half a quarter of a row from the peak at most, and at 10 ms a third of a radian in a step.
    coarse = (math.sqrt(1e6 / 1000.0) * solver.own_step) ** 2 / 2
    assert solver.solve(scene)["box_1-ground.normal"].max() == pytest.approx(expected, rel=coarse + 1e-3)
