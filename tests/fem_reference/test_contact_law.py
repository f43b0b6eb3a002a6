"""The contact forces of one step: what rows obey, in random small problems and in their edges."""

from itertools import product

import numpy as np
import pytest

from fem_reference.contact import iteration
from fem_reference.contact.iteration import CONVERGED, NONE, SEVERAL, find_contact
from fem_reference.contact.law import AT_LOWER, AT_UPPER, INSIDE, Law, agreed, equations_of, solution

POINT = [(AT_LOWER, INSIDE), (INSIDE, INSIDE), (INSIDE, AT_LOWER), (INSIDE, AT_UPPER)]  # across and along


def law_of(W, compliance, pairs, tangent=0.0, cohesion=np.inf, limit=6):
    """Points that open, each with a row along the base if they are pairs."""
    row = np.arange(len(W))
    points = len(W) // 2 if pairs else len(W)
    slips = row >= points
    strength = np.where(slips, cohesion, 0.0)
    upper = np.where(slips, cohesion, np.inf)
    single = 4 * points if np.isfinite(cohesion).all() else 100 * points
    return Law(W, compliance, -strength, upper, tangent * slips, row % points, slips, limit, single)


def found(law, q, gap, states, fallback=iteration.fall_back):
    return find_contact(law, equations_of(law, states, np.ones(len(q))), q, gap, states, fallback)


def obeys(law, q, gap, states, force):
    """Assert what every row obeys of the forces of a step, without the equations that gave them."""
    place = q + law.W @ force
    size = law.compliance * np.abs(force) + np.abs(q) + np.abs(law.W) @ np.abs(force)
    for row, partner in enumerate(law.partner):
        off = 1e-7 * size[row]
        stretch = place[row] + law.compliance[row] * force[row]
        if not law.slips[row]:
            assert force[row] >= 0 and abs(stretch if force[row] > 0 else min(place[row], 0.0)) <= off
            continue
        pressing = force[partner]
        if pressing == 0:
            assert force[row] == 0
            continue
        depth = pressing * law.compliance[partner]
        phi = depth / (depth + gap[partner]) if states[partner] == AT_LOWER else 1.0
        slip = phi * place[row] + law.compliance[row] * force[row]
        limit = law.friction[row] * pressing + law.upper[row]
        assert abs(force[row]) <= limit * (1 + 1e-9)
        assert abs(slip) <= off or (abs(force[row]) >= limit * (1 - 1e-9) and slip * force[row] <= off * limit)


