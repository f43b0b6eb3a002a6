"""Figures in one house style: lines carry their names at their ends instead of a legend, axes carry units."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from validation.report.blocks import FigureBlock
from validation.report.figures.curves import (
    COLUMNS,
    HAIR,
    HOUSE_STYLE,
    Panel,
    common_range,
    differences,
    engineering,
    nudge,
    style_of,
    thin,
)
from validation.runs.files import write_atomically
from validation.runs.history import Array

P = TypeVar("P", bound=Any)  # a dataclass with a title
WIDTH = 166.0  # mm, text width of the report
DOT = "#0072b2"
LABEL_GAP = 3.0  # mm between the names of two lines
LETTER = 1.5  # mm, width of a letter of a name, amply
COLUMN_GAP = 4.0  # mm between two panels
TITLE_LETTER, TITLE_LINE = 1.6, 3.2  # mm, letter and line of a panel's title, amply
FLOOR = 1e-17  # differences below count as zero on a logarithmic axis


@contextmanager
def house_style() -> Iterator[None]:
    """Apply the house style for the time of a drawing or saving."""
    with mpl.rc_context(HOUSE_STYLE):  # type: ignore[arg-type]
        yield


def save(figure: Figure, path: Path) -> Path:
    """Write a figure as SVG, text as paths, the same bytes every time; return the path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with house_style():
        write_atomically(path, lambda stream: figure.savefig(stream, format="svg", metadata={"Date": None}))
    return path


def saved(figure: Figure, directory: Path, file: str, caption: str) -> FigureBlock:
    """Write a figure into a directory and return its block."""
    save(figure, directory / file)
    return FigureBlock(file, caption)


@dataclass(frozen=True)
class Margins:
    """Margins of a figure, and the gap between its columns [mm]."""

    left: float = 13.0
    right: float = 21.0
    top: float = 5.0
    bottom: float = 8.5
    between: float = COLUMN_GAP


def axes_grid(
    rows: Sequence[tuple[float, float]], columns: int, margins: Margins, width: float = WIDTH
) -> tuple[Figure, list[list[Axes]]]:
    """Return a figure with axes placed in millimetres: each row has its height and the gap below it."""
    height = margins.top + sum(map(sum, rows)) - rows[-1][1] + margins.bottom
    across = (width - margins.left - margins.right - margins.between * (columns - 1)) / columns
    figure, grid, y = Figure(figsize=(width / 25.4, height / 25.4)), [], height - margins.top
    for row, gap in rows:
        y -= row
        lefts = [margins.left + j * (across + margins.between) for j in range(columns)]
        grid.append([figure.add_axes((x / width, y / height, across / width, row / height)) for x in lefts])
        y -= gap
    return figure, grid


def one_axes(
    height: float, margins: Margins, labels: tuple[str, str], logarithmic: bool = False
) -> tuple[Figure, Axes]:
    """Return a figure with one pair of axes of a height [mm], labelled in x and y."""
    figure, ((axes,),) = axes_grid([(height, 0.0)], 1, margins)
    if logarithmic:
        axes.set_xscale("log")
        axes.set_yscale("log")
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    return figure, axes


def size_of(axes: Axes) -> tuple[float, float]:
    """Return width and height of the axes [mm]."""
    figure = axes.get_figure()
    if not isinstance(figure, Figure):
        raise ValueError("axes: must belong to a figure, got none")
    box = axes.get_position()
    return box.width * figure.get_figwidth() * 25.4, box.height * figure.get_figheight() * 25.4


def label_ends(
    axes: Axes,
    ends: Mapping[str, float],
    names: Mapping[str, str] | None = None,
    colors: Mapping[str, str] | None = None,
    below: float = 1.0,
) -> None:
    """Write the names of lines beside their ends (data coordinates), nudged apart, with a thin leader.

    The limits of the axes must have been set before; `names` replaces the text of a label, `colors` the solver's own,
    and labels stand at most `below` mm below the axes.
    """
    if not ends:
        return
    width, height = size_of(axes)
    inverse, right = axes.transAxes.inverted(), axes.get_xlim()[1]
    points = [inverse.transform(axes.transData.transform((right, y))) for y in ends.values()]
    own = [float(np.clip(point[1], 0, 1)) for point in points]
    places = nudge(own, LABEL_GAP / height, -below / height, 1 + 1.0 / height)
    for name, start, place in zip(ends, own, places, strict=True):
        color = style_of(name).color if colors is None else colors[name]
        where: dict[str, Any] = {"transform": axes.transAxes, "color": color}
        axes.plot([1, 1 + 2.5 / width], [start, place], lw=HAIR, clip_on=False, **where)
        axes.text(1 + 3.1 / width, place, (names or {}).get(name, name), va="center_baseline", ha="left", **where)


def draw_line(axes: Axes, name: str, x: Array, y: Array) -> None:
    """Draw a solver's line in its own style."""
    style = style_of(name)
    axes.plot(
        x, y, color=style.color, lw=style.width, zorder=2 + style.layer, ls=(0, style.dash) if style.dash else "-"
    )


