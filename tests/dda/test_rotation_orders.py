"""A block that turns against DOP853: the order in the time step, and the turn of a step."""

import math

import numpy as np
import pytest
from oracles.rolling import RollingBlock

from dda import Block, Load, Material, Scheme, Unilateral, solve_unilateral
from dda.bodies.turning_block import RollingModel
from dda.bodies.turning_body import Turn, turn, turned

OUTLINE = [[0, 0], [1, 0], [1.1, 1.4], [0.1, 1.6]]
MATERIAL = Material(2000.0, 3e7, 0.2)
P, SHEAR, TILT, T = 5e6, 4e6, 0.6, 0.25
MODEL = RollingModel(Block(OUTLINE, MATERIAL), Unilateral(P, SHEAR), Load(gravity=9.81), tilt=TILT)


@pytest.fixture(scope="module")
def truth():
    """Return centroid and angle at T by DOP853, of a block that is bonded at its corner M, at the origin."""
    outline = np.array([complex(*point) for point in OUTLINE])
    block = RollingBlock(outline, 2000.0, MATERIAL.elasticity(), P, SHEAR, -9.81j)
    q0 = [*(turned(TILT) @ MODEL.body.centroid), TILT, 0, 0, 0]
    return block.motion(q0, np.zeros(6), np.array([T]), [0.0, None, None, None])[-1][:3]


@pytest.mark.long
@pytest.mark.parametrize(("alpha", "delta", "order"), [(0.25, 0.5, 2.0), (0.5, 1.0, 1.0), (0.3025, 0.6, 1.0)])
def test_a_block_on_a_corner_converges_at_the_order_of_the_scheme(truth, alpha, delta, order):
    errors = []
    for n in (150, 300):
        last = solve_unilateral(MODEL, Scheme(alpha, delta, 1.0, T / n, "consistent"), n).motion
        errors.append(np.linalg.norm([*last.c[-1], last.r[-1] + TILT] - truth))
    assert abs(math.log2(errors[0] / errors[1]) - order) < 0.1  # the next order at these steps


def turned_by(Q, r):
    out = Turn(*np.zeros((3, 2, 2)))
    turn(Q, r, True, out)
    return out


def test_the_first_derivative_of_the_turn_is_its_chord_in_the_limit():
    Q = turned_by(np.eye(2), 0.7).end
    assert np.max(np.abs(Q - turned(0.7))) < 1e-15
    for r in (1e-3, -0.4, 2.0):
        made = turned_by(Q, r)
        assert np.max(np.abs(made.end - Q - r * made.chord)) < 1e-15
    assert np.max(np.abs(turned_by(Q, 1e-9).chord - [-Q[1], Q[0]])) < 1e-8
