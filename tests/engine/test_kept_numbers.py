"""Rows, windows and comparisons: each number is of its own case, steps and static value."""

from __future__ import annotations

import gc
import math
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from faults import seams
from oracles.made_cases import made_history, made_row

from validation.engine import measure, origin
from validation.engine.case import Case
from validation.engine.finished import Finished
from validation.engine.judge import compare, evaluate
from validation.engine.run import finish, run_study
from validation.engine.study import Study
from validation.errors import InputError
from validation.gates.gate import Gate, judge
from validation.metrics import growth
from validation.metrics import poles as pencil
from validation.metrics.catalogue import pair, solo
from validation.metrics.measurable import Measurable
from validation.runs import provenance
from validation.runs.history import History
from validation.runs.modes import Mode
from validation.runs.results import Results
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene, load_scene
from validation.solvers.registry import get_solver

# ---- windows ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("step", "window", "count"), [(0.002, 0.2, 100), (1e-3, 0.3, 300), (1e-5, 0.07, 7000)])
def test_a_window_holds_the_step_that_ends_with_it(step: float, window: float, count: int) -> None:
    """The times are sums of rounded steps, some a rounding beyond the window's end."""
    time = np.cumsum(np.full(2 * count, step))
    history = History(time, {"displacement": np.arange(2.0 * count)})
    kept = history.until(window)
    assert (len(kept.time), len(kept.displacement), kept.displacement[-1]) == (count, count, count - 1)
    assert len(history.until(window - step / 2).time) == count - 1
    assert len(history.until(window + step / 2).time) == count


def finished(tmp_path: Path, rows: dict[str, tuple[dict[str, Any], History]]) -> Finished:
    results, kept = Results(tmp_path), {}
    for solver, (found, history) in rows.items():
        row = made_row(solver, found)
        results.append(row, history)
        kept["s", solver] = row
    return Finished(kept, results)


def gate(metric: str, until: float | None = None, pair: tuple[str, ...] = ("dda", "bar")) -> Gate:
    return Gate("s", pair, metric, -1e9, 1e9, "a test", until=until)


def test_a_gates_window_counts_every_step_up_to_its_end_and_none_beyond(tmp_path: Path) -> None:
    """From step 3 on DDA is off by so much that a step more or less shows."""
    error = np.array([0.0, 1.0, 2.0, 4.0, 8.0])
    made = finished(tmp_path, {"dda": ({}, made_history(0.1, 10 + error, 20 + 2 * error)),
                               "bar": ({}, made_history(0.1, np.full(5, 10.0), np.full(5, 20.0)))})  # fmt: skip
    for until, last in ((0.3, 3), (0.4, 4), (None, 5)):
        squares = float(np.sum(error[:last] ** 2))
        for metric in ("displacement.l2", "pressure.l2"):
            value = evaluate(gate(metric, until), made).value
            assert value == pytest.approx(math.sqrt(squares / (100 * last)), rel=1e-12)
        assert evaluate(gate("displacement.max", until), made).value == pytest.approx(error[last - 1] / 10)


# ---- comparisons --------------------------------------------------------------------------------------------------

STATICS = {  # an error of 0.5 beside a reference of 2 at most
    "dda": ({"displacement.static": 10.0, "pressure.static": 25.0}, made_history(0.1, [0.5, 2.5], [0.0, 2.5])),
    "bar": ({"displacement.static": 4.0, "pressure.static": 5.0}, made_history(0.1, [0.0, 2.0], [0.5, 2.0])),
}


def test_a_scaled_error_is_over_the_runs_own_static_value(tmp_path: Path) -> None:
    made = finished(tmp_path, STATICS)
    assert evaluate(gate("displacement.scaled"), made).value == pytest.approx(0.05)
    assert evaluate(gate("pressure.scaled"), made).value == pytest.approx(0.02)
    (found,) = compare(made)
    assert (found["solver"], found["reference"], found["window"]) == ("dda", "bar", pytest.approx(0.2))
    values = found["metrics"]
    assert (values["displacement.scaled"], values["pressure.scaled"]) == (0.05, 0.02)
    assert values["displacement.max"] == values["worst.max"] == 0.25
    assert values["displacement.l2"] == pytest.approx(math.sqrt(0.5) / 2, rel=1e-5)


