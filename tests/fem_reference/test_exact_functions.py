"""Exponentials times polynomials on balls, and the search for their first crossing, which must miss none."""

import numpy as np
import pytest
from conftest import thinned
from flint import arb, arb_poly

from fem_reference.events.enclosure import bits_of, precision
from fem_reference.events.exponential import Exponential


def first_fall(values: np.ndarray, grid: np.ndarray) -> float | None:
    """Left end of the first cell in which sampled values fall below zero."""
    below = np.flatnonzero((values[:-1] >= 0) & (values[1:] < 0))
    return float(grid[below[0]]) if len(below) else None


@pytest.mark.parametrize("seed", thinned(range(40), 10))
def test_the_first_fall_of_an_exponential(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    kappa, count = rng.uniform(0.3, 30), rng.integers(1, 9)
    P = rng.normal(size=2) * 0.05
    Q = rng.normal(size=count) * kappa ** np.arange(count)
    P[0] += max(0.0, -(P[0] + Q[0])) + 1e-3 * rng.integers(2)
    grid = np.linspace(0, 2, 400_001)
    values = np.polyval(P[::-1], grid) + np.exp(-kappa * grid) * np.polyval(Q[::-1], grid)
    with precision(bits_of(60)):
        function = Exponential(arb(kappa), arb_poly(P.tolist()), arb_poly(Q.tolist()))
        sign = function.first_sign()
        found = (function * sign).first_fall(arb(2))
    expected = first_fall(sign * values[1:], grid[1:])
    assert (found is None) == (expected is None)
    if found is not None and expected is not None:
        assert 0 <= float(found.at) - expected <= grid[1]


def test_the_calculus_of_an_exponential() -> None:
    with precision(bits_of(60)):
        f = Exponential(arb("1.7"), arb_poly([2, -3]), arb_poly([arb(1), arb(4), arb("-0.5")]))
        start, s, h, zero = arb("0.3"), arb("0.8"), arb("1e-15"), arb(0)
        assert abs((f(s + h) - f(s - h)) / (2 * h) - f.derivative()(s)) < arb("1e-27")
        integral, relaxed = f.integral(start), f.relaxed(start)
        for one, other in (
            (f.shifted(s)(start), f(s + start)),
            (integral(zero), start),
            (relaxed(zero), start),
            (integral.derivative()(s), f(s)),
            (relaxed.derivative()(s) + f.kappa * relaxed(s), f(s)),
        ):
            assert one.overlaps(other)
            assert abs(one - other) < arb("1e-55")


def test_what_rounding_leaves_of_terms_that_cancel_is_zero() -> None:
    with precision(bits_of(60)):
        noise = arb(1) / 3 * 3 - 1
        f = Exponential(arb(200), arb_poly([noise, noise]), arb_poly([arb("1e-82"), noise, arb("1e-81")]))
        clean = f.without_noise(arb(1))
        assert clean.P.length() == 0
        assert [bool(c == 0) for c in clean.Q.coeffs()] == [False, True, False]
        assert clean.first_sign() == 1
        assert clean.first_fall(arb(1)) is None
