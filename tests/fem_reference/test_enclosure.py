"""Ball arithmetic of the exact motions: first falls that must not be missed, flows, and enclosures that hold."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from conftest import thinned
from flint import arb, arb_mat, arb_poly
from oracles.friction_oracle import slipping_problem

from fem_reference.events import block_events, block_flow, block_march
from fem_reference.events.block_events import solve
from fem_reference.events.block_flow import (
    ANGLE,
    CELLS,
    CUTS,
    EXPONENTIAL_ERROR,
    FLOAT_TERMS,
    FREQUENT,
    ROUNDING,
    SIZE,
    Flow,
)
from fem_reference.events.block_model import LEFT, OPEN, RIGHT, STICKS, BlockModel, BlockProblem, Course
from fem_reference.events.enclosure import Smooth, ball, bits_of, first_fall, is_blank, precision
from fem_reference.events.enclosure import polynomial as smooth
from fem_reference.events.switches import LostDigitsError, NoContactStateError, TooMuchWorkError

PAPER = BlockProblem(2.0, 2.0, 2700.0, 1e9, 1e9, 5e6)
ROUGH = replace(PAPER, shear_stiffness=4e8, friction=30.0, poisson=0.2, cohesion=1e3)
STATES = [(OPEN, OPEN), (STICKS, STICKS), (STICKS, OPEN), (RIGHT, LEFT), (RIGHT, RIGHT), (LEFT, STICKS), (OPEN, RIGHT)]


def polynomial(c: list[float | arb]) -> Smooth:
    return smooth([arb(x) for x in c], arb(1))


def values(function: Smooth, at: arb) -> arb:
    return function(at, arb(0)).value


def state(seed: int, size: float = 1.0) -> arb_mat:
    """A state (x, x', r, 1) of random numbers, with references of a tenth."""
    x = np.random.default_rng(seed).normal(size=12) * size
    return arb_mat(SIZE, 1, [*x.tolist(), 0.1 * size, -0.3 * size, 1.0])


@pytest.mark.parametrize("seed", thinned(range(60), 6))
def test_the_first_fall_of_a_polynomial(seed: int) -> None:
    rng = np.random.default_rng(seed)
    c = rng.normal(size=30) * 4.0 ** np.arange(30) / np.cumprod([1, *range(1, 30)])
    grid = np.linspace(0, 1, 200_001)
    values = np.polyval(c[::-1], grid)
    c[0] -= values.min() * rng.uniform(0.5, 1.1) if seed % 2 else c[0] - 1e-3
    values = np.polyval(c[::-1], grid)
    sign = 1 if c[0] > 0 else -1
    with precision(bits_of(50)):
        fall = first_fall(polynomial([float(sign * x) for x in c]), arb(1))
    below = np.flatnonzero((sign * values[1:-1] >= 0) & (sign * values[2:] < 0))
    assert (fall is None) == (len(below) == 0)
    if fall is not None:
        assert 0 <= float(fall.at) - grid[below[0] + 1] <= grid[1]
        assert not fall.grazing


def test_what_bends_down_beyond_the_middle_is_seen() -> None:
    """0.01 + y^2 - 8 y^3 with y from the middle: there it is positive, level and bends up, and yet it falls."""
    with precision(bits_of(50)):
        function = arb_poly([arb("0.01"), 0, 1, -8])(arb_poly([arb(-0.5), 1])).coeffs()
        fall = first_fall(polynomial(function), arb(1))
        assert fall is not None
        assert float(fall.at) == pytest.approx(0.5 + 0.1688, abs=1e-3)


@pytest.mark.parametrize("depth", ["1e-3", "1e-8", "1e-14", "1e-20"])
def test_a_dip_of_any_depth_is_seen_and_one_that_stays_above_is_none(depth: str) -> None:
    """(z - 1/3)^2 (1 + z^3) less or more than a depth: floats cannot tell, balls can; the root is enclosed."""
    with precision(bits_of(50)):
        third = arb(1) / 3
        square = [third * third, -2 * third, arb(1)]
        for sign in (-1, 1):
            touches: list[arb] = []
            function = polynomial([square[0] + sign * arb(depth), *square[1:], *square])
            fall = first_fall(function, arb(1), touches)
            assert (fall is not None) == (sign < 0)
            assert not touches
            if fall is not None:
                reach = 8 * fall.at.rad()  # the ball is as narrow as rounding, which hides the signs at its ends
                low, high = fall.at.mid() - reach, fall.at.mid() + reach
                assert values(function, low) > 0 > values(function, high)
                assert float(fall.at.rad()) < 1e-28
                assert fall.at < third


def test_a_touch_is_named_and_counts_as_none() -> None:
    with precision(bits_of(50)):
        third = arb(1) / 3
        touches: list[arb] = []
        touching = polynomial([third * third + ball(arb("1e-45")), -2 * third, arb(1)])
        assert first_fall(touching, arb(1), touches) is None
        assert touches
        assert all(abs(float(touch) - 1 / 3) < 1e-15 for touch in touches)


def test_a_touch_is_told_by_the_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    def grazing(_function: Smooth, end: arb, touches: list[arb]) -> None:
        touches.append(end / 2)

    monkeypatch.setattr(block_march, "first_fall", grazing)
    with precision(bits_of(50)):
        march = block_march.March(BlockModel(PAPER), Course(None), 0.0, 0.0033, 100)
        with pytest.raises(NoContactStateError):  # open corners that have gone through the base
            march.run(0.0)
    assert march.touches[0] == pytest.approx(0.0032525750597312, rel=1e-3)


def test_a_number_of_which_little_is_known_counts_as_zero() -> None:
    with precision(bits_of(50)):
        assert is_blank(arb(0))
        assert is_blank(arb("1e-60") + ball(arb("1e-61")))
        assert not is_blank(arb("1e-60"))


@pytest.mark.parametrize(("states",), thinned([(states,) for states in STATES], 3))
def test_a_flow_is_the_exponential_of_its_matrix(states: tuple[int, int]) -> None:
    """By its series, and by that of nearly this length, which is kept once frequent."""
    with precision(bits_of(50)):
        flow, z = Flow(BlockModel(ROUGH), states), state(3)
        length = ANGLE / flow.rate
        exact = (flow.G * arb(length)).exp() * z
        by_series = flow.advance(z, arb(length))
        for _ in range(FREQUENT):
            flow.advance(z, arb(length * (1 + 1e-10)))
        by_exponential = flow.advance(z, arb(length))
        for moved in (flow.series(z, arb(length)), by_series, by_exponential):
            for i in range(SIZE):
                assert moved[i, 0].overlaps(exact[i, 0])
                assert float(moved[i, 0].rad()) < 1e-40 * float(abs(exact[i, 0]) + 1)
        assert len(flow._exponentials) == 1


@pytest.mark.parametrize(("states",), thinned([(states,) for states in STATES], 3))
@pytest.mark.parametrize("kept", [False, True])
def test_floats_of_an_exponential_are_as_good_as_is_counted_on(states: tuple[int, int], kept: bool) -> None:
    with precision(bits_of(50)):
        flow, z = Flow(BlockModel(replace(ROUGH, stiffness=1e13)), states), state(3)
        units = flow.units[None, :] / flow.units[:, None]
        for angle in (0.01, 1.0, ANGLE):
            length = arb(angle / flow.rate)
            for _ in range(2 * FREQUENT if kept else 0):
                flow.advance(z, length * (1 + arb("1e-10")))
            J = flow.sensitivity(length)
            exact = np.array([float(x) for x in flow._exp(length).entries()]).reshape(SIZE, SIZE)
            assert np.abs((J - exact) * units).max() < EXPONENTIAL_ERROR / 4 * np.abs(exact * units).max()
        assert len(flow._exponentials) == (3 if kept else 0)


@pytest.mark.parametrize(("states",), thinned([(states,) for states in STATES], 3))
def test_the_coefficients_of_what_is_watched_hold_it(states: tuple[int, int]) -> None:
    with precision(bits_of(50)):
        flow, z = Flow(BlockModel(ROUGH), states), state(4, 1e-3)
        for angle in (0.003, 0.2, 6.0):
            later = (flow.G * (arb(angle) / flow.rate)).exp() * z
            for i, watched in enumerate(flow.watched):
                c = flow.coefficients(i, z, arb_mat(SIZE, 1), angle)
                value = sum((part * arb(angle) ** k for k, part in enumerate(c)), arb(0))
                assert value.overlaps((watched * later)[0, 0])
                assert float(value.rad()) < 1e-40 * max(float(abs(part).upper()) for part in c)


@pytest.mark.parametrize(("states",), thinned([(states,) for states in STATES], 3))
def test_what_a_short_series_leaves_out_is_enclosed(states: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    """With as few terms as the bound allows the rest of the series is no rounding, and must lie in the ball."""
    monkeypatch.setattr(block_flow, "term_count", lambda angle: math.ceil(2 * angle) + 3)
    with precision(bits_of(50)):
        flow, z = Flow(BlockModel(ROUGH), states), state(5, 1e-3)
        for angle in (0.3, 1.0, 5.0):
            later = (flow.G * (arb(angle) / flow.rate)).exp() * z
            moved = flow.series(z, arb(angle) / flow.rate)
            assert all(moved[i, 0].overlaps(later[i, 0]) for i in range(SIZE))
            assert max(float(moved[i, 0].rad()) for i in range(SIZE)) > 1e-12
            for i, watched in enumerate(flow.watched):
                c = flow.coefficients(i, z, arb_mat(SIZE, 1), angle)
                value = sum((part * arb(angle) ** k for k, part in enumerate(c)), arb(0))
                assert value.overlaps((watched * later)[0, 0])


@pytest.mark.parametrize(("states", "seed"), thinned([(states, i) for states in STATES for i in range(6)], 6))
def test_floats_prove_no_more_than_holds(states: tuple[int, int], seed: int) -> None:
    """As far as floats say that all functions are positive they are, and the first that is not falls soon after."""
    with precision(bits_of(50)):
        flow = Flow(BlockModel(ROUGH), states)
        length = ANGLE / flow.rate
        z = state(seed, 1e-3)
        for watched in flow.watched:
            if (watched * z)[0, 0] < 0:
                z = z * -1
        z[14, 0] = 1
        positive = all((watched * z)[0, 0] > 0 for watched in flow.watched)
        share, width, doubtful = flow.clear(z, np.zeros(SIZE), [0] * len(flow.watched), length)
        assert positive or share == 0.0
        for part in np.linspace(0.0, share, 9)[: 9 if positive else 0]:
            at = flow.advance(z, arb(part * length))
            assert all((watched * at)[0, 0] > -arb("1e-30") for watched in flow.watched)
        if doubtful and positive:
            assert width == CELLS**-CUTS
            before = flow.advance(z, arb(share * length))
            near = flow.advance(z, arb((share + 2 * width) * length))
            falls = [(flow.watched[i] * near)[0, 0] < (flow.watched[i] * before)[0, 0] for i in doubtful]
            sizes = [sum(abs(float(x)) for x in flow.leading(z, FLOAT_TERMS)[i]) for i in doubtful]
            assert any(falls)
            assert any((flow.watched[i] * near)[0, 0] < 1e-3 * size for i, size in zip(doubtful, sizes, strict=True))


def test_floats_count_on_their_rounding_and_on_what_the_state_may_be_off() -> None:
    """A block in flight, a micrometre above the springs and on its way up: clear, but not if it may be lower."""
    with precision(bits_of(50)):
        flow = Flow(BlockModel(replace(ROUGH, pressure=0.0)), (OPEN, OPEN))
        for height, off, clear in ((1e-6, 0.0, True), (1e-6, 1e-7, True), (1e-6, 1.1e-6, False), (1e-22, 0.0, False)):
            z = arb_mat(SIZE, 1, [0, height, *[0] * 5, 1, *[0] * 6, 1])
            radius = np.zeros(SIZE)
            radius[1] = off
            share, _, doubtful = flow.clear(z, radius, [0] * len(flow.watched), 1e-3)
            assert (share, doubtful) == ((1.0, []) if clear else (0.0, [0, 1]))


def test_what_floats_leave_out_is_below_their_rounding() -> None:
    assert ANGLE**FLOAT_TERMS / float(mpmath.factorial(FLOAT_TERMS)) < 1e-3 * ROUNDING


@pytest.mark.parametrize(("seed", "moved"), thinned([(i, i % 2 == 1) for i in range(60, 72)], 3))
def test_the_balls_of_the_switches_hold_those_of_more_digits(seed: int, moved: bool) -> None:
    problem = slipping_problem(seed, moved)
    end = 6 * problem.height * (problem.density / problem.young) ** 0.5
    motion, finer = solve(problem, end, digits=30), solve(problem, end, digits=60)  # of which forty are printed
    assert motion.switches
    assert motion.digits == 30
    assert finer.radius < 1e-35 * end
    with precision(bits_of(100)):
        for switch, other in zip(motion.switches, finer.switches, strict=True):
            apart = abs(arb(switch.midpoint) - arb(other.midpoint))
            assert apart < arb(switch.radius + other.radius) + abs(arb(switch.midpoint)) * arb("1e-39")  # as printed
    t = np.linspace(0, end, 50)
    one, more = motion.at(t), finer.at(t)
    assert np.all(np.abs(one.displacement - more.displacement) <= one.displacement_radius + more.displacement_radius)
    assert one.displacement_radius.max() < 1e-12 * np.abs(one.displacement).max()
    assert np.all(one.displacement_radius >= np.finfo(float).eps / 2 * np.abs(one.displacement))  # floats round it


def test_corners_that_switch_in_one_ball_are_named() -> None:
    centred = solve(PAPER, 0.05)
    assert len(centred.simultaneous) == len(centred.switches) / 2 > 3
    assert not solve(replace(ROUGH, eccentricity=0.3), 0.01).simultaneous


def test_too_much_work_stops_at_a_horizon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(block_march, "STEPS", 50)
    with pytest.raises(TooMuchWorkError, match="50 steps") as caught:
        solve(replace(PAPER, stiffness=1e18, pressure=0.0, gravity=9.81), 1e-3)
    assert 0 < caught.value.time < 5e-5


def test_a_locked_block_that_takes_too_many_steps_is_refused_before_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(block_march, "STEPS", 50)
    monkeypatch.setattr(block_march.March, "step", None)
    with pytest.raises(TooMuchWorkError, match="would be needed") as caught:
        solve(replace(PAPER, locked=True), 1.0)
    assert 0 < caught.value.time < 1.0


def test_digits_that_are_lost_are_asked_for_again_and_missed_at_last(monkeypatch: pytest.MonkeyPatch) -> None:
    stiff = replace(PAPER, stiffness=1e11)
    assert solve(stiff, 0.02, digits=30).digits == 30
    monkeypatch.setattr(block_events, "PROMISED", 1e-40)
    assert solve(stiff, 0.02, digits=30).digits > 30
    monkeypatch.setattr(block_events, "MOST_DIGITS", 30)
    with pytest.raises(LostDigitsError) as caught:
        solve(stiff, 0.02, digits=30)
    assert 0 <= caught.value.time < 0.02
