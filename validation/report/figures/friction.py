"""Figures of blocks with friction: ways beside closed forms, creep over time and step, drag over its rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from validation.report.figures.histories import Margins, axes_grid, house_style
from validation.runs.history import Array

HEIGHT = 48.0  # mm
Place = Literal["best", "upper left", "upper center", "lower left"]


@dataclass(frozen=True)
class Trace:
    """A line or, where it is `dotted`, points, with the words beside its end."""

    name: str
    x: Array
    y: Array
    color: str
    dotted: bool = False
    dash: tuple[float, ...] = ()


@dataclass(frozen=True)
class TracePanel:
    """Traces in one pair of axes."""

    title: str
    x_label: str
    y_label: str
    traces: tuple[Trace, ...]
    logarithmic: bool = False
    legend: Place = "best"


def panels_figure(panels: Sequence[TracePanel]) -> Figure:
    """Draw panels side by side, each with axes of its own."""
    with house_style():
        figure, (row,) = axes_grid([(HEIGHT, 0.0)], len(panels), Margins(15.0, 3.0, 6.0, 10.0, 16.0))
        for axes, panel in zip(row, panels, strict=True):
            _draw(axes, panel)
    return figure


def _draw(axes: Axes, panel: TracePanel) -> None:
    if panel.logarithmic:
        axes.set(xscale="log", yscale="log")
    for trace in panel.traces:
        style = "o" if trace.dotted else "-"
        (line,) = axes.plot(trace.x, trace.y, style, color=trace.color, lw=1.1, ms=3.2, mew=0.6, label=trace.name)
        if trace.dotted:
            line.set_markerfacecolor("white")
        elif trace.dash:
            line.set_dashes(trace.dash)
    if panel.logarithmic:
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_minor_formatter(NullFormatter())
    elif panel.traces:
        axes.set_xlim(0.0, float(np.max([np.max(trace.x) for trace in panel.traces])))
    axes.set(title=panel.title, xlabel=panel.x_label, ylabel=panel.y_label)
    if panel.traces:
        axes.legend(loc=panel.legend, frameon=False, fontsize=6, handlelength=1.6)
