"""One block on corners that open: invariants of the stepping at random data, to rounding, and named outcomes."""

from copy import deepcopy
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.unilateral_checks import DT, apart, checked, random_model, run, size, stepping_by, sums

import dda.one_block.unilateral as unilateral
import dda.one_block.unilateral_step as step
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
from dda.contact.kernel import NONE
from dda.stepping.driver import OUTCOMES

SCHEMES = [
    (0.5, 1.0, 1.0, "zero"),
    (0.25, 0.5, 1.0, "consistent"),
    (0.3025, 0.6, 0.97, "zero"),
    (0.7, 0.8, 0.99, "zero"),
]
SEEDS = range(12)
PAPER = UnilateralModel(Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0)), Unilateral(1e9), 5e6)
OTHER = UnilateralModel(
    Block.rectangle(1.7, 1.3, Material(2350.0, 4.3e9, 0.31)), Unilateral(7e9, 3e9), 3.7e6, gravity=4.0
)
TRAVEL = 2.0 / np.sqrt(1e9 / 2700.0)  # a/c of PAPER [s]


@pytest.mark.parametrize(("seed", "scheme"), thinned(product(SEEDS, SCHEMES), 11))
def test_complementarity_momentum_and_energy_hold_to_rounding(seed, scheme):
    alpha, delta, gg, start = scheme
    result = checked(random_model(seed), Scheme(alpha, delta, gg, DT, start))
    assert seed % 3 != 1 or len(result.notes) > 1  # symmetric scenes keep one contact


@pytest.mark.parametrize(("seed", "p"), thinned(product([3, 5, 11], [1e14, 1e18, 1e22, np.inf]), 5))
def test_a_stiff_normal_spring_beside_glued_shear_keeps_the_invariants(seed, p):
    model = random_model(seed, glued=True)
    result = checked(replace(model, contact=replace(model.contact, stiffness=p)), Scheme(0.5, 1.0, 1.0, DT), 200)
    assert np.max(np.diff(sums(result)[0])) <= 1e-13 * size(result)


def test_average_acceleration_gains_energy_by_opening():
    gains = [np.min(np.diff(run(random_model(s), 0.25, 0.5, energies=True).energies["switching"])) for s in SEEDS[:4]]
    assert np.min(gains) < 0  # the theorem above is one of delta = 1, not of the bookkeeping


@pytest.mark.parametrize("scheme", SCHEMES)
def test_one_contact_for_both_corners_is_the_full_model(scheme):
    alpha, delta, gg, start = scheme
    names = ("normal_force_m", "normal_force_n", "shear_force_m", "shear_force_n", "gap_n", "shear_m", "velocity")
    one, full = (
        solve_unilateral(OTHER, Scheme(alpha, delta, gg, DT, start), 200, options=UnilateralOptions(full=kept))
        for kept in (False, True)
    )
    assert one.unknowns == 3 and full.unknowns == 6 and np.count_nonzero(np.diff(one.closed_m)) > 0
    for name in names:
        assert apart(getattr(full, name), getattr(one, name)) <= 1e-9, name
    assert solve_unilateral(PAPER, Scheme(alpha, delta, gg, DT), 2).unknowns == 2


@pytest.mark.parametrize(
    ("pressure", "dt", "gg", "eccentricity"),
    [(5e6, 1.91e-3, 1.0, 0.0), (3.1e6, 1e-2, 0.98, 0.0), (3.1e6, 1e-2, 0.98, 0.2), (5e6, 4e-3, 1.0, -0.1)],
)
def test_a_contact_that_never_opens_is_the_locked_one(pressure, dt, gg, eccentricity):
    block, scheme = PAPER.block, Scheme(0.5, 1.0, gg, dt)
    contact, names = Contact(1e9, 0.4e9), ("displacement", "contact_pressure", "rotation")
    locked = solve(TwoBlockModel(block, contact, pressure, eccentricity=eccentricity), scheme, 60, names)
    model = UnilateralModel(block, Unilateral(1e9, 0.4e9), pressure, eccentricity=eccentricity)
    opens = solve_unilateral(model, scheme, 60, names)
    assert np.all(opens.closed_m) and np.all(opens.closed_n) and np.all(opens.step_solves == 1)
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
        assert not below.closed_m[0] and below.step_solves[0] == 2
        assert above.closed_m[0] and above.normal_force_m[0] > 0


