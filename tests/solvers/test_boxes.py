"""Boxes on a ground as DDA takes them, against what is known of them without it."""

import math

import numpy as np
import pytest
from oracles.box_scenes import GROUND, box_scene

from validation.models.plane.boxes import boxes_of
from validation.problems.problem import ProblemHooks
from validation.runs.history import History
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver
from validation.solvers.user import base_limit

BOX = {"width": 0.8, "height": 1.5, "density": 800.0}


def test_the_ground_carries_a_box_along_that_friction_holds():
    run = get_solver("dda").solve(box_scene(BOX, friction=40.0, base=(0.001, 10.0), step=0.01, steps=5))
    assert run.outcome is Outcome.COMPLETED
    assert run.history.columns["box_1.x"][-1] == pytest.approx(0.002, rel=1e-2)  # at half a period twice the amplitude


BESIDE = {"name": "box_1", "rectangle": [1.0, 1.0], "at": [5.0, 0.5]}
ABOVE = {"name": "box_1", "sides": 4, "radius": 1.0, "at": [0.0, 4.0]}
TIP = {"name": "ground", "vertices": [[4.0, -1.0], [6.0, -1.0], [5.3, 0.0]], "fixed": True}
NO_BOXES = [  # what is changed of a box on a ground, and what is said
    ({"plane.contact.cohesion": 10.0, "plane.contact.friction": 5.0}, "friction alone"),
    ({"plane.ramp": 0.1}, "weight alone, got ramp"),
    ({"plane.block": [GROUND, BESIDE, BESIDE | {"name": "b", "at": [9.0, 0.5], "fixed": True}]}, "got 2 such blocks"),
    (
        {"plane.block": [BESIDE | {"name": "b", "at": [9, -0.5], "fixed": True}, GROUND, BESIDE]},
        "got 2 such blocks",
    ),
    ({"plane.block": [TIP, BESIDE]}, "got 1 such blocks"),
    ({"plane.block": [GROUND, ABOVE]}, "lower left corner, got box_1"),
    ({"plane.block": [GROUND, BESIDE, BESIDE | {"name": "low", "at": [9.0, 0.5]}]}, "got low below another"),
    ({"plane.block": [GROUND, BESIDE | {"young": 1e9}]}, "lower left corner, got box_1"),
]


def test_what_is_no_box_on_a_ground_is_said():
    for values, words in NO_BOXES:
        with pytest.raises(ValueError, match=words):
            boxes_of(box_scene({}).with_values(values))


def test_boxes_are_on_the_ground_that_is_stated():
    blocks = [GROUND | {"at": [7.0, -0.5]}, BESIDE, BESIDE | {"name": "box_2", "at": [5.0, 1.5]}]
    contact = {"stiffness": math.inf}
    scene = box_scene({}, slope=13.0, steps=70).with_values({"plane.block": blocks, "plane.contact": contact})
    ground = boxes_of(scene)
    assert (ground.ends, ground.friction, ground.stiffness) == ((-93.0, 107.0), 90.0, None)
    assert (ground.slope, ground.gravity) == (pytest.approx(13.0), pytest.approx(9.81))
    assert base_limit(scene) == 60.0 + 3.0 * 0.7 * 2
    assert base_limit(load_scene("figures-3-4")) == base_limit() == base_limit(load_scene("patch-strip"))


def test_the_ground_is_shaken_along_itself_by_a_cosine_alone(tmp_path):
    scene = box_scene(BOX, base=(0.013, 3.0), steps=9)
    ground = boxes_of(scene)
    assert (ground.base_amplitude, ground.base_frequency) == pytest.approx((0.013, 3.0))
    turn = 6 * math.pi * 0.07
    assert ground.base(0.07) == pytest.approx((0.013 * (1 - math.cos(turn)), 0.078 * math.pi * math.sin(turn)))
    time = np.linspace(0.0, 0.2, 41)
    cosine = 0.013 * (1 - np.cos(6 * np.pi * time))
    for name, x, y in (("up", cosine, time), ("straight", time, 0 * time)):
        path = tmp_path / f"{name}.csv"
        np.savetxt(path, np.column_stack([time, x, y]), "%.17g", ",", header="time,x,y", comments="")
        with pytest.raises(ValueError, match="another motion"):
            boxes_of(scene.with_values({"plane.block.0.motion": str(path)}))


def test_a_height_in_another_unit_is_named():
    scene = box_scene(BOX | {"lift": 0.3})
    hooks = ProblemHooks.of(scene)
    for unit, told in ((1.0, []), (1e3, ["box_1.y"]), (7.0, [])):
        history = History(np.array([0.01, 0.02]), {"box_1.y": np.array([1.05, 0.2]) * unit})
        found = list(hooks.other_units(scene, history))
        assert [column for column, _ in found] == told and all("mm" in rule for _, rule in found)


def test_a_restitution_that_springs_do_not_have_is_refused():
    assert "0.5" in get_solver("dda").refusal(box_scene({**BOX, "lift": 0.1}, restitution=0.5))
    assert get_solver("dda").refusal(box_scene({**BOX, "lift": 0.1}, restitution=1.0)) is None
