"""One joint between bars: closed forms, as another program printed them, and the exact motion of `bars_events`.

Graff, Wave Motion in Elastic Solids (1975), sections 2.4 to 2.6, for the spalls; Miller, J. Appl. Mech. 44 (1977), for
the joint that slips under a sine: T^2 = (2/pi)(th - a cos th + 2 a^2 q), R^2 = (4/pi)(q/2 - 3 a cos(th)/2 + a^2 q) with
th = asin a, q = pi/2 - th of a rigid one, and their integrals of one on a spring.
"""

import math

import numpy as np
import pytest

from fem_reference.events.bars_events import solve
from fem_reference.events.bars_model import Bar, BarJoint, BarsProblem
from fem_reference.events.column_drive import half_sine, sine, triangle

STEEL = Bar(6.0, 1.0, 1.0)


def passage_of(motion: object, strength_on: float) -> tuple[float, float]:
    """T and R of a bar above a half-space in the period of a sine after its first three."""
    t = np.linspace(9.0, 10.0, 1001)[:-1]
    force = motion.at(t).force[0]  # type: ignore[attr-defined]
    reflected = strength_on * np.sin(2 * np.pi * (t - 6.0)) - force
    return math.sqrt(2 * np.mean(force**2)), math.sqrt(2 * np.mean(reflected**2))


@pytest.mark.parametrize(
    ("a", "kap", "expected"),  # strength over z v0, 2 kj/(z w), transmitted and reflected amplitudes
    [
        (0.5, math.inf, (0.6253017023452, 0.4159406891220)),
        pytest.param(0.5, 2.0, (0.5983458073885, 0.5208014249747), marks=pytest.mark.long),
        pytest.param(0.25, 10.0, (0.3325104188586, 0.6959639378461), marks=pytest.mark.long),
    ],
)
def test_the_bars_pass_as_much_as_the_closed_form(a: float, kap: float, expected: tuple[float, float]) -> None:
    stiffness = kap * math.pi  # kap = 2 kj / (z w), w = 2 pi
    joint = BarJoint("frictional", stiffness, strength=a)
    motion = solve(BarsProblem((STEEL,), (joint,), base_impedance=1.0, top=sine(1.0, 1.0)), 10.0)
    assert passage_of(motion, 1.0) == pytest.approx(expected, rel=5e-5)  # by sums over 1000 instants


def test_half_a_sine_leaves_a_slip() -> None:
    slip = 2 / math.pi * math.sqrt(3) - 2 / 3  # 2 v0/w (cos w t1 - cos w t2) - 2 s (t2 - t1)/z
    joint = BarJoint("frictional", strength=0.5)
    motion = solve(BarsProblem((STEEL,), (joint,), base_impedance=1.0, top=half_sine(1.0, 1.0)), 8.0)
    assert motion.at([8.0]).slip[0, 0] == pytest.approx(-slip, rel=1e-13)


def test_pieces_leave_a_free_end_with_their_trapped_momentum() -> None:
    opening, velocity = 0.5, 1.5  # 2 a/c and P/(rho a) 2a/c (1 - a/(c td))
    free_end = (Bar(0.25, 1.0, 1.0), Bar(2.75, 1.0, 1.0))  # the pulse from the other end
    motion = solve(BarsProblem(free_end, (None, BarJoint("unilateral")), top=triangle(1.0, 1.0)), 5.0)
    assert motion.switches[-1].time == pytest.approx(2.75 + opening, rel=1e-14)
    assert motion.at([5.0]).mean_velocity[0, 0] == pytest.approx(-velocity, rel=1e-14)
