"""The exact bar against routes that know nothing of its modes."""

import itertools

import numpy as np
import pytest
from oracles.elements import make

from fem_reference.exact import continuum
from fem_reference.exact.bar import Bar, applicable
from fem_reference.problem.problem import Problem, Scheme

PAPER = Bar(2.0, 2.0, 2700.0, 1e9, 2e9, 5e6)


def test_where_the_bar_is_exact():
    square = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
    data = (2700.0, 1e9, 0.0, "plane stress", 1e9, 1e9, 5e6)
    assert applicable(Problem(square, 0, 2, *data)) is None
    assert Bar.of(Problem(square, 0, 2, *data)) == PAPER
    assert "Poisson" in applicable(Problem(square, 0, 2, 2700.0, 1e9, 0.1, *data[3:]))
    assert "foundation" in applicable(Problem(square, 0, 2, *data, foundation="corner"))
    assert all("rectangle" in applicable(Problem(square, *edges, *data)) for edges in ((0, 1), (2, 0)))
    modes = PAPER.modes(Scheme(0.5, 1.0, 1.0, 1e-3), 300)
    assert sum(mode.share for mode in modes) == pytest.approx(1.0, abs=1e-3)
    assert [mode.frequency for mode in modes] == pytest.approx(PAPER.frequencies(300), rel=1e-15)
    with pytest.raises(ValueError, match=r"^young: "):
        Bar(2.0, 2.0, 2700.0, -1e9, 2e9, 5e6)


def test_waves_beyond_the_range_of_the_exponential():
    # exp(-x / 2) is zero in doubles for the first of these waves, and the series still oscillates about one.
    mp = pytest.importorskip("mpmath").mp
    x, j = 1800.0, 500
    wave = next(itertools.islice(continuum._laguerre(np.full(j + 2, x)), j, None))
    with mp.workdps(60):
        first, second = (mp.exp(-x / 2) * mp.laguerre(n, 0, x) for n in (j, j + 1))
        assert wave[0] == pytest.approx(float(first - second), abs=1e-12)


def test_nothing_comes_before_its_wave():
    """Each step carries a little further than the wave: h / (c dt) = 33 steps to the base, where rounding is none."""
    columns = Bar.of(make(ramp=0.01)).solve(Scheme(0.25, 0.5, 1.0, 1e-4, "consistent"), 40).columns
    assert not columns["contact_pressure"][:12].any() and columns["contact_pressure"][-1] == pytest.approx(133858.8)
    assert columns["displacement"][:4] == pytest.approx([-8.4e-21, -5.6e-19, -1.92e-17, -4.23e-16], rel=0.01)
