"""Power series of motions whose matrix is not symmetric, and their first crossings, which must not be missed."""

from decimal import Decimal

import mpmath
import numpy as np
import pytest
from conftest import thinned

from fem_reference.events.decimals import working
from fem_reference.events.series import ANGLE, Series, Stepper, terms

MASS = [Decimal(2), Decimal(3)]
STIFFNESSES = {
    "complex rates": [[200, -900], [700, 100]],
    "a double rate with one vector": [[200, 600], [0, 300]],
    "a double zero with one vector": [[0, 500], [0, 0]],
    "one that grows": [[-300, 0], [40, 900]],
}


@pytest.mark.parametrize("name", STIFFNESSES)
def test_the_series_is_the_exponential_of_the_matrix(name: str) -> None:
    K = [[Decimal(x) for x in row] for row in STIFFNESSES[name]]
    start, force = (
        ([Decimal("0.3"), Decimal("-1.1")], [Decimal(7), Decimal(-4)]),
        ([Decimal(50), Decimal(-20)], [Decimal(-90), Decimal(30)]),
    )
    with working(50), mpmath.workdps(70):
        stepper = Stepper.of(MASS, K)
        length = ANGLE / Decimal(stepper.rate)
        c = stepper.coefficients(start, force, length, terms())
        found = [Series(length, tuple(column))(length)[0] for column in zip(*c, strict=True)]
        A = mpmath.zeros(6)  # x, x', 1, t
        for i in (0, 1):
            m = mpmath.mpf(int(MASS[i]))
            A[i, 2 + i] = 1
            for j in (0, 1):
                A[2 + i, j] = -mpmath.mpf(int(K[i][j])) / m
            A[2 + i, 4], A[2 + i, 5] = mpmath.mpf(int(force[0][i])) / m, mpmath.mpf(int(force[1][i])) / m
        A[5, 4] = 1
        y = mpmath.matrix([mpmath.mpf(str(x)) for x in (*start[0], *start[1], 1, 0)])
        exact = mpmath.expm(A * mpmath.mpf(str(length))) * y
        for ours, theirs in zip(found, exact, strict=False):
            assert abs(mpmath.mpf(str(ours)) - theirs) <= mpmath.mpf(10) ** -45 * (1 + abs(theirs))


@pytest.mark.parametrize("digits", [30, 50, 80])
def test_what_is_left_out_is_below_the_digits(digits: int) -> None:
    with working(digits):
        n = terms()
    assert mpmath.mpf(ANGLE) ** n / mpmath.factorial(n) < mpmath.mpf(10) ** (-digits - 4)
    assert mpmath.mpf(ANGLE) ** (n - 2) / mpmath.factorial(n - 2) > mpmath.mpf(10) ** (-digits - 8)


def test_bounds_are_bounds() -> None:
    rng = np.random.default_rng(3)
    with working(50):
        K = [[Decimal(float(x)) for x in row] for row in rng.normal(size=(6, 6)) * 100]
        stepper = Stepper.of([Decimal(float(x)) for x in rng.uniform(1, 3, 6)], K)
        start, force = [tuple([Decimal(float(x)) for x in row] for row in rng.normal(size=(2, 6))) for _ in range(2)]
        scale = 1 / Decimal(stepper.rate)
        found = np.array(stepper.coefficients(start, force, scale, 12), dtype=float)
        assert np.all(np.abs(found) <= stepper.bounds(start, force, scale, 12) * (1 + 1e-12))
    eigenvalues = np.linalg.eigvals(np.array(K, dtype=float) / np.array(stepper.mass, dtype=float)[:, None])
    assert stepper.rate >= np.sqrt(np.abs(eigenvalues)).max() * (1 - 1e-12)


@pytest.mark.parametrize("seed", thinned(range(60), 6))
def test_the_first_fall_of_a_series(seed: int) -> None:
    rng = np.random.default_rng(seed)
    c = rng.normal(size=30) * 4.0 ** np.arange(30) / np.cumprod([1, *range(1, 30)])
    grid = np.linspace(0, 1, 200_001)
    values = np.polyval(c[::-1], grid)
    c[0] += 1e-3 * rng.integers(0, 2) - (values.min() * rng.uniform(0.5, 1.1) if seed % 2 else c[0])
    values = np.polyval(c[::-1], grid)
    sign = 1 if (values[1] if abs(c[0]) < 1e-12 else c[0]) > 0 else -1
    with working(50):
        function = Series(Decimal("0.01"), tuple(Decimal(float(sign * x)) for x in c))
        found = function.first_fall(Decimal("0.01"))
    below = np.flatnonzero((sign * values[1:-1] >= 0) & (sign * values[2:] < 0))
    assert (found is None) == (len(below) == 0)
    if found is not None:
        assert 0 <= float(found) * 100 - grid[below[0] + 1] <= grid[1]


@pytest.mark.parametrize("depth", [1e-3, 1e-8, 1e-14, 1e-20])
def test_a_dip_of_any_depth_is_seen_and_one_that_stays_above_is_none(depth: float) -> None:
    """(z - 1/3)^2 (1 + z^3) less or more than a depth: floats cannot tell, decimals can."""
    with working(50):
        third = 1 / Decimal(3)
        square = [third * third, -2 * third, Decimal(1)]
        c = [*square, *square]
        for sign in (-1, 1):
            moved = (c[0] + sign * Decimal(depth), *c[1:])
            found = Series(Decimal(1), moved).first_fall(Decimal(1))
            assert (found is not None) == (sign < 0)
            if found is not None:
                assert abs(Series(Decimal(1), moved)(found)[0]) < Decimal("1e-40")
                assert found < third


@pytest.mark.parametrize("late", [1e-3, 1e-12, 1e-16])
def test_a_crossing_just_before_the_end_is_seen(late: float) -> None:
    with working(50):
        c = (Decimal(1), -1 - Decimal(late), *[Decimal(0)] * 30)
        assert Series(Decimal(1), c).first_fall(Decimal(1)) == pytest.approx(
            1 / (1 + Decimal(late)), abs=Decimal("1e-45")
        )
        assert Series(Decimal(1), (Decimal(1), -1 + Decimal(late), *c[2:])).first_fall(Decimal(1)) is None
