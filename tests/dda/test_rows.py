"""The contact problem of a step: the one solution of frictionless contact, states of friction, where there is none."""

import math

import numpy as np
import pytest

from dda.contact import rows
from dda.contact.band import find_in_band
from dda.contact.dense import eliminate
from dda.contact.rows import FOUND, INSIDE, LIMIT, LOWER, NONE, SEVERAL, UPPER, Flexibility, Laws, Rows


def laws_of(contacts, m, compliance, cohesion=math.inf, **changes):
    """Return contacts that open, and rows along the base that carry up to the cohesion beside friction."""
    across = np.arange(m) < contacts
    lower = np.where(across, 0.0, -cohesion)
    upper = np.where(across, math.inf, cohesion)
    slips = math.isfinite(cohesion)
    numbers = (
        np.broadcast_to(compliance, m),
        lower,
        upper,
        across.astype(int),
        np.zeros(contacts),
        slips,
        False,
        False,
        False,
    )
    return Laws(contacts, m, *numbers, closing=0.0, retardation=0.0, together=6, most=0)._replace(**changes)


def solved(laws, W, q, before=None, paired=None, pair=None):
    """Return outcome, solves and the rows at the end of a step."""
    m = len(q)
    before = before or rows.rows_of(np.zeros(m), np.zeros(m))
    after = rows.rows_of(np.zeros(m), np.zeros(m))
    work = rows.work_for(laws.contacts, m, laws.banded)
    work.q[:] = q
    if pair is not None:
        work.pair[:] = pair
    W = np.array(W, dtype=float)
    flexible = Flexibility(W, W if paired is None else paired, np.ones(1))
    find = find_in_band if laws.banded else rows.find
    return *find(laws, before, flexible, after, work), after


CYCLES = [
    ([[14.0, -14.0, 13.0], [-14.0, 17.0, -12.0], [13.0, -12.0, 13.0]], [-4.0, 5.0, -2.0]),
    ([[12.0, -10.0, -8.0], [-10.0, 13.0, 13.0], [-8.0, 13.0, 14.0]], [-5.0, 4.0, 1.0]),
]


@pytest.mark.parametrize(("W", "w"), CYCLES)
def test_contacts_that_cycle_when_set_at_once_are_set_one_at_a_time(W, w):
    laws = laws_of(3, 3, 0.05)
    outcome, solves, after = solved(laws, W, w)
    assert outcome == FOUND and solves > 6 and solved(laws._replace(together=40), W, w)[1] > 40  # for ever
    assert np.all(after.force >= 0) and np.all(after.opening >= -after.force / 20.0 * (1 + 1e-14))
    assert np.array(w) + np.array(W) @ after.force == pytest.approx(after.opening, rel=1e-12)
    for most in (3, 7):  # of them, set at once and one at a time
        assert solved(laws._replace(most=most), W, w)[:2] == (LIMIT, most)


def test_the_states_of_contacts_are_the_digits_of_a_number():
    states = [7] * 6
    rows.set_states(three()[0], states, 3 * 16 + 2, 4, 6)
    assert states == [INSIDE, LOWER, INSIDE, UPPER, INSIDE, LOWER]


def test_equations_are_solved_by_pivots():
    A = np.array([[0.0, 2.0, -3.0], [5.0, 0.0, 1.0], [7.0, -4.0, 0.5]])
    right = np.array([[1.0, 4.0], [2.5, -3.0], [-6.0, 0.7]])
    x = right.copy()
    eliminate(A.copy(), x, np.array([2.0, 0.5, 4.0]), 3, 2)
    assert x == pytest.approx(np.linalg.solve(A, right), rel=1e-13)


def test_a_chain_in_a_band_has_the_solution_of_the_full_matrix():
    """Rows that open beside rows with a strength: z = 0 inside of the bounds, of the sign that each allows beyond."""
    rng = np.random.default_rng(2)
    seen = set()
    for _ in range(30):
        m = int(rng.integers(2, 12))
        opens = rng.integers(0, 2, m)
        strength = rng.uniform(0.1, 1.0, m)
        laws = laws_of(m, m, rng.uniform(0.0, 0.5, m), together=int(rng.integers(1, 7)), opens=opens, slips=True)
        laws = laws._replace(lower=np.where(opens, 0.0, -strength), upper=np.where(opens, math.inf, strength))
        band = np.array([rng.uniform(2.1, 4.0, m), rng.uniform(-1.0, 1.0, m)])
        W = np.diag(band[0]) + np.diag(band[1, :-1], 1) + np.diag(band[1, :-1], -1)
        q = 2 * rng.standard_normal(m)
        full = solved(laws, W, q)
        in_band = solved(laws._replace(banded=True), band, q)
        rounding = 1e-13 * np.max(np.abs(q))
        assert full[0] == in_band[0] == FOUND
        assert np.max(np.abs(np.subtract(full[2], in_band[2]))) < rounding
        state, _, force, slip = full[2]
        z = q + W @ force + laws.compliance * force
        assert np.max(np.abs(z[state == INSIDE]), initial=0.0) < rounding and np.all(z * state <= 0)
        assert slip == pytest.approx(np.where(opens, 0.0, z * (state != INSIDE)), rel=1e-13)
        seen |= {*zip(opens.tolist(), state.tolist(), strict=True)}
    assert seen == {(1, LOWER), (1, INSIDE), (0, LOWER), (0, INSIDE), (0, UPPER)}


