"""One joint between bars: numbers of another program, and the exact motion of `bars_events`."""

import math

import numpy as np
import pytest
from oracles import joints

from fem_reference.events.bars_events import solve
from fem_reference.events.bars_model import Bar, BarJoint, BarsProblem
from fem_reference.events.column_drive import half_sine, sine, triangle

SPRINGS = {
    (0.5, 1.0): (0.56408566368265, 0.67017217424733, 0.48236565061406),
    (0.5, 100.0): (0.62527545338902, 0.41601340538129, 0.66027528647696),
    (0.75, 1.0): (math.sqrt(0.5), math.sqrt(0.5), 0.0),  # never slips
}
STEEL = Bar(6.0, 1.0, 1.0)


@pytest.mark.parametrize(("a", "kap"), SPRINGS)
def test_a_spring_joint_that_slips_passes_reflects_and_absorbs(a: float, kap: float) -> None:
    assert joints.slipping_spring_joint(a, kap) == pytest.approx(SPRINGS[a, kap], rel=2e-12, abs=1e-7)


def passage_of(motion: object, strength_on: float) -> tuple[float, float]:
    """T and R of a bar above a half-space in the period of a sine after its first three."""
    t = np.linspace(9.0, 10.0, 1001)[:-1]
    force = motion.at(t).force[0]  # type: ignore[attr-defined]
    reflected = strength_on * np.sin(2 * np.pi * (t - 6.0)) - force
    return math.sqrt(2 * np.mean(force**2)), math.sqrt(2 * np.mean(reflected**2))


@pytest.mark.parametrize(
    ("a", "kap"),
    [(0.5, math.inf), pytest.param(0.5, 2.0, marks=pytest.mark.long), pytest.param(0.25, 10.0, marks=pytest.mark.long)],
)
def test_the_bars_pass_as_much_as_the_closed_form(a: float, kap: float) -> None:
    stiffness = kap * math.pi  # kap = 2 kj / (z w), w = 2 pi
    joint = BarJoint("frictional", stiffness, strength=a)
    motion = solve(BarsProblem((STEEL,), (joint,), base_impedance=1.0, top=sine(1.0, 1.0)), 10.0)
    expected = joints.slipping_joint(a) if math.isinf(kap) else joints.slipping_spring_joint(a, kap)
    assert passage_of(motion, 1.0) == pytest.approx(expected[:2], rel=5e-5)  # by sums over 1000 instants


def test_half_a_sine_leaves_a_slip() -> None:
    slip = joints.residual_slip(1.0, 1.0, 0.5, 1.0)
    assert slip == pytest.approx(0.43599112417692, rel=1e-13)
    joint = BarJoint("frictional", strength=0.5)
    motion = solve(BarsProblem((STEEL,), (joint,), base_impedance=1.0, top=half_sine(1.0, 1.0)), 8.0)
    assert motion.at([8.0]).slip[0, 0] == pytest.approx(-slip, rel=1e-13)
    assert joints.residual_slip(1.0, 1.0, 1.5, 1.0) == 0


def test_pieces_leave_a_free_end_with_their_trapped_momentum() -> None:
    opening, velocity = joints.spall_of_half_sine(1.0, 1.0, 1.0, 1.0, 0.25)
    assert (opening, velocity) == pytest.approx((0.75, 1.8006326323142), rel=1e-13)
    opening, velocity = joints.spall_of_triangle(1.0, 1.0, 1.0, 1.0, 0.25)
    assert (opening, velocity) == (0.5, 1.5)
    free_end = (Bar(0.25, 1.0, 1.0), Bar(2.75, 1.0, 1.0))  # the pulse from the other end
    motion = solve(BarsProblem(free_end, (None, BarJoint("unilateral")), top=triangle(1.0, 1.0)), 5.0)
    assert motion.switches[-1].time == pytest.approx(2.75 + opening, rel=1e-14)
    assert motion.at([5.0]).mean_velocity[0, 0] == pytest.approx(-velocity, rel=1e-14)
