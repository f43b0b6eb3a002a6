"""Errors and costs as they are kept, judged and told: points, record, rows, and the chapters of work and sub-blocks."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from oracles.made_cases import between, kept_study, made_history, made_row

from validation.engine.table import tidy
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies.work_precision import chapter as chapters_work
from validation.studies.work_precision import formulas as work_precision
from validation.studies.work_precision.points import COSTS, METHODS, Point, cheapest, floor, front, points

BASE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 40, "fem.elements": 12})
V, P = "displacement", "contact pressure"


def kept(results: Results) -> dict[str, Any]:
    """Keep one case by dda, bar and continuum, whose every number is another one."""
    work = {"unknowns": 6, "factorisations": 1, "solves": 41, "steps": 40}
    spent = {"setup": 0.25, "stepping": 0.5}
    rows = {
        "dda": made_row("dda", {"mode1.numerical_frequency": 330.0, "mode1.damping": 0.17}, "w1", work=work,
                        seconds=spent, notes=("a note", "another"), estimate=2e-15),
        "bar": made_row("bar", {"mode1.numerical_frequency": 300.0, "mode1.damping": 0.15}, "w1",
                        seconds={"stepping": 0.1}),
        "continuum": made_row("continuum", {"mode1.numerical_frequency": 320.0, "mode1.damping": 0.0}, "w1"),
    }  # fmt: skip
    name = BASE.name
    pairs = [
        between(name, "dda", "bar", displacement_l2=0.031, pressure_l2=0.032),
        between(name, "dda", "continuum", displacement_l2=0.51, pressure_l2=0.52),
        between(name, "bar", "continuum", displacement_l2=0.41, pressure_l2=0.42),
    ]
    return kept_study(results, [(BASE, row, None) for row in rows.values()], pairs)


def test_every_number_of_a_study_is_a_line_with_what_it_is_of(tmp_path: Path) -> None:
    results = Results(tmp_path)
    manifest = kept(results) | {"derived": [{"scene": "owner", "name": "order", "metrics": {"power": 2.0}}]}
    rows = list(tidy(results, manifest))  # type: ignore[arg-type]
    numbers = {(row.solver, row.reference, row.metric): row.value for row in rows}
    assert len(numbers) == len(rows)
    assert numbers["dda", "", "outcome"] == "completed" and numbers["dda", "", "estimate"] == 2e-15
    assert numbers["dda", "", "work.solves"] == 41 and numbers["dda", "", "seconds.stepping"] == 0.5
    assert numbers["dda", "", "mode1.damping"] == 0.17 and numbers["bar", "", "mode1.damping"] == 0.15
    assert numbers["dda", "bar", "displacement.l2"] == 0.031 and numbers["bar", "continuum", "pressure.l2"] == 0.42
    assert ("bar", "bar", "pressure.l2") not in numbers and ("continuum", "", "estimate") not in numbers
    units = {(row.metric, row.window, row.unit) for row in rows if row.metric in ("displacement.l2", "seconds.setup")}
    assert units == {("displacement.l2", 1.0, "1"), ("seconds.setup", None, "s")}
    derived = rows[-1]
    assert (derived.scene, derived.case, derived.solver, derived.metric) == ("owner", "", "order", "power")


def test_a_point_has_relative_errors_of_frequency_and_absolute_ones_of_damping(tmp_path: Path) -> None:
    results = Results(tmp_path)
    dda, bar = points(results, kept(results), "figures")
    assert dda.errors == {
        (V, "bar"): 0.031, (P, "bar"): 0.032, (V, "continuum"): 0.51, (P, "continuum"): 0.52,
        ("first frequency", "bar"): pytest.approx(0.1), ("first frequency", "continuum"): pytest.approx(10 / 320),
        ("damping ratio", "bar"): pytest.approx(0.02), ("damping ratio", "continuum"): pytest.approx(0.17),
    }  # fmt: skip
    assert (dda.seconds, dda.work, COSTS["seconds"](dda), COSTS["unknowns × steps"](dda)) == (0.75, 240, 0.75, 240)
    assert bar.errors[V, "continuum"] == 0.41 and (V, "bar") not in bar.errors


# ---- the chapter of error against run time ------------------------------------------------------------------------


def point(method: str, step: float, seconds: float, *errors: float) -> Point:
    keys = [(V, "bar"), (P, "bar"), (V, "continuum"), (P, "continuum")]
    spent = {"setup": seconds / 5, "stepping": 4 * seconds / 5}
    row = made_row(method, {}, work={"unknowns": 31, "solves": 17, "steps": 40}, seconds=spent)
    return Point(method, BASE.with_values({"time.step": step}), row, dict(zip(keys, errors, strict=True)))


FOUND = (
    point("dda", 0.01, 0.001, 0.011, 0.012, 0.09, 0.08),
    point("dda", 0.002, 0.005, 0.021, 0.022, 0.041, 0.042),
    point("bar", 0.002, 0.002, 0.0, 0.0, 0.0051, 0.0052),
    point("fem, quadratic", 0.002, 0.05, 0.0001, 0.0002, 0.0053, 0.0054),
    point("bar", 0.001, 0.004, 0.0, 0.0, 0.0009, 0.002),
)


def test_the_cheapest_keeps_both_quantities_within_the_error() -> None:
    assert cheapest(FOUND, 0.1) is FOUND[0]
    assert cheapest(FOUND, 0.085) is FOUND[2]
    assert cheapest(FOUND, 0.001) is None  # the last has the displacement and not the pressure
    assert cheapest(FOUND, 0.03, "bar") is FOUND[0]
    assert floor(FOUND, V, "continuum") == 0.041 and floor(FOUND, P, "bar") == 0.022  # at the finest step
    assert floor(FOUND[2:], V, "continuum") is None


def test_the_sentences_of_the_work_chapter() -> None:
    assert chapters_work.cheapest_sentence(FOUND) == (
        "Cheapest against the continuum, at 10\u00a0%: dda with dt = 10 ms (in 1 ms); at 1\u00a0%: bar with dt = 2 ms "
        "(in 2 ms), and of the block's own models fem, quadratic with dt = 2 ms, 12 elements a side (in 50 ms); at "
        "0.1\u00a0%: no run gets there."
    )
    assert chapters_work.floor_sentence(FOUND) == (
        "At the finest step DDA is 4.1\u00a0% from the continuum in displacement and 4.2\u00a0% in contact pressure "
        "(relative L2 over 0.04 to 0.4\u00a0s): its model form, which no finer step removes."
    )


def test_orders_are_shown_by_what_was_refined_and_quantity() -> None:
    verdicts = [{"scene": scene, "metric": metric, "value": value} for scene, metric, value in
                (("a", "order.displacement", 1.98765), ("a", "order.pressure", 2.5), ("b", "order.pressure", None),
                 ("c", "order.pressure", 4.0), ("d", "record.work", 1.0))]  # fmt: skip
    shown = chapters_work.order_table(verdicts)
    assert [(c.group, c.title) for c in shown.columns] == [
        ("", "Refined"),
        ("Order", "displacement"),
        ("Order", "pressure"),
    ]
    assert shown.rows == (("a", "1.988", "2.500"), ("c", "–", "4.000"))


def test_scenes_and_methods_of_the_study_have_their_own_names() -> None:
    alphas = {prefix: work_precision.named(f"{prefix}-linear").time.alpha for prefix in chapters_work.SCHEMES}
    words = {chapters_work.SCHEMES[prefix].split()[0]: alpha for prefix, alpha in alphas.items()}
    assert words == {"Constant": 0.5, "Average": 0.25}
    assert {name for (_, degree), name in METHODS.items() if degree == 2} == {"fem, quadratic"}
    assert front([(1, 5), (2, 4.9), (3, 6), (4, 1), (4, 0.5)]) == [(1, 5), (2, 4.9), (4, 0.5)]


# ---- orders -------------------------------------------------------------------------------------------------------


def finished(**histories: Any) -> Any:
    rows = {("a", name): made_row(name, {}, "a", work={"unknowns": 6, "solves": 40}, seconds={"stepping": 1.0})
            for name in histories}  # fmt: skip
    history = lambda case, name: histories.get(name)  # noqa: E731
    return SimpleNamespace(rows=rows, history=history, needed_history=history)


def test_histories_of_finer_steps_are_read_at_the_coarse_steps_times() -> None:
    """Step n of dt and step 4 n of dt / 4 end at the same time."""
    fine = made_history(0.25, np.arange(1, 13) ** 2, np.arange(1, 13))
    found = work_precision._columns(finished(dda=fine), "a", "dda", 4)
    assert found["displacement"].tolist() == [16, 64, 144] and found["pressure"].tolist() == [4, 8, 12]


def test_the_grid_convergence_index_is_that_of_the_last_change() -> None:
    """Values 1 + n^-2 change by (3/4) n^-2: order 2, index 1.25 |last change| / (2^2 - 1)."""
    recipe, index = work_precision.grid_convergence(), work_precision.named("work-h-poisson").expand()
    values = {case.name: 1 + n**-2 for case, n in zip(index, work_precision.MESHES, strict=True)}
    made = SimpleNamespace(needed_history=lambda case, _: made_history(0.1, [values[case]] * 3, [2 * values[case]] * 3))
    metrics = recipe.compute(made)
    change = 0.75 * 32**-2 / values[index[-1].name]
    assert metrics["order.displacement"] == pytest.approx(2.0, abs=0.02)
    assert metrics["gci.displacement"] == pytest.approx(1.25 * change / (2 ** metrics["order.displacement"] - 1))
    assert metrics["gci.pressure"] == pytest.approx(metrics["gci.displacement"])


# ---- the chapter of sub-blocks ------------------------------------------------------------------------------------
