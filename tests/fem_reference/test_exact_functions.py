"""Decimal functions, and the searches for a first crossing, which must miss none."""

from decimal import Decimal, localcontext

import numpy as np
import pytest
from conftest import thinned

from fem_reference.events.decimals import working
from fem_reference.events.exponential import Exponential


def test_the_working_context_is_independent_of_the_callers() -> None:
    with localcontext() as context:
        context.prec = 3
        with working(50):
            assert len((Decimal(2).sqrt()).as_tuple().digits) == 50
        assert context.prec == 3


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
    with working(60):
        function = Exponential(Decimal(kappa), tuple(map(Decimal, P)), tuple(map(Decimal, Q)))
        sign = function.first_sign()
        found = (function * Decimal(sign)).first_fall(Decimal(2))
    expected = first_fall(sign * values[1:], grid[1:])
    assert (found is None) == (expected is None)
    if found is not None and expected is not None:
        assert 0 <= float(found) - expected <= grid[1]


def test_the_calculus_of_an_exponential() -> None:
    with working(60):
        f = Exponential(Decimal("1.7"), (Decimal(2), Decimal(-3)), (Decimal(1), Decimal(4), Decimal("-0.5")))
        start, s, h = Decimal("0.3"), Decimal("0.8"), Decimal("1e-15")
        assert abs((f(s + h) - f(s - h)) / (2 * h) - f.derivative()(s)) < Decimal("1e-27")
        assert abs(f.shifted(s)(start) - f(s + start)) < Decimal("1e-55")
        integral, relaxed = f.integral(start), f.relaxed(start)
        assert abs(integral(Decimal(0)) - start) < Decimal("1e-55")
        assert abs(relaxed(Decimal(0)) - start) < Decimal("1e-55")
        assert abs(integral.derivative()(s) - f(s)) < Decimal("1e-55")
        assert abs(relaxed.derivative()(s) + f.kappa * relaxed(s) - f(s)) < Decimal("1e-55")
