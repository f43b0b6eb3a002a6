"""Charts: lines in panels, described once and drawn by one function.

A chapter says what the lines are and what the axes mean; how an axis is numbered, where a name stands and how a
hairline looks is decided here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure as Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, NullLocator

from validation.report.figures.curves import GREY, HAIR, dash_style, style_of, thin
from validation.report.figures.histories import (
    WIDTH,
    EndLabel,
    Margins,
    axes_grid,
    house_style,
    label_ends,
    outer_ticks,
    share_left,
    size_of,
)
from validation.runs.history import Array, ArrayPair
from validation.runs.numbers import tick_text

LETTER = 1.42  # mm, width of a letter of a name
Names = Literal["ends", "beside", "none", "upper left", "upper center", "lower left"]  # or where the legend stands
DECADES = 1.5  # a shorter logarithmic axis has ticks at 1, 2 and 5
MARKED = 9.0  # mm above the panels: room for the words of marks below the title


@dataclass(frozen=True)
class ChartLine:
    """A line and its name, which stands beside its end."""

    name: str
    x: Array
    y: Array
    color: str = ""  # with width and dash those of the solver of this name where it is empty
    dash: tuple[float, ...] = ()  # pt
    width: float = 1.2  # pt; 0: its dots alone
    dots: float = 0.0  # pt, size of the dots at its points; 0: none
    hollow: bool = False  # whether the dots are
    notes: tuple[str, ...] = ()  # words beside each point
    note: str = ""  # what follows the name
    shaded: ArrayPair | None = None  # least and greatest value about the line

    @property
    def shade(self) -> str:
        """The colour."""
        return self.color or style_of(self.name).color

    def look(self) -> dict[str, Any]:
        """Return how matplotlib draws the line."""
        if self.color:
            return {"color": self.color, "lw": self.width, "ls": dash_style(self.dash), "zorder": 4}
        style = style_of(self.name)
        return {"color": style.color, "lw": style.width, "ls": dash_style(style.dash), "zorder": 2 + style.layer}


@dataclass(frozen=True)
class ChartPanel:
    """Lines on one pair of axes."""

    title: str
    x_label: str
    y_label: str
    lines: Sequence[ChartLine]
    x_range: tuple[float, float] | None = None  # of all points by default, from 0 where the axis is linear
    y_range: tuple[float | None, float | None] | None = None
    logarithmic: tuple[bool, bool] = (False, False)
    marks: Mapping[str, float] = field(default_factory=dict)  # words at an x, above the axes where there is room
    levels: Mapping[str, float] = field(default_factory=dict)  # words at a y
    x_ticks: Mapping[float, str] | int = 0  # or how many parts an axis from 0 has at most
    y_ticks: Mapping[float, str] | int = 0
    names: Names = "ends"


def chart_figure(
    panels: Sequence[ChartPanel | None],
    height: float | Sequence[tuple[float, float]] = 48.0,
    margins: Margins | None = None,
    shared: bool = False,
    width: float = WIDTH,
) -> Figure:
    """Draw panels from left to right and from above.

    Parameters
    ----------
    panels
        As many in each row, of which the last may be None: these places stay empty.
    height
        Height of one row [mm], or height of each row and gap below it.
    margins
        Margins [mm]; by default there is room for the names of the lines at the right of each panel.
    shared
        Whether the panels of a row have one y axis, labelled at the left.
    width
        Width of the figure [mm].
    """
    rows = [(height, 0.0)] if isinstance(height, float | int) else list(height)
    drawn = [panel for panel in panels if panel is not None]
    is_marked = margins is None or any(panel.marks for panel in drawn)
    if margins is None:
        margins = _margins_for(drawn)
    across = len(panels) // len(rows)
    has_marked_top = is_marked and margins.top >= MARKED
    with house_style():
        figure, grid = axes_grid(rows, across, margins, width)
        lines = [panels[first : first + across] for first in range(0, len(panels), across)]
        for row, line in zip(grid, lines, strict=True):
            pairs = [(axes, panel) for axes, panel in zip(row, line, strict=True) if panel is not None]
            for axes, panel in pairs:
                _draw_lines(axes, panel)
            if shared:
                _share_y([axes for axes, _ in pairs])
            for axes, panel in pairs:
                axes.set(xlabel=panel.x_label, ylabel=panel.y_label)
                axes.set_title(panel.title, pad=12.0 if has_marked_top else None)
                _number_axis(axes, axes.xaxis, panel.logarithmic[0], panel.x_ticks)
                _number_axis(axes, axes.yaxis, panel.logarithmic[1], panel.y_ticks)
                _draw_hairlines(axes, panel, has_marked_top)
                if not shared or axes is pairs[-1][0]:
                    _write_names(axes, panel)
            if shared:
                share_left(row, len(pairs), pairs[0][1].y_label)
                for axes, _ in pairs[1:]:
                    axes.set_ylabel("")
        for row, following, (_, gap) in zip(grid, grid[1:], rows, strict=False):
            for axes, below in zip(row, following, strict=True):
                if gap < MARKED and axes.get_xlim() == below.get_xlim():  # the axis below has the same numbers
                    axes.tick_params(labelbottom=False)
    return figure


def _margins_for(panels: Sequence[ChartPanel]) -> Margins:
    longest = 0
    for panel in panels:
        longest = max([longest, *(len(line.name + line.note) for line in panel.lines)])
    room = 4.5 + LETTER * longest
    return Margins(10.0, room, 10.0, 9.5, room + 9.0)


def _draw_lines(axes: Axes, panel: ChartPanel) -> None:
    """Draw the lines of a panel; set its scales and ranges."""
    for line in panel.lines:
        draw_chart_line(axes, line)
    scales = ["log" if logarithmic else "linear" for logarithmic in panel.logarithmic]
    axes.set(xscale=scales[0], yscale=scales[1])
    if panel.x_range is not None:
        axes.set_xlim(panel.x_range)
    elif not panel.logarithmic[0] and panel.lines:
        axes.set_xlim(0.0, max(float(np.max(line.x)) for line in panel.lines))
    if panel.y_range is not None:
        axes.set_ylim(*panel.y_range)
    axes.autoscale_view()


def _share_y(row: Sequence[Axes]) -> None:
    """Give the axes of a row one range of y."""
    limits = [axes.get_ylim() for axes in row]
    for axes in row:
        axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))


def draw_chart_line(axes: Axes, line: ChartLine) -> None:
    """Draw a line, its dots and their notes."""
    look = line.look()
    if line.shaded is not None:
        axes.fill_between(line.x, *line.shaded, color=line.shade, alpha=0.2, lw=0)
    x, y = (line.x, line.y) if line.dots else thin(line.x, line.y)
    marker: dict[str, Any] = {}
    if line.dots:
        face = "white" if line.hollow else line.shade
        edge = 0.6 if line.hollow else 1.0
        marker = {"marker": "o", "ms": line.dots, "mfc": face, "mec": line.shade, "mew": edge}
    if not line.width:
        look["ls"] = "none"
    axes.plot(x, y, label=line.name, clip_on=not line.hollow, **look, **marker)
    for point_x, point_y, note in zip(line.x, line.y, line.notes, strict=False):
        axes.annotate(note, (point_x, point_y), (2.0, 2.5), textcoords="offset points", fontsize=5.5)


def _number_axis(axes: Axes, axis: Axis, logarithmic: bool, ticks: Mapping[float, str] | int) -> None:
    low, high = axis.get_view_interval()
    if isinstance(ticks, Mapping):
        axis.set_ticks(list(ticks), labels=list(ticks.values()))
        axis.set_minor_formatter(NullFormatter())
    elif logarithmic:
        is_short = math.log10(high / low) < DECADES
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)) if is_short else LogLocator(numticks=7))
        axis.set_major_formatter(lambda value, _: tick_text(value))
        minor = LogLocator(subs=tuple(range(2, 10)), numticks=12) if axis is axes.xaxis else NullLocator()
        axis.set_minor_locator(minor)
        axis.set_minor_formatter(NullFormatter())
    elif ticks and axis is axes.xaxis:
        places = MaxNLocator(ticks, steps=[1, 2, 5, 10]).tick_values(0, high)
        texts = {float(x): f"{x:,g}".replace(",", "\u202f") for x in places if 0 <= x <= high * (1 + 1e-9)}
        outer_ticks(axes, high, texts)
    elif ticks:
        axis.set_major_locator(MaxNLocator(ticks))


def _draw_hairlines(axes: Axes, panel: ChartPanel, has_marked_top: bool) -> None:
    look: dict[str, Any] = {"color": GREY, "lw": HAIR, "zorder": 1, "ls": (0, (3, 2))}
    low, high = axes.get_xlim()
    for words, x in panel.marks.items():
        if not low <= x <= high:
            continue
        axes.axvline(x, **look)
        at: dict[str, Any] = {"xycoords": axes.get_xaxis_transform(), "color": GREY, "fontsize": 6}
        if has_marked_top:
            axes.annotate(words, (x, 1.01), ha="center", va="bottom", **at)
        else:  # inside, on the side of the hairline where there is more room
            is_right = axes.transAxes.inverted().transform(axes.transData.transform((x, 0.5)))[0] > 0.6
            side, shift = ("right", -2.0) if is_right else ("left", 2.0)
            axes.annotate(words, (x, 1.0), (shift, -1.0), textcoords="offset points", ha=side, va="top", **at)
    for words, y in panel.levels.items():
        axes.axhline(y, **look)
        place = axes.get_yaxis_transform()
        if words:
            axes.text(0.01, y, words, transform=place, color=GREY, fontsize=6, ha="left", va="bottom")


def _write_names(axes: Axes, panel: ChartPanel) -> None:
    if panel.names == "ends":
        name_at_ends(axes, panel.lines)
    elif panel.names == "beside":
        _name_beside(axes, panel)
    elif panel.names != "none" and any(line.name for line in panel.lines):
        axes.legend(loc=panel.names, frameon=False, fontsize=6, handlelength=1.6)


def name_at_ends(axes: Axes, lines: Sequence[ChartLine]) -> None:
    """Write the names beside the values at the largest drawn x."""
    labels: dict[str, EndLabel] = {}
    low, high = axes.get_ylim()
    for line in lines:
        is_drawn = np.isfinite(line.y) & (line.x <= axes.get_xlim()[1])
        if axes.get_yscale() == "log":
            is_drawn &= line.y > low
        drawn = np.flatnonzero(is_drawn)
        if line.name and drawn.size:
            last = drawn[np.argmax(line.x[drawn])]
            labels[line.name] = (float(np.clip(line.y[last], low, high)), line.name + line.note, line.shade)
    label_ends(axes, list(labels.values()), below=0.0)


def _name_beside(axes: Axes, panel: ChartPanel) -> None:
    """Write the names with their notes into the right margin, from above."""
    width, _ = size_of(axes)
    for number, line in enumerate(panel.lines):
        place = (1 + 2.3 / width, 0.97 - 0.3 * number)
        text = f"{line.name}\n{line.note}"
        axes.text(*place, text, transform=axes.transAxes, color=line.shade, va="top", linespacing=1.4)
