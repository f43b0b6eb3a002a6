"""Boxes on a ground as DDA takes them, against what is known of them without it."""

import pytest
from oracles.box_scenes import GROUND, box_scene

from validation.models.plane.boxes import boxes_of
from validation.runs.run import Outcome
from validation.solvers.registry import get_solver

BOX = {"width": 0.8, "height": 1.5, "density": 800.0}


def test_the_ground_carries_a_box_along_that_friction_holds():
    run = get_solver("dda").solve(box_scene(BOX, friction=40.0, base=(0.001, 10.0), step=0.01, steps=5))
    assert run.outcome is Outcome.COMPLETED
    assert run.history.columns["box_1.x"][-1] == pytest.approx(0.002, rel=1e-2)  # at half a period twice the amplitude


BESIDE = {"name": "box_1", "rectangle": [1.0, 1.0], "at": [5.0, 0.5]}
ABOVE = {"name": "box_1", "sides": 4, "radius": 1.0, "at": [0.0, 4.0]}
NO_BOXES = [  # what is changed of a box on a ground, and what is said
    ({"plane.contact.cohesion": 10.0, "plane.contact.friction": 5.0}, "friction alone"),
    ({"plane.ramp": 0.1}, "weight alone, got ramp"),
    ({"plane.block": [GROUND, BESIDE, BESIDE | {"name": "b", "at": [9.0, 0.5], "fixed": True}]}, "got 2 such blocks"),
    ({"plane.block": [GROUND, ABOVE]}, "lower left corner, got box_1"),
    ({"plane.block": [GROUND, BESIDE, BESIDE | {"name": "low", "at": [9.0, 0.5]}]}, "got low below another"),
    ({"plane.block": [GROUND, BESIDE | {"young": 1e9}]}, "lower left corner, got box_1"),
]


def test_what_is_no_box_on_a_ground_is_said():
    for values, words in NO_BOXES:
        with pytest.raises(ValueError, match=words):
            boxes_of(box_scene({}).with_values(values))


def test_a_restitution_that_springs_do_not_have_is_refused():
    assert "0.5" in get_solver("dda").refusal(box_scene({**BOX, "lift": 0.1}, restitution=0.5))
    assert get_solver("dda").refusal(box_scene({**BOX, "lift": 0.1}, restitution=1.0)) is None
