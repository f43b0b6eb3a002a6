"""Drake's adapter: that it states a scene of boxes rightly, by what Drake's own integrator and contact must give."""

import math
from importlib.util import find_spec

import numpy as np
import pytest
from oracles.box_scenes import box_scene, euler
from peers.boxes import spring_step, substeps
from peers.drake import OWN_STEP, SPRING_SHARE, AsItComes, Drake, program

from validation.models.plane.boxes import boxes_of

# To look for it costs nothing; to import it takes seconds in every process that collects these tests.
installed = pytest.mark.skipif(not find_spec("pydrake"), reason="NOT RUN: Drake is not installed")
# Thousands of steps a second with the chosen settings, few as it comes.
slowly = pytest.mark.parametrize("solver", [pytest.param(Drake(), marks=pytest.mark.long), AsItComes()],
                                 ids=["chosen", "default"])  # fmt: skip
both = pytest.mark.parametrize("solver", [Drake(), AsItComes()], ids=["chosen", "default"])
SLOPE = math.radians(20.0)


@installed
def test_its_default_step_is_that_of_a_new_configuration():
    assert program().MultibodyPlantConfig().time_step == OWN_STEP


@installed
@pytest.mark.parametrize("density", [1.0, 5000.0])
def test_a_box_without_friction_slides_as_semi_implicit_euler_does_whatever_its_mass(density):
    scene = box_scene({"density": density}, slope=20.0)
    expected = euler(scene, OWN_STEP, 0.0, 9.81 * math.sin(SLOPE))
    # What is left is the tilt by which the contact gives way, a part in a hundred thousand.
    np.testing.assert_allclose(Drake().solve(scene)["box_1.x"], expected, rtol=1e-5)


@installed
def test_a_box_slides_with_coulomb_friction_to_the_order_of_the_step():
    """The friction of a step is that of the normal force of the step before: at first of none."""
    errors = []
    for refine in (0, 2):
        solver = Drake()
        solver.step = OWN_STEP / 2**refine
        scene = box_scene(slope=20.0, friction=15.0)
        acceleration = 9.81 * (math.sin(SLOPE) - math.tan(math.radians(15.0)) * math.cos(SLOPE))
        exact = acceleration / 2
        errors.append(abs(solver.solve(scene)["box_1.x"][-1] / exact - 1))
    assert errors[0] < 0.01
    assert errors[1] < 0.5 * errors[0]


@installed
@slowly
def test_a_given_stiffness_is_that_of_a_box_on_the_ground(solver):
    scene = box_scene({"width": 2.0, "height": 1.5}, stiffness=1e7)
    weight = 9.81 * 3000.0
    assert 0.75 - solver.solve(scene)["box_1.y"][-1] == pytest.approx(weight / 1e7, rel=1e-3)


@installed
@slowly
def test_no_dissipation_gives_the_speed_back_where_the_step_resolves_the_contact(solver):
    """Over half a period implicit steps of length h take away pi (k/m)^(1/2) h / 2 of the speed."""
    scene = box_scene({"velocity": (0.0, -1.0)}, restitution=1.0, stiffness=1e6, gravity=0.0, steps=20)
    frequency = math.sqrt(1e6 / 1000.0)
    finer = type(solver)()
    finer.step = OWN_STEP / (2 if solver.chosen else 16)
    own_step = min(finer.step, SPRING_SHARE * spring_step(scene)) if solver.chosen else finer.step
    height = finer.solve(scene)["box_1.y"]
    rebound = (height[-1] - height[-2]) / scene.time.step
    loss = math.pi * frequency * scene.time.step / substeps(scene, own_step) / 2
    assert 1 - rebound == pytest.approx(loss, rel=0.2)


@installed
@both
def test_a_ground_that_moves_takes_a_box_along(solver):
    scene = box_scene(friction=45.0, base=(0.1, 1.0), steps=20)
    times = scene.time.step * np.arange(1, 21)
    expected = [boxes_of(scene).base(time)[0] for time in times]
    tolerance = 2e-5 if solver.chosen else 2e-3  # as it comes the box leans on one point, and rocks
    np.testing.assert_allclose(solver.solve(scene)["box_1.x"], expected, atol=tolerance)


@installed
@both
def test_forces_of_a_pile_are_the_weights_above(solver):
    scene = box_scene({}, {"density": 500.0}, {"density": 2000.0}, friction=30.0, steps=60)
    columns = solver.solve(scene)
    forces = [columns[name][-10:].mean() for name in boxes_of(scene).force_columns]
    assert forces == pytest.approx([9.81 * 3500.0, 9.81 * 2500.0, 9.81 * 2000.0], rel=0.05)
