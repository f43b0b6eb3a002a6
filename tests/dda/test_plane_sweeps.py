"""Sweeps of many contacts, each solved for alone: the states and forces of the solves that follow them."""

import numpy as np
import pytest
from oracles.plane_scenes import CONSTANT, moved, scheme, slope

from dda import solve_plane
from dda.contact.rows import INSIDE, LOWER, UPPER
from dda.march.step import steps_by
from dda.plane import many, solution, step


def test_sweeps_end_in_the_states_and_forces_of_the_solution(monkeypatch):
    find, sweep = many.find_many, many.sweep
    swept = []
    seen = set(), set()

    def sweep_long(matrices, laws, length, after, work, sweeps):
        sweep(matrices, laws, length, after, work, 60)
        swept.append((np.array(after.force), np.array(work.tried)))

    def find_and_compare(matrices, laws, before, length, after, work, again):
        swept.clear()
        outcome = find(matrices, laws, before, length, after, work, again)
        n = laws.contacts
        states = np.array(after.state)
        closes = (np.array(before.state) != INSIDE) & (states == INSIDE)  # for a share of the step
        if swept and not closes[:n].any():
            assert np.array_equal(swept[-1][1], states)
            assert swept[-1][0] == pytest.approx(np.array(after.force), abs=1e-7 * max(after.force))
            seen[0].update(states[:n].tolist())
            seen[1].update(states[n : 2 * n].tolist())
        return outcome

    monkeypatch.setattr(solution, "DENSE", 0)
    monkeypatch.setattr(many, "TOGETHER", 1)
    monkeypatch.setattr(many, "sweep", sweep_long)
    monkeypatch.setattr(step, "find_many", find_and_compare)
    monkeypatch.setattr(solution, "make_steps", steps_by(step.make_stage, step.account, step.keep, step.keep_rows))
    for side in (1.0, -1.0):
        model = moved(slope(0.3, 0.6), np.diag([side, 1.0]), np.zeros(2))
        result = solve_plane(model, scheme(CONSTANT, 1e-3), 8, compiled=False)
        assert result.outcome == "completed"
    assert seen == ({INSIDE, LOWER}, {INSIDE, LOWER, UPPER})
