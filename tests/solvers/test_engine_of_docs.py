"""The engine of docs/field.md: its code runs as the page has it, and the page's table of problems is the code's."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from validation.scenes.scene import Scene, parse_scene
from validation.solvers.user import UserSolver

PAGE = (Path(__file__).parents[2] / "docs" / "field.md").read_text(encoding="utf-8")
GRAVITY = 9.81


@pytest.fixture
def engine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Scene], dict[str, np.ndarray]]:
    """Return the solve of the page's second adapter, that of rigid boxes."""
    code = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[1]
    names: dict[str, Any] = {}
    exec(compile(code, "docs/field.md", "exec"), names)
    solve: Callable[[Scene], dict[str, np.ndarray]] = names["Impulses"]().solve
    return solve


def scene(box: dict[str, Any], steps: int = 50, boxes: int = 1, **rigid: Any) -> Scene:
    own = {"width": 1.0, "height": 1.0, "density": 2500.0} | box
    data = {"rigid": {"box": [own] * boxes} | rigid, "time": {"step": 0.01, "steps": steps}}
    return parse_scene(data, "boxes")


@pytest.mark.long
def test_a_box_slides_as_far_as_it_should_or_stands(engine: Callable[..., Any]) -> None:
    slope = math.radians(20)
    for friction in (10.0, 30.0):
        history = engine(scene({}, slope=20.0, friction=friction))
        pull = GRAVITY * (math.sin(slope) - math.tan(math.radians(friction)) * math.cos(slope))
        # At t = 0 it stands on the ground to rounding: a step or so of free flight is the error, 1 mm of 0.7 s falling.
        assert history["x_1"][-1] == pytest.approx(max(pull, 0.0) * 0.5**2 / 2, abs=1e-3)
        assert history["force_1"][-1] == pytest.approx(2500 * GRAVITY * math.cos(slope), rel=1e-6)


def test_it_answers_without_weight_too(engine: Callable[..., Any]) -> None:
    history = engine(scene({"lift": 0.1, "velocity": [0.0, -1.0]}, restitution=0.5, gravity=0.0))
    assert np.diff(history["y_1"])[-1] / 0.01 == pytest.approx(0.5, abs=1e-9)


@pytest.mark.long
def test_ground_that_shakes_takes_it_along_as_far_as_friction_can(engine: Callable[..., Any]) -> None:
    history = engine(scene({}, friction=45.0, base_amplitude=0.01, base_frequency=1.0, steps=100))
    time = 0.01 * np.arange(1, 101)
    assert history["x_1"] == pytest.approx(0.01 * (1 - np.cos(2 * math.pi * time)), abs=1e-4)


def test_the_suite_takes_it_for_a_solver_of_rigid_boxes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[1]
    (tmp_path / "impulses.py").write_text(code)
    monkeypatch.syspath_prepend(str(tmp_path))
    solver = UserSolver("impulses", "impulses:Impulses")
    assert solver.about()["program"] == "impulses"
