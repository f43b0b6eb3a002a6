"""Elastic bars by characteristics: numbers of another program, a grid of characteristics, balances and symmetries."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from fem_reference.events import bars_events
from fem_reference.events.bars_events import least_terms, solve
from fem_reference.events.bars_model import BONDED, Bar, BarJoint, BarsProblem
from fem_reference.events.column_drive import half_sine
from fem_reference.events.switches import LostDigitsError, TooManySwitchesError, TooMuchWorkError, Work

LETTERS = {"opens": "O", "closes": "C", "sticks": "K", "slips forwards": "+", "slips backwards": "-"}


def bar(velocity=0.0, length=1.0, density=1.0, modulus=1.0):
    return Bar(length, density, modulus, velocity)


def opens(stiffness=math.inf, gap=0.0):
    return BarJoint("unilateral", stiffness, gap)


def slips(stiffness, strength):
    return BarJoint("frictional", stiffness, strength=strength)


def names(motion):
    return [f"{switch.corner}{LETTERS[switch.kind]}" for switch in motion.switches]


def times(motion):
    return [switch.time for switch in motion.switches]


UNIT, HALF_SINE = bar(), half_sine(1.0, 1.0)
B4 = BarsProblem((bar(1.0), bar(density=2.0, modulus=8.0)), (None, opens()))
B5 = replace(B4, joints=(None, opens(10)))
B6 = BarsProblem((bar(-1.0), bar(-1.0)), (opens(10), opens(10, 0.05)), gravity=0.05)
B10 = BarsProblem((bar(length=2.75), bar(length=0.25)), (opens(), opens()), top=HALF_SINE)
LAYER = bar(length=0.25)
D2 = BarsProblem(
    (LAYER, bar(length=6.0)), (slips(math.inf, 0.5), slips(math.inf, 0.4)), base_impedance=1, top=HALF_SINE
)
# problem and end; switches; the first of their times; mean velocities at the end: waves and impulses in 30 digits,
# compared by another program with a grid of characteristics
NUMBERS = {
    "B5": (B5, 5.0, "1O", [2.0896018911888], [-0.29289614683987, 0.64644807341994]),
    "B10": (
        B10,
        10.0,
        "1C 0C 1O 0O",
        [0.25, 3, 6.5, 9],
        [0.067804223377828, 8 / math.pi * math.sin(math.pi / 4)],
    ),
    "D2": (D2, 9.0, "1- 1K", [6.1309898804345, 6.8690101195655], [-0.57652712700713]),
}


@pytest.mark.parametrize("name", NUMBERS)
def test_the_bars_move_as_another_program_computed(name):
    problem, end, order, instants, values = NUMBERS[name]
    motion = solve(problem, end)
    assert " ".join(names(motion)) == order
    assert times(motion)[: len(instants)] == pytest.approx(instants, rel=5e-14)
    state = motion.at([end])
    if name.startswith("D"):
        moved = [slip for slip in state.slip[:, 0] if slip]
        assert moved == pytest.approx(values, rel=5e-14)
    else:
        assert state.mean_velocity[:, 0] == pytest.approx(values, rel=5e-12, abs=1e-15)
    assert motion.digits == 2 * bars_events.DIGITS  # the first two computations agree
    if name == "B5":
        given = 2.0 * state.mean_velocity[1, 0]
        assert motion.impulse(1, [end, 0.0]) == pytest.approx([given, 0.0], rel=1e-13, abs=1e-15)
        assert motion.impulse(0, [end]) == [0.0]


def test_cut_bars_that_stay_bonded_move_as_one():
    whole = BarsProblem((bar(-1.0, 2.0),), (opens(10),), gravity=0.05)
    cut = BarsProblem((bar(-1.0, 0.75), bar(-1.0, 1.25)), (opens(10), BONDED), gravity=0.05)
    one, two = solve(whole, 7.0), solve(cut, 7.0)
    assert times(one) == pytest.approx(times(two), rel=1e-15) and one.switches
    assert two.at([7.0]).mean_velocity[:, 0] @ [0.375, 0.625] == pytest.approx(
        one.at([7.0]).mean_velocity[0, 0], rel=1e-14
    )
    above = two.point(1, 0.5, [1.0, 6.5]), one.point(0, 1.25, [1.0, 6.5])
    for field in ("displacement", "velocity", "stress"):
        assert getattr(above[0], field) == pytest.approx(getattr(above[1], field), rel=1e-14, abs=1e-15)


def test_bars_at_rest_under_their_weight_stay_so():
    joints = opens(1e10, 1e-3), opens(2e9, 2e-4)
    problem = BarsProblem((Bar(1.0, 2500.0, 1e9), Bar(0.7, 2200.0, 3e8)), joints, gravity=9.81, settled=True)
    motion = solve(problem, 0.002)
    upper = 2200 * 0.7 * 9.81
    whole = upper + 2500 * 9.81
    for force in motion.at([0.0, 0.0019]).force.T:
        assert force == pytest.approx([whole, upper], rel=1e-14)
    foot = -whole / 1e10 - 1e-3
    top = foot - (whole + upper) / 2e9 - upper / 2e9 - 2e-4 - upper * 0.7 / 6e8
    assert motion.point(0, 0.0, [0.0]).displacement[0] == pytest.approx(foot, rel=1e-14)
    assert motion.point(1, 0.7, [0.0, 0.0019]).displacement == pytest.approx([top, top], rel=1e-14)
    assert motion.point(1, 0.2, [0.0]).stress[0] == pytest.approx(upper * 5 / 7, rel=1e-14)


def test_a_motion_that_takes_too_much_ends_at_a_horizon(monkeypatch):
    with pytest.raises(TooManySwitchesError):
        solve(B6, 3.6, limit=2)
    with monkeypatch.context() as context:  # two computations that never agree
        context.setattr(bars_events, "PROMISED", -1.0)
        with pytest.raises(LostDigitsError) as lost:
            solve(B5, 4.0)
        assert lost.value.time == pytest.approx(2.0896018911888, rel=1e-13)
    free = Work()
    solve(B6, 2.5, work=free)
    assert free.terms > least_terms(B6, 2.5) > 0
    enough = Work(1.2 * free.terms)
    assert len(solve(B6, 2.5, work=enough).switches[0].midpoint) == 41 and enough.terms == free.terms
    reached = []
    work = Work(free.terms / 2, reached.append)
    with pytest.raises(TooMuchWorkError) as error:
        solve(B6, 2.5, work=work)
    assert 1.0 < error.value.time == reached[-1] == work.reached < 2.5
