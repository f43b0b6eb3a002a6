"""Decimal functions, and the searches for a first crossing, which must miss none."""

from decimal import Decimal, localcontext

import mpmath
import numpy as np
import pytest
from conftest import thinned

from fem_reference.events.decimals import cos_sin, dot, eigen, split, working
from fem_reference.events.exponential import Exponential
from fem_reference.events.oscillation import Oscillation

ANGLES = ["1e-20", "0.1", "-3", "3.14159265358979323846", "1e6", "-12345.678", "1.57079632679489661923132169163975144"]


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("digits", [30, 50, 90])
def test_cosine_and_sine(angle: str, digits: int) -> None:
    with working(digits), mpmath.workdps(digits + 30):
        cosine, sine = cos_sin(Decimal(angle))
        exact = mpmath.cos(mpmath.mpf(angle)), mpmath.sin(mpmath.mpf(angle))
        for ours, theirs in zip((cosine, sine), exact, strict=True):
            assert abs(mpmath.mpf(str(ours)) - theirs) <= mpmath.mpf(10) ** (1 - digits)


def test_the_working_context_is_independent_of_the_callers() -> None:
    with localcontext() as context:
        context.prec = 3
        with working(50):
            assert len((Decimal(2).sqrt()).as_tuple().digits) == 50
        assert context.prec == 3


def test_eigenvalues_of_graded_matrices() -> None:
    rng = np.random.default_rng(5)
    with working(50):
        B = [[Decimal(float(x)) * Decimal(10) ** i for x in row] for i, row in enumerate(rng.normal(size=(6, 6)))]
        A = [[dot(x, y) for y in B] for x in B]
        values, vectors = eigen(A)
        for value, vector in zip(values, vectors, strict=True):
            residual = [dot(row, vector) - value * x for row, x in zip(A, vector, strict=True)]
            assert max(map(abs, residual)) <= Decimal("1e-46") * max(values)
            assert abs(dot(vector, vector) - 1) <= Decimal("1e-47")
        trace = sum((A[i][i] for i in range(6)), Decimal(0))
        assert abs(sum(values) - trace) <= Decimal("1e-46") * trace


def test_a_decimal_is_the_sum_of_two_floats() -> None:
    with working(50):
        third = Decimal(1) / 3
        high, low = split(third)
        assert abs(Decimal(high) + Decimal(low) - third) < Decimal("1e-32")


def first_fall(values: np.ndarray, grid: np.ndarray) -> float | None:
    """Left end of the first cell in which sampled values fall below zero."""
    below = np.flatnonzero((values[:-1] >= 0) & (values[1:] < 0))
    return float(grid[below[0]]) if len(below) else None


@pytest.mark.parametrize("seed", thinned(range(40), 10))
def test_the_first_fall_of_an_oscillation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    waves = [(rng.uniform(0.5, 20), rng.normal(), rng.normal()) for _ in range(3)]
    bottom = sum(np.hypot(A, B) for _, A, B in waves) * rng.uniform(0.3, 1.05)
    slope = rng.normal() * 0.1
    grid = np.linspace(0, 8, 400_001)
    values = bottom + slope * grid + sum(A * np.cos(w * grid) + B * np.sin(w * grid) for w, A, B in waves)
    sign = 1 if values[0] > 0 else -1
    with working(50):
        terms = tuple((Decimal(w), Decimal(sign * A), Decimal(sign * B)) for w, A, B in waves)
        found = Oscillation((Decimal(sign * bottom), Decimal(sign * slope), Decimal(0)), terms).first_fall(Decimal(8))
    expected = first_fall(sign * values, grid)
    assert (found is None) == (expected is None)
    if found is not None and expected is not None:
        assert 0 <= float(found) - expected <= grid[1]


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
