"""Charts of a few curves side by side: each named at its end, limits and levels as hairlines with their words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from validation.report.figures.curves import GREY, HAIR, dash_style
from validation.report.figures.histories import Margins, axes_grid, house_style, label_ends
from validation.runs.history import Array

CHOICES = ("#0072b2", "#009e73", "#cc79a7", "#8c6d1f")  # of settings, which are no solvers: colours of their own
DASHED = (4.0, 1.8)
NARROW = 1.42  # mm, width of a letter of a name


@dataclass(frozen=True)
class Stroke:
    """A named curve, or its dots alone."""

    name: str
    x: Array
    y: Array
    color: str
    dash: tuple[float, ...] = ()
    dots: bool = False
    line: bool = True
    has_label: bool = True  # its name, at its end


@dataclass(frozen=True)
class Chart:
    """Curves on one pair of axes."""

    title: str
    labels: tuple[str, str]
    strokes: Sequence[Stroke]
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    marks: Mapping[str, float] = field(default_factory=dict)  # words at an x
    levels: Mapping[str, float] = field(default_factory=dict)  # words at a y
    logarithmic: tuple[bool, bool] = (True, True)


def charts_figure(charts: Sequence[Chart], height: float = 48.0) -> Figure:
    """Draw charts side by side, each with room for the names of its curves at the right."""
    labels: list[str] = []
    for chart in charts:
        labels += [stroke.name for stroke in chart.strokes if stroke.has_label]
    room = 4.5 + NARROW * max(map(len, labels))
    with house_style():
        margins = Margins(10.0, room, 10.0, 9.5, room + 9.0)
        figure, (row,) = axes_grid([(height, 0.0)], len(charts), margins)
        for axes, chart in zip(row, charts, strict=True):
            _draw(axes, chart)
    return figure


def _draw(axes: Axes, chart: Chart) -> None:
    for name, logarithmic in zip("xy", chart.logarithmic, strict=True):
        if logarithmic:
            getattr(axes, f"set_{name}scale")("log")
            axis = getattr(axes, f"{name}axis")
            axis.set_major_locator(LogLocator(numticks=7))
            axis.set_major_formatter(lambda value, _: _power(value))
            minor = NullLocator() if name == "y" else LogLocator(subs=tuple(range(2, 10)), numticks=12)
            axis.set_minor_locator(minor)
            axis.set_minor_formatter(NullFormatter())
    axes.set(xlim=chart.x_range, ylim=chart.y_range, xlabel=chart.labels[0], ylabel=chart.labels[1])
    axes.set_title(chart.title, pad=12.0)
    _hairlines(axes, chart)
    ends: dict[str, float] = {}
    colors: dict[str, str] = {}
    for stroke in chart.strokes:
        look: dict[str, Any] = {"color": stroke.color, "zorder": 4}
        if stroke.line:
            axes.plot(stroke.x, stroke.y, lw=1.2, ls=dash_style(stroke.dash), **look)
        if stroke.dots:
            axes.plot(stroke.x, stroke.y, "o", ms=3.2, **look)
        drawn = np.flatnonzero(np.isfinite(stroke.y) & (stroke.x <= chart.x_range[1]))
        if stroke.has_label and drawn.size:
            ends[stroke.name] = float(np.clip(stroke.y[drawn[-1]], *chart.y_range))
            colors[stroke.name] = stroke.color
    label_ends(axes, ends, colors=colors, below=0.0)


def _power(value: float) -> str:
    """Return a tick's number, as a power of ten where it is long."""
    return f"{value:g}" if 1e-3 < value < 1e4 else f"$10^{{{round(math.log10(value))}}}$"


def _hairlines(axes: Axes, chart: Chart) -> None:
    look: dict[str, Any] = {"color": GREY, "lw": HAIR, "zorder": 1}
    for words, x in chart.marks.items():
        axes.axvline(x, ls=(0, (3, 2)), **look)
        place = axes.get_xaxis_transform()
        axes.text(x, 1.01, words, transform=place, color=GREY, fontsize=6, ha="center", va="bottom")
    for words, y in chart.levels.items():
        axes.axhline(y, ls=(0, (3, 2)), **look)
        place = axes.get_yaxis_transform()
        axes.text(0.01, y, words, transform=place, color=GREY, fontsize=6, ha="left", va="bottom")