def test_a_scaled_error_is_over_the_references_maximum_where_that_is_larger() -> None:
    run, reference = made_history(0.1, [0.5, 8.0]), made_history(0.1, [0.0, 2.0])
    assert pair("displacement.scaled", run, reference, {"displacement.static": -0.1}) == 3.0
    assert pair("displacement.scaled", run, reference, {"displacement.static": -12.0}) == 0.5


def test_histories_of_unequal_length_are_compared_on_all_their_common_steps() -> None:
    short, long = made_history(0.1, [1.0, 3.0]), made_history(0.1, [1.0, 2.0, 9.0])
    assert pair("displacement.max", short, long) == 0.5
    assert pair("displacement.max", long, short) == pytest.approx(1 / 3)


def test_a_metric_of_one_run_is_compared_as_a_ratio_to_the_reference(tmp_path: Path) -> None:
    made = finished(tmp_path, STATICS)
    assert evaluate(gate("displacement.static"), made).value == pytest.approx(1.5)
    assert evaluate(gate("displacement.static", pair=("bar",)), made).value == 4.0


# ---- metrics of one run -------------------------------------------------------------------------------------------


def test_each_metric_of_a_history_is_its_own() -> None:
    v = -0.01 * np.array([0.5, 1.2, 1.6, 1.4, 0.7, 0.9, 1.05, 1.005, 0.9995, 1.00005])
    p = 5e6 * np.array([-0.2, -0.5, -0.1, 0.4, 1.7, 1.3, 0.995, 1.0005, 1.00005, 1.0])
    roots = (-0.3 + 0j, -0.9 + 0j)
    modes = (
        Mode(300.0, 1.0, (0.5 + 0.4j, 0.5 - 0.4j), 0.9),
        Mode(900.0, 0.0, (0.1 + 0.2j, 0.1 - 0.2j), 0.1),
        Mode(2000.0, 0.0, roots, -0.4),
    )
    static = {"displacement": -0.01, "contact_pressure": 5e6}
    found = solo(Measurable(made_history(0.002, v, p), 0.002, static, modes))
    expected = {
        "displacement.static": -0.01,
        "displacement.final": -0.01 * 1.00005,
        "displacement.minimum": -0.016,
        "displacement.peak": -0.016,
        "displacement.peak_time": 0.006,
        "displacement.settling_step": 8.0,
        "displacement.fine_settling_step": 10.0,
        "pressure.static": 5e6,
        "pressure.final": 5e6,
        "pressure.minimum": -2.5e6,
        "pressure.minimum_time": 0.004,
        "pressure.tension_time": 0.006,
        "pressure.peak": 8.5e6,
        "pressure.peak_time": 0.01,
        "pressure.settling_step": 7.0,
        "pressure.fine_settling_step": 9.0,
        "mode1.frequency": 300.0,
        "mode1.spectral_radius": math.hypot(0.5, 0.4),
        "contact.frequency": 2000.0,  # the mode that carries most of the contact pressure, of those after the first
        "contact.spectral_radius": 0.9,
        "contact.least_root": -0.9,
        "contact.damping": "undefined",
    }
    assert {name: found[name] for name in expected} == {
        name: value if isinstance(value, str) else pytest.approx(value) for name, value in expected.items()
    }


@pytest.mark.parametrize(("size", "count"), [(0.3, 400), (0.06, 1200)])
def test_long_histories_are_thinned_without_changing_frequency_or_damping(size: float, count: int) -> None:
    xi, step = 0.02, 1e-3
    n = np.arange(1, count + 1)
    signal = 3 * np.exp(-xi * size * n) * np.cos(math.sqrt(1 - xi**2) * size * n) + np.exp(-0.05 * size * n) * np.cos(
        2.5 * size * n
    )
    strongest = pencil.poles(signal, step)[0]
    assert strongest.frequency == pytest.approx(size / step, rel=1e-6)
    assert strongest.damping == pytest.approx(xi, rel=1e-6)


