"""The bar on a spring that carries no tension under the Newmark scheme: towards the exact motion."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

from fem_reference import Bar, Scheme, named_scheme
from fem_reference.events.bar_events import solve as exact
from fem_reference.exact.opening_bar import OpeningBar
from fem_reference.problem.bar import BarProblem

CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-4)
AVERAGE = Scheme(0.25, 0.5, 1.0, 1e-4, "consistent")


@pytest.mark.parametrize(
    ("scheme", "order"),
    # The fronts' widths, h^(1/2) and h^(2/3) for schemes of first and second order, leave d^(3/2) in the L2 norm.
    thinned([(CONSTANT, 0.75), (AVERAGE, 1.0)], 2),
)
def test_refining_the_step_leads_to_the_exact_motion(scheme, order):
    errors, steps = [], [250, 500, 1000]
    motion = exact(BarProblem(2.0, 2.0, 2700.0, 1e9, 2e9, 5e6), 0.0301)
    truth = motion.at(0.03 / 250 * np.arange(1, 251)).displacement
    for count in steps:
        bar = OpeningBar.of(make()).solve(replace(scheme, step=0.03 / count), count)
        away = bar.columns["displacement"][count // 250 - 1 :: count // 250] - truth
        errors.append(np.linalg.norm(away) / np.linalg.norm(truth))
    found = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert found == pytest.approx(order, abs=0.13)


def test_a_bar_that_never_opens_is_the_sum_of_its_modes():
    numbers = {"step": 1.3e-3, "gg": 0.97}
    schemes = [named_scheme(name, **numbers, rho_inf=0.6) for name in ("chung-hulbert", "hht", "wbz")]
    schemes += [replace(schemes[0], start="zero"), Scheme(0.3, 0.6, 0.9, 1.3e-3, "consistent")]
    problem = make(p=1e8)
    for scheme in schemes:
        pressed = OpeningBar.of(problem).solve(scheme, 40).columns
        assert pressed["closed"].all()
        for name, values in Bar.of(problem).solve(scheme, 40).columns.items():
            assert pressed[name] == pytest.approx(values, rel=1e-12), (scheme, name)
