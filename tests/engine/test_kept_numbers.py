"""Rows, windows and comparisons: each number is of its own case, steps and static value."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.made_cases import made_history, made_row

from validation.engine import measure
from validation.engine.case import Case
from validation.engine.horizon import shadow
from validation.engine.run import finish, run_study
from validation.engine.study import Study
from validation.errors import InputError
from validation.runs.results import Results
from validation.runs.run import Outcome, Run
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver

# ---- rows ---------------------------------------------------------------------------------------------------------


def test_a_kept_row_that_another_case_brings_has_the_names_of_this_one(scene, tmp_path):
    """Without savings the solver dda is what is called dda:full, and its row is of the same key."""
    alike = scene.model_copy(update={"name": "alike"})
    first, second = (Study(name, "t", "p", [scene], ("dda",)) for name in ("first", "second"))
    finish([Case(scene, "dda", without_savings=True)], first, Results(tmp_path))
    (row,) = finish([Case(alike, "dda:full")], second, Results(tmp_path)).rows.values()
    assert len(Results(tmp_path).rows()) == 1
    assert (row.scene, row.solver, row.study) == ("alike", "dda:full", "second")


# ---- between the steps --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("values", [{"time.gg": 0.9}, {"time.gg_rate": 30.0}], ids=str)
def test_an_exact_motion_is_kept_between_its_steps_and_passes_through_them(values, tmp_path, monkeypatch):
    """At 10 ms for 0.07 s the first mode turns four times; a discount per step must not become one per instant."""
    scene = load_scene("figures-3-4").with_values({"time.step": 0.01, "time.steps": 7} | values)
    results = Results(tmp_path)
    run_study(Study("s", "S", "", [scene], ("dda", "continuum")), results)
    kept = {row.solver: results.history(key) for key, row in results.rows().items()}
    exact = kept["continuum"]
    assert kept["dda"].between is None and len(exact.time) == 7
    parts = measure.INSTANTS_OF_STEP
    np.testing.assert_allclose(exact.between.time[parts - 1 :: parts], exact.time, rtol=1e-12)
    for name, column in exact.columns.items():
        scale = np.abs(column).max()
        # rounding: of the instants, and of a root of gg that is raised to its power again
        np.testing.assert_allclose(exact.between.columns[name][parts - 1 :: parts], column, atol=1e-11 * scale)
    monkeypatch.setattr(measure, "INSTANTS", 15)
    assert len(measure.execute(Case(scene, "continuum"), "", "s")[1].between.time) == 14
    assert exact.until(0.05).between.time[-1] == pytest.approx(0.05)


def test_a_shadow_is_the_motion_in_other_digits():
    scene = load_scene("figures-3-4").expand()[0].with_values({"time.step": 0.01, "time.steps": 7})
    solver = get_solver("dda")
    motion, other = (h.columns["displacement"] for h in (solver.solve(scene).history, shadow(solver, scene, False)))
    assert other == pytest.approx(motion, rel=1e-9) and np.all(other != motion)


def test_seconds_are_the_least_of_a_run_and_their_spread(monkeypatch):
    clocks = {"process_time": [0.0, 5.0, 10.0, 13.0], "perf_counter": [0.0, 5.0, 10.0, 14.0]}
    ticking = {name: iter(instants).__next__ for name, instants in clocks.items()}
    monkeypatch.setattr(measure, "time", SimpleNamespace(**ticking))
    run = Run(Outcome.COMPLETED, seconds={"stepping": 1.0})
    solver = SimpleNamespace(solve=lambda scene, full: run)
    least, spread = measure.timed(run, solver, SimpleNamespace(scene=None, full=False, repeats=2))
    assert least.seconds == {"setup": 2.25, "stepping": 0.75} and spread == 2.0


def test_damage_between_the_steps_is_refused(tmp_path):
    results = Results(tmp_path)
    history = made_history(0.1, [1.0, 2.0])
    broken = replace(history, between=made_history(0.05, [1.0, np.nan, 2.0, 3.0]))
    results.append(made_row("continuum"), broken)
    with pytest.raises(InputError, match=r"between .* displacement"):
        results.history("s continuum")
