"""The damping budget of a scene's page: its numbers, its curves and its caption."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import beside
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from oracles.made_cases import lines_of, names_at

from validation.advice.budget import budgets
from validation.engine.run import run_study
from validation.report.blocks import figures_of
from validation.report.chapters.alarms import alarm_lines
from validation.report.chapters.budget import CONTACT_COLOR, MARGINS, budget_panel
from validation.report.chapters.data import groups_of_studies
from validation.report.chapters.registry import chapter_of
from validation.report.figures.charts import chart_figure
from validation.report.figures.curves import style_of
from validation.scenes.scene import load_scene
from validation.suite import Study
from validation.suite.folders import scene_study


def budget_of(**parts: float) -> dict[str, Any]:
    """Return a budget of constant curves: the first mode's parts as given, the contact mode at 20 %."""
    dt = np.geomspace(1e-5, 1e-2, 20)
    first = {part: np.full(20, value).tolist() for part, value in parts.items()}
    contact = {part: np.full(20, 0.2).tolist() for part in parts}
    return {
        "scene": "s",
        "steps": [1e-3, 2e-3],
        "gg": 0.98,
        "gg_rate": None,
        "dt": dt.tolist(),
        "modes": {"first axial": first, "contact": contact},
        "limits": {"real roots": 4e-3, "wave transit": 3e-4},
        "real roots at": 3.96,
        "floor": 1.0521,
    }


def test_the_damping_budget_names_its_parts_in_per_cent_at_their_own_curves() -> None:
    record = budget_of(total=0.05, algorithmic=0.012, kinetic=0.0015)
    (axes,) = chart_figure([budget_panel("", record)], 40.0, MARGINS).axes
    expected = {"first axial": 5.0, "contact": 20.0, "algorithmic part": 1.2, "kinetic part": 0.15}
    orange, violet = to_hex(style_of("dda").color), to_hex(CONTACT_COLOR)
    colors = dict.fromkeys(expected, orange) | {"contact": violet}
    assert names_at(axes) == {name: (pytest.approx(value, rel=1e-6), colors[name]) for name, value in expected.items()}
    drawn = {(colour, round(float(y[0]), 9)) for colour, x, y in lines_of(axes) if x.size == 20}
    assert drawn == {(orange, 5.0), (violet, 20.0), (orange, 1.2), (orange, 0.15)}


def test_the_damping_budget_names_a_part_where_it_ends() -> None:
    record = budget_of(total=0.05, algorithmic=0.05, kinetic=0.0)
    record["modes"]["contact"]["total"] = [*np.linspace(0.9, 0.3, 15), *[None] * 5]
    (axes,) = chart_figure([budget_panel("", record)], 40.0, MARGINS).axes
    assert names_at(axes)["contact"][0] == pytest.approx(30)


@pytest.mark.long
def test_the_page_of_a_scene_shows_its_budget_and_the_appendix_its_alarms(
    tmp_path: Path, finished_cases: Path, drawn: dict[str, Figure]
) -> None:
    scene = load_scene("figures-5-6")
    study = scene_study("figures-5-6")
    results = beside(finished_cases, tmp_path / "results")
    run_study(Study(study.name, study.title, study.purpose, [scene], ("dda", "bar", "continuum")), results)
    blocks = chapter_of("figures-5-6")(results, results.manifest("figures-5-6"), tmp_path)
    captions = [figure.caption for figure in figures_of(blocks)]
    assert len(captions) == len(drawn) > 1
    assert any("Damping budget" in caption and "1.052 to 1.102 times" in caption for caption in captions)
    alarms = " ".join(line.text for line in alarm_lines(groups_of_studies(results, [results.manifest("figures-5-6")])))
    assert all(kind in alarms for kind in ("agreement by damping", "hidden tension", "contact ringing"))


@pytest.mark.long
def test_a_budget_s_viscous_part_is_what_the_tables_add() -> None:
    scene = load_scene("figures-3-4").expand()[1].with_values({"damping.mass": 20.0})
    (record,) = budgets([scene])
    first = record["modes"]["first axial"]
    total, algorithmic, added = (first[part][0] for part in ("total", "algorithmic", "viscous"))
    assert added == pytest.approx(20.0 / (2 * 344.5612), rel=1e-3)  # a0 / (2 w) at small dt
    assert total == pytest.approx(algorithmic + added, rel=1e-3)
