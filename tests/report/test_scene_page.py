"""The page of a scene: its drawing, and the case and window that show what the solvers differ by."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from oracles.made_cases import made_case, made_group, made_history

from validation.report.chapters.scene import PERIODS, lead_figure
from validation.report.figures.drawing import FACE, scene_figure
from validation.scenes.scene import load_scene, scene_names

FREQUENCY = 345.0  # rad/s
BASE = load_scene("figures-3-4").with_values({"time.step": 0.001, "time.steps": 200})


def vibrating(step: float, share: float, metrics: dict[str, float]):
    """Return a case whose DDA is so large a share off its bar at every instant."""
    time = step * np.arange(1, round(0.2 / step) + 1)
    bar = -0.01 * (1 - np.cos(FREQUENCY * time))
    scene = BASE.with_values({"time.step": step, "time.steps": len(time)}, label=True)
    histories = {"dda": made_history(step, (1 + share) * bar), "bar": made_history(step, bar)}
    return made_case(scene, {"dda": metrics, "bar": metrics}, histories, f"dt = {step:g} s")


@pytest.mark.parametrize("known", [True, False], ids=["frequency known", "counted"])
def test_the_case_and_the_window_that_open_a_page(known: bool, drawn: dict[str, Figure], tmp_path: Path) -> None:
    """Of 0.5, 8 and 60 % the middle one, over the first periods of the slowest mode."""
    metrics = {"mode1.frequency": FREQUENCY} if known else {}
    cases = [vibrating(*numbers, metrics) for numbers in ((0.002, 0.005), (0.001, 0.08), (0.0005, 0.6))]
    (block,) = lead_figure(made_group(*cases), tmp_path)
    assert block.caption.startswith("dt = 0.001 s, of 3 cases")
    assert "dda is 8\u00a0% off bar in displacement" in block.caption
    window = drawn["scene-lead.svg"].axes[0].get_xlim()[1]
    assert window == pytest.approx(PERIODS * 2 * np.pi / FREQUENCY, rel=0.02 if known else 0.2)


def test_a_motion_that_is_driven_is_shown_whole(drawn: dict[str, Figure], tmp_path: Path) -> None:
    case = vibrating(0.001, 0.08, {"mode1.frequency": FREQUENCY})
    record = tmp_path / "record.csv"
    record.write_text("time,x\n0,0\n1,0\n")
    driven = case.scene.with_values({"load.base_motion": str(record)})
    lead_figure(made_group(made_case(driven, {"dda": {}, "bar": {}}, case.histories)), tmp_path)
    assert drawn["scene-lead.svg"].axes[0].get_xlim()[1] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("name", "bodies"),
    [("figures-3-4", 1), ("rocking-swing", 1), ("columns-joints", 1), ("rigid-pile", 11), ("patch-four-quads", 4)],
)
def test_each_kind_of_scene_is_drawn_with_all_its_bodies(name: str, bodies: int) -> None:
    (axes,) = scene_figure(load_scene(name).expand()[0]).axes
    filled = [patch for patch in axes.patches if to_hex(patch.get_facecolor()) == FACE]
    assert len(filled) == bodies and not axes.axison


def test_scenes_are_drawn_inside_their_axes() -> None:
    for name in scene_names()[::3]:  # of every family some
        (axes,) = scene_figure(load_scene(name).expand()[0]).axes
        corners = np.vstack([patch.get_path().vertices for patch in axes.patches])
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        assert left <= corners[:, 0].min() and corners[:, 0].max() <= right, name
        assert low <= corners[:, 1].min() and corners[:, 1].max() <= high, name


def test_what_is_rounding_decides_nothing(drawn: dict[str, Figure], tmp_path: Path) -> None:
    """Which of two cases is shown would depend on the processor."""
    cases = [vibrating(step, share, {"mode1.frequency": FREQUENCY}) for step, share in ((0.002, 1e-15), (0.001, 1e-13))]
    (block,) = lead_figure(made_group(*cases), tmp_path)
    assert block.caption.startswith("dt = 0.002 s, of 2 cases the first.")
