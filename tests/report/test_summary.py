"""Page 1 of a scene of one's own: reference, errors, cost and damping of the rows; what is not known is left out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure
from oracles.made_cases import between, made_case, made_group, made_row

from validation.report.blocks import Beside, Callout, Points
from validation.report.chapters import summary
from validation.scenes.scene import Scene, load_scene

PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 100})
COST: dict[str, Any] = {
    "work": {"unknowns": 2, "solves": 7, "steps": 100},
    "seconds": {"setup": 0.002, "stepping": 0.004},
}


def case(scene: Scene = PAPER, label: str = "as stated", **metrics: dict[str, Any]) -> Any:
    """Return a case with a cost for each solver."""
    return made_case(
        scene, {name: made_row(name, own, scene.name, **COST) for name, own in metrics.items()}, label=label
    )


def test_damping_is_told_by_scheme_discount_and_tables() -> None:
    scene = PAPER.with_values({"time.gg": 0.98})
    parts = summary.mode_damping(case(scene, dda={}), 344.561)
    assert parts["scheme"] == pytest.approx(0.1602, abs=5e-4)  # of (1/2, 1) at w dt = 0.689
    assert parts["total"] == pytest.approx(parts["scheme"] + parts["discount"])  # type: ignore[operator]
    assert parts["discount"] == pytest.approx(-0.5 * 1e-2 / 0.689 * -2, rel=0.3) and parts["tables"] is None
    viscous = PAPER.with_values({"damping.mass": 20.0})
    assert summary.mode_damping(case(viscous, dda={"mode1.damping": 0.19}), 344.561)["tables"] == pytest.approx(
        0.19 - 0.1602, abs=5e-4
    )


@pytest.mark.parametrize(
    ("name", "choices"),
    [
        ("figures-3-4", ["Time step.", "Springs.", "Discount."]),
        ("waves-blocks", ["Time step.", "Discount."]),
        ("beams-squares", ["Time step.", "Springs.", "Discount."]),
        ("rigid-standing", ["Time step.", "Discount."]),
    ],
)
def test_each_kind_of_scene_has_its_choices_and_a_drawing(
    name: str, choices: list[str], tmp_path: Path, drawn: dict[str, Figure]
) -> None:
    scene = load_scene(name).expand()[0]
    alarm = {"kind": "hidden tension", "scene": scene.name, "sentence": "it pulls"}
    beside, *others = summary.scene_summary(made_group(case(scene, dda={}), alarms=(alarm,)), tmp_path)
    assert isinstance(beside, Beside) and list(drawn) == ["scene-drawing.svg"]
    points = beside.right[0]
    assert isinstance(points, Points) and [head for head, _ in points.items] == choices
    assert isinstance(others[-1], Callout) and "it pulls" in others[-1].text


def steps(*errors: tuple[float, float]) -> Any:
    """Return a group of steps with their errors; the run time is in inverse proportion to the step."""
    cases, pairs = [], []
    for step, error in errors:
        scene = PAPER.with_values({"time.step": step}, label=True)
        own = case(scene, f"dt = {step:g} s", dda={}, bar={})
        seconds = {"setup": 0.0, "stepping": 1 / step / 1e5}
        cases.append(replace(own, rows={**own.rows, "dda": replace(own.rows["dda"], seconds=seconds)}))
        pairs.append(between(scene.name, "dda", "bar", displacement_l2=error))
    return made_group(*cases, comparisons=tuple(pairs))


def test_page_1_says_what_its_rows_hold_and_leaves_out_what_they_do_not(kept: Any) -> None:
    """One case, steps within and beyond the named errors, no damping, a contact that opens, several scenes."""
    pair = between(PAPER.name, "dda", "bar", displacement_l2=0.0363, pressure_l2=0.0405)
    one = made_group(case(dda={"mode1.frequency": 344.56}, bar={"mode1.frequency": 327.7}), comparisons=(pair,))
    undamped = PAPER.with_values({"time.alpha": 0.25, "time.delta": 0.5})
    lost = {"energy.given": 21.0, "energy.lost_switching": 5.01, "energy.lost_friction": 0.0}
    damped = replace(made_group(case(dda={"mode1.damping": 0.16}, bar={}), comparisons=(pair,)), title="One")
    blocks = [
        *summary.error_blocks(one),
        *summary.error_blocks(steps((0.002, 0.05), (0.001, 0.005))),
        *summary.fastest(steps((0.002, 0.9), (0.001, 0.9))),
        *summary.damping_blocks(made_group(case(undamped, dda={"mode1.frequency": 344.561}))),
        *summary.damping_blocks(one),
        *summary.damping_blocks(made_group(case(dda=lost))),
        summary.overview({"one": damped, "two": replace(made_group(case(fem={})), title="Two")}),
    ]
    kept("summary", blocks)
    silent = made_group(case())
    assert summary.error_blocks(silent) == summary.damping_blocks(silent) == summary.fastest(one) == []
