"""Figures of blocks that turn: lines over time in panels, each line with its name at its end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from validation.report.figures.curves import dash_style, thin
from validation.report.figures.histories import Margins, axes_grid, house_style, label_ends
from validation.runs.history import Array

COLORS = ("#d55e00", "#0072b2", "#009e73", "#666666")


@dataclass(frozen=True)
class TurningLine:
    """A line and its name."""

    name: str
    x: Array
    y: Array
    dashed: bool = False


@dataclass(frozen=True)
class TurningPanel:
    """Lines over one axis, with a level and an instant to compare with."""

    title: str
    x_label: str
    y_label: str
    lines: tuple[TurningLine, ...]
    level: float | None = None
    instant: float | None = None


def turning_figure(panels: Sequence[TurningPanel]) -> Figure:
    """Draw panels side by side."""
    with house_style():
        figure, (row,) = axes_grid([(42.0, 0.0)], len(panels), Margins(13.0, 20.0, 6.0, 10.0, 33.0))
        for axes, panel in zip(row, panels, strict=True):
            ends: dict[str, float] = {}
            colors: dict[str, str] = {}
            for line, solid in zip(panel.lines, COLORS, strict=False):
                x, y = thin(line.x, line.y)
                color, dash = ("#000000", (3.0, 2.0)) if line.dashed else (solid, ())
                axes.plot(x, y, color=color, lw=1.0, ls=dash_style(dash))
                ends[line.name] = float(line.y[-1])
                colors[line.name] = color
            axes.set_xlim(0.0, max(float(line.x[-1]) for line in panel.lines))
            if panel.level is not None:
                axes.axhline(panel.level, color="#999999", lw=0.5)
            if panel.instant is not None:
                axes.axvline(panel.instant, color="#999999", lw=0.5)
            axes.set(title=panel.title, xlabel=panel.x_label, ylabel=panel.y_label)
            label_ends(axes, ends, colors=colors)
    return figure
