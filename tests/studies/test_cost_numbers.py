"""Errors and costs as they are kept, judged and told: points, record, rows, and the chapters of work and sub-blocks."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from oracles.made_cases import between, kept_study, made_case, made_group, made_history, made_row
from validation.studies.work import study as work_precision
from validation.studies.work.points import COSTS, METHODS, Point, cheapest, floor, front, points, table

from validation.report.chapters import subblocks as chapters_subblocks
from validation.report.chapters import work as chapters_work
from validation.runs.results import Results
from validation.scenes.scene import load_scene

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


def test_every_row_of_a_study_holds_its_own_work_seconds_metrics_and_differences(tmp_path: Path) -> None:
    results = Results(tmp_path)
    dda, bar, continuum = table(results, kept(results))
    assert dda == {
        "scene": BASE.name, "solver": "dda", "outcome": "completed",
        "work.unknowns": 6, "work.factorisations": 1, "work.solves": 41, "work.steps": 40,
        "seconds.setup": 0.25, "seconds.stepping": 0.5, "seconds.total": 0.75, "estimate": 2e-15,
        "mode1.numerical_frequency": 330.0, "mode1.damping": 0.17,
        "bar:displacement.l2": 0.031, "bar:pressure.l2": 0.032,
        "continuum:displacement.l2": 0.51, "continuum:pressure.l2": 0.52,
        "notes": "a note; another",
    }  # fmt: skip
    assert (bar["continuum:pressure.l2"], "bar:pressure.l2" in bar) == (0.42, False)
    assert not [name for name in continuum if ":" in name]


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


def cut(across: int, upwards: int, own: dict[str, float], fem: dict[str, float], **changes: Any) -> Any:
    values = {"block.subdivide": [across, upwards], "block.pattern": "squares"}
    scene = BASE.with_values(values | {key.replace("__", "."): value for key, value in changes.items()}, label=True)
    spent = {"setup": 0.001, "stepping": 0.004}
    row = made_row("dda", own, scene.name, work={"unknowns": 6 * across * upwards}, seconds=spent)
    return made_case(scene, {"dda": row, "fem": fem})


def test_sub_blocks_are_told_by_rows_with_signed_errors_and_milliseconds() -> None:
    case = cut(2, 3, {"mode1.frequency": 291.0}, {"mode1.frequency": 300.0})
    pair = between(case.name, "dda", "fem", displacement_l2=0.0123, horizontal_l2=0.9)
    shown = chapters_subblocks.patterns(made_group(case, comparisons=(pair,)))
    assert [c.title for c in shown.columns] == ["Pattern", "n", "Error of ω₁", "L2 error", "Unknowns", "ms"]
    assert shown.rows == (("squares", "3", "−3\u00a0%", "1.23\u00a0%", "36", "5"),)
    (line,) = chapters_subblocks._line(
        "squares", made_group(case, comparisons=(pair,)), [case], "fem", "displacement.l2"
    )
    assert (list(line.x), list(line.y), line.notes) == ([0.005], [0.0123], ("3",))


def test_glue_is_told_for_the_axial_and_for_the_rocking_motion() -> None:
    axial = cut(2, 2, {"mode1.frequency": 306.0}, {"mode1.frequency": 300.0}, block__glue_ratio=3.0)
    turned = cut(2, 2, {"mode1.frequency": 110.0}, {"mode1.frequency": 100.0}, block__glue_ratio=3.0,
                 load__pressure=0.0, load__traction=1e6)  # fmt: skip
    shown = chapters_subblocks.glue(made_group(axial, turned))
    assert [c.title for c in shown.columns] == ["glue_ratio", "Axial ω₁", "Rocking ω₁"]
    assert shown.rows == (("3", "2\u00a0%", "10\u00a0%"),)


def test_rocking_is_told_for_the_block_and_for_the_elements() -> None:
    own, fem = ({"mode1.frequency": w, "mode1.damping": xi} for w, xi in ((220.0, 0.11), (200.0, 0.1)))
    scene = BASE.with_values({"fem.foundation": "patch", "fem.patch_width": 0.5})
    shown = chapters_subblocks.rocking(made_group(made_case(scene, {"dda": own, "fem": fem})))
    heads = [(c.group, c.title) for c in shown.columns]
    assert dict(zip(heads, shown.rows[0], strict=True)) == {
        ("", "Patch width [m]"): "0.5",
        ("ω₁ [rad/s]", "dda"): "220",
        ("ω₁ [rad/s]", "fem"): "200",
        ("ξ₁ [1]", "dda"): "0.11",
        ("ξ₁ [1]", "fem"): "0.1",
        ("", "Block above elements"): "10\u00a0%",
    }
