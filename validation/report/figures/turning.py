"""Figures of blocks that turn: lines over time in panels, each line with its name at its end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from validation.report.figures.curves import thin
from validation.report.figures.histories import Margins, axes_grid, house_style, label_ends
from validation.runs.history import Array

COLORS = ("#d55e00", "#0072b2", "#009e73", "#666666")


@dataclass(frozen=True)
class Line:
    """A line and its name."""

    name: str
    x: Array
    y: Array
    dashed: bool = False


@dataclass(frozen=True)
class Panel:
    """Lines over one axis, with a level and an instant to compare with."""

    title: str
    across: str
    up: str
    lines: tuple[Line, ...]
    level: float | None = None
    instant: float | None = None


def panels(shown: Sequence[Panel]) -> Figure:
    """Draw panels side by side."""
    with house_style():
        figure, (row,) = axes_grid([(42.0, 0.0)], len(shown), Margins(13.0, 20.0, 6.0, 10.0, 33.0))
        for axes, panel in zip(row, shown, strict=True):
            ends, colors = {}, {}
            for line, solid in zip(panel.lines, COLORS, strict=False):
                x, y = thin(line.x, line.y)
                color = "#000000" if line.dashed else solid
                axes.plot(x, y, color=color, lw=1.0, ls=(0, (3, 2)) if line.dashed else "-")
                ends[line.name], colors[line.name] = float(line.y[-1]), color
            axes.set_xlim(0.0, max(float(line.x[-1]) for line in panel.lines))
            if panel.level is not None:
                axes.axhline(panel.level, color="#999999", lw=0.5)
            if panel.instant is not None:
                axes.axvline(panel.instant, color="#999999", lw=0.5)
            axes.set(title=panel.title, xlabel=panel.across, ylabel=panel.up)
            label_ends(axes, ends, colors=colors)
    return figure