def consistent(law, q, gap, states):
    """Forces of all sets of states that ask for themselves."""
    kept = []
    for points in product(POINT, repeat=len(q) // 2):
        guess = np.array(points, dtype=np.int8).T.ravel()
        trial = solution(law, equations_of(law, guess, np.ones(len(q))), q, gap, states, guess)
        if trial.settled and agreed(law, trial, gap, states, guess)[1] < 0:
            kept.append(trial.force)
    return kept


def random_step(rng, n, pairs):
    """Flexibilities and compliances in unlike units, and what there is without forces."""
    rows = 2 * n if pairs else n
    shape = rng.standard_normal((rows, rows)) * 10.0 ** rng.uniform(-6, -3, rows)[:, None]
    W = shape @ shape.T
    compliance = np.diag(W) * 10.0 ** rng.uniform(-3, 1, rows)
    return W, compliance, rng.standard_normal(rows) * 1e-3


def test_points_without_friction_solve_the_complementarity_problem():
    rng = np.random.default_rng(2)
    singly = 0
    for n in (1, 2, 3, 5, 12) * 8:
        W, compliance, q = random_step(rng, n, pairs=False)
        law = law_of(W, compliance, pairs=False, limit=1)
        states = rng.choice([AT_LOWER, INSIDE], n).astype(np.int8)
        trial, _, solves, outcome = found(law, q, np.zeros(n), states)
        assert outcome == CONVERGED and solves in (1, 2)
        singly += solves == 2
        obeys(law, q, np.zeros(n), states, trial.force)
    assert singly > 20


def test_points_that_may_slide_have_the_one_set_of_states_that_holds():
    """Or are told to have none or several; what is found obeys the law."""
    rng = np.random.default_rng(4)
    outcomes = []
    for limit in (1, 6) * 30:
        W, compliance, q = random_step(rng, 2, pairs=True)
        cohesion = np.tile(rng.choice([0.0, 1.0]) * rng.random(2) * 1e-3 / np.diag(W)[:2], 2)
        law = law_of(W, compliance, True, 5.0 if limit == 1 else rng.uniform(0, 1.5), cohesion, limit)
        states = np.array([POINT[k] for k in rng.integers(4, size=2)], dtype=np.int8).T.ravel()
        gap = np.append(rng.random(2) * np.where(states[:2] == INSIDE, -1e-3, 1e-3), np.zeros(2))
        trial, _, solves, outcome = found(law, q, gap, states)
        if solves > limit:
            sets = consistent(law, q, gap, states)
            assert outcome == [NONE, CONVERGED, SEVERAL][min(len(sets), 2)] and solves == limit + 1
            outcomes.append(outcome)
        if outcome == CONVERGED:
            obeys(law, q, gap, states, trial.force)
    assert set(outcomes) == {CONVERGED, NONE, SEVERAL}


def test_as_many_sets_of_states_are_tried_as_is_allowed(monkeypatch):
    monkeypatch.setattr(iteration, "ENUMERATED", 16)
    for cohesion, points, solves in ((np.inf, 4, 7), (np.inf, 5, 6), (1e3, 2, 7), (1e3, 3, 12)):
        law = law_of(np.eye(2 * points) * 1e-9, np.full(2 * points, 3e-9), True, 0.5, cohesion)
        q = np.tile(-7e-6 * np.arange(1.0, points + 1), 2)
        states = np.full(2 * points, AT_LOWER, dtype=np.int8)
        trial = solution(law, equations_of(law, states, np.ones(2 * points)), q, q, states, states)
        assert iteration.fall_back(law, trial, q, q, states, states)[2] == solves, (cohesion, points)


def test_edges_of_a_point_or_two():
    """States before, W, q, gap, law; then the forces, states and solves."""
    soft = np.diag([1e-9, 1e-8])
    four = np.eye(4) * 1e-9
    rows = [
        # without force and gap it keeps its state
        ([AT_LOWER], np.eye(1), [0.0], [0.0], (1.0, False), ([0.0], [AT_LOWER], 1)),
        ([INSIDE], np.eye(1), [0.0], [0.0], (1.0, False), ([0.0], [INSIDE], 1)),
        # on a body softer than the shear spring either direction asks for the other one; held, it is at rest
        *(
            (
                *([INSIDE, side], soft, [-2e-6, 0.0], [-1e-6, 0.0], (1e-9, True, 0.5, 0.0)),
                ([1e3, 0.0], [INSIDE, INSIDE], 2),
            )
            for side in (AT_LOWER, AT_UPPER)
        ),
        # beside a point that closes one that touches without a force: open, held or sliding, it is one contact
        (
            *([AT_LOWER, INSIDE, INSIDE, INSIDE], four, [-1e-6, 0.0, 0.0, 0.0], [1e-6, 0.0, 0.0, 0.0]),
            *((1e-9, True, 0.5, 0.0, 1), ([500.0, 0.0, 0.0, 0.0], None, 2)),
        ),
    ]
    for states, W, q, gap, (compliance, *law), (force, after, solves) in rows:
        before = np.array(states, dtype=np.int8)
        rule = law_of(W, np.full(len(q), compliance), *law)
        trial, names, number, outcome = found(rule, np.array(q), np.array(gap), before)
        assert (number, outcome) == (solves, CONVERGED), states
        assert trial.force == pytest.approx(force, abs=1e-9), states
        assert after is None or names.tolist() == after, states
    # T = -N on a body that turns it into as much gap: the equations of that state are singular, and nothing asks for it
    rule = law_of(np.array([[1.0, 2.0], [2.0, 8.0]]), np.ones(2), True, 1.0, 0.0)
    turning = np.array([INSIDE, AT_UPPER], dtype=np.int8)
    lost = equations_of(rule, turning * np.int8(-1), np.ones(2))
    assert np.isnan(lost.inverse).all()
    trial, _, _, outcome = found(rule, np.array([-1.0, 0.0]), np.array([-1.0, 0.0]), turning)
    assert outcome != CONVERGED or np.isfinite(trial.force).all()
