"""The Rayleigh translator: what a step hides, to leading order and exactly, and back."""

import numpy as np
import pytest

from validation.advice import rayleigh
from validation.advice.rayleigh import Rayleigh
from validation.errors import InputError
from validation.theory.stepping import Stepping

CONSTANT = Stepping(0.01, 0.5, 1.0)
MIXED = Stepping(0.002, 0.45, 0.8, 0.98)


def test_constant_acceleration_hides_the_sine_of_a_quarter_turn() -> None:
    f = np.array([5.0, 10.0, 20.0])
    assert np.allclose(100 * rayleigh.ratio(CONSTANT, f), [7.846, 15.643, 30.902], atol=5e-4)
    assert rayleigh.hidden(CONSTANT) == Rayleigh(0.0, 0.005)
    assert np.allclose(100 * Rayleigh(0.0, 0.005).ratio(f), [7.854, 15.708, 31.416], atol=5e-4)


def test_leading_order_is_what_a_small_step_hides() -> None:
    small = Stepping(1e-5, 0.45, 0.8, 1 - 1e-4)
    f = np.array([20.0, 60.0, 150.0])
    leading = rayleigh.hidden(small)
    assert (leading.a0, leading.a1) == (pytest.approx(10.0, rel=1e-4), pytest.approx(3e-6))
    assert np.allclose(rayleigh.ratio(small, f), leading.ratio(f), rtol=2 * 0.04**2)  # the next order is xi^2
    assert leading.least is not None
    f_min, xi_min = leading.least
    assert leading.ratio(f_min) == pytest.approx(xi_min, rel=1e-12)
    assert np.all(leading.ratio(f_min * np.array([0.9, 1.1])) > xi_min)


def test_a_matched_damping_has_the_ratios_of_the_step_at_both_ends() -> None:
    found = rayleigh.matched(MIXED, 2.0, 40.0)
    assert np.allclose(found.ratio([2.0, 40.0]), rayleigh.ratio(MIXED, [2.0, 40.0]), rtol=1e-12)


@pytest.mark.parametrize("keep_step", [False, True])
def test_there_and_back(keep_step: bool) -> None:
    back = rayleigh.settings(rayleigh.hidden(MIXED), Stepping(0.002 if keep_step else 9.0, 0.45, 0.8), keep_step)
    assert (back.step, back.delta, back.gg) == pytest.approx((MIXED.step, MIXED.delta, MIXED.gg), rel=1e-12)
    exact = rayleigh.ratio(MIXED, [3.0, 30.0])
    points = [(3.0, float(exact[0])), (30.0, float(exact[1]))]
    back = rayleigh.exact_settings(*points, Stepping(0.002 if keep_step else 9.0, 0.45, 0.8), keep_step)
    assert (back.step, back.delta, back.gg) == pytest.approx((MIXED.step, MIXED.delta, MIXED.gg), rel=1e-7)


@pytest.mark.parametrize("gg", [0.99, 0.9, 0.5, 0.1])
def test_the_mass_part_is_the_limit_of_small_w_dt(gg: float) -> None:
    """a0 = 2 (1 - gg) / ((1 + gg) dt): 5 % more than (1 - gg) / dt at 0.9, 33 % at 0.5."""
    stepping = Stepping(0.002, 0.5, 1.0, gg)
    w = 1e-4 / stepping.step
    limit = -stepping.squared_frequency(w).imag / w
    assert rayleigh.hidden(stepping).a0 == pytest.approx(float(limit), rel=1e-6)
    assert rayleigh.hidden(stepping).a0 * 0.002 / (1 - gg) == pytest.approx(2 / (1 + gg), rel=1e-12)
    free = -np.log(gg) / 0.002  # what a free vibration loses: the same to second order in 1 - gg
    assert rayleigh.hidden(stepping).a0 == pytest.approx(2 * np.tanh(free * 0.001) / 0.002, rel=1e-12)
    assert 0 < 1 - rayleigh.hidden(stepping).a0 / free < np.log(gg) ** 2 / 12


HIGH = [(Stepping(0.002, 0.5, 0.6), 3.4694), (Stepping(0.001, 1.0, 1.0), 2.3523), (Stepping(0.002, 1.0, 0.6), 21.512)]


