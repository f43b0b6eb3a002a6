"""Boxes on a ground as DDA takes them, against what is known of them without it."""

import math

import numpy as np
import pytest
from oracles.box_scenes import box_scene

from validation.models.plane.boxes import boxes_of
from validation.runs.run import Outcome
from validation.solvers.registry import get_solver

BOX = {"width": 0.8, "height": 1.5, "density": 800.0}
WEIGHT = 800 * 0.8 * 1.5 * 9.81  # N
AVERAGE = {"alpha": 0.25, "delta": 0.5, "start": "consistent"}


def scene_of(*boxes, seconds=2.0, **values):
    """Return a scene of boxes; every row is 1/100 s."""
    return box_scene(*boxes, step=0.01, steps=round(seconds / 0.01), **values)


def columns_of(scene):
    """Return the columns that DDA gives of a scene."""
    run = get_solver("dda").solve(scene)
    assert run.outcome is Outcome.COMPLETED
    return dict(run.history.columns)


def test_a_box_slides_as_far_as_friction_lets_it():
    columns = columns_of(scene_of(BOX, slope=25.0, friction=20.0, seconds=0.5))
    slope = math.radians(25)
    distance = 9.81 * math.cos(slope) * (math.tan(slope) - math.tan(math.radians(20))) * 0.5**2 / 2
    # The springs ring while the weight comes on, and friction with them: it starts by no more than a step earlier.
    step = 2e-3
    assert columns["box_1.x"][-1] == pytest.approx(distance, rel=2 * step / 0.5)
    assert columns["box_1-ground.normal"][-1] == pytest.approx(WEIGHT * math.cos(slope), rel=1e-6)


def test_a_box_that_friction_holds_rests_in_rows_of_the_scene_and_steps_of_dda():
    scene = scene_of(BOX, slope=25.0, friction=26.0, seconds=0.5)
    run = get_solver("dda").solve(scene)
    assert run.outcome is Outcome.COMPLETED and run.work["steps"] == 5 * scene.time.steps  # 2 ms
    assert run.history.time == pytest.approx(0.01 * np.arange(1, 51))
    late = run.history.columns["box_1.x"][30:]
    settlement = WEIGHT / 2e9
    assert abs(late[-1] - late[0]) < 1e-6 * settlement
    assert 0 < late[-1] < 20 * settlement


def test_a_box_turns_with_the_spin_and_the_velocity_it_starts_with():
    tossed = {**BOX, "lift": 5.0, "velocity": [1.5, 2.0], "spin": 3.0}
    columns = columns_of(scene_of(tossed, seconds=0.2, time=AVERAGE, restitution=1.0))
    assert columns["box_1.x"][-1] == pytest.approx(0.3, rel=1e-9)
    assert columns["box_1.y"][-1] == pytest.approx(5.75 + 2.0 * 0.2 - 9.81 * 0.02, rel=1e-9)
    assert columns["box_1.angle"][-1] == pytest.approx(0.6, rel=1e-9)


@pytest.mark.long
def test_a_pile_carries_its_weight():
    boxes = [BOX, {**BOX, "density": 8000.0}, BOX]
    scene = scene_of(*boxes, seconds=0.4)
    columns = columns_of(scene)
    weights = WEIGHT * np.array([1.0, 10.0, 1.0])
    forces = [columns[name][-1] for name in boxes_of(scene).force_columns]
    assert forces == pytest.approx(np.cumsum(weights[::-1])[::-1], rel=1e-6)
    # Two corner springs of 1e9 N/m below each box.
    assert 3.75 - columns["box_3.y"][-1] == pytest.approx(sum(forces) / 2e9, rel=1e-5)
    assert np.max(np.abs(columns["box_3.x"])) < 1e-12


def test_the_ground_carries_a_box_along_that_friction_holds():
    columns = columns_of(scene_of(BOX, friction=40.0, base=(0.001, 10.0), seconds=0.05))
    assert columns["box_1.x"][-1] == pytest.approx(0.002, rel=1e-2)  # at half a period twice the amplitude


def test_a_restitution_that_springs_do_not_have_is_refused():
    assert "0.5" in get_solver("dda").refusal(scene_of({**BOX, "lift": 0.1}, restitution=0.5))
    assert get_solver("dda").refusal(scene_of({**BOX, "lift": 0.1}, restitution=1.0)) is None
