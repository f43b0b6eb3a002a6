"""The damped bar in time is the sum of its modes."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.exact import bar_modes, continuum, damped

COLUMNS = ("displacement", "contact_pressure")
SUMMED = 20_000  # modes; what the others add falls as their number, of the mean of two partial sums as its square
BARS = [(0.7, 0.0), (0.7, 0.3), (1e3, 3.0), (2e-3, 1.0), (40.0, 60.0)]  # stiffness of the spring over the bar's, a


@pytest.mark.parametrize(("kappa", "a"), BARS)
def test_the_damped_bar_is_the_sum_of_its_modes(kappa, a):
    """A mode of frequency b swings as 1 - exp(-a t) (cos(w t) + a sin(w t) / w), w^2 = b^2 - a^2; off the fronts."""
    times = np.array([0.31, 0.77, 1.23, 2.6, 3.37, 7.71])
    b = bar_modes.wave_numbers(kappa, SUMMED)
    w = np.sqrt(b**2 - a**2 + 0j)
    swings = 1 - np.exp(-a * times) * (np.cos(w[:, None] * times) + a * np.sin(w[:, None] * times) / w[:, None])
    found = continuum.histories(times, kappa, 2 * a, COLUMNS)
    for name, values in zip(COLUMNS, found, strict=True):
        sums = np.cumsum(bar_modes.shares(name, b, kappa)[:, None] * swings.real, axis=0)
        np.testing.assert_allclose(values, (sums[-1] + sums[-2]) / 2, rtol=0, atol=2e-6)


def test_waves_that_are_too_many_are_refused():
    late = np.array([2.0 * damped.LONGEST])
    with pytest.raises(ValueError, match=r"^steps: "):
        continuum.histories(late, 1.0, 1e-4, ("displacement",))
