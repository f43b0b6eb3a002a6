"""Contact forces that do the work of their springs: of one contact, of two, and of a block."""

from types import SimpleNamespace

import numpy as np
import pytest

from dda.contact.conserving import conserving
from dda.contact.rows import FOUND, INSIDE, LOWER, NONE, Flexibility, rows_of, work_for


def after_step(p, gaps, free, W):
    """Return outcome, solves, gaps and states at the end of the step, and the forces over it."""
    n = len(gaps)
    before = rows_of(gaps, np.where(np.array(gaps) < 0, INSIDE, LOWER))
    after = rows_of(gaps, before.state)
    work = work_for(n, n)
    work.q[:] = free
    law = SimpleNamespace(compliance=np.full(n, 1 / p))
    outcome, solves = conserving(law, before, Flexibility(np.array(W), W, np.ones(1)), after, work)
    return outcome, solves, after, work.mean


def check_work(p, w0, w_f, W, digits):
    """Every force does the work of its spring, and moves the gaps by the flexibility."""
    outcome, solves, after, N = after_step(p, w0, w_f, W)
    w1 = after.opening
    before, end = (p * np.minimum(w, 0.0) ** 2 / 2 for w in (np.array(w0), w1))
    given = before - end
    assert outcome == FOUND and np.all(N >= 0) and np.array_equal(after.state, np.where(w1 < 0, INSIDE, LOWER))
    assert after.force == pytest.approx(p * np.maximum(-w1, 0.0), rel=1e-15)
    assert np.all(np.abs(N * (w1 - w0) - given) <= 1e-9 * np.abs(given) + digits * (before + end + digits))
    moved = np.matmul(W, N)
    assert np.all(np.abs(w1 - w_f - moved) <= digits * (np.abs(w1) + np.abs(w_f) + np.abs(moved)))
    return solves


def test_two_contacts_do_the_work_of_their_springs_and_say_if_they_do_not_end(monkeypatch):
    rng = np.random.default_rng(3)
    solves = []
    for _ in range(100):
        p = 10 ** rng.uniform(-2, 4)
        coupling = rng.uniform(-0.99, 0.99)
        W = [[1.0, coupling], [coupling, 1.0]]
        solves.append(check_work(p, rng.uniform(-1, 1, 2) / max(p, 1.0), rng.uniform(-1, 1, 2), W, 1e-9))
    assert np.mean(solves) < 4  # by Newton's method
    monkeypatch.setattr("dda.contact.conserving.ROUNDS", 1)
    assert after_step(1.0, [-1.0, -1.0], [-1.0, -1.0], W)[0] == NONE


@pytest.mark.parametrize(("w0", "w_f"), [(-1e-170, 1.0), (0.0, -5e-324), (-1e-300, -1e-300), (0.0, 0.0)])
def test_contacts_that_hardly_touch_have_a_force(w0, w_f):
    _, _, after, mean = after_step(1e9, [w0], [w_f], [[0.8]])
    assert 0 <= mean[0] <= 1e-280 and abs(after.opening[0] - max(w_f, 0.0)) < 1e-280