def test_a_signal_that_its_poles_do_not_give_back_has_none() -> None:
    n = np.arange(1, 120)
    noise = 1e-3 * np.random.default_rng(5).standard_normal(n.size)
    assert pencil.poles(np.cos(0.3 * n), 1.0) and pencil.poles(np.cos(0.3 * n) + noise, 1.0) == []


def test_measures_of_stability_are_the_solvers_diagnostics_of_their_name() -> None:
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


def test_the_drift_is_that_of_the_energy_the_square_of_the_amplitude() -> None:
    n = np.arange(1, 2 * growth.WINDOW + 1)
    shape = 1 + np.where(n <= growth.WINDOW, 0.5, 0.6) * np.cos(0.3 * n + 0.7)
    turning = Mode(300.0, 1.0, (complex(np.exp(0.3j)), complex(np.exp(-0.3j))))
    found = growth.drift(Measurable(made_history(0.1, -0.01 * shape), 0.1, {"displacement": -0.01}, (turning,)))
    assert found == pytest.approx(0.36 / 0.25 - 1, rel=1e-9)


def test_a_verdict_is_kept_with_its_gate_and_four_digits() -> None:
    judged = Gate("s", ("dda", "bar"), "displacement.l2", 0.25, 0.75, "why", "other code", 0.125, 0.2)
    assert judge(judged, 0.512345).record("study") == {
        "id": "s:dda-bar:displacement.l2@0.2s",
        "study": "study",
        "scene": "s",
        "pair": ["dda", "bar"],
        "metric": "displacement.l2",
        "value": 0.5123,
        "band": [0.25, 0.75],
        "verdict": "PASS",
        "reason": "why",
        "why": "",
        "reference_kind": "other code",
        "reference_uncertainty": 0.125,
        "alarms": [],
    }


# ---- provenance ---------------------------------------------------------------------------------------------------


def test_provenance_names_this_interpreter_these_packages_and_this_commit(monkeypatch: pytest.MonkeyPatch) -> None:
    import platform

    import scipy

    seams.COMMIT.put(monkeypatch, lambda: "the commit")
    seams.PROCESSOR.put(monkeypatch, lambda: "the processor")
    found = provenance.provenance()
    assert found["python"] == platform.python_version()
    assert (found["packages"]["numpy"], found["packages"]["scipy"]) == (np.__version__, scipy.__version__)
    assert (found["commit"], found["processor"]) == ("the commit", "the processor")


# ---- rows ---------------------------------------------------------------------------------------------------------


def test_what_differs_between_rows_is_told_with_the_number_of_each() -> None:
    rows = [made_row("dda", provenance={"commit": commit}) for commit in ("then", "now", "then")]
    assert origin.of_rows(rows)["commit"] == "then (2 rows); now (1 row)"
    assert origin.of_rows(rows[1:2])["commit"] == "now"


