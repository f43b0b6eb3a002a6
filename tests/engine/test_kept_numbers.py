"""Rows, windows and comparisons: each number is of its own case, steps and static value."""

import sys
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from faults import seams
from oracles.made_cases import made_history, made_row

from validation.engine import measure, origin
from validation.engine.case import Case
from validation.engine.run import finish, run_study
from validation.engine.study import Study
from validation.errors import InputError
from validation.metrics.catalogue import solo
from validation.metrics.measurable import Measurable
from validation.runs import provenance
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver

# ---- metrics of one run -------------------------------------------------------------------------------------------


def test_measures_of_stability_are_the_solvers_diagnostics_of_their_name():
    names = ("predicted_radius", "spectral_radius", "condition_number", "scaled_residual", "largest_omega")
    told = dict(zip(names, (0.91, 0.92, 3e5, 4e-16, 5.5), strict=True))
    found = solo(Measurable(made_history(0.1, np.ones(3)), 0.1, diagnostics=told), ("stability",))
    assert found == {
        "stability.radius": 0.91,
        "stability.radius_seen": 0.92,
        "stability.condition": 3e5,
        "stability.residual": 4e-16,
        "stability.omega": 5.5,
        "stability.growth": "undefined",
        "stability.kind": "stable",
    }


# ---- provenance ---------------------------------------------------------------------------------------------------


def test_provenance_names_this_interpreter_these_packages_and_this_commit(monkeypatch):
    import platform

    import scipy

    seams.COMMIT.put(monkeypatch, lambda: "the commit")
    seams.PROCESSOR.put(monkeypatch, lambda: "the processor")
    found = provenance.provenance()
    assert found["python"] == platform.python_version()
    assert (found["packages"]["numpy"], found["packages"]["scipy"]) == (np.__version__, scipy.__version__)
    assert (found["commit"], found["processor"]) == ("the commit", "the processor")


# ---- rows ---------------------------------------------------------------------------------------------------------


def test_what_differs_between_rows_is_told_with_the_number_of_each():
    rows = [made_row("dda", provenance={"commit": commit}) for commit in ("then", "now", "then")]
    assert origin.of_rows(rows)["commit"] == "then (2 rows); now (1 row)"
    assert origin.of_rows(rows[1:2])["commit"] == "now"


def test_lines_of_python_are_counted_and_a_tracer_goes_on(monkeypatch):
    def loop(count):
        for _ in range(count):
            pass

    before = sys.gettrace()
    few, many = (measure.lines_of(partial(loop, count)) for count in (10, 110))
    assert many - few == 200 and sys.gettrace() is before
    run = partial(get_solver("dda").solve, load_scene("figure-8").expand()[0])
    run()
    assert measure.lines_of(run) == measure.lines_of(run)


def test_a_kept_row_that_another_case_brings_has_the_names_of_this_one(scene, tmp_path):
    """Without savings the solver dda is what is called dda:full, and its row is of the same key."""
    alike = scene.model_copy(update={"name": "alike"})
    first, second = (Study(name, "t", "p", [scene], ("dda",)) for name in ("first", "second"))
    finish([Case(scene, "dda", without_savings=True)], first, Results(tmp_path))
    (row,) = finish([Case(alike, "dda:full")], second, Results(tmp_path)).rows.values()
    assert len(Results(tmp_path).rows()) == 1
    assert (row.scene, row.solver, row.study) == ("alike", "dda:full", "second")


# ---- between the steps --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("values", [{}, {"time.gg": 0.9}, {"time.gg_rate": 30.0}], ids=str)
def test_an_exact_motion_is_kept_between_its_steps_and_passes_through_them(values, tmp_path):
    """At 10 ms for 0.2 s the first mode turns eleven times; a discount per step must not become one per instant."""
    scene = load_scene("figures-3-4").with_values({"time.step": 0.01, "time.steps": 20} | values)
    results = Results(tmp_path)
    run_study(Study("s", "S", "", [scene], ("dda", "continuum")), results)
    kept = {row.solver: results.history(key) for key, row in results.rows().items()}
    exact = kept["continuum"]
    assert kept["dda"].between is None and len(exact.time) == 20
    parts = measure.INSTANTS_OF_STEP
    np.testing.assert_allclose(exact.between.time[parts - 1 :: parts], exact.time, rtol=1e-12)
    for name, column in exact.columns.items():
        scale = np.abs(column).max()
        # rounding: of the instants, and of a root of gg that is raised to its power again
        np.testing.assert_allclose(exact.between.columns[name][parts - 1 :: parts], column, atol=1e-11 * scale)
    assert exact.until(0.05).between.time[-1] == pytest.approx(0.05)


def test_damage_between_the_steps_is_refused(tmp_path):
    results = Results(tmp_path)
    history = made_history(0.1, [1.0, 2.0])
    broken = replace(history, between=made_history(0.05, [1.0, np.nan, 2.0, 3.0]))
    results.append(made_row("continuum"), broken)
    with pytest.raises(InputError, match="between the steps: displacement must hold one finite number a step"):
        results.history("s continuum")
