"""LMGC90's adapter: that it states boxes rightly, by what the Moreau-Jean scheme must give, and its limits."""

import math
from importlib.util import find_spec

import numpy as np
import pytest
from oracles.box_scenes import box_scene
from peers.lmgc90 import LMGC90, AsItComes

if not find_spec("compas_lmgc90"):  # to import it takes seconds in every process that collects these tests
    pytest.skip("NOT RUN: LMGC90 is not installed", allow_module_level=True)
both = pytest.mark.parametrize("solver", [LMGC90(), AsItComes()], ids=["chosen", "default"])
SLOPE = math.radians(20.0)
TOLERANCE = 2e-4  # of its Gauss-Seidel iteration, 1.666e-4, which the wrapper sets


def test_its_defaults_are_those_of_the_solver_of_compas():
    import inspect

    from compas_lmgc90.solver import Solver

    assert inspect.signature(Solver).parameters["dt"].default == AsItComes.own_step
    assert inspect.signature(Solver).parameters["theta"].default == 0.5
    assert inspect.signature(Solver.contact_law).parameters["alert"].default == 1e-3


@both
@pytest.mark.parametrize(("gravity", "width", "height"), [(9.81, 2.0, 0.5), (1.6, 1.0, 3.0), (9.81, 1.0, 1.0)])
def test_a_box_flies_and_spins_as_the_midpoint_rule_does(solver, gravity, width, height, tmp_path, monkeypatch):
    """The step x + h (v + v') / 2 is exact of a constant force; a rotation by h w is 2 atan(h w / 2) in a step."""
    monkeypatch.chdir(tmp_path)
    box = {"velocity": (3.0, 20.0), "spin": 2.0, "width": width, "height": height}
    scene = box_scene(box, slope=20.0, gravity=gravity)
    t = scene.time.step * np.arange(1, scene.time.steps + 1)
    columns = solver.solve(scene)
    np.testing.assert_allclose(columns["box_1.x"], 3 * t + gravity * math.sin(SLOPE) * t**2 / 2, atol=1e-9)
    np.testing.assert_allclose(
        columns["box_1.y"], height / 2 + 20 * t - gravity * math.cos(SLOPE) * t**2 / 2, atol=1e-9
    )
    h = solver.own_step
    rotation = t / h * 2 * math.atan(h * 2.0 / 2)
    # The step before the first turns it by half as much, from the rate 0.
    np.testing.assert_allclose(columns["box_1.angle"], rotation, atol=(2.0 * h) ** 3)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("restitution", [0.3, 0.5, 1.0])
@pytest.mark.parametrize("density", [10.0, 5000.0])
def test_a_box_comes_back_at_e_times_the_speed_it_came_with(restitution, density, monkeypatch):
    """The law acts where the gap half a step ahead is not positive; the box starts where that is just so.

    It leaves h e v / 2 above the ground and the contact is open a step later: the impact is one of one step.
    """
    monkeypatch.setattr("peers.lmgc90.refuse", lambda rigid: None)  # landings are refused for what can follow them
    h = LMGC90.own_step
    box = {"velocity": (0.0, -2.0), "lift": 2.0 * h / 2 * (1 - 1e-6), "density": density}
    scene = box_scene(box, gravity=0.0, restitution=restitution, step=h, steps=3)
    rebound = np.diff(LMGC90().solve(scene)["box_1.y"]) / h
    np.testing.assert_allclose(rebound, 2.0 * restitution, rtol=2 * TOLERANCE)


def test_a_stiffness_of_the_scene_bears_the_weight():
    """It vibrates about the static sinking m g / k, five times in the last second."""
    columns = LMGC90().solve(box_scene(stiffness=1e6, steps=300))
    assert 0.5 - columns["box_1.y"][-100:].mean() == pytest.approx(9.81e-3, rel=2e-2)


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        (box_scene(slope=20.0, friction=15.0, steps=300), "slides by more than"),
        (box_scene({"spin": -4.0, "velocity": (2.0, 2.0)}, friction=60.0, steps=300), "turns over"),
    ],
)
def test_refuses_what_the_points_of_a_contact_do_not_follow(scene, message):
    with pytest.raises(NotImplementedError, match=message):
        LMGC90().solve(scene)
