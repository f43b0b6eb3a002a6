"""Figures of vibrations, waves, impacts, slopes and turning blocks: each line holds its own numbers in its own unit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from oracles.made_cases import line_in, names_at

from validation.report.figures import response
from validation.report.figures.charts import ChartLine, ChartPanel, Names, chart_figure
from validation.report.figures.curves import style_of
from validation.report.figures.histories import Margins
from validation.runs.history import DISPLACEMENT, PRESSURE

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


# ---- impacts ------------------------------------------------------------------------------------------------------


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
