"""Digits of the robust form and of opening contact against 80-digit arithmetic, over stiff and extreme data."""

from itertools import product

import pytest
from conftest import thinned
from oracles import block_in_digits

from dda import (
    Block,
    Contact,
    Material,
    Scheme,
    TwoBlockModel,
    Unilateral,
    UnilateralModel,
    modes,
    solve,
    solve_unilateral,
)
from dda.scheme import spectral

STEPS = 25
# The bounds that the package promises; worst of some 2000 random rectangles: 4e-12 and 6e-12.
LIMIT = {"zero": 1e-11, "consistent": 1e-9}
STARTS = ["zero", "consistent"]
DATA = [(1e-9, 1e3, 0.9), (3.0, 7e-4, 0.97), (1e15, 1e-5, 1.0)]  # p / E, step, gg
SCHEMES = [(0.5, 1.0), (0.25, 0.5), (0.5625, 1.0), (0.3025, 0.6), (1 / 6, 0.5), (0.0, 0.5)]


def assert_digits(model, scheme):
    result = solve(model, scheme, STEPS)
    exact = block_in_digits.locked_history(model, scheme, STEPS)
    for name, values in zip(("displacement", "contact_pressure"), exact, strict=True):
        assert block_in_digits.lost(result.columns[name], values) < LIMIT[scheme.start], name


def bounded_step(model, alpha, delta, gg, step):
    """Return the step, or one just inside the limit of a conditional scheme."""
    fastest = max(mode.frequency for mode in modes(model, Scheme(alpha, delta, gg, 1.0)))
    return min(step, 0.97 * spectral.critical_omega(alpha, delta, gg) / fastest)


@pytest.mark.parametrize(("data", "scheme", "start"), thinned(product(DATA, SCHEMES, STARTS), 11))
def test_digits_over_stiffness_step_and_scheme(data, scheme, start):
    (ratio, step, gg), (alpha, delta) = data, scheme
    block = Block.rectangle(1.7, 1.3, Material(2350.0, 4.3e9, 0.31))
    model = TwoBlockModel(block, Contact(ratio * 4.3e9, 0.4 * ratio * 4.3e9), 3.7e6)
    step = bounded_step(model, alpha, delta, gg, step)
    assert_digits(model, Scheme(alpha, delta, gg, step, start))


EXTREMES = {
    "stiff contact, slow mode resolved": ([2, 31], Material(2700.0, 1e9, 0.49), 1.8e19, 7.16e-5),
    "nearly incompressible": ([2, 2.5], Material(2700.0, 1e9, 0.4999999, "plane strain"), 3e9, 1e-3),
    "auxetic": ([2, 1], Material(2700.0, 1e9, -0.9), 2e8, 1e-3),
    "tall": ([1, 1000], Material(2700.0, 1e9, 0.25), 1e10, 1e-2),
    "huge": ([1e6, 1.2e6], Material(2700.0, 1e9, 0.2), 1e10, 1e2),
    "light and hard": ([2, 1], Material(1e-6, 1e15, 0.2), 1e13, 1e-9),
}


@pytest.mark.parametrize(("scheme", "start", "name"), thinned(product(SCHEMES[:2], STARTS, EXTREMES), 11))
def test_digits_at_extremes(scheme, start, name):
    (width, height), material, p, step = EXTREMES[name]
    model = TwoBlockModel(Block.rectangle(width, height, material), Contact(p), 1e300)
    assert_digits(model, Scheme(*scheme, 1.0, step, start))


# Stiffness against step: soft to rigid, a contact resolved in time and one that is not.
PAIRS = [(1.0, 1e3), (1e9, 1e-6), (1e13, 1e-3), (1e17, 1e-9), (1e17, 1e3), (1e21, 1e-3), (1e24, 1e-9), (1e24, 1e-3)]


@pytest.mark.parametrize(("p", "dt", "gg"), thinned([(*pair, gg) for pair in PAIRS for gg in (0.99, 1.0)], 9))
def test_one_contact_keeps_its_digits_from_soft_to_rigid(p, dt, gg):
    block = Block.rectangle(1.7, 1.3, Material(2350.0, 4.3e9, 0.0))
    model, scheme = UnilateralModel(block, Unilateral(p), velocity=-1.0), Scheme(0.5, 1.0, gg, dt)
    result, exact = solve_unilateral(model, scheme, 12), block_in_digits.history(model, scheme, 12)
    assert result.outcome == "completed"
    assert block_in_digits.lost(result.columns["displacement"], [row[0] for row in exact]) < 1e-14
    for i, force in enumerate(result.normal):
        assert block_in_digits.lost(force, [row[1][i] for row in exact]) < 1e-14
