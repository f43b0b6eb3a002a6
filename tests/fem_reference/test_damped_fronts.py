"""The damped bar right beside its fronts, and late: against its transform."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.bars import damped as damped_bar

from fem_reference.exact import continuum, damped

FIRST = {"contact_pressure": (1.0, 2.0), "displacement": (0.5, 1.0)}  # arrival of the wave, and of every further one
STIFF = 1e9  # of the spring over the bar: here a front is sharpest
ROUNDING = 5e-13  # of a sum over cells and trips, and of the transform


@pytest.mark.long
@pytest.mark.parametrize(("a", "column"), list(product([0.003, 1.0], FIRST)))
def test_the_damped_bar_right_beside_its_fronts(column, a):
    first, gap = FIRST[column]
    times = first + 3 * gap + np.array([-2e-3, -1e-4, 0.0, 2e-4, 2e-3])
    found = continuum.histories(times, STIFF, 2 * a, (column,))[0]
    beside = times != first + 3 * gap  # the transform has no value at a jump
    expected = [damped_bar(column, t, STIFF, a) for t in times[beside]]
    np.testing.assert_allclose(found[beside], expected, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize(("behind", "a", "column"), thinned(product([6e-5, 0.25, 0.4], [3.0, 3.3], FIRST), 12))
def test_fronts_count_until_they_are_below_rounding(column, a, behind):
    """At a t = 21 to 25 a front of size exp(-a t), 1e-9 to 1e-11, is still alive, and so is what is between."""
    first, gap = FIRST[column]
    t = first + 3 * gap * (1 if column == "contact_pressure" else 2) + behind
    assert 19 < a * t < 26
    found = continuum.histories(np.array([t]), STIFF, 2 * a, (column,))[0, 0]
    assert found == pytest.approx(damped_bar(column, t, STIFF, a), abs=ROUNDING)


@pytest.mark.parametrize("a", [0.05, 1.0, 30.0])
def test_the_kernel_keeps_what_does_not_move(a):
    """A mode without a frequency keeps x = 1: exp(-a t) and the integral of the kernel are one together."""
    t = 3.7
    x, w = np.polynomial.legendre.leggauss(400)
    s = t * (1 + x) / 2
    assert np.exp(-a * t) + damped.kernel(t, s, a) @ w * t / 2 == pytest.approx(1.0, abs=1e-13)


def test_waves_that_are_too_many_are_refused():
    late = np.array([2.0 * damped.LONGEST])
    with pytest.raises(ValueError, match=r"^steps: "):
        continuum.histories(late, 1.0, 1e-4, ("displacement",))
