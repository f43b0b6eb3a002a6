"""Histories as small multiples: a panel a case, a row a column, and below them how far the lines are apart.

Lines that lie on one another are drawn once and named together; a history of more swings than can be seen is drawn as
the band that it fills, with its start below.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from validation.report.figures.charts import ChartLine, draw_chart_line
from validation.report.figures.curves import (
    HAIR,
    HistoryPanel,
    HistoryPanels,
    common_range,
    differences,
    engineering,
    style_of,
)
from validation.report.figures.histories import (
    LETTER,
    SLIDE,
    WIDTH,
    Margins,
    house_style,
    label_ends,
    outer_ticks,
    share_left,
    size_of,
    small_multiples,
)
from validation.runs.columns import NO_OWN, axis_of
from validation.runs.history import Array, History
from validation.solvers.contract import Role
from validation.solvers.registry import role

ROW = 20.0  # mm, height of a column
TWIN = 2e-3  # of the largest value: closer lines cannot be told apart on axes that begin at zero
SWINGS = 150  # crossings of the mean; more of them in a panel are a filled rectangle
START = 24  # swings that the start shows
BINS = 300  # of a band
HALF = 0.05  # of the range: smaller swings are noise on larger ones
FLOOR = 1e-9  # of the static value; smaller differences are not drawn
Twins = Mapping[str, Mapping[str, float]]  # a drawn line -> the lines on it, and how far off they are at most


def history_figure(
    panels: HistoryPanels, *columns: str, apart: bool = False, height: float = ROW, slide: bool = False
) -> Figure:
    """Draw columns of all solvers, one panel a case, each column so many mm high, or all of them to fill a slide.

    If `apart`, the first column's differences from the reference stand below. They are divided by the static value (by
    the reference's largest value where there is none) and shown as the largest magnitude in each fortieth of the time,
    on a logarithmic axis; those of lines that lie on one another are left out.
    """
    on_one = twins(panels, columns)
    drawn = [_with_lines(panel, on_one) for panel in panels]
    span = start_of(drawn, columns[0])
    apart = apart and any(differences(panel, columns[0]) for panel in drawn)
    names = {name: ", ".join([name, *others]) for name, others in on_one.items()}
    room = max(14.0, 5.0 + LETTER * max(map(len, names.values()), default=0))
    margins = Margins(left=15.0, right=room)
    below = [(14.0, 3.0)] * apart
    gap = 3.0
    if span is not None:  # whose own times stand below the rows above
        gap = 7.0
        below.insert(0, (16.0, 7.0 if apart else 3.0))
    if slide:
        rest = [(0.0, 3.0)] * (len(columns) - 1) + [(0.0, gap), *below]
        room_for_columns = SLIDE[1] - margins.top - margins.bottom - sum(map(sum, rest)) + rest[-1][1]
        height = room_for_columns / len(columns)
    rows = [*[(height, 3.0)] * (len(columns) - 1), (height, gap), *below]
    rows[-1] = (rows[-1][0], 13.0)
    width = SLIDE[0] if slide else WIDTH
    with house_style():
        figure, bands = small_multiples(drawn, _columns(len(panels)), margins, rows, width)
        for band, lines in bands:
            for row, column in zip(lines, columns, strict=False):
                _history_row(row, band, column, common_range(drawn, column))
                _row_labels(row, len(band), _label(drawn, column), _ends(band, drawn, column), names)
            for axes, panel in zip(lines[0], band, strict=False):
                axes.set_title(panel.title)
            if span is not None:
                start = [_until(panel, span) for panel in band]
                _history_row(lines[len(columns)], start, columns[0], common_range(drawn, columns[0]))
                _row_labels(lines[len(columns)], len(band), "its start", {}, names)
            if apart:
                _difference_row(lines[-1], band, columns[0], names)
            _name_time(lines[-1], len(band), lines)
    return figure


# ---- lines that lie on one another --------------------------------------------------------------------------------


def twins(panels: HistoryPanels, columns: Sequence[str]) -> Twins:
    """Return the solvers that are drawn, and with each the later ones that lie on it in every panel.

    One that repeats another by other arithmetic, such as the printed recursion, is named only where it departs.
    """
    lines: dict[str, dict[str, float]] = {}
    for name in dict.fromkeys(itertools.chain.from_iterable(panel.histories for panel in panels)):
        for line, others in lines.items():
            off = _apart(panels, columns, line, name)
            if off is not None and off <= TWIN:
                if role(name) is not Role.REPEAT:
                    others[name] = off
                break
        else:
            lines[name] = {}
    return lines


def _apart(panels: HistoryPanels, columns: Sequence[str], one: str, other: str) -> float | None:
    """Return how far a solver is off another at most, over the largest value; None where it is drawn without it."""
    worst = 0.0
    for panel in panels:
        a = panel.histories.get(one)
        b = panel.histories.get(other)
        if b is None:
            continue
        if a is None or a.time.size != b.time.size:
            return None
        for column in columns:
            if (column in a.columns) != (column in b.columns):
                return None
            if column not in a.columns:
                continue
            size = max(float(np.abs(a.columns[column]).max()), abs(panel.static.get(column, 0.0))) or 1.0
            with np.errstate(all="ignore"):
                off = float(np.abs(a.columns[column] - b.columns[column]).max() / size)
            if not math.isfinite(off):  # a run that blew up is far from everything
                return math.inf
            worst = max(worst, off)
    return worst


def _with_lines(panel: HistoryPanel, on_one: Twins) -> HistoryPanel:
    """Return a panel with the histories that are drawn; of the reference, which may lie on another, the base."""
    lines = {name: history for name, history in panel.histories.items() if name in on_one}
    like_base = next((name for name, others in on_one.items() if panel.reference in others), None)
    return replace(panel, histories=lines, base=panel.histories.get(panel.reference or ""), like_base=like_base)


# ---- long histories -----------------------------------------------------------------------------------------------


def swings(history: History, column: str) -> int:
    """Return how often a history swings through its mean, by more than a twentieth of its range to either side."""
    values = history.columns[column] - history.columns[column].mean()
    far = values[np.abs(values) > HALF * np.ptp(values)]
    return int(np.count_nonzero(np.diff(np.signbit(far))))


def start_of(panels: HistoryPanels, column: str) -> float | None:
    """Return the time [s] of the start that is drawn by itself, or None where all swings can be seen."""
    spans = []
    for panel in panels:
        for history in panel.drawn(column).values():
            if (count := swings(history, column)) > SWINGS:
                spans.append(float(history.time[-1]) * START / count)
    return max(spans, default=None)


def _until(panel: HistoryPanel, span: float) -> HistoryPanel:
    cut = {name: history.until(span) for name, history in panel.histories.items()}
    return replace(panel, histories=cut, finer={name: history.until(span) for name, history in panel.finer.items()})


def band(x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Return the middles of equal parts of the samples, and the least and the greatest value in each."""
    edges = np.unique(np.linspace(0, x.size, BINS + 1).astype(int))
    low, high = (function.reduceat(y, edges[:-1]) for function in (np.minimum, np.maximum))
    return (x[edges[:-1]] + x[edges[1:] - 1]) / 2, low, high


