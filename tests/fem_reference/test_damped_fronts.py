"""The damped bar right beside its fronts, and late: against its transform."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.bars import damped as damped_bar

from fem_reference.exact import continuum, damped

FIRST = {"contact_pressure": (1.0, 2.0), "displacement": (0.5, 1.0)}  # arrival of the wave, and of every further one
STIFF = 1e9  # of the spring over the bar: here a front is sharpest, the shares of the modes fall as 1 / b only
CUT_OFF = 2e-12  # the smooth cut-off promises 1e-12; the sums round by as much as a half


@pytest.mark.parametrize(("a", "column"), thinned(product([0.003, 1.0], FIRST), 4))
def test_the_correction_reaches_as_far_as_the_cut_off_needs_it(column: str, a: float) -> None:
    """The tail of the cut-off sum is 1e-1 at a front and 1e-12 at 42 / modes from it: what is nearer is corrected.

    Uncorrected it would be 4e-6 at 22 / modes, 1e-8 at 28 and 4e-12 at 34 (contact pressure, a = 0.003).
    """
    first, gap = FIRST[column]
    times = first + 3 * gap + np.array([-42, -22, -2, 3, 33]) / damped.MODES
    found = continuum.histories(times, STIFF, 2 * a, (column,))[0]
    expected = [damped_bar(column, t, STIFF, a) for t in times]
    np.testing.assert_allclose(found, expected, rtol=0, atol=CUT_OFF)


@pytest.mark.parametrize(
    ("behind", "a", "column"), thinned(product([1 / damped.MODES, 0.25, 0.4], [3.0, 3.3], FIRST), 5)
)
def test_fronts_and_fast_modes_count_until_they_are_below_rounding(column: str, a: float, behind: float) -> None:
    """At a t = 21 to 25 a front of size exp(-a t), 1e-9 to 1e-11, is still alive, and so are the modes between."""
    first, gap = FIRST[column]
    t = first + 3 * gap * (1 if column == "contact_pressure" else 2) + behind
    assert 19 < a * t < 26
    found = continuum.histories(np.array([t]), STIFF, 2 * a, (column,))[0, 0]
    assert found == pytest.approx(damped_bar(column, t, STIFF, a), abs=CUT_OFF)