@pytest.mark.parametrize(("scheme", "p"), thinned(product(SCHEMES, [1e9, 1e11, 1e15, np.inf]), 5))
def test_frictionless_contacts_take_two_and_three_solves_at_most(scheme, p):
    alpha, delta, gg, start = scheme
    for dt in (1e-4, 1e-2):
        for e, most in ((0.0, 2), (0.4, 3)):
            model = replace(PAPER, contact=Unilateral(p), eccentricity=e)
            result = solve_unilateral(model, Scheme(alpha, delta, gg, dt, start), 300)
            assert result.outcome == "completed"
            assert np.max(result.step_solves) <= most and not np.any(result.step_cuts)


@pytest.mark.parametrize("p", [2e9, np.inf])
def test_a_dropped_block_falls_freely_until_the_gap_closes(p):
    model = replace(PAPER, contact=Unilateral(p, gap=0.05), pressure=0.0, gravity=9.81)
    result = solve_unilateral(model, Scheme(0.25, 0.5, 1.0, 1e-3, "consistent"), 150)
    t = result.time
    before = t < np.sqrt(2 * 0.05 / 9.81)
    assert np.allclose(result.columns["displacement"][before], -9.81 * t[before] ** 2 / 2, rtol=1e-12)
    assert np.flatnonzero(result.closed_m)[0] == np.count_nonzero(before)
    assert result.gap_m[-1] > -1e-3


@pytest.mark.parametrize(("gg", "delta"), [(1.0, 0.5), (0.97, 1.0)])
def test_an_explicit_scheme_keeps_the_invariants(gg, delta):
    for seed in (3, 11):
        checked(random_model(seed), Scheme(0.0, delta, gg, 2e-6), 500)


def test_gg_in_flight_is_a_drag_by_the_closed_formula():
    gg, dt, g, n = 0.98, 1e-3, 9.81, 200
    model = replace(PAPER, contact=Unilateral(1e9, gap=10.0), pressure=0.0, gravity=g)
    result = solve_unilateral(model, Scheme(0.5, 1.0, gg, dt), n)
    assert result.velocity[-1] == pytest.approx(-dt * g * (1 - gg**n) / (1 - gg), rel=1e-12)


def failing(times):
    """Return a loop whose contacts have no state in the first attempts, and what these were given."""
    given = []

    def stubborn(block, shear_law, state, after, base, part):
        given.append((part.ratio, deepcopy(state), block.room))
        outcome, solves = step.advance(block, shear_law, state, after, base, part)
        return (NONE if len(given) <= times else outcome), solves

    return stepping_by(stubborn), given


def test_a_cut_step_begins_from_the_saved_state(monkeypatch):
    stubborn, given = failing(2)
    monkeypatch.setattr(unilateral, "make_steps", stubborn)
    model = random_model(3, glued=True)
    result = run(model, steps=3, gg=0.9, full=True)
    ratios = [ratio for ratio, *_ in given[:4]]
    assert ratios[:3] == pytest.approx([1.0, 0.3, 0.09]) and ratios[3] == pytest.approx(0.91)
    assert given[0][1] == given[1][1] == given[2][1] != given[3][1]
    assert result.step_cuts.tolist() == [2, 0, 0] and result.factorisations == 4
    assert len(result.time) == 3 and result.time[-1] == pytest.approx(3 * DT)


@pytest.mark.parametrize("cut", [0.3, 1 / 3, 0.5])
def test_cut_steps_keep_the_share_gg_of_the_velocity(monkeypatch, cut):
    stubborn, _ = failing(3)
    monkeypatch.setattr(unilateral, "make_steps", stubborn)
    model = replace(PAPER, contact=Unilateral(1e9, gap=1.0), pressure=0.0, velocity=-0.8)
    result = run(model, steps=4, gg=0.9, cut=cut)
    assert result.step_cuts[0] == 3
    assert result.velocity == pytest.approx(-0.8 * 0.9 ** np.arange(1, 5), rel=1e-14)