def _log_axis(axes: Axes, low: float, high: float) -> None:
    """Set a logarithmic y axis over whole decades with few ticks."""
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(LogLocator(numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())


def history_figure(panels: Sequence[Panel], column: str) -> Figure:
    """Draw a column of all solvers, one panel per case, with the differences from the reference below.

    Differences are divided by the static value (by the reference's largest value where there is none) and shown
    as the largest magnitude in each fortieth of the time, on a logarithmic axis.
    """
    columns = _columns(len(panels))
    letters = [max(map(len, panel.histories), default=0) for panel in panels]
    room = max(21.0, 4.0 + LETTER * max(letters, default=0))
    with house_style():
        figure, bands = small_multiples(panels, columns, Margins(right=room), [(24.0, 2.5), (15.0, 13.0)])
        for some, (above, below) in bands:
            _history_row(above, some, column)
            _difference_row(below, some, column)
    return figure


def small_multiples(
    panels: Sequence[P], columns: int, margins: Margins, rows: Sequence[tuple[float, float]]
) -> tuple[Figure, list[tuple[Sequence[P], list[list[Axes]]]]]:
    """Return a figure of titled panels in bands, and for each band its panels and its rows of axes.

    Titles are broken so that they stay above their panel; bands and margin grow by the lines that this takes.
    """
    across = (WIDTH - margins.left - margins.right) / columns - COLUMN_GAP
    titles = []
    for panel in panels:
        # A setting such as "q = 5 MPa" stays on one line: textwrap breaks at plain spaces only.
        whole = ", ".join(part.replace(" ", "\u00a0") for part in panel.title.split(", "))
        titles.append(textwrap.fill(whole, max(8, int(across / TITLE_LETTER)), break_long_words=False))
    extra = TITLE_LINE * max((title.count("\n") for title in titles), default=0)
    shown = [replace(panel, title=title) for panel, title in zip(panels, titles, strict=True)]
    band = [*rows[:-1], (rows[-1][0], rows[-1][1] + extra)]
    groups = [shown[i : i + columns] for i in range(0, len(shown), columns)]
    figure, grid = axes_grid(band * len(groups), columns, replace(margins, top=margins.top + extra))
    return figure, [(some, grid[len(rows) * i : len(rows) * (i + 1)]) for i, some in enumerate(groups)]


def _columns(count: int) -> int:
    """Return the number of columns that fills the rows evenly, at most five."""
    rows = -(-count // 5)
    return -(-count // rows)


def _history_row(row: list[Axes], panels: Sequence[Panel], column: str) -> None:
    name, unit = COLUMNS.get(column, (column.replace("_", " ").capitalize(), ""))
    low, high = common_range(panels, column)
    factor, unit = engineering(max(abs(low), abs(high)), unit)
    pad = 0.05 * (high - low) or 1.0
    for axes, panel in zip(row, panels, strict=False):
        axes.set_title(panel.title)
        axes.set_ylim(factor * (low - pad), factor * (high + pad))
        for solver, history in panel.histories.items():
            x, y = thin(history.time, np.clip(history.columns[column], low - 9 * pad, high + 9 * pad))
            draw_line(axes, solver, x, factor * y)
        _time_axis(axes, panel)
        axes.tick_params(labelbottom=False)
        axes.yaxis.set_major_locator(MaxNLocator(5))
        if panel.static is not None:
            axes.axhline(factor * panel.static, color="#bbbbbb", lw=HAIR, zorder=1)
    ends = {}
    for panel in panels:
        for solver, history in panel.histories.items():
            ends[solver] = factor * float(np.nan_to_num(history.columns[column][-1]))
    _row_labels(row, len(panels), f"{name} [{unit}]" if unit else name, ends)


def _difference_row(row: list[Axes], panels: Sequence[Panel], column: str) -> None:
    curves = [differences(panel, column) for panel in panels]
    values = np.array([1.0]) if not any(curves) else np.zeros(0)
    for lines in curves:
        values = np.concatenate([values, *(y for _, y in lines.values())])
    values = values[(values > FLOOR) & np.isfinite(values)]
    low, high = (values.min(), values.max()) if values.size else (FLOOR, 1.0)
    low, high = 10.0 ** math.floor(math.log10(low)), 10.0 ** min(2, math.ceil(math.log10(high) + 0.05))
    for axes, panel, lines in zip(row, panels, curves, strict=False):
        _log_axis(axes, min(low, high / 10), high)
        for solver, (x, y) in lines.items():
            draw_line(axes, solver, x, np.where(y > FLOOR, np.minimum(y, 1e3 * high), np.nan))
        _time_axis(axes, panel)
        axes.set_xlabel("Time [s]", labelpad=1.5)
    ends: dict[str, float] = {}
    for lines in curves:
        ends |= {solver: float(np.clip(y[-1], low, high)) for solver, (_, y) in lines.items()}
    _row_labels(row, len(panels), "|Δ| / static", ends)


def _row_labels(row: list[Axes], count: int, label: str, ends: Mapping[str, float]) -> None:
    share_left(row, count, label)
    row[0].yaxis.set_label_coords(-9.5 / size_of(row[0])[0], 0.5)
    label_ends(row[count - 1], ends)


def share_left(row: Sequence[Axes], count: int, label: str) -> None:
    """Label the y axis at the left, hide the other panels' tick labels and all of the axes beyond the count."""
    row[0].set_ylabel(label)
    for axes in row[1:count]:
        axes.tick_params(labelleft=False)
    for axes in row[count:]:
        axes.set_axis_off()


def outer_ticks(axes: Axes, last: float, texts: Mapping[float, str]) -> None:
    """Set ticks on the x axis with their labels; the outer ones stay inside, clear of the neighbouring panels."""
    axes.set_xticks(list(texts), list(texts.values()))
    labels = axes.get_xticklabels()
    labels[0].set_horizontalalignment("left")
    if max(texts) > 0.95 * last:
        labels[-1].set_horizontalalignment("right")


def _time_axis(axes: Axes, panel: Panel) -> None:
    longest = max((float(h.time[-1]) for h in panel.histories.values()), default=1.0)
    axes.set_xlim(0, longest)
    ticks = MaxNLocator(3 if size_of(axes)[0] < 40 else 5, steps=[1, 2, 5, 10]).tick_values(0, longest)
    outer_ticks(axes, longest, {float(tick): f"{tick:g}" for tick in ticks if 0 <= tick <= longest * (1 + 1e-9)})


@dataclass(frozen=True)
class LedgerLine:
    """One case of the ledger: for each part the displacement's and the pressure's relative L2 error, or None."""

    label: str
    parts: Mapping[str, tuple[float | None, float | None]]


def ledger_figure(lines: Sequence[LedgerLine]) -> Figure:
    """Draw the parts of the error side by side, one line per case: displacement filled, contact pressure open."""
    parts: dict[str, None] = {}
    values: list[float] = []
    for line in lines:
        parts |= dict.fromkeys(line.parts)
        for pair in line.parts.values():
            values += [value for value in pair if value]
    low, high = min(values, default=1e-16), max(values, default=1.0)
    limits = 10.0 ** math.floor(math.log10(max(low, 1e-17))), 10.0 ** math.ceil(math.log10(min(high, 1e3)) + 0.05)
    with house_style():
        figure, (row,) = axes_grid([(max(12.0, 3.3 * len(lines)), 0.0)], len(parts), Margins(left=48.0, right=4.0))
        for axes, part in zip(row, parts, strict=True):
            axes.set_title(part)
            _ledger_axes(axes, [line.parts.get(part, (None, None)) for line in lines], limits)
        row[0].set_yticks(range(len(lines)), [line.label for line in lines])
        row[0].tick_params(axis="y", length=0, pad=5.0)
        middle, bottom = (48 + (WIDTH - 52) / 2) / WIDTH, 0.5 / (figure.get_figheight() * 25.4)
        figure.text(middle, bottom, "Relative L2 difference", ha="center", va="bottom")
    return figure


def _ledger_axes(axes: Axes, pairs: Sequence[tuple[float | None, float | None]], limits: tuple[float, float]) -> None:
    axes.set_xscale("log")
    axes.set_xlim(*limits)
    axes.set_ylim(len(pairs) - 0.4, -0.6)
    axes.hlines(range(len(pairs)), *limits, color="#dddddd", lw=HAIR, zorder=0)
    for y, pair in enumerate(pairs):
        for value, face, shift in zip(pair, (DOT, "white"), (-0.17, 0.17), strict=True):
            if value is not None:
                axes.plot(max(value, limits[0]), y + shift, "o", ms=2.6, mfc=face, mec=DOT, mew=0.6, clip_on=False)
    first, last = (round(math.log10(limit)) for limit in limits)
    axes.set_xticks([10.0**power for power in range(first, last, max(1, -(-(last - first) // 3)))])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)


@dataclass(frozen=True)
class Line:
    """A named line; the name chooses the style, `note` follows it at the line's end."""

    name: str
    x: Array
    y: Array
    note: str = ""


def line_figure(
    lines: Sequence[Line], x_label: str, y_label: str, levels: Mapping[str, float] | None = None, log2_x: bool = False
) -> Figure:
    """Draw named lines (with markers where they have few points) and horizontal levels, labelled at their ends."""
    with house_style():
        figure, axes = one_axes(38.0, Margins(16.0, 56.0, 3.0, 9.5), (x_label, y_label))
        if log2_x:
            axes.set_xscale("log", base=2)
            axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        for line in lines:
            x, y = thin(line.x, line.y)
            draw_line(axes, line.name, x, y)
            if x.size <= 20:
                axes.plot(x, y, "o", ms=3, color=style_of(line.name).color, zorder=9)
        for name, level in (levels or {}).items():
            axes.axhline(level, color=style_of(name).color, lw=style_of(name).width)
        axes.margins(x=0.02, y=0.08)
        axes.autoscale_view()
        ends = {line.name: float(line.y[-1]) for line in lines} | dict(levels or {})
        label_ends(axes, ends, {line.name: f"{line.name}{line.note}" for line in lines})
    return figure
