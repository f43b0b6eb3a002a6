"""The chapter of the study `paper`: the register of claims, and figures from results made by hand."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from oracles.made_cases import kept_study, lines_of, made_history, made_row, names_at, rules_of

from validation.engine.finished import Finished
from validation.report.blocks import Blocks, FigureBlock, Paragraph
from validation.report.chapters.registry import chapter_of
from validation.report.figures.curves import style_of
from validation.runs.history import History
from validation.runs.results import Results
from validation.scenes.scene import Scene, load_scene
from validation.suite.folders import get_study

BASE = load_scene("figures-3-4")
RULE = "#6b6b6b"
Case = tuple[Scene, Mapping[str, Any], Mapping[str, History]]  # metrics and histories by solver


def named(scene: str, **values: Any) -> Scene:
    """Return a case of a scene; its name is that of the scene."""
    return BASE.with_values(values).model_copy(update={"name": scene})


def page(place: Path, *cases: Case, claims: Mapping[str, Mapping[str, Any]] | None = None, **kept: Any) -> Blocks:
    """Return the chapter of a study that has these cases and claims."""
    results = Results(place)
    triples = [
        (scene, made_row(solver, metrics[solver], scene.name), histories.get(solver))
        for scene, metrics, histories in cases
        for solver in metrics
    ]
    rows = [{"scene": "claims", "name": name, "metrics": metrics} for name, metrics in (claims or {}).items()]
    data = dict(get_study("paper").data()) | kept.pop("data", {})
    manifest = kept_study(results, triples, study="paper", data=data, derived=[*rows, *kept.pop("derived", ())], **kept)
    return chapter_of("paper")(results, manifest, place)


def color(name: str) -> str:
    return to_hex(style_of(name).color)


# ---- the register ---------------------------------------------------------------------------------------------------


def test_claims_have_verdict_reason_and_numbers_and_the_lead_counts_them(kept: Any, tmp_path: Path) -> None:
    """Also where all hold or none, and where one or several of the refuted are misprints."""
    claims = {
        "S16": {"verdict": 0.0, "steps": 44, "none": 0, "share": "undefined"},
        "C1": {"verdict": 2.0, "left": 0.001, "nothing": 1e-15},
        "C6": {"verdict": 1.0},
    }
    blocks = page(tmp_path, claims=claims)
    counted = (
        {"C1": 2.0, "C6": 1.0, "C2": 0.0},
        {"C1": 2.0, "C3": 2.0, "S16": 0.0},
        {"C2": 0.0, "S16": 0.0, "S20": 0.0},
    )
    for verdicts in counted:
        others = page(tmp_path, claims={name: {"verdict": verdict} for name, verdict in verdicts.items()})
        blocks.append(next(block for block in others if isinstance(block, Paragraph)))
    kept("claims", blocks)


def test_the_register_keeps_the_words_of_every_claim() -> None:
    data = get_study("paper").data()
    names = [f"C{i}" for i in range(1, 23)], [f"S{i}" for i in (13, 16, 20, 21, 25, 29, 32)]
    assert (data["statements"], data["slips"]) == names
    assert {name for words in ("statement", "why", "condition") for name in data[words]} == {*names[0], *names[1]}
    place = re.compile(r"\((abstract|sections?|conclusions?|equations?)\b")
    assert all(place.search(text) for text in data["statement"].values())


# ---- figures 3 to 9 -------------------------------------------------------------------------------------------------

METRICS = {
    "displacement.static": -0.01,
    "pressure.static": 5e6,
    "displacement.settling_step": 12.0,
    "pressure.settling_step": 17.0,
}


@pytest.mark.parametrize(
    ("scene", "number", "value", "level", "settled", "unit"),
    [
        ("figures-3-4", 3, -12.0, -10.0, 12.0, "[mm]"),
        ("figures-3-4", 4, 6.5, 5.0, 17.0, "[MPa]"),
        ("figure-8", 8, 20.0, 0.0, None, "[%]"),
    ],
)
def test_the_papers_figures_are_in_their_units(
    scene: str,
    number: int,
    value: float,
    level: float,
    settled: float | None,
    unit: str,
    drawn: dict[str, Figure],
    tmp_path: Path,
) -> None:
    history = made_history(0.002, np.full(300, -0.012), np.full(300, 6.5e6))
    blocks = page(tmp_path, (named(scene, **{"time.step": 0.002}), {"dda": METRICS}, {"dda": history}))
    captions = {block.caption.split(".")[0]: block.caption for block in blocks if isinstance(block, FigureBlock)}
    assert ("Dashed: step from which DDA stays" in captions[f"Figure {number}"]) == (settled is not None)
    (axes,) = drawn[f"figure-{number}.svg"].axes
    (line,) = [y for own, _, y in lines_of(axes) if own == color("dda")]
    assert len(line) == (200 if number == 8 else 100)  # steps that the figure shows
    assert np.allclose(line, value) and axes.get_ylabel().endswith(unit)
    assert rules_of(axes, RULE) == ([pytest.approx(level)], [] if settled is None else [settled])


def test_a_figure_over_steps_begins_at_step_one_and_names_the_values_at_its_last(
    drawn: dict[str, Figure], tmp_path: Path
) -> None:
    steps = np.arange(1, 201)  # at step 100: 2 and -2 mm
    moved = {"dda": steps / 5e4, "bar": 2e-3 - steps / 2.5e4}
    histories = {name: made_history(1e-3, values, values) for name, values in moved.items()}
    metrics = {"dda": {"displacement.static": 5e-4, "displacement.settling_step": 30.0}, "bar": {}}
    page(tmp_path, (named("figures-3-4", **{"time.step": 1e-3}), metrics, histories))
    (axes,) = drawn["figure-3.svg"].axes
    assert names_at(axes) == {"dda": (pytest.approx(2.0), color("dda")), "bar": (pytest.approx(-2.0), color("bar"))}
    for name, history in histories.items():
        (line,) = [(x, y) for own, x, y in lines_of(axes) if own == color(name) and x.size > 2]
        assert np.allclose(line[0], steps[:100]) and np.allclose(line[1], 1e3 * history.displacement[:100])
    assert rules_of(axes, RULE) == ([pytest.approx(0.5)], [30.0])
    assert "30 steps" in [text.get_text() for text in axes.texts]


def test_the_continuum_is_left_out_where_its_period_has_too_few_steps(drawn: dict[str, Figure], tmp_path: Path) -> None:
    cases = []
    derived = []
    for name, word in (("figures-5-6", "curve"), ("figures-3-4", "none")):
        history = made_history(0.002, np.full(40, -0.012), np.full(40, 6.5e6))
        case = named(name, **{"time.step": 0.002})
        cases.append((case, {"dda": METRICS, "continuum": {}}, {"dda": history, "continuum": history}))
        derived.append({"scene": name, "name": "period", "metrics": {"continuum": word}})
    blocks = page(tmp_path, *cases, derived=derived)
    captions = [block.caption for block in blocks if isinstance(block, FigureBlock)]
    assert [text.split(".")[0] for text in captions if "continuum is left out" in text] == ["Figure 3", "Figure 4"]
    assert [set(names_at(drawn[f"figure-{n}.svg"].axes[0])) for n in (3, 5)] == [{"dda"}, {"dda", "continuum"}]


def test_a_period_is_counted_in_steps_and_angles_are_those_within_figure_1(tmp_path: Path) -> None:
    """A period of 2 pi / 300 = 21 ms has ten steps of 2 ms and two of 10 ms; w dt = 0.09 lies outside the figure."""
    recipes = {(row.scene, row.name): row for row in get_study("paper").derived()}
    metrics = {"mode1.frequency": 300.0, "contact.frequency": 9000.0}
    rows = {(scene, solver): made_row(solver, metrics, scene) for (scene, _), row in recipes.items()
            for _, solver in row.needs}  # fmt: skip
    finished = Finished(rows, Results(tmp_path))
    values = {key: row.compute(finished) for key, row in recipes.items() if row.name in ("period", "w dt")}
    steps = {step: values[f"figures-3-4[time.step={step}]", "period"] for step in (0.01, 0.002)}
    assert steps[0.01]["continuum"] == "none" and steps[0.002]["continuum"] == "curve"
    assert steps[0.002]["steps"] == pytest.approx(10.472, rel=1e-4)
    angles = {tuple(sorted(row)) for (_, name), row in values.items() if name == "w dt"}
    assert angles >= {("contact",), ("contact", "mode1")}


# ---- figure 1 -------------------------------------------------------------------------------------------------------