def test_a_timed_run_keeps_the_least_seconds_their_spread_and_its_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the least run, 3 s of the processor, a quarter steps by the clock; what interrupts it counts nowhere."""
    clocks = {"process_time": 0.0, "perf_counter": 0.0}
    runs = iter([(9.0, 9.0, 1.0), (5.0, 5.0, 1.0), (3.0, 40.0, 10.0), (4.0, 4.0, 1.0)])

    def solve(scene: Scene, full: bool) -> Run:
        processor, clock, stepping = next(runs)
        clocks["process_time"] += processor
        clocks["perf_counter"] += clock
        return Run(Outcome.COMPLETED, seconds={"setup": 0.1, "stepping": stepping})

    fake: Any = SimpleNamespace(**{name: partial(clocks.__getitem__, name) for name in clocks})
    monkeypatch.setattr(measure, "time", fake)
    case = Case(load_scene("figure-8"), "dda", repeats=3)
    solver: Any = SimpleNamespace(solve=solve)
    run, spread = measure.timed(Run(Outcome.COMPLETED, work={"steps": 7}), solver, case)
    assert run.seconds == {"setup": 2.25, "stepping": 0.75} and spread == 2.0
    assert run.work["steps"] == 7 and run.work["lines"] > 4


def test_lines_of_python_are_counted_and_a_tracer_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def loop(count: int) -> None:
        for _ in range(count):
            pass

    before = sys.gettrace()
    few, many = (measure.lines_of(partial(loop, count)) for count in (10, 110))
    assert many - few == 200 and sys.gettrace() is before
    run = partial(get_solver("dda").solve, load_scene("figure-8").expand()[0])
    run()
    assert measure.lines_of(run) == measure.lines_of(run)


def test_lines_that_a_collection_of_garbage_runs_are_not_counted() -> None:
    """Hypothesis, for one, times each collection by a callback of some lines."""

    def collected(phase: str, info: object) -> None:
        pass

    def cycles() -> None:
        for _ in range(3000):
            own: list[Any] = []
            own.append(own)

    alone = measure.lines_of(cycles)
    gc.callbacks.append(collected)
    try:
        assert measure.lines_of(cycles) == alone and gc.isenabled()
    finally:
        gc.callbacks.remove(collected)


def test_a_kept_row_that_another_case_brings_has_the_names_of_this_one(scene: Scene, tmp_path: Path) -> None:
    """Without savings the solver dda is what is called dda:full, and its row is of the same key."""
    alike = scene.model_copy(update={"name": "alike"})
    first, second = (Study(name, "t", "p", [scene], ("dda",)) for name in ("first", "second"))
    finish([Case(scene, "dda", without_savings=True)], first, Results(tmp_path))
    (row,) = finish([Case(alike, "dda:full")], second, Results(tmp_path)).rows.values()
    assert len(Results(tmp_path).rows()) == 1
    assert (row.scene, row.solver, row.study) == ("alike", "dda:full", "second")


def test_a_verdict_carries_the_alarms_of_its_case_and_of_its_whole_scene(scene: Scene, tmp_path: Path) -> None:
    first, second = swept = scene.model_copy(update={"sweep": {"time.step": [0.001, 0.002]}}).expand()
    raised: Any = [{"kind": kind, "scene": name, "sentence": "", "values": {}} for kind, name in
                   (("of all", scene.name), ("of one", first.name), ("of another", "elsewhere"))]  # fmt: skip
    gates = tuple(Gate(case.name, ("dda",), "displacement.static", -1.0, 1.0, "r") for case in swept)
    run_study(
        Study("s", "t", "p", swept, ("dda",), gates=lambda: gates,
              annotate=lambda scenes, finished: {"alarms": raised, "budgets": []}),
        Results(tmp_path),
    )  # fmt: skip
    told = {verdict["scene"]: verdict["alarms"] for verdict in Results(tmp_path).verdicts()}
    assert told == {first.name: ["of all", "of one"], second.name: ["of all"]}


# ---- between the steps --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("values", [{}, {"time.gg": 0.9}, {"time.gg_rate": 30.0}], ids=str)
def test_an_exact_motion_is_kept_between_its_steps_and_passes_through_them(
    values: dict[str, float], tmp_path: Path
) -> None:
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


def test_damage_between_the_steps_is_refused(tmp_path: Path) -> None:
    results = Results(tmp_path)
    history = made_history(0.1, [1.0, 2.0])
    broken = replace(history, between=made_history(0.05, [1.0, np.nan, 2.0, 3.0]))
    results.append(made_row("continuum"), broken)
    with pytest.raises(InputError, match="between the steps: displacement must hold one finite number a step"):
        results.history("s continuum")