@pytest.mark.parametrize(("scheme", "rise"), HIGH)
def test_a_ratio_rises_faster_than_the_frequency_beyond_the_leading_order_only(scheme: Stepping, rise: float) -> None:
    f = np.array([50.0, 100.0])
    low, high = rayleigh.ratio(scheme, f)
    assert high / low == pytest.approx(rise, rel=1e-4)
    small = Stepping(scheme.step / 100, scheme.alpha, scheme.delta)
    low, high = rayleigh.ratio(small, f)
    assert high / low == pytest.approx(2.0, rel=1e-3)
    with pytest.raises(InputError, match="negative mass part"):
        rayleigh.settings(rayleigh.matched(scheme, *f), scheme)


@pytest.mark.parametrize("keep_step", [False, True])
@pytest.mark.parametrize("scheme", [*(scheme for scheme, _ in HIGH), Stepping(0.002, 0.25, 0.5, 0.98)])
def test_ratios_that_a_scheme_has_are_found_where_none_has_them_to_leading_order(
    scheme: Stepping, keep_step: bool
) -> None:
    low, high = rayleigh.ratio(scheme, [50.0, 100.0])
    start = Stepping(scheme.step if keep_step else 9.0, scheme.alpha, scheme.delta)
    back = rayleigh.exact_settings((50.0, float(low)), (100.0, float(high)), start, keep_step)
    assert (back.step, back.delta, back.gg) == pytest.approx((scheme.step, scheme.delta, scheme.gg), rel=1e-7)


def test_ratios_of_three_digits_find_the_scheme_without_discount_that_has_them() -> None:
    """Without a discount: the edge of what can be had: half of all roundings lie beyond it."""
    scheme = Stepping(0.002, 0.5, 0.6)
    points = (50.0, 0.0354), (100.0, 0.123)
    back = rayleigh.exact_settings(*points, scheme, keep_step=True)
    assert back.gg == 1
    assert back.delta == pytest.approx(0.6, abs=1e-3)
    assert 1e-6 < rayleigh.misfit(back, *points) < rayleigh.WRITTEN
    with pytest.raises(InputError, match="no scheme with dt"):
        rayleigh.exact_settings((50.0, 0.0354), (100.0, 0.14), scheme, keep_step=True)


def test_delta_beyond_the_limit_of_alpha_raises_alpha() -> None:
    found = rayleigh.settings(Rayleigh(0.0, 0.01), Stepping(0.01, 0.5, 1.0), keep_step=True)
    assert (found.delta, found.alpha) == (1.5, 0.75)


@pytest.mark.parametrize(
    ("damping", "scheme", "rule"),
    [
        (Rayleigh(-1.0, 0.01), CONSTANT, "to leading order in w dt no scheme hides a negative mass part"),
        (Rayleigh(1.0, -0.01), CONSTANT, "to leading order in w dt no scheme hides a negative stiffness part"),
        (Rayleigh(1.0, 0.01), Stepping(0.01, 0.25, 0.5), "hides, to leading order, no a1"),
        (Rayleigh(1.0, 0.0), CONSTANT, "hides, to leading order, no a1"),
        (Rayleigh(500.0, 0.01), CONSTANT, "takes more than the whole velocity"),
    ],
)
def test_what_no_scheme_hides_to_leading_order_is_refused(damping: Rayleigh, scheme: Stepping, rule: str) -> None:
    with pytest.raises(InputError, match=rule):
        rayleigh.settings(damping, scheme)


def test_ratios_out_of_reach_and_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match="delta = 1 has these two ratios"):
        rayleigh.exact_settings((5.0, 0.005), (50.0, 0.1), CONSTANT)
    with pytest.raises(InputError, match="two frequencies must differ"):
        Rayleigh.through((5.0, 0.1), (5.0, 0.2))
    with pytest.raises(InputError, match="a ratio must be from 0 to below 1"):
        Rayleigh.through((5.0, 1.1), (6.0, 0.2))
    for texts, a0, rule in (
        (["5=0.1"], None, "given twice"),
        (["5:0.1"] * 2, None, "as in 5=0.02"),
        (["5=1"], 1.0, "exclude"),
    ):
        with pytest.raises(InputError, match=rule):
            rayleigh.points(texts, a0, None)
    with pytest.raises(InputError, match="--from, --to"):
        rayleigh.check_band(3.0, 2.0, 0.01)
