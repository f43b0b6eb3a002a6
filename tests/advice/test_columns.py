"""What is known of a column before a step is made, and which of its scenes raise an alarm."""

import math

import numpy as np
import pytest
from conftest import thinned

from validation.advice import columns
from validation.scenes.scene import parse_scene
from validation.solvers.registry import solve
from validation.theory.columns import lowest_frequency

RIGID = {"thickness": 10.0, "density": 2500.0, "young": "inf", "blocks": 10}


def stack(layer=RIGID, column=(), **time):
    sections = {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "gravity": 9.81, "layer": [layer]}
    data = {"column": sections | dict(column), "time": {"step": 1e-3, "steps": 10} | time}
    return parse_scene(data | {"run": {"solvers": ["dda"]}}, "stack")


SLIPS = {"motion": "shear", "law": "frictional", "strength": 1e4, "layer": [RIGID | {"velocity": 1.0}]}
ELASTIC = {"layer": [RIGID | {"young": 1e9}]}


@pytest.mark.parametrize(
    ("kind", "column", "time", "raised"),
    [
        (columns.FEW_SOLVES, {"solve_limit": 10}, {}, True),
        (columns.FEW_SOLVES, {"solve_limit": 11}, {}, False),
        (columns.FAR_FACE, ELASTIC, {"step": 1e-4}, True),
        (columns.FAR_FACE, ELASTIC, {"step": 1e-2}, False),
        (columns.GAINS, {}, {"alpha": 0.25, "delta": 0.5}, True),
        (columns.GAINS, {}, {}, False),
        (columns.GAINS, {}, {"delta": 0.5, "gg": 0.99}, False),
        (columns.PATH, SLIPS, {}, True),
        (columns.PATH, SLIPS, {"delta": 0.5}, False),
        (columns.PATH, SLIPS, {"delta": 0.5, "gg": 0.9}, True),
    ],
)
def test_an_alarm_is_raised_where_it_should_be(kind, column, time, raised):
    kinds = [alarm.kind for alarm in columns.column_alarms(stack(column=column, **time))]
    assert (kind in kinds) == raised


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


@pytest.mark.parametrize("kind", thinned(STACKS, 2))
def test_a_stack_comes_to_rest_when_a_long_run_of_it_does(kind):
    blocks, angle, velocity, gap, young, heavy = STACKS[kind]
    layers = [{"thickness": 1.0 * blocks, "density": 2500.0, "young": young, "blocks": blocks, "velocity": velocity}]
    if heavy:
        layers.append({"thickness": 1.0, "density": 2.5e4, "young": young, "velocity": velocity})
    middles = [number + 0.5 for number in range(blocks + heavy)]
    step = angle / lowest_frequency(1e9, 2500.0, blocks)
    scene = stack(layers[0], {"layer": layers, "gap": gap, "heights": middles}, step=step)
    resting = columns.rest(scene)
    steps = 100 + 4 * round(resting.seconds / step)
    names = [f"displacement_{number}" for number in range(1, len(middles) + 1)]
    history = solve(scene.with_values({"time.steps": steps, "run.columns": names}), "dda").history
    moved = np.array([history.columns[name] for name in names])
    away = np.abs(moved - moved[:, -1:]).max(axis=0) > 1e-3 * resting.settlement
    assert resting.seconds == pytest.approx(history.time[np.flatnonzero(away)[-1]] + step, rel=1e-9)
    doublings = math.log2(resting.run / step / columns.FIRST_RUN)
    assert doublings == pytest.approx(round(doublings)) and resting.run > 2 * resting.seconds - 3 * step
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
    monkeypatch.setattr(columns, "LONGEST", 2_000)
    resting = columns.rest(stack())
    assert (resting.seconds, resting.run) == (None, pytest.approx(0.5))
