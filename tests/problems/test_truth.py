"""Which exact motion a scene has: the right one, or none; a wrong one would judge programs wrongly."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from validation.errors import InputError
from validation.models.plane import problems as boxes
from validation.problems import truth
from validation.problems.problem import ASKS, problem, problem_of
from validation.problems.truth import exact, truth_of
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.solvers.registry import solve
from validation.solvers.rigid.rocking import friction_needed

ROCKING = load_scene("field-rocking")
ROCKS = "rigid rocking"


@pytest.mark.parametrize("name", [*ASKS, *boxes.box_problems()])
def test_every_problem_has_its_exact_motion(name):
    one = problem(name)
    kinds = {"column": "layers", "rocking": ROCKS}
    kinds |= dict.fromkeys(("stack", "mass-ratio"), "column-events")
    kinds |= dict.fromkeys(("spall", "cradle", "joint"), "bars-events")
    kinds |= dict.fromkeys(boxes.box_problems(), "rigid-exact")
    truth = truth_of(one.scene)
    assert (one.truth is None) == (name in boxes.box_problems())
    assert truth.name == kinds.get(name, "block-events")
    assert truth.name == "layers" or truth.name in (*one.scene.run.solvers, ROCKS)
    if name != "rocking":
        assert truth.until == one.scene.time.duration


def test_rigid_blocks_beside_elastic_bars_have_none():
    scene = load_scene("field-mass-ratio")
    light, heavy = scene.definition()["column"]["layer"]
    with pytest.raises(InputError) as caught:
        truth_of(scene.with_values({"column.layer": [light, heavy | {"young": 1e9}]}))
    assert caught.value.field == "column.layer.young"


def test_rigid_stops_of_rigid_blocks_have_none():
    with pytest.raises(InputError, match=r"column-events: .*rigid"):
        truth_of(load_scene("field-mass-ratio").with_values({"column.stiffness": "inf"}))


# Of Taylor series with thirty digits, and for the cradle of characteristics: last rows, or those at an instant [s].
KNOWN = {
    "stack": [
        ("displacement_1", 0.06, 0.01074499902223, 1e-11),
        ("displacement_3", 0.06, 0.03962539027349, 1e-11),
        ("velocity_3", 0.06, 1.030656757347, 1e-11),
        ("force_4", 0.02, 1606810.4758, 1e-9),
    ],
    "mass-ratio": [
        ("displacement_1", 0.03, -0.01331442988, 1e-9),
        ("displacement_2", 0.02, -0.01994421045988, 1e-11),
        ("force_4", 0.0105, 3993437.96, 1e-8),
    ],
}


@pytest.mark.parametrize("name", [pytest.param("stack", marks=pytest.mark.long), "mass-ratio"])
def test_columns_of_rigid_blocks_move_as_is_known(name):
    one = problem(name)
    motion = exact(one.scene, one.truth)
    for column, instant, known, digits in KNOWN[name]:
        row = round(instant / one.scene.time.step) - 1
        assert motion.columns[column][row] == pytest.approx(known, rel=digits), column


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"contact.gap": 0.1}, "gap"),
        ({"block.velocity": -1.0}, "velocity"),
        ({"contact.cohesion": 1e3}, "cohesion"),
        ({"contact.friction": 15.0}, "contact.friction.* 18.3"),
        ({"contact.stiffness": 1e8}, "springs"),
        ({"contact.shear_stiffness": 1e8}, "springs"),
        ({"block.young": 1e8}, "springs"),
        ({"load.slope": 1.0}, "slope"),
        ({"contact.band": [0.0, 1e-3]}, "bands"),
        ({"load.pressure": 1e3}, "weight"),
        ({"block.tilt": 0.0}, "by weight"),
        ({"run.columns": ["rotation", "displacement"]}, "run.columns"),
    ],
)
def test_a_block_that_turns_otherwise_has_none(values, said):
    with pytest.raises(InputError, match=said):
        problem_of(ROCKING.with_values(values))


def test_a_frictionless_corner_slides():
    definition = ROCKING.definition()
    del definition["contact"]["friction"]
    scene = type(ROCKING).model_validate(definition | {"name": "x"}).with_values({"contact.shear_stiffness": 0.0})
    with pytest.raises(InputError) as refusal:
        problem_of(scene)
    assert refusal.value.field == "contact.friction"


def test_a_scene_without_an_exact_motion_says_why():
    with pytest.raises(InputError, match=r"block-events: .*damping"):
        truth_of(load_scene("field-opening").with_values({"time.gg": 0.99}))
    with pytest.raises(InputError, match="damping"):  # the continuum's is not that of a block of one strain
        truth_of(load_scene("field-locked").with_values({"damping.stiffness": 1e-4}))


@pytest.mark.parametrize("outcome", [Outcome.NOT_RUN, Outcome.OVERFLOW, Outcome.COMPLETED])
def test_a_motion_that_was_not_computed_to_its_end_is_none(outcome, monkeypatch):
    """What a run that overflows leaves is no exact motion; a completed run without a history is none either."""
    left = None if outcome is Outcome.COMPLETED else "a history"
    run = SimpleNamespace(outcome=outcome, history=left, notes=("why",))
    monkeypatch.setattr(truth, "get_solver", lambda name: SimpleNamespace(solve=lambda scene: run))
    one = problem("locked")
    with pytest.raises(InputError) as refusal:
        exact(one.scene, one.truth)
    assert refusal.value.field == one.truth.name


@pytest.mark.parametrize("tilt", [0.5, 0.9])
def test_the_friction_that_a_corner_needs(tilt):
    """Accelerations of the rotation itself, by differences of the exact motion."""
    width, height = 2.0, 4.0
    alpha = math.atan2(width, height)
    scene = ROCKING.with_values({"block.tilt": math.degrees(tilt * alpha), "time.step": 1e-3, "time.steps": 3000})
    motion = exact(scene, truth_of(scene))
    f = alpha - (tilt * alpha + motion.columns["rotation"])
    r = math.hypot(width, height) / 2
    x, y = (np.diff(r * part, 2) / 1e-6 for part in (np.sin(f), np.cos(f)))
    measured = float(np.max(np.abs(x) / (scene.load.gravity + y)))
    assert friction_needed(width, height, tilt * alpha) == pytest.approx(measured, rel=5e-3)


@pytest.mark.parametrize("sign", [-1, pytest.param(1, marks=pytest.mark.long)])
def test_the_rotation_is_that_of_the_suites_block(sign):
    scene = ROCKING.with_values({"block.tilt": sign * ROCKING.block.tilt})
    motion = exact(scene, truth_of(scene))
    found = solve(scene, "dda").history
    rotation = found.columns["rotation"][: len(motion.time)]
    np.testing.assert_allclose(rotation, motion.columns["rotation"], atol=1e-3)