@pytest.mark.parametrize("cohesion", [math.inf, 0.3])
def test_two_ways_as_mean_and_difference_give_the_forces_of_both(cohesion):
    """Of contacts that were pressed, and that close at different shares of the step."""
    rng = np.random.default_rng(7)
    for _ in range(40):
        B = np.eye(4) + rng.uniform(-0.3, 0.3, (4, 4))
        B = np.vstack([B, (B[2] + B[3]) / 2, B[3] - B[2]])
        both = B @ B.T
        q = -rng.uniform(0.5, 2.0, 4) * [1, 1, 0.3, -0.5]
        before = rows.rows_of([*rng.choice([0.2, 0.4, -0.1], 2), 0.1, -0.2], [LOWER, INSIDE, INSIDE, INSIDE])
        laws = laws_of(2, 4, rng.uniform(0.01, 0.02, 4), cohesion, friction=np.full(2, 0.3 * (cohesion < 1)))
        plain = solved(laws, both[:4, :4], q, before)
        places = np.ix_([0, 1, 4, 5], [0, 1, 4, 5])
        paired = solved(laws._replace(paired=True), both[:4, :4], q, before, both[places], [q[2:].mean(), q[3] - q[2]])
        assert paired[0] == plain[0] == FOUND
        for part, values in zip(paired[2], plain[2], strict=True):
            assert part == pytest.approx(values, rel=1e-9, abs=1e-12)


def three(**changes):
    """Return three rough contacts that were pressed, and the flexibility of a step."""
    pressed = np.array([1e5] * 3 + [0.0] * 3)
    before = Rows(np.full(6, INSIDE), -pressed / 1e9, pressed, np.zeros(6))
    compliance = np.repeat([1e-9, 2.5e-9], 3)
    return (
        laws_of(3, 6, compliance, 0.0, friction=np.full(3, 0.5))._replace(**changes),
        before,
        1e-9 * (np.eye(6) + 0.1),
    )


GAPS = [-1e-4, -2e-4, 5e-4]


@pytest.mark.parametrize(("way", "cohesion", "state"), [(1e-3, 0.0, LOWER), (-1e-3, 0.0, UPPER), (1e-3, 1e6, INSIDE)])
def test_contacts_stick_slip_and_open_all_at_once_and_one_by_one(way, cohesion, state, monkeypatch):
    laws, before, W = three()
    laws.upper[3:] = cohesion
    outcome, _, after = solved(laws, W, [*GAPS, way, way, way], before)
    normal, shear = np.split(after.force, 2)
    assert outcome == FOUND and after.state.tolist() == [INSIDE, INSIDE, LOWER, state, state, INSIDE]
    limit = (0.5 * normal + cohesion) * (normal > 0)
    assert np.all(np.abs(shear) <= limit * (1 + 1e-12)) and np.all(normal[:2] > 0)
    slips = after.slip[3:5]
    assert np.all(slips * way > 0) if state else np.all(slips == 0)
    moved = np.array([*GAPS, way, way, way]) + W @ after.force
    assert after.opening[:3] == pytest.approx(moved[:3], rel=1e-12)
    assert slips + after.opening[3:5] == pytest.approx(moved[3:5], rel=1e-12)
    monkeypatch.setattr(rows, "TRIED", 1)
    singly = solved(laws._replace(together=1), W, [*GAPS, way, way, way], before)
    assert singly[1] > 1 and singly[2].force == pytest.approx(after.force, rel=1e-12)


def test_a_contact_that_slips_has_the_friction_of_the_solve_before():
    laws, before, W = three(lagged=True)
    q = [*GAPS, 1e-3, 1e-3, 1e-3]
    outcome, solves, after = solved(laws, W, q, before)
    sticking = np.linalg.solve(W + np.diag(laws.compliance), np.negative(q))
    assert (outcome, solves) == (FOUND, 2)
    assert after.force[3:5] == pytest.approx(-0.5 * sticking[:2], rel=1e-12)


def never_agrees(laws, flexible, after, work, r):
    return LOWER if work.tried[r] == INSIDE else INSIDE


def test_what_does_not_end_has_no_state_or_several(monkeypatch):
    laws, before, W = three(together=2)
    problem = laws, W, [*GAPS, 1e-3, 1e-3, 1e-3], before
    monkeypatch.setattr(rows, "across", never_agrees)
    assert solved(*problem)[:2] == (NONE, 2 + 4**3)

    def agrees_twice(laws, flexible, after, work, r):  # where all are open, and where the last one is not
        is_open = work.tried[0] == work.tried[1] == LOWER
        return work.tried[r] if is_open else never_agrees(laws, flexible, after, work, r)

    monkeypatch.setattr(rows, "across", agrees_twice)
    assert solved(*problem)[:2] == (SEVERAL, 2 + 4**3)
    monkeypatch.setattr(rows, "TRIED", 1)  # of many contacts not all states are tried: they come back
    monkeypatch.setattr(rows, "across", never_agrees)
    assert solved(*problem)[0] == NONE
