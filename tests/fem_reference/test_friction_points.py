"""The law of points that slide, in steps of random small problems against all sets of states, and in its edges."""

from itertools import product

import numpy as np
import pytest
from oracles.contact_points import PointStep

from fem_reference.contact.law import crossed


def random_step(rng, n, tangent=None):
    """A base of n points with friction in one step, in unlike units."""
    shape = rng.standard_normal((2 * n, 2 * n)) * 10.0 ** rng.uniform(-6, -3, 2 * n)[:, None]
    C = shape @ shape.T
    states = rng.choice([0, 1, 2, -2], n).astype(np.int8)
    k_t = 1 / np.diag(C)[n:] * 10.0 ** rng.uniform(-2, 2, n)
    compliance = np.diag(C)[:n] * 10.0 ** rng.uniform(-3, 1, n)
    force = 1e-3 / np.diag(C)[:n]
    cohesion = np.where(rng.random(n) < 0.5, 0.0, rng.random(n) * force)
    tangent = rng.uniform(0, 1.5) if tangent is None else tangent
    before = np.where(states != 0, -1.0, 1.0) * rng.random(n) * 1e-3
    free = rng.standard_normal((2, n)) * 1e-3
    return PointStep(C, compliance, k_t, free.ravel(), before, states, tangent, cohesion)


def holding(step):
    """Forces (N, T) of all sets of states that hold, each contact once."""
    kept = []
    for choice in product((0, 1, 2, -2), repeat=len(step.closed)):
        states = np.array(choice, dtype=np.int8)
        trial = step.forces(states)
        if trial.settled and np.array_equal(step.asked(trial, states), states):
            kept.append(np.concatenate([trial.normal, trial.shear]))
    return kept


@pytest.mark.parametrize(
    ("force", "gap", "share"), [(2.0, 2e-3, 0.5), (2.0, 0.0, 1.0), (-1.0, 1e-3, 0.0), (0.0, 0.0, 1.0)]
)
def test_the_share_of_a_step_for_which_a_point_is_closed(force, gap, share):
    """Of a straight way from the gap to the depth; one that neither moves nor presses counts as closed throughout."""
    assert crossed(force, gap, 1e-3) == share


def test_few_points_try_all_states():
    rng = np.random.default_rng(4)
    outcomes = set()
    for _ in range(40):
        step = random_step(rng, 2, 5.0)
        found = step.contact(1)
        if found.solves == 1:
            continue
        sets = holding(step)
        outcomes.add(found.failure)
        assert found.solves == 2
        if len(sets) == 1:
            assert np.allclose(np.concatenate([found.trial.normal, found.trial.shear]), sets[0], rtol=1e-12)
        else:
            assert found.failure == ("several" if sets else "none")
    assert outcomes == {"", "none", "several"}


def test_a_point_without_forces_is_one_contact_however_its_state_is_called():
    """Beside a point that closes one that touches its base without a force: open, held or sliding, it is the same."""
    free, gap, states = np.array([-1e-6, 0.0, 0.0, 0.0]), np.array([1e-6, 0.0]), np.array([0, 1], dtype=np.int8)
    step = PointStep(np.eye(4) * 1e-9, np.full(2, 1e-9), np.full(2, 1e9), free, gap, states, 0.5)
    assert len(holding(step)) > 1
    found = step.contact(1)
    assert (found.failure, found.solves) == ("", 2)
    assert found.trial.normal == pytest.approx([500.0, 0.0])


def test_a_point_that_turns_is_held_first():
    """On a body softer than the shear spring either direction asks for the other one; held, the point is at rest."""
    for before in (2, -2):
        states = np.full(1, before, dtype=np.int8)
        free, gap = np.array([-2e-6, 0.0]), np.full(1, -1e-6)
        found = PointStep(np.diag([1e-9, 1e-8]), np.full(1, 1e-9), np.full(1, 1e9), free, gap, states, 0.5).contact()
        assert (found.solves, found.states[0], found.trial.shear[0]) == (2, 1, 0.0)


@pytest.mark.parametrize("before", [(0, 0), (0, 1)])
def test_the_reference_of_a_point_that_closes_lies_where_it_crosses(before):
    """Two points on one body: the shear springs count with the share of the step in which the points are closed."""
    C = 1e-9 * np.array([[3.0, 0.4, 0.2, -0.3], [0.4, 2.0, 0.1, 0.5], [0.2, 0.1, 4.0, 0.7], [-0.3, 0.5, 0.7, 5.0]])
    compliance, shear = np.array([2e-9, 3e-9]), np.array([6e8, 9e8])
    free, gap = np.array([-5e-6, -4e-6, 7e-6, -3e-6]), np.array([3e-6, 0.0 if before[1] else 1e-6])
    step = PointStep(C, compliance, shear, free, gap, np.array(before, dtype=np.int8))
    found = step.contact()
    N, T = found.trial.normal, found.trial.shear
    force = np.concatenate([N, T])
    assert found.states.tolist() == [1, 1] and found.trial.settled
    assert found.trial.gap == pytest.approx(-compliance * N, rel=1e-11)
    shares = -found.trial.gap / (gap - found.trial.gap)
    shares[np.array(before) == 1] = 1.0
    assert 0.2 < shares[0] < 0.8
    assert T / shear == pytest.approx(-shares * (free + C @ force)[2:], rel=1e-10)
