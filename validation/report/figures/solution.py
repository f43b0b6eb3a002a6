"""The figure of a solution from Python: columns of a history over time, a panel each."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure as Figure

from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.histories import Margins
from validation.runs.columns import NO_OWN, OwnColumns, axis_of
from validation.runs.history import History

ROW = 42.0, 17.0  # mm: height of a panel, gap below it
MARGINS = Margins(20.0, 24.0, 10.0, 9.5)


def solution_figure(history: History, columns: Sequence[str], solver: str, own: OwnColumns = NO_OWN) -> Figure:
    """Draw columns of a history, over time, below each other, in the colour of its solver."""
    panels = []
    for name in columns:
        words, unit = axis_of(name, own)
        label = f"{words} [{unit}]" if unit else words
        panels.append(ChartPanel(words, "Time [s]", label, [ChartLine(solver, history.time, history.columns[name])]))
    return chart_figure(panels, [ROW] * len(panels), MARGINS)