# ---- rows ---------------------------------------------------------------------------------------------------------


def _columns(count: int) -> int:
    """Return the number of columns that fills the rows evenly, at most five."""
    rows = -(-count // 5)
    return -(-count // rows)


def _scale(panels: HistoryPanels, column: str) -> tuple[float, str]:
    """Return the factor and the unit that a column is drawn in."""
    low, high = common_range(panels, column)
    return engineering(max(abs(low), abs(high)), _axis(panels, column)[1])


def _axis(panels: HistoryPanels, column: str) -> tuple[str, str]:
    return axis_of(column, panels[0].own if panels else NO_OWN)


def _label(panels: HistoryPanels, column: str) -> str:
    name, _ = _axis(panels, column)
    _, unit = _scale(panels, column)
    return f"{name}\n[{unit}]" if unit else name


def _ends(band: HistoryPanels, panels: HistoryPanels, column: str) -> dict[str, float]:
    """Return where each line ends, in the last panel of a band that has it."""
    factor, _ = _scale(panels, column)
    ends = {}
    for panel in band:
        for solver, history in panel.drawn(column).items():
            ends[solver] = factor * float(np.nan_to_num(history.columns[column][-1]))
    return ends


def _history_row(row: list[Axes], panels: HistoryPanels, column: str, limits: tuple[float, float]) -> None:
    low, high = limits
    factor, _ = engineering(max(abs(low), abs(high)), _axis(panels, column)[1])
    pad = 0.05 * (high - low) or 1.0
    for axes, panel in zip(row, panels, strict=False):
        axes.set_ylim(factor * (low - pad), factor * (high + pad))
        for solver, history in panel.drawn(column).items():
            values = factor * np.clip(history.columns[column], low - 9 * pad, high + 9 * pad)
            _draw(axes, solver, history.time, values, swings(history, column) > SWINGS)
        _time_axis(axes, panel)
        axes.yaxis.set_major_locator(MaxNLocator(5))
        if column in panel.static:
            axes.axhline(factor * panel.static[column], color="#bbbbbb", lw=HAIR, zorder=1)


def _draw(axes: Axes, solver: str, x: Array, y: Array, dense: bool) -> None:
    if not dense:
        draw_chart_line(axes, ChartLine(solver, x, y))
        return
    style = style_of(solver)
    middles, low, high = band(x, y)
    axes.fill_between(middles, low, high, color=style.color, alpha=0.3, lw=0, zorder=1 + style.layer)
    for edge in (low, high):
        axes.plot(middles, edge, color=style.color, lw=0.6, zorder=2 + style.layer)


def _difference_row(row: list[Axes], panels: HistoryPanels, column: str, names: Mapping[str, str]) -> None:
    curves = [differences(panel, column) for panel in panels]
    values = np.zeros(0)
    for lines in curves:
        values = np.concatenate([values, *(y for _, y in lines.values())])
    values = values[(values > FLOOR) & np.isfinite(values)]
    least, largest = (values.min(), values.max()) if values.size else (FLOOR, 1.0)
    low = 10.0 ** math.floor(math.log10(least))
    high = 10.0 ** min(2, math.ceil(math.log10(largest) + 0.05))
    for axes, panel, lines in zip(row, panels, curves, strict=False):
        axes.set(yscale="log", ylim=(min(low, high / 10), high))
        axes.yaxis.set_major_locator(LogLocator(numticks=5))
        axes.yaxis.set_minor_locator(NullLocator())
        for solver, (x, y) in lines.items():
            visible = np.where(y > FLOOR, np.minimum(y, 1e3 * high), np.nan)
            draw_chart_line(axes, ChartLine(solver, x, visible))
        _time_axis(axes, panel)
    ends: dict[str, float] = {}
    for lines in curves:
        ends |= {solver: float(np.clip(y[-1], low, high)) for solver, (_, y) in lines.items()}
    scale = "static" if any(panel.static.get(column) for panel in panels) else "largest"
    _row_labels(row, len(panels), f"|Δ| / {scale}", ends, names)


def _row_labels(row: list[Axes], count: int, label: str, ends: Mapping[str, float], names: Mapping[str, str]) -> None:
    share_left(row, count, label)
    row[0].yaxis.set_label_coords(-9.0 / size_of(row[0])[0], 0.5)
    labels = [(y, names.get(solver, solver), style_of(solver).color) for solver, y in ends.items()]
    label_ends(row[count - 1], labels)


def _name_time(last: Sequence[Axes], count: int, rows: Sequence[Sequence[Axes]]) -> None:
    """Name the time under the last row; other rows keep their numbers only where their time is another."""
    for axes in last[:count]:
        axes.set_xlabel("Time [s]", labelpad=1.5)
    for row in rows[:-1]:
        for axes, below in zip(row[:count], last, strict=False):
            axes.tick_params(labelbottom=axes.get_xlim() != below.get_xlim())


def _time_axis(axes: Axes, panel: HistoryPanel) -> None:
    longest = max((float(h.time[-1]) for h in panel.histories.values()), default=1.0)
    axes.set_xlim(0, longest)
    count = 3 if size_of(axes)[0] < 40 else 5
    ticks = MaxNLocator(count, steps=[1, 2, 5, 10]).tick_values(0, longest)
    outer_ticks(axes, longest, {float(tick): f"{tick:g}" for tick in ticks if 0 <= tick <= longest * (1 + 1e-9)})
