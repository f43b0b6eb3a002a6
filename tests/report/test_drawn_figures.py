"""What a drawn figure tells its reader: each name stands beside its own line's end, each line holds its own numbers."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_hex
from oracles.made_cases import names_at

from validation.report.chapters import ledger
from validation.report.figures import curves
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure


def color(name: str) -> str:
    return to_hex(curves.style_of(name).color)


def test_the_ledger_figure_shows_displacement_filled_and_pressure_open_in_the_columns_of_their_parts() -> None:
    parts = {"code": (1e-13, 2e-11), "mesh": (1e-6, 3e-5), "time": (0.1, None)}
    panels = ledger.ledger_panels([("one", {}), ("two", parts)])
    figure = chart_figure(panels, 12.0, ledger.MARGINS, shared=True)
    assert [(t.get_text(), t.get_position()[1]) for t in figure.axes[0].get_yticklabels()] == [("one", 1), ("two", 0)]
    rounding = np.sqrt(ledger.EDGE * ledger.ROUNDING)  # a strip without places of its own
    for axes, (part, (displacement, pressure)) in zip(figure.axes, parts.items(), strict=True):
        assert axes.get_title(loc="left") == part
        shown = {
            to_hex(line.get_markerfacecolor()): line
            for line in axes.lines
            if line.get_marker() == "o" and line.get_xdata().size
        }
        filled = shown[to_hex(ledger.ROUNDING_COLOR if part == "code" else ledger.DOT_COLOR)]
        hollow = shown.get("#ffffff")
        assert filled.get_xdata()[0] == (rounding if part == "code" else displacement)
        assert round(filled.get_ydata()[0]) == 0  # the second line of the ledger, from above
        assert (None if hollow is None else hollow.get_xdata()[0]) == pressure


# ---- error against cost -------------------------------------------------------------------------------------------


def test_work_lines_are_named_at_their_dearest_run_and_points_carry_their_own_note() -> None:
    lines = [
        ChartLine("squares", np.array([1.0, 10.0]), np.array([0.5, 0.1]), dots=3.0, notes=("1", "2")),
        ChartLine("triangles", np.array([20.0, 2.0]), np.array([0.01, 0.4]), dots=3.0, notes=("8", "3")),
    ]
    (axes,) = chart_figure([ChartPanel("", "s", "error", lines, logarithmic=(True, True))]).axes
    found = names_at(axes)
    assert found["squares"] == (pytest.approx(0.1), color("squares"))
    assert found["triangles"] == (pytest.approx(0.01), color("triangles"))
    notes = {text.get_text(): text.xy for text in axes.texts if hasattr(text, "xy")}
    assert notes == {"1": (1.0, 0.5), "2": (10.0, 0.1), "8": (20.0, 0.01), "3": (2.0, 0.4)}


# ---- stiff contacts and extremes ----------------------------------------------------------------------------------
