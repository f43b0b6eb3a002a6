"""The cause of a failure: named where it is certain, silent elsewhere."""

import numpy as np
import pytest

from validation.gates.gate import Status
from validation.problems import cause as module
from validation.problems.bands import standard
from validation.problems.cause import NOT_EXPLAINED, cause
from validation.problems.judge import judge
from validation.problems.problem import problem
from validation.runs.history import History
from validation.solvers.registry import get_solver


@pytest.fixture(autouse=True)
def without_compare(monkeypatch):
    """Leave out what takes tens of seconds where nothing explains a history."""
    monkeypatch.setattr(module, "compared", lambda scene, history: None)


def test_ddas_habit_and_another_integrator():
    asked = problem("locked")
    time = asked.scene.time
    held = standard(asked)
    usual = get_solver("dda").solve(asked.scene).history
    assert judge(asked, usual, held).status is Status.FAIL
    habit = cause(asked, usual, held)
    assert (habit.ids, habit.values["alpha"]) == (("scheme",), 0.5)
    times = round(time.step / habit.passing_step)
    finer = {"time.step": time.step / times, "time.steps": time.steps * times}
    found = get_solver("dda").solve(asked.scene.with_values(finer)).history
    rows = slice(times - 1, None, times)
    passing = History(found.time[rows], {name: x[rows] for name, x in found.columns.items()})
    assert judge(asked, passing).status is Status.PASS


@pytest.mark.long
def test_no_cause_of_a_random_history_is_wrong():
    """Two wrong things at once, or noise: no single one may be named, of eight."""
    name = "opening"
    exact = standard(problem(name)).exact
    rng = np.random.default_rng(7)
    for _ in range(8):
        wobble = 1 + 0.2 * rng.standard_normal() * np.sin(rng.uniform(0.3, 2.0) * np.arange(len(exact.time)))
        noise = 0.2 * rng.standard_normal()
        seen = {}
        for key, x in exact.columns.items():
            seen[key] = wobble * x + noise * np.abs(x).max() * rng.standard_normal(len(x))
        found = History(exact.time, seen)
        if judge(problem(name), found).status is Status.FAIL:
            assert cause(problem(name), found, standard(problem(name))).sentence.startswith(NOT_EXPLAINED)
