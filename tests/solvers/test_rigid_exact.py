"""The exact motions of rigid boxes: they pass their own problems, keep their energy, and refuse the rest."""

import math
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import thinned
from oracles.box_scenes import box_scene

from validation.gates.gate import Status
from validation.models.plane import exact
from validation.models.plane.problems import box_problems
from validation.problems.judge import judge
from validation.runs.run import Outcome
from validation.solvers.registry import get_solver

BOX = {"width": 0.8, "height": 0.5, "density": 700.0}
CASES = [(name, case) for name, problem in box_problems().items() for case in problem.cases]


def motion(scene):
    """Return the exact motion of a scene."""
    solver = get_solver("rigid-exact")
    assert solver.refusal(scene) is None
    history = solver.solve(scene).history
    assert history is not None
    return history


def refusal(scene):
    """Return why a scene is refused."""
    return get_solver("rigid-exact").refusal(scene) or ""


@pytest.mark.parametrize(
    ("name", "case"), thinned([pytest.param(*one, id=f"{one[0]} {one[1].label}") for one in CASES], 3)
)
def test_the_exact_motion_passes_its_problem(name, case):
    problem = box_problems()[name]
    scene = problem.scene(case)
    quantities = (case.quantities or problem.quantities)(scene)
    assert quantities
    if case.quantities is not None:
        assert refusal(scene)
        return
    for one in judge(SimpleNamespace(name=name, scene=scene, numbers=quantities), motion(scene)).criteria:
        assert one.status is Status.PASS and one.error <= 0.05 * one.allowed, one


def test_a_box_that_is_pushed_up_a_slope_stops_and_stands_or_slides_back():
    pushed = BOX | {"velocity": [-1.0, 0.0]}
    for friction, back in ((25.0, 0.0), (10.0, 1.0)):
        history = motion(box_scene(pushed, slope=20.0, friction=friction, steps=300))
        grip = math.tan(math.radians(friction)) * 9.81 * math.cos(math.radians(20))
        along = 9.81 * math.sin(math.radians(20))
        stop = 1 / (along + grip)
        moved = -stop / 2 + back * (along - grip) * (3 - stop) ** 2 / 2
        assert history.columns["box_1.x"][-1] == pytest.approx(moved, rel=1e-9)


REFUSED = tomllib.loads(Path(__file__).with_name("rigid_exact.toml").read_text(encoding="utf-8"))["refused"]


def test_other_motions_are_refused_by_name():
    for boxes, rigid, why in REFUSED:
        assert why in refusal(box_scene(*[BOX | box for box in boxes], **rigid))
    unknown = get_solver("rigid-exact").prepare(box_scene(BOX | {"lift": 1.0}))
    assert unknown.run().outcome is Outcome.NOT_APPLICABLE
    assert not refusal(box_scene(BOX, BOX, BOX, slope=28.0, friction=40.0))  # three stand to atan(0.4 / 0.75)


def test_boxes_rebound_and_slide_down_as_they_fly():
    thrown = BOX | {"lift": 0.3, "velocity": [0.4, -2.0]}
    still, slope = (motion(box_scene(thrown, gravity=g, slope=30.0, restitution=0.5)).columns for g in (0.0, 8.0))
    assert (still["box_1.y"][-1], slope["box_1.x"][-1]) == pytest.approx((0.25 + 0.85, 0.4 + 2.0))
    spring = motion(box_scene(BOX | {"lift": 0.3}, stiffness=1e6, restitution=1.0)).columns["box_1.y"]
    assert np.abs(np.diff(spring)).max() < 0.025


def test_impacts_without_end_have_a_horizon(monkeypatch):
    monkeypatch.setattr(exact, "MOST_IMPACTS", 3)
    posed = box_scene(BOX | {"tilt": 3.0, "lift": 0.1}, restitution=1.0, step=0.05, steps=40)
    run = get_solver("rigid-exact").solve(posed)
    assert run.outcome is Outcome.HORIZON and run.history is None
    last = int(run.notes[0].split()[-2])
    shorter = posed.with_values({"time.steps": last})
    assert 0 < last < 40 and get_solver("rigid-exact").solve(shorter).outcome is Outcome.COMPLETED
