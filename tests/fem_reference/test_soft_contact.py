"""The exact bars on soft springs, where all that moves is a small difference, against transforms in 50 digits.

Errors are over the history's own maximum, which on a soft spring is far below the static value.
"""

from itertools import product

import numpy as np
import pytest
from conftest import thinned
from mpmath import mpf
from oracles import bar_by_series, bar_by_transform

from fem_reference.exact import bar as bar_module
from fem_reference.exact import continuum
from fem_reference.exact.bar import Bar
from fem_reference.problem.problem import Scheme

SOFTNESS = [2e-12, 4e-6, 0.9]  # of the spring over the bar: twice p / E of a square block
COLUMNS = ["contact_pressure", "displacement"]
CUT_OFF = 2e-12  # of the sums over modes, as in `test_damped_fronts`


def over_maximum(found, expected):
    scale = max(map(abs, expected))
    return float(max(abs(mpf(float(x)) - y) for x, y in zip(found, expected, strict=True)) / scale)


CONTINUA = product(COLUMNS, SOFTNESS, [0.25, 0.2371], [1e-6, 0.0, 1.0, 300.0])


@pytest.mark.parametrize(("column", "kappa", "step", "rate"), thinned(CONTINUA, 48))
def test_the_continuum(column, kappa, rate, step):
    """On the fronts, where a quarter of a travel time falls, and away from them; without damping and diffusive."""
    times, looked = step * np.arange(1, 61), [19]
    found = continuum.histories(times, kappa, rate, (column,))[0]
    expected = [bar_by_transform.history(column, float(times[i]), kappa, rate) for i in looked]
    assert over_maximum(found[looked], expected) <= CUT_OFF


STIFFNESSES = [1e-15, 3e-9, 1e-3]
SCHEMES = [
    Scheme(0.5, 1.0, 1.0, 2e-3),
    Scheme(0.25, 0.5, 1.0, 5e-5),
    Scheme(0.25, 0.5, 0.95, 2e-4),
    Scheme(0.5625, 1.0, 1.0, 3e-4, "consistent"),
    Scheme(0.5, 1.0, 0.999, 1e-3),
    Scheme(0.25, 0.5, 1 - 3e-5, 2e-4),
]


@pytest.mark.parametrize(("stiffness", "scheme"), thinned(product(STIFFNESSES, SCHEMES), 7))
def test_the_bar_in_steps(stiffness, scheme):
    steps = [1, 3, 20, 60]
    bar = Bar(2.0, 2.0, 2700.0, 1e9, 2e9 * stiffness, 5e6)
    expected = bar_by_series.at_steps(bar, scheme, COLUMNS, steps)
    for name, values in bar.solve(scheme, steps[-1]).columns.items():
        assert over_maximum(values[np.array(steps) - 1], expected[name]) <= bar_module.TARGET


def test_a_critically_damped_slow_mode_in_steps():
    """The lowest mode's roots are equal and next to one: no pair of powers, and no difference from one either."""
    bar = Bar(2.0, 2.0, 2700.0, 1e9, 2e1, 5e6)
    omega = float(bar.frequencies(1)[0]) * 2e-4
    gg = 1 - 2 * omega  # (1 - gg)^2 = 4 h, to the first order of h = Omega^2
    scheme, steps = Scheme(0.25, 0.5, gg, 2e-4), [2, 40, 80]
    expected = bar_by_series.at_steps(bar, scheme, COLUMNS, steps)
    for name, values in bar.solve(scheme, steps[-1]).columns.items():
        assert over_maximum(values[np.array(steps) - 1], expected[name]) <= bar_module.TARGET
