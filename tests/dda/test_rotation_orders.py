"""A block that turns against DOP853: the order in the time step, and what the order needs."""

import math
from unittest.mock import patch

import numpy as np
import pytest
from oracles.rolling import RollingBlock

import dda.rotation.step as step
from dda import Block, Load, Material, Scheme, Unilateral
from dda.rotation.body import Turn, turn, turned
from dda.rotation.solution import RollingModel, solve_rolling

OUTLINE = [[0, 0], [1, 0], [1.1, 1.4], [0.1, 1.6]]
MATERIAL = Material(2000.0, 3e7, 0.2)
P, T = 5e6, 0.25
SCHEMES = [(0.25, 0.5, 2.0), (0.5, 1.0, 1.0), (0.3025, 0.6, 1.0)]
CASES = {"glued": (0.6, 4e6), "frictionless": (0.15, 0.0)}  # tilt [rad], shear stiffness [N/m]


def truth(name):
    """Return centroid, angle and strain at T by DOP853."""
    tilt, shear = CASES[name]
    outline = np.array([complex(*point) for point in OUTLINE])
    block = RollingBlock(outline, 2000.0, MATERIAL.elasticity(), P, shear, -9.81j)
    q0 = [*place(0.0, tilt), tilt, 0, 0, 0]
    reference = [0.0 if shear else None, None, None, None]
    return block.motion(q0, np.zeros(6), np.array([T]), reference)[-1][:6]


@pytest.fixture(scope="module")
def glued():
    return truth("glued")


def model(name):
    tilt, shear = CASES[name]
    return RollingModel(Block(OUTLINE, MATERIAL), Unilateral(P, shear), Load(gravity=9.81), tilt=tilt)


def place(r, tilt):
    """Return the centroid of the tilted block, whose corner M is at the origin."""
    x, y = model("glued").body.centroid
    c, s = math.cos(tilt), math.sin(tilt)
    return c * x - s * y, s * x + c * y


def errors(name, alpha, delta, truth, steps):
    """Return the errors of centroid and angle at T."""
    found = []
    for n in steps:
        last = solve_rolling(model(name), Scheme(alpha, delta, 1.0, T / n, "consistent"), n).motion
        found.append(np.linalg.norm([*(last.c[-1] - truth[:2]), last.r[-1] + CASES[name][0] - truth[2]]))
    return np.array(found)


@pytest.mark.long
@pytest.mark.parametrize(("alpha", "delta", "order"), SCHEMES)
def test_a_block_on_a_corner_converges_at_the_order_of_the_scheme(glued, alpha, delta, order):
    found = errors("glued", alpha, delta, glued, (150, 300))
    assert abs(math.log2(found[0] / found[1]) - order) < 0.1  # the next order at these steps


def test_delta_one_needs_the_directions_of_the_chord():
    """With those of the end of the step a block gains energy as it falls over its corner."""
    scheme = Scheme(0.5, 1.0, 1.0, 4e-3)
    heavy = RollingModel(Block.rectangle(1.0, 2.5, MATERIAL), Unilateral(1e9, 1e9), Load(gravity=9.81), tilt=0.5)

    def rise():
        e = solve_rolling(heavy, scheme, 75).energies
        return np.max(np.diff(sum(e[name] for name in ("kinetic", "strain", "springs", "load"))))

    assert rise() < 1e-7
    with patch.object(step, step.late_share.__name__, lambda delta: 1.0):
        assert rise() > 1e-3


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
