"""The bar on a spring that carries no tension under the Newmark scheme: locked bar, elements, exact motion."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.elements import make

from fem_reference import Motion, Scheme
from fem_reference.events.bar_events import solve as exact
from fem_reference.exact.opening_bar import OpeningBar, applicable, closed_forms
from fem_reference.problem.bar import BarProblem

CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-4)
AVERAGE = Scheme(0.25, 0.5, 1.0, 1e-4, "consistent")


@pytest.mark.parametrize("size", [1e-4, 1e-2, 0.3, 1.49, 1.51, 3.0, 30.0, 500.0])
def test_closed_forms_to_the_last_digits(size):
    mp = pytest.importorskip("mpmath").mp
    x = size * np.exp(1j * np.array([0.0, 0.4, 0.9, 1.3, 1.5]))
    found = closed_forms(x * x)
    with mp.workdps(60):
        for i, square in enumerate(x * x):
            root = mp.sqrt(mp.mpc(complex(square)))
            known = (root * mp.coth(root), root / mp.sinh(root), root / (2 * mp.sinh(root / 2)))
            for values, value in zip(found, known, strict=True):
                expected = complex((value - 1) / root**2)
                # near a free mode, x = i n pi, a rounding of x^2 is multiplied by the distance
                assert abs(values[i] - expected) <= 1e-13 * abs(expected)


@pytest.mark.parametrize(
    ("scheme", "order"),
    # The fronts' widths, h^(1/2) and h^(2/3) for schemes of first and second order, leave d^(3/2) in the L2 norm.
    [(CONSTANT, 0.75), (AVERAGE, 1.0)],
)
def test_refining_the_step_leads_to_the_exact_motion(scheme, order):
    errors, steps = [], [1000, 2000, 4000, 8000]
    motion = exact(BarProblem(2.0, 2.0, 2700.0, 1e9, 2e9, 5e6), 0.0301)
    truth = motion.at(0.03 / 250 * np.arange(1, 251)).displacement
    for count in steps:
        bar = OpeningBar.of(make()).solve(replace(scheme, step=0.03 / count), count)
        away = bar.displacement[count // 250 - 1 :: count // 250] - truth
        errors.append(np.linalg.norm(away) / np.linalg.norm(truth))
    found = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert found == pytest.approx(order, abs=0.1)


def test_a_bar_at_rest_stays_closed_and_the_least_touch_closes_it():
    problem = replace(make(), pressure=0.0)
    still = OpeningBar.of(problem).solve(CONSTANT, 5)
    assert np.all(still.closed == 1) and not still.gap.any() and not still.displacement.any()
    gap = 10 * CONSTANT.step  # a free bar of one metre a second is there in the tenth step
    touched = OpeningBar.of(problem, gap * (1 - 1e-9), -1.0).solve(CONSTANT, 10)
    assert touched.closed.tolist() == [0.0] * 9 + [1.0] and touched.contact_pressure[-1] > 0


def test_what_is_no_bar_is_refused_by_name():
    square = make()
    for change, words in (
        ({"poisson": 0.1}, "Poisson's ratio is 0.1"),
        ({"traction": 1.0}, "a centred pressure and its weight only"),
        ({"motion": Motion((0.0, 1.0), (0.0, 0.0), (0.0, 1e-3))}, "a centred pressure and its weight only"),
        ({"foundation": "corner"}, "the foundation is 'corner'"),
        ({"vertices": ((0, 0), (2, 0), (2, 2), (0.1, 2))}, "not an upright rectangle"),
    ):
        assert words in applicable(replace(square, **change))
        with pytest.raises(ValueError, match=words):
            OpeningBar.of(replace(square, **change))
    with pytest.raises(ValueError, match=r"^gap: "):
        OpeningBar.of(square, gap=-1.0)
    with pytest.raises(ValueError, match=r"^velocity: "):
        OpeningBar.of(square, velocity=math.nan)
    with pytest.raises(ValueError, match=r"^steps: "):
        OpeningBar.of(square).solve(CONSTANT, 0)
    with pytest.raises(ValueError, match="explicit"):
        OpeningBar.of(square).solve(replace(CONSTANT, alpha=0.0), 1)
