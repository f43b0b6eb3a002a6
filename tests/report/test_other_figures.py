"""Figures of vibrations, waves, impacts, slopes and turning blocks: each line holds its own numbers in its own unit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from oracles.made_cases import line_in, lines_of, made_case, made_group, names_at

from validation.report.figures import response
from validation.report.figures.charts import ChartLine, ChartPanel, Names, chart_figure
from validation.report.figures.curves import style_of
from validation.report.figures.histories import Margins
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.scenes.scene import load_scene
from validation.studies.rebound import chapter as rebound
from validation.studies.waves import chapter as waves

F = np.array([1.0, 2.0, 4.0])  # Hz


def color(name: str) -> str:
    return to_hex(style_of(name).color)


def curve(name: str, solver: str, size: Any, phase: Any, dashed: bool = False) -> response.ResponseCurve:
    parts = {DISPLACEMENT: (1e-3 * np.array(size), np.array(phase)), PRESSURE: (2e6 * np.array(size), np.array(phase))}
    return response.ResponseCurve(name, solver, dashed, F, parts)


@pytest.mark.parametrize(
    ("per_metre", "factors", "titles"),
    [
        (False, (1.0, 2.0), ("Displacement [mm]", "Contact pressure [MPa]")),
        (True, (1e-3, 2e6), ("Displacement [m/m]", "Contact pressure [Pa/m]")),
    ],
)
def test_a_response_has_its_amplitudes_above_its_phases_and_its_names_at_their_ends(
    per_metre: bool, factors: tuple[float, float], titles: tuple[str, str]
) -> None:
    sizes, phases = {"dda": (4.0, 8.0, 2.0), "bar": (3.0, 5.0, 6.0)}, {"dda": (0.1, 0.5, 3.0), "bar": (-0.2, -1.0, -3)}
    shown = [curve(f"{name} as stepped", name, sizes[name], phases[name]) for name in sizes]
    above, right, below, last = response.response_figure(shown, False, per_metre).axes
    assert (above.get_title(loc="left"), right.get_title(loc="left")) == titles
    for axes, phase_axes, factor in ((above, below, factors[0]), (right, last, factors[1])):
        for name in sizes:
            x, y = line_in(axes, color(name))
            assert np.allclose(x, F) and np.allclose(y, factor * np.array(sizes[name]))
            assert np.allclose(line_in(phase_axes, color(name))[1], phases[name])
    ends = {f"{name} as stepped": (pytest.approx(factors[1] * size[-1]), color(name)) for name, size in sizes.items()}
    assert names_at(right) == ends


def test_damping_ratios_over_frequency_are_in_per_cent() -> None:
    lines = {"as stepped": np.array([0.01, 0.02, 0.05]), "Rayleigh": np.array([0.03, 0.02, 0.01])}
    (axes,) = response.ratio_figure(F, lines).axes
    for (name, values), shade in zip(lines.items(), response.COLORS, strict=False):
        assert np.allclose(line_in(axes, shade)[1], 100 * values)
        assert names_at(axes)[name] == (pytest.approx(100 * values[-1]), shade)


# ---- waves --------------------------------------------------------------------------------------------------------


def test_speed_is_in_per_cent_beside_what_is_left_as_a_share() -> None:
    blocks = np.array([8.0, 20.0, 100.0])
    lost = waves.TravelledWaves("(1/2, 1)", 0.5, blocks, np.array([0.03, 0.01, 0.001]), np.array([0.1, 0.4, 0.8]))
    kept = waves.TravelledWaves("(1/4, 1/2)", 0.5, blocks, np.array([-0.02, -0.01, 0.0]), np.ones(3))
    speed, left = chart_figure(waves.travel_panels([lost, kept], [])).axes
    for travel in (lost, kept):
        shade = waves.COLORS[travel.scheme]
        assert np.allclose(line_in(speed, shade)[1], 100 * travel.speed)
        assert np.allclose(line_in(left, shade)[1], travel.amplitude)
    named = names_at(left)
    assert named["(1/2, 1), c dt/h = 0.5"] == (pytest.approx(0.8), waves.COLORS["(1/2, 1)"])
    assert named["(1/4, 1/2), every dt"] == (pytest.approx(1.0), waves.COLORS["(1/4, 1/2)"])


def test_a_site_tells_the_largest_of_each_trace_in_the_unit_of_its_panel() -> None:
    time = np.array([0.0, 1.0, 2.0])
    moved = ChartLine("surface", time, np.array([0.0, -4e-3, 3e-3]), "#123456")
    pushed = ChartLine("base", time, np.array([0.0, 2e5, -1e5]), "#654321")
    panels = [waves.site_panel("Displacement", "m", [moved], ""), waves.site_panel("Stress", "Pa", [pushed], "t")]
    first, second = chart_figure(panels, [(42.0, 9.0), (42.0, 0.0)]).axes
    assert (first.get_title(loc="left"), second.get_title(loc="left")) == ("Displacement [mm]", "Stress [kPa]")
    assert [text.get_text() for axes in (first, second) for text in axes.texts] == [
        "surface\n4 mm at most", "base\n200 kPa at most"
    ]  # fmt: skip
    assert np.allclose(line_in(first, "#123456")[1], [0, -4, 3])
    assert np.allclose(line_in(second, "#654321")[1], [0, 200, -100])


# ---- impacts ------------------------------------------------------------------------------------------------------


def test_a_restitution_has_its_mean_as_a_line_within_its_range_and_its_impacts_as_dots(
    drawn: dict[str, Figure], tmp_path: Path
) -> None:
    mean, low, high = [0.9, 0.6, 0.5], [0.8, 0.4, 0.0], [1.0, 0.8, 1.2]
    data = {"omega": [0.1, 1.0, 10.0], "schemes": {"constant": {"mean": mean, "low": low, "high": high}}}
    scene = load_scene("rebound-constant").expand()[0]
    width, height = np.ptp(np.array(scene.block.outline), axis=0)
    natural = np.sqrt(2 * scene.contact.stiffness / (scene.block.density * width * height))
    cases = [
        made_case(scene.with_values({"time.step": omega / natural}), {"dda": {"contact.restitution": e}})
        for omega, e in ((2.0, 0.3), (50.0, 0.7))
    ]
    impacts = [replace(made_group(*cases), name="rebound-constant")]
    rebound.restitution_blocks(data, impacts, tmp_path)
    (axes,) = drawn["rebound-restitution.svg"].axes
    assert axes.get_title(loc="left") == "constant acceleration"
    assert np.allclose(line_in(axes, rebound.COLORS[0])[1], mean)
    dots = [(float(x[0]), float(y[0])) for shade, x, y in lines_of(axes) if x.size == 1]
    assert dots == [(pytest.approx(2.0), 0.3)]  # the other lies beyond the axis
    (edge,) = axes.collections[0].get_paths()
    for x, least, most in zip(data["omega"], low, high, strict=True):
        ys = edge.vertices[np.isclose(edge.vertices[:, 0], x), 1]
        assert (ys.min(), ys.max()) == (pytest.approx(least), pytest.approx(most))


# ---- slopes and turning blocks ------------------------------------------------------------------------------------


def of_legend(axes: Axes) -> dict[str, str]:
    """Return the names of a legend with the colours that stand beside them."""
    legend = axes.get_legend()
    assert legend is not None
    handles, texts = legend.legend_handles, legend.get_texts()
    return {text.get_text(): to_hex(line.get_color()) for text, line in zip(texts, handles, strict=True)}  # type: ignore[union-attr]


def test_runs_are_lines_and_another_program_is_circles_each_named_in_its_colour() -> None:
    x = np.array([1.0, 2.0, 3.0])
    run = ChartLine("dda", x, 2 * x, "#d55e00")
    other = ChartLine("program", x, 3 * x, "#000000", width=0, dots=3.2, hollow=True)
    panel = ChartPanel("Slip", "t [s]", "slip [mm]", (run, other), names="upper left")
    (axes,) = chart_figure([panel], margins=Margins(15.0, 3.0, 6.0, 10.0, 16.0)).axes
    assert (axes.get_title(loc="left"), axes.get_xlabel(), axes.get_ylabel()) == ("Slip", "t [s]", "slip [mm]")
    assert of_legend(axes) == {"dda": "#d55e00", "program": "#000000"}
    assert [(line.get_linestyle(), line.get_marker()) for line in axes.lines] == [("-", "None"), ("None", "o")]
    assert np.allclose(line_in(axes, "#d55e00")[1], 2 * x) and np.allclose(line_in(axes, "#000000")[1], 3 * x)
    assert axes.get_xlim() == (0.0, 3.0)


@pytest.mark.parametrize("names", ["ends", "beside", "upper left"])
@pytest.mark.parametrize("logarithmic", [(False, False), (True, True)])
def test_a_panel_without_lines_is_empty_axes(names: Names, logarithmic: tuple[bool, bool]) -> None:
    (axes,) = chart_figure([ChartPanel("Slide", "t [s]", "", (), logarithmic=logarithmic, names=names)]).axes
    assert (len(axes.lines), axes.get_legend(), axes.get_xlabel()) == (0, None, "t [s]")
