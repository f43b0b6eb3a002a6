"""Boxes on a ground as DDA takes them, against what is known of them without it."""

import pytest
from oracles.box_scenes import box_scene

from validation.runs.run import Outcome
from validation.solvers.registry import get_solver

BOX = {"width": 0.8, "height": 1.5, "density": 800.0}


def test_the_ground_carries_a_box_along_that_friction_holds():
    run = get_solver("dda").solve(box_scene(BOX, friction=40.0, base=(0.001, 10.0), step=0.01, steps=5))
    assert run.outcome is Outcome.COMPLETED
    assert run.history.columns["box_1.x"][-1] == pytest.approx(0.002, rel=1e-2)  # at half a period twice the amplitude


def test_a_restitution_that_springs_do_not_have_is_refused():
    assert "0.5" in get_solver("dda").refusal(box_scene({**BOX, "lift": 0.1}, restitution=0.5))
    assert get_solver("dda").refusal(box_scene({**BOX, "lift": 0.1}, restitution=1.0)) is None
