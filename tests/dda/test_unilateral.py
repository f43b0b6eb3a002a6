"""One block on corners that open: invariants of the stepping at random data, to rounding, and named outcomes."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.contact_bodies import CASES
from oracles.unilateral_checks import DT, apart, random_model, run

from dda import (
    Block,
    Contact,
    Material,
    Scheme,
    TwoBlockModel,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    solve,
    solve_unilateral,
)

SCHEMES = [
    (0.5, 1.0, 1.0, "zero"),
    (0.25, 0.5, 1.0, "consistent"),
    (0.3025, 0.6, 0.97, "zero"),
    (0.7, 0.8, 0.99, "zero"),
]
PAPER = UnilateralModel(Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0)), Unilateral(1e9), 5e6)
OTHER = UnilateralModel(
    Block.rectangle(1.7, 1.3, Material(2350.0, 4.3e9, 0.31)), Unilateral(7e9, 3e9), 3.7e6, gravity=4.0
)
TRAVEL = 2.0 / np.sqrt(1e9 / 2700.0)  # a/c of PAPER [s]


def test_average_acceleration_gains_energy_by_opening():
    gains = [np.min(np.diff(run(random_model(s), 0.25, 0.5, energies=True).energies["switching"])) for s in range(4)]
    assert np.min(gains) < 0  # that none is gained is a theorem of delta = 1, not of the bookkeeping


@pytest.mark.parametrize("scheme", SCHEMES)
def test_one_contact_for_both_corners_is_the_full_model(scheme):
    alpha, delta, gg, start = scheme
    names = ("normal", "shear", "gap", "velocity")
    one, full = (
        solve_unilateral(OTHER, Scheme(alpha, delta, gg, DT, start), 200, options=UnilateralOptions(full=kept))
        for kept in (False, True)
    )
    assert one.unknowns == 3 and full.unknowns == 6 and np.count_nonzero(np.diff(one.closed[0])) > 0
    for name in names:
        assert apart(getattr(full, name), getattr(one, name)) <= 1e-9, name
    assert solve_unilateral(PAPER, Scheme(alpha, delta, gg, DT), 2).unknowns == 2


@pytest.mark.parametrize(
    ("pressure", "dt", "gg", "eccentricity"),
    [(5e6, 1.91e-3, 1.0, 0.0), (3.1e6, 1e-2, 0.98, 0.0), (3.1e6, 1e-2, 0.98, 0.2), (5e6, 4e-3, 1.0, -0.1)],
)
def test_a_contact_that_never_opens_is_the_locked_one(pressure, dt, gg, eccentricity):
    block, scheme = PAPER.block, Scheme(0.5, 1.0, gg, dt)
    contact, names = Contact(1e9, 0.4e9), ("displacement", "contact_pressure", "horizontal_displacement", "rotation")
    locked = solve(TwoBlockModel(block, contact, pressure, eccentricity=eccentricity), scheme, 60, names)
    model = UnilateralModel(block, Unilateral(1e9, 0.4e9), pressure, eccentricity=eccentricity)
    opens = solve_unilateral(model, scheme, 60, names)
    assert np.all(opens.closed[0]) and np.all(opens.closed[1]) and np.all(opens.step_solves == 1)
    for name in names:  # the locked history is blocked: some hundred roundings of the modes
        assert np.max(np.abs(opens.columns[name] - locked.columns[name])) <= 1e-12 * np.max(
            np.abs(locked.columns[name]), initial=1e-12
        ), name


@pytest.mark.parametrize(("alpha", "delta"), [(0.5, 1.0), (0.25, 0.5), (0.3025, 0.6)])
@pytest.mark.parametrize("p", [1e8, 1e11, np.inf])
def test_the_first_step_opens_below_the_closed_formula(alpha, delta, p):
    limit = TRAVEL / np.sqrt(6 * alpha)
    model = replace(PAPER, contact=Unilateral(p))
    for gg in (1.0, 0.9):
        below, above = (
            solve_unilateral(model, Scheme(alpha, delta, gg, side * limit), 1) for side in (1 - 1e-9, 1 + 1e-9)
        )
        assert not below.closed[0][0] and below.step_solves[0] == 2
        assert above.closed[0][0] and above.normal[0][0] > 0


@pytest.mark.parametrize(("scheme", "p"), thinned(product(SCHEMES, [1e9, 1e11, 1e15, np.inf]), 5))
def test_frictionless_contacts_take_two_and_three_solves_at_most(scheme, p):
    alpha, delta, gg, start = scheme
    for dt in (1e-4, 1e-2):
        for e, most in ((0.0, 2), (0.4, 3)):
            model = replace(PAPER, contact=Unilateral(p), eccentricity=e)
            result = solve_unilateral(model, Scheme(alpha, delta, gg, dt, start), 300)
            assert result.outcome == "completed"
            assert np.max(result.step_solves) <= most and not np.any(result.step_cuts)


def test_glued_states_that_disagree_are_cut_and_the_run_goes_on():
    """Long steps and stiff glued corners: some have no single state."""
    assert sum(np.sum(CASES["long steps"](seed).run().step_cuts) for seed in range(12)) > 0
