"""Scenes of rigid boxes on the command line: drawn and told in numbers, run, drawn; what is not theirs refuses them."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import typed

from validation import solve
from validation.report.chapters.text import parameter_items
from validation.report.figures.curves import HistoryPanel, common_range
from validation.runs.columns import axis_of
from validation.runs.history import History
from validation.scenes.kinds import kinds
from validation.scenes.scene import Scene, parse_scene

SCENE = """
title = "A box on a slope"
[rigid]
slope = 20.0
friction = 19.0
[[rigid.box]]
width = 0.6
height = 1.2
density = 2500.0
[time]
step = 0.01
steps = 20
[run]
solvers = ["dda"]
"""
BOX = {"width": 0.6, "height": 1.2, "density": 2500.0}
WEIGHT = 9.81


def scene(boxes: list[dict[str, Any]], columns: list[str] | None = None, **rigid: Any) -> Scene:
    run = {"solvers": ["dda"]} | ({"columns": columns} if columns else {})
    data = {"rigid": {"box": [BOX | box for box in boxes]} | rigid, "time": {"step": 0.01, "steps": 20}, "run": run}
    return parse_scene(data, "boxes")


@pytest.fixture
def rigid_file(tmp_path: Path) -> Path:
    file = tmp_path / "boxes.toml"
    file.write_text(SCENE)
    return file


def shown(*arguments: object) -> dict[str, Any]:
    done = typed("show", *arguments, "--json")
    assert done.returncode == 0, done.stderr
    page: dict[str, Any] = json.loads(done.stdout)
    return page


def test_numbers_are_those_of_the_formulas(rigid_file: Path) -> None:
    page = shown(rigid_file)
    values = {name: value["low"] for name, value in page["numbers"].items()}
    expected = {"m": 1800.0, "w/h": 0.5, "tan phi": math.tan(math.radians(19)), "tan b": math.tan(math.radians(20))}
    assert values == pytest.approx(expected | {"n dt": 0.2})
    assert list(page["remarks"]) == ["tan b > tan phi: the boxes slide"]


def test_what_turns_a_box_over_satisfies_the_balance_of_energy(rigid_file: Path) -> None:
    level = ("--set", "rigid.slope=0.0", "--set", "rigid.friction=40.0")
    values = {name: value["low"] for name, value in shown(rigid_file, *level)["numbers"].items()}
    half_diagonal = math.hypot(0.6, 1.2) / 2
    about_edge = 1800 * (0.6**2 + 1.2**2) / 12 + 1800 * half_diagonal**2
    rise = half_diagonal - 1.2 / 2
    assert about_edge * values["w over"] ** 2 / 2 == pytest.approx(1800 * WEIGHT * rise)
    assert values["p"] ** 2 == pytest.approx(1800 * WEIGHT * half_diagonal / about_edge)
    assert math.tan(math.radians(values["alpha"])) == pytest.approx(0.5)


def test_a_box_that_slides_before_it_rocks_is_told_no_rate_that_turns_it_over(rigid_file: Path) -> None:
    level = ("--set", "rigid.slope=0.0")
    assert "w over" not in shown(rigid_file, *level, "--set", "rigid.friction=26.0")["numbers"]
    assert "w over" in shown(rigid_file, *level, "--set", "rigid.friction=27.0")["numbers"]


def test_a_landing_a_contact_and_a_ground_that_moves(tmp_path: Path) -> None:
    file = tmp_path / "boxes.toml"
    extra = "stiffness = 1e5\nbase_amplitude = 0.1\nbase_frequency = 2.0\n[[rigid.box]]\nlift = 0.2\nvelocity = [0, -1]"
    file.write_text(SCENE.replace("slope = 20.0", "").replace("[[rigid.box]]", extra))
    page = shown(file)
    values = {name: value["low"] for name, value in page["numbers"].items()}
    time = values["t landing"]
    assert 0.2 - time - WEIGHT / 2 * time**2 == pytest.approx(0, abs=1e-12)
    assert values["v landing"] == pytest.approx(1 + WEIGHT * time)
    assert values["t contact"] == pytest.approx(math.pi * math.sqrt(1800 / 1e5))
    assert values["m g/k"] == pytest.approx(1800 * WEIGHT / 1e5)
    assert values["a ground"] == pytest.approx(0.1 * (4 * math.pi) ** 2)
    assert any("slips" in remark for remark in page["remarks"])


@pytest.mark.long
def test_a_scene_of_boxes_is_run_reported_and_drawn(rigid_file: Path, tmp_path: Path) -> None:
    results = ("--results", tmp_path / "results")
    done = typed("run", rigid_file, *results)
    assert done.returncode == 0, done.stderr
    assert "displacement" not in done.stdout  # no metric and no gate of a block is advised
    assert typed("report", *results, "--out", tmp_path / "report.pdf").returncode == 0
    drawn = typed("report", "boxes", *results, "--figures", tmp_path / "figures")
    assert drawn.returncode == 0, drawn.stderr
    assert typed("report", *results, "--site", tmp_path / "gallery").returncode == 0
    assert "boxes-history.svg" in (tmp_path / "gallery" / "scene-boxes.html").read_text()


@pytest.mark.parametrize(
    ("column", "words", "unit"),
    [("x_1", "x, box 1", "m"), ("angle_12", "Rotation, box 12", "rad"), ("force_1", "Normal force, box 1", "N")],
)
def test_columns_of_boxes_have_words_and_units(column: str, words: str, unit: str) -> None:
    assert axis_of(column, kinds()["rigid"].columns) == (words, unit)


def test_a_solution_says_its_peak_in_the_unit_of_the_column() -> None:
    at_rest = scene([{}], columns=["force_1"], friction=30.0)
    weight = solve(at_rest, "rigid-exact")
    assert f"peak force_1 {1800 * WEIGHT:.4g} N" in repr(weight)
    beside = replace(weight, history=History(np.array([0.01]), {"energy_1": np.array([2.0])}))
    assert "peak energy_1 2," in repr(beside)


def test_rounding_of_a_box_at_rest_is_drawn_as_rest() -> None:
    time = np.linspace(0.01, 1, 100)
    history = History(time, {"angle_1": 1e-16 * np.sin(time)})
    low, high = common_range([HistoryPanel("", {"mine": history}, {}, None, own=kinds()["rigid"].columns)], "angle_1")
    assert (low, high) == (-1e-9, 1e-9)


def test_parameters_name_what_all_boxes_have_in_common() -> None:
    items = parameter_items(scene([{"density": 1000.0}, {}], friction=30.0), set())
    assert items[:4] == ["2 boxes", "width = 0.6 m", "height = 1.2 m", "density by box"]
    assert "φ = 30°" in items
    assert not any(item.startswith(("α", "δ", "degree", "foundation")) for item in items)
