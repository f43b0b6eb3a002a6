"""The Rayleigh translator: what a step hides, to leading order and exactly, and back."""

import pytest

from validation.advice import rayleigh
from validation.advice.rayleigh import Rayleigh
from validation.errors import InputError
from validation.theory.stepping import Stepping

CONSTANT = Stepping(0.01, 0.5, 1.0)


HIGH = [(Stepping(0.002, 0.5, 0.6), 3.4694), (Stepping(0.001, 1.0, 1.0), 2.3523), (Stepping(0.002, 1.0, 0.6), 21.512)]


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
