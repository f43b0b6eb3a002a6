"""What is known of a column before a step is made, and which of its scenes raise an alarm."""

import numpy as np
import pytest

from validation.advice import columns
from validation.scenes.scene import parse_scene
from validation.solvers.registry import solve
from validation.theory.columns import lowest_frequency

RIGID = {"thickness": 10.0, "density": 2500.0, "young": "inf", "blocks": 10}


def stack(layer=RIGID, column=(), **time):
    sections = {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "gravity": 9.81, "layer": [layer]}
    data = {"column": sections | dict(column), "time": {"step": 1e-3, "steps": 10} | time}
    return parse_scene(data | {"run": {"solvers": ["dda"]}}, "stack")


def kinds(scene):
    return [alarm.kind for alarm in columns.column_alarms(scene)]


@pytest.mark.parametrize(("limit", "raised"), [(6, True), (10, True), (11, False)])
def test_too_few_solves_are_an_alarm(limit, raised):
    assert (columns.FEW_SOLVES in kinds(stack(column={"solve_limit": limit}))) == raised


@pytest.mark.parametrize(("step", "raised"), [(1e-4, True), (1e-2, False)])
def test_a_step_below_that_of_the_far_face_is_an_alarm(step, raised):
    assert (columns.FAR_FACE in kinds(stack(RIGID | {"young": 1e9}, step=step))) == raised


@pytest.mark.parametrize(
    ("time", "raised"), [({"alpha": 0.25, "delta": 0.5}, True), ({}, False), ({"delta": 0.5, "gg": 0.99}, False)]
)
def test_gain_by_switching_is_an_alarm_of_average_acceleration(time, raised):
    assert (columns.GAINS in kinds(stack(**time))) == raised


@pytest.mark.parametrize(("time", "raised"), [({}, True), ({"delta": 0.5}, False), ({"delta": 0.5, "gg": 0.9}, True)])
def test_damping_that_changes_what_slips_is_an_alarm(time, raised):
    sheared = {"motion": "shear", "law": "frictional", "strength": 1e4, "layer": [RIGID | {"velocity": 1.0}]}
    assert (kinds(stack(column=sheared, **time)) == [columns.PATH]) == raised


def test_advice_names_the_blocks_that_the_step_can_bear():
    scene = stack(RIGID | {"young": 1e9, "blocks": 5}, step=1e-4, alpha=0.25, delta=0.5)
    known = columns.limits(scene)
    (blocks,) = known.blocks
    for count, below in ((blocks, False), (blocks - 1, True)):
        finer = stack(RIGID | {"young": 1e9, "blocks": count}, step=1e-4, alpha=0.25, delta=0.5)
        assert (columns.limits(finer).far_face_step > 1e-4 * (1 + 1e-9)) == below
    assert any(f"{blocks} blocks" in sentence for sentence in columns.advised(scene, known))


STACKS = {  # blocks, w1 dt of rigid ones, velocity [m/s], gap [m], Young's modulus, a heavy block on top
    "weight, coarse": (10, 1.9, 0.0, 0.0, "inf", False),
    "weight, elastic": (4, 1.2, 0.0, 0.0, 2e9, False),
    "dropped, coarse": (8, 2.7, -1.0, 5e-4, "inf", False),
    "dropped, unequal": (3, 1.0, -0.5, 0.0, "inf", True),
    "thrown up": (3, 1.0, 2.0, 0.0, "inf", False),
}


@pytest.mark.parametrize("numbers", STACKS.values(), ids=STACKS)
def test_a_stack_comes_to_rest_when_a_long_run_of_it_does(numbers):
    blocks, angle, velocity, gap, young, heavy = numbers
    layers = [{"thickness": 1.0 * blocks, "density": 2500.0, "young": young, "blocks": blocks, "velocity": velocity}]
    if heavy:
        layers.append({"thickness": 1.0, "density": 2.5e4, "young": young, "velocity": velocity})
    middles = [number + 0.5 for number in range(blocks + heavy)]
    step = angle / lowest_frequency(1e9, 2500.0, blocks)
    scene = stack(layers[0], {"layer": layers, "gap": gap, "heights": middles}, step=step)
    resting = columns.rest(scene)
    names = [f"displacement_{number}" for number in range(1, len(middles) + 1)]
    history = solve(scene.with_values({"time.steps": 6000, "run.columns": names}), "dda").history
    moved = np.array([history.columns[name] for name in names])
    away = np.abs(moved - moved[:, -1:]).max(axis=0) > 1e-3 * resting.settlement
    assert resting.seconds == pytest.approx(history.time[np.flatnonzero(away)[-1]] + step, rel=1e-9)
    shortening = 2500.0 * 9.81 / 4 / float(young)  # of the upper half of the top block, to whose middle it moved
    assert resting.settlement == pytest.approx(shortening - moved[-1, -1] - gap * (blocks + heavy), rel=1e-6)


@pytest.mark.parametrize(
    ("column", "more"),
    [
        ({"gravity": 0.0, "layer": [RIGID | {"velocity": -1.0}]}, {}),
        ({"settled": True}, {}),
        ({"base": "free"}, {}),
        ({"solve_limit": 1}, {"step": 0.01}),
    ],
)
def test_no_rest_is_told_of_a_stack_that_its_weight_does_not_bring_there(column, more):
    assert columns.rest(stack(column=column, **more)) is None


def test_what_takes_too_long_is_not_said_to_rest(monkeypatch):
    monkeypatch.setattr(columns, "LONGEST", 10_000)
    resting = columns.rest(stack())
    assert (resting.seconds, resting.run) == (None, pytest.approx(1.0))
