"""Rigid boxes as DDA takes them, against what is known of them without it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from validation.runs.run import Outcome
from validation.scenes.scene import Scene, parse_scene
from validation.solvers.registry import get_solver

BOX = {"width": 0.8, "height": 1.5, "density": 800.0}
WEIGHT = 800 * 0.8 * 1.5 * 9.81  # N
AVERAGE = {"alpha": 0.25, "delta": 0.5, "start": "consistent"}


def scene_of(*boxes: dict[str, Any], seconds: float = 2.0, time: dict[str, Any] | None = None, **rigid: Any) -> Scene:
    """Return a scene of boxes; every row is 1/50 s."""
    steps = {"step": 0.02, "steps": round(seconds / 0.02)}
    return parse_scene({"name": "boxes", "rigid": {"box": list(boxes), **rigid}, "time": steps | (time or {})}, "boxes")


def columns_of(scene: Scene) -> dict[str, np.ndarray]:
    """Return the columns that DDA gives of a scene."""
    run = get_solver("dda").solve(scene.with_values({"run.columns": list(scene.rigid.columns)}))
    assert run.outcome is Outcome.COMPLETED
    return dict(run.history.columns)


def test_a_box_slides_as_far_as_friction_lets_it():
    columns = columns_of(scene_of(BOX, slope=25.0, friction=20.0))
    slope = math.radians(25)
    distance = 9.81 * math.cos(slope) * (math.tan(slope) - math.tan(math.radians(20))) * 2.0**2 / 2
    # The springs ring while the weight comes on, and friction with them: it starts by no more than a step earlier.
    step = 2e-3
    assert columns["x_1"][-1] == pytest.approx(distance, rel=2 * step / 2.0)
    assert columns["force_1"][-1] == pytest.approx(WEIGHT * math.cos(slope), rel=1e-6)


def test_a_box_that_friction_holds_rests():
    columns = columns_of(scene_of(BOX, slope=25.0, friction=26.0))
    late = columns["x_1"][50:]
    settlement = WEIGHT / 2e9
    assert abs(late[-1] - late[0]) < 1e-6 * settlement
    assert 0 < late[-1] < 20 * settlement


def test_the_rows_are_those_of_the_scene_and_the_steps_dda_s_own():
    scene = scene_of(BOX, slope=25.0, friction=26.0, refine=1, seconds=0.2)
    run = get_solver("dda").solve(scene)
    assert len(run.history.time) == scene.time.steps
    assert run.history.time[-1] == pytest.approx(0.2)
    assert run.work["steps"] == 2 * 10 * scene.time.steps  # 2 ms, halved


def test_a_box_turns_with_the_spin_and_the_velocity_it_starts_with():
    tossed = {**BOX, "lift": 5.0, "velocity": [1.5, 2.0], "spin": 3.0}
    columns = columns_of(scene_of(tossed, seconds=0.5, time=AVERAGE, restitution=1.0))
    assert columns["x_1"][-1] == pytest.approx(0.75, rel=1e-9)
    assert columns["y_1"][-1] == pytest.approx(5.75 + 2.0 * 0.5 - 9.81 * 0.125, rel=1e-9)
    # A block of one strain that spins is widened by what turns it, 1e-6 of its size, and its inertia with it.
    assert columns["angle_1"][-1] == pytest.approx(1.5, rel=1e-5)


def test_a_pile_carries_its_weight():
    boxes = [BOX, {**BOX, "density": 8000.0}, BOX]
    columns = columns_of(scene_of(*boxes))
    weights = WEIGHT * np.array([1.0, 10.0, 1.0])
    forces = [columns[f"force_{number}"][-1] for number in (1, 2, 3)]
    assert forces == pytest.approx(np.cumsum(weights[::-1])[::-1], rel=1e-6)
    # Two corner springs of 1e9 N/m below each box; the columns of blocks between them strain by some 1e-5.
    springs = sum(forces) / 2e9
    strains = sum(force * 1.5 / 0.8e9 for force in forces)
    sinking = 3.75 - columns["y_3"][-1]
    assert springs < sinking < springs + strains
    assert not columns["x_3"].any()


def test_the_ground_carries_a_box_along_that_friction_holds():
    columns = columns_of(scene_of(BOX, friction=40.0, base_amplitude=0.05, base_frequency=0.5, seconds=1.0))
    assert columns["x_1"][-1] == pytest.approx(0.1, rel=1e-3)  # at half a period twice the amplitude


@pytest.mark.parametrize(
    ("boxes", "rigid"),
    [
        ([{**BOX, "lift": 0.1}], {"restitution": 0.5}),
        ([BOX, {**BOX, "x": 0.2}], {}),
        ([BOX, {**BOX, "width": 0.5}], {}),
        ([BOX, BOX], {"slope": 5.0, "friction": 30.0}),
        ([BOX, {**BOX, "spin": 0.1}], {}),
    ],
)
def test_what_dda_has_no_blocks_for_is_refused(boxes, rigid):
    run_refusal = get_solver("dda").refusal(scene_of(*boxes, **rigid))
    assert run_refusal