def test_cutting_ends_at_a_hundredth_with_the_named_outcome(monkeypatch):
    stubborn, given = failing(1000)
    monkeypatch.setattr(unilateral, "make_steps", stubborn)
    result = run(OTHER, steps=5)
    assert result.outcome == OUTCOMES[NONE] and len(result.time) == 0
    assert result.notes[-1] == f"{OUTCOMES[NONE]} at step 1"
    assert [ratio for ratio, *_ in given] == pytest.approx([1.0, 0.3, 0.09, 0.027, 0.01])


def test_glued_states_that_disagree_are_cut_and_the_run_goes_on():
    """Long steps and stiff glued corners: some steps have no single state; cutting finds one that loses energy."""
    cuts = 0
    for seed in range(12):
        model = random_model(seed, glued=True)
        result = solve_unilateral(model, Scheme(0.5, 1.0, 1.0, 8e-3), 60, options=UnilateralOptions(energies=True))
        assert np.all(np.diff(sums(result)[0]) < 1e-13 * size(result))
        cuts += int(np.sum(result.step_cuts))
    assert cuts > 0


def test_a_dead_band_holds_tension_and_delays_closing():
    band = (1e-3, 1e-6)
    model = replace(PAPER, contact=Unilateral(1e11, band=band))
    result = solve_unilateral(model, Scheme(0.5, 1.0, 1.0, 1e-4), 600)
    free = result.gap_m[~result.closed_m]
    assert np.min(free) < 0 and np.min(free) >= -band[0]
    assert np.max(result.gap_m[result.closed_m]) <= band[1]
    assert np.min(result.normal_force_m) >= -1e11 * band[1]


@pytest.mark.parametrize("seeds", thinned([range(2), range(2, 6)], 2))
@pytest.mark.parametrize("dt", [1e-5, 2e-4])
def test_the_implicit_contact_rule_never_gains_and_keeps_the_bulk(dt, seeds):
    for seed in seeds:
        model = random_model(seed)
        options = UnilateralOptions(rule="implicit", energies=True)
        result = solve_unilateral(model, Scheme(0.25, 0.5, 1.0, dt, "consistent"), 300, options=options)
        total, lost = sums(result)
        first = model.block.material.density * model.block.section.area * model.velocity**2 / 2
        assert np.max(np.abs(total + lost - first)) < 1e-12 * size(result)
        assert np.max(np.diff(total)) < 1e-12 * size(result)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Unilateral(0.0), "stiffness: must be positive, got 0.0"),
        (lambda: Unilateral(float("nan")), "stiffness: must be positive"),
        (lambda: Unilateral(1e9, shear=-1.0), "shear: must be finite and not negative"),
        (lambda: Unilateral(1e9, gap=float("inf")), "gap: must be finite"),
        (lambda: Unilateral(1e9, band=(-1e-6, 0.0)), "band: must be two finite lengths"),
        (lambda: Unilateral(float("inf"), band=(0.0, 1e-6)), "band: a rigid stop"),
        (lambda: replace(PAPER, velocity=float("nan")), "velocity: must be finite"),
        (lambda: replace(PAPER, base=7), "base: must be an edge"),
        (lambda: replace(PAPER, top=0), "top: must differ from base"),
        (lambda: replace(PAPER, eccentricity=1.0), "eccentricity: must be below"),
        (lambda: UnilateralOptions(rule="hope"), "rule: must be among"),
        (lambda: UnilateralOptions(solve_limit=0), "solve_limit: must be a positive integer"),
        (lambda: UnilateralOptions(cut=1.0), "cut: must be between 0 and 1"),
        (lambda: run(PAPER, rule="implicit"), "rule: implicit contact needs average acceleration"),
        (lambda: run(replace(PAPER, contact=Unilateral(np.inf)), 0.0, 0.5), "stiffness: must be finite in an explicit"),
        (lambda: run(PAPER, steps=0), "steps: must be a positive integer"),
    ],
)
def test_bad_input_is_named(make, said):
    with pytest.raises(ValueError, match="^" + said.replace("(", r"\(")):
        make()
