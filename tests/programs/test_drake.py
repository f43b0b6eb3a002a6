"""Drake's adapter: that it states a scene of boxes rightly, by what Drake's own integrator and contact must give."""

import math
from importlib.util import find_spec

import pytest
from oracles.box_scenes import box_scene
from peers.boxes import spring_step, substeps
from peers.drake import OWN_STEP, SPRING_SHARE, AsItComes, Drake, program

if not find_spec("pydrake"):  # to import it takes seconds in every process that collects these tests
    pytest.skip("NOT RUN: Drake is not installed", allow_module_level=True)
# Thousands of steps a second with the chosen settings, few as it comes.
slowly = pytest.mark.parametrize("solver", [pytest.param(Drake(), marks=pytest.mark.long), AsItComes()],
                                 ids=["chosen", "default"])  # fmt: skip
SLOPE = math.radians(20.0)


def test_its_default_step_is_that_of_a_new_configuration():
    assert program().MultibodyPlantConfig().time_step == OWN_STEP


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


@slowly
def test_a_given_stiffness_is_that_of_a_box_on_the_ground(solver):
    scene = box_scene({"width": 2.0, "height": 1.5}, stiffness=1e7)
    weight = 9.81 * 3000.0
    assert 0.75 - solver.solve(scene)["box_1.y"][-1] == pytest.approx(weight / 1e7, rel=1e-3)


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
