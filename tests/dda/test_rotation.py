"""A block that turns by any angle: invariants of its steps, small motion as its limit, named outcomes."""

import math
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest

import dda.bodies.turning_step as step
from dda import (
    Block,
    Load,
    Material,
    Scheme,
    Unilateral,
    UnilateralOptions,
    solve_unilateral,
)
from dda.bodies.turning_block import RollingModel
from dda.bodies.turning_body import FIRST_ORDER

MATERIAL = Material(2700.0, 1e9, 0.2)
QUADRILATERAL = Block([[0, 0], [2, 0], [2.5, 1], [0.3, 1.7]], MATERIAL)
FAR = Unilateral(1e9, gap=100.0)
AVERAGE, CONSTANT = (0.25, 0.5), (0.5, 1.0)
HEAVY = RollingModel(
    Block.rectangle(1.0, 2.5, MATERIAL), Unilateral(1e8, 4e7, friction=0.3), Load(gravity=9.81), tilt=0.3
)


@pytest.mark.parametrize(("alpha", "delta"), [AVERAGE, CONSTANT, pytest.param(0.3025, 0.6, marks=pytest.mark.long)])
def test_free_flight_keeps_momentum_angular_momentum_and_shape(alpha, delta):
    model, scheme = RollingModel(QUADRILATERAL, FAR), Scheme(alpha, delta, 1.0, 0.01)
    V = np.array([1.0, 2.0, 7.0, 0.3, -0.2, 0.4])  # it vibrates as it spins
    real = RollingModel.start

    def vibrating(model, scheme):
        start = real(model, scheme)
        return start._replace(p=scheme.step * (model.body.shapes.T @ model.body.M @ V))

    with patch.object(RollingModel, "start", vibrating):
        result = solve_unilateral(model, scheme, 100)
    states, M = result.motion, result.body.M
    assert states.r[-1] > 2 * math.pi
    assert np.max(np.abs(states.V @ M[:, :3] / (M[:3] @ V) - 1)) < 1e-12
    e = result.energies
    gained = np.diff(e["kinetic"] + e["strain"]) / e["kinetic"][0]
    assert np.max(gained) < 1e-13 and (delta > 0.5 or np.max(np.abs(gained)) < 1e-13)
    assert np.max(np.abs(np.linalg.det(states.Q) - 1)) < 1e-12
    assert np.ptp(e["strain"]) > 1e-5 * e["kinetic"][0]


@pytest.mark.parametrize("steps", [45])
def test_first_order_rotation_grows_the_outline_as_its_closed_form_says(steps, held):
    r = math.pi / steps
    model = RollingModel(Block.rectangle(2.0, 2.0, MATERIAL), FAR, spin=r / 0.01)
    growing = UnilateralOptions(rotation=FIRST_ORDER)
    result = solve_unilateral(model, Scheme(*CONSTANT, 1.0, 0.01), steps, options=growing)
    held("growing outline", result)
    assert result.area[-1] == pytest.approx((1 + r * r) ** steps, rel=1e-11)
    first, last = result.energies["kinetic"][[0, -1]]
    assert last / first == pytest.approx((1 + r * r) ** (2 * (steps - 1)), rel=1e-11)  # moments go with its square
    outline = result.outline[-1] - result.motion.c[-1]
    angle = math.atan2(*(outline[1] - outline[0])[::-1]) % (2 * math.pi)
    assert angle == pytest.approx(steps * math.atan(r), rel=1e-11)


def test_corners_that_were_not_thought_to_touch_are_found_by_the_step(held):
    scheme, rocking = Scheme(*CONSTANT, 1.0, 5e-3), replace(HEAVY, tilt=0.1)
    sound = solve_unilateral(rocking, scheme, 80)
    with patch.object(step, "REACH", -100.0):
        blind = solve_unilateral(rocking, scheme, 80)
    held("rocking", sound)
    assert np.max(np.abs(blind.gap - sound.gap)) < 1e-9 and np.count_nonzero(np.diff(sound.states)) > 1
