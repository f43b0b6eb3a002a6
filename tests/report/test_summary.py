"""Page 1 of a scene of one's own: reference, errors, cost and damping of the rows; what is not known is left out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure
from oracles.made_cases import between, made_case, made_group, made_row

from validation.report.blocks import Beside, Callout, Heading, Paragraph, Points, Table
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


def cells(table: Table) -> list[dict[str, str]]:
    """Return the rows of a table by the titles of its columns, with those that columns share before them."""
    titles = [f"{column.group} {column.title}".strip() for column in table.columns]
    return [dict(zip(titles, row, strict=True)) for row in table.rows]


def table_of(blocks: Any) -> Table:
    (found,) = [block for block in blocks if isinstance(block, Table)]
    return found


def test_the_best_reference_is_exact_in_time_if_it_was_run_and_compared() -> None:
    pairs = {"continuum": 0.3, "bar": 0.2, "fem": 0.1, "block-events": 0.4}
    own = case(**{name: {} for name in ("dda", *pairs)})
    found = []
    for left in range(4):
        compared = [between(PAPER.name, "dda", other, displacement_l2=pairs[other]) for other in list(pairs)[left:]]
        found.append(summary.reference_of(made_group(own, comparisons=tuple(compared)), own))
    assert found == ["continuum", "bar", "fem", "block-events"]
    assert summary.reference_of(made_group(own), own) is None  # nothing was compared
    alone = case(dda={})
    group = made_group(alone, comparisons=(between(PAPER.name, "dda", "bar", displacement_l2=0.2),))
    assert summary.reference_of(group, alone) is None  # it has no row


def test_errors_and_cost_stand_for_each_solver_and_absent_quantities_have_no_column() -> None:
    own = case(dda={"mode1.frequency": 344.56}, bar={"mode1.frequency": 327.7})
    pair = between(PAPER.name, "dda", "bar", displacement_l2=0.0363, pressure_l2=0.0405)
    heading, table, frequency = summary.error_blocks(made_group(own, comparisons=(pair,)))
    assert isinstance(heading, Heading) and isinstance(table, Table) and isinstance(frequency, Paragraph)
    first, second = cells(table)
    assert first == {
        "Solver": "dda", "Error [%] displacement": "3.63", "Error [%] contact pressure": "4.05", "Work unknowns": "2",
        "Work solves": "7", "Work steps": "100", "Time [ms] set-up": "2.0", "Time [ms] steps": "4.0",
    }  # fmt: skip
    assert second["Solver"] == "bar (reference)" and second["Error [%] displacement"] == "–"
    assert "5.14\u00a0%" in frequency.text  # 344.56 / 327.7 - 1
    assert summary.error_blocks(made_group(case())) == []


def test_the_fastest_run_within_an_error_is_named_only_where_there_are_several() -> None:
    steps = ((0.002, 0.05), (0.001, 0.005))
    cases, pairs = [], []
    for step, error in steps:
        scene = PAPER.with_values({"time.step": step}, label=True)
        own = case(scene, f"dt = {step:g} s", dda={}, bar={})
        seconds = {"setup": 0.0, "stepping": 1 / step / 1e5}
        cases.append(replace(own, rows={**own.rows, "dda": replace(own.rows["dda"], seconds=seconds)}))
        pairs.append(between(scene.name, "dda", "bar", displacement_l2=error))
    (paragraph,) = summary.fastest(made_group(*cases, comparisons=tuple(pairs)))
    assert "10\u00a0%: dda at dt = 0.002 s, 5.0\u00a0ms; 1\u00a0%: dda at dt = 0.001 s, 10\u00a0ms." in paragraph.text  # type: ignore[union-attr]
    far = [pair | {"metrics": {"displacement.l2": 0.9}} for pair in pairs]
    (paragraph,) = summary.fastest(made_group(*cases, comparisons=tuple(far)))
    assert "No run is within 10" in paragraph.text  # type: ignore[union-attr]
    assert summary.fastest(made_group(cases[0], comparisons=tuple(pairs))) == []


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
    undamped = PAPER.with_values({"time.alpha": 0.25, "time.delta": 0.5})
    heading, nothing = summary.damping_blocks(made_group(case(undamped, dda={"mode1.frequency": 344.561})))
    assert isinstance(heading, Heading) and isinstance(nothing, Paragraph)
    assert summary.damping_blocks(made_group(case(dda={}))) == []


def test_of_a_contact_that_opens_the_energy_is_told_without_what_lost_none() -> None:
    lost = {"energy.given": 21.0, "energy.lost_switching": 5.01, "energy.lost_friction": 0.0}
    (row,) = cells(table_of(summary.damping_blocks(made_group(case(dda=lost)))))
    assert row == {"given": "21", "Lost by opening and closing": "5.01"}


@pytest.mark.parametrize(
    ("name", "choices"),
    [
        ("figures-3-4", ["Time step.", "Springs.", "Discount."]),
        ("waves-blocks", ["Time step.", "Discount."]),
        ("beams-squares", ["Time step.", "Springs.", "Discount."]),
        ("rigid-standing", []),
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


def test_several_scenes_have_a_line_each() -> None:
    pair = between(PAPER.name, "dda", "bar", displacement_l2=0.0363)
    known = replace(made_group(case(dda={"mode1.damping": 0.16}, bar={}), comparisons=(pair,)), title="One")
    table = summary.overview({"one": known, "two": replace(made_group(case(fem={})), title="Two")})
    first, second = cells(table)
    assert first["Error of DDA displacement"] == "3.63\u00a0%" and first["most ms a run"] == "6.00"
    assert (second["Scene"], second["damping of the first mode"], second["Alarms"]) == ("Two", "–", "none")
    assert "Error of DDA contact pressure" not in first
