"""Histories as small multiples: a panel a case, a row a column, and below them how far the lines are apart.

Lines that lie on one another are drawn once and named together; of more swings than can be seen the band is drawn that
they fill, with their start below.
"""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.curves import (
    HistoryPanel,
    HistoryPanels,
    band,
    common_range,
    differences,
    engineering,
)
from validation.report.figures.histories import LETTER, SLIDE, TITLE_LETTER, TITLE_LINE, WIDTH, Margins, size_of
from validation.runs.columns import NO_OWN, axis_of
from validation.runs.history import History
from validation.solvers.contract import Role
from validation.solvers.registry import role

ROW = 20.0  # mm, height of a column
NARROW = 40.0  # mm, width of a panel below which its time has three numbers
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

    If `apart`, the first column's differences from the reference stand below, over the static value (over the
    reference's largest value where there is none): the largest magnitude in each fortieth of the time, on a logarithmic
    axis, without those of lines that lie on one another.
    """
    on_one = twins(panels, columns)
    notes = {name: "".join(f", {other}" for other in others) for name, others in on_one.items()}
    longest = max((len(name + note) for name, note in notes.items()), default=0)
    across = _columns(len(panels))
    width = SLIDE[0] if slide else WIDTH
    margins = Margins(left=15.0, right=max(14.0, 5.0 + LETTER * longest))
    room = (width - margins.left - margins.right) / across - margins.between
    drawn = [replace(_with_lines(panel, on_one), title=_broken(panel.title, room)) for panel in panels]
    extra = TITLE_LINE * max((panel.title.count("\n") for panel in drawn), default=0)
    margins = replace(margins, top=margins.top + extra)
    span = start_of(drawn, columns[0])
    apart = apart and any(differences(panel, columns[0]) for panel in drawn)
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
    rows[-1] = (rows[-1][0], 13.0 + extra)
    ticks = 3 if room < NARROW else 5
    charts = []
    rows_of_panels = [drawn[first : first + across] for first in range(0, len(drawn), across)]
    for shown in rows_of_panels:
        in_rows = [_history_row(shown, drawn, column, notes) for column in columns]
        if span is not None:
            start = [_until(panel, span) for panel in shown]
            row = _history_row(start, drawn, columns[0], notes)
            in_rows.append([replace(chart, y_label="its start", names="none") for chart in row])
        if apart:
            in_rows.append(_difference_row(shown, columns[0], notes))
        in_rows[0] = [replace(chart, title=panel.title) for chart, panel in zip(in_rows[0], shown, strict=True)]
        in_rows[-1] = [replace(chart, x_label="Time [s]") for chart in in_rows[-1]]
        for row in in_rows:
            charts += [replace(chart, x_ticks=ticks) for chart in row] + [None] * (across - len(row))
    figure = chart_figure(charts, rows * len(rows_of_panels), margins, shared=True, width=width)
    for axes in figure.axes[::across]:
        axes.yaxis.set_label_coords(-9.0 / size_of(axes)[0], 0.5)
    return figure


def _broken(title: str, room: float) -> str:
    """Return a title in lines that stay above its panel; a setting such as "q = 5 MPa" stays on one line."""
    whole = ", ".join(part.replace(" ", "\u00a0") for part in title.split(", "))  # textwrap breaks at plain spaces only
    return textwrap.fill(whole, max(8, int(room / TITLE_LETTER)), break_long_words=False)


# ---- lines that lie on one another ----


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
    """Return how far a solver is off another at most, over the largest value; None where drawn without it."""
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
    """Return a panel with the drawn histories; of the reference, which may lie on another, the base."""
    lines = {name: history for name, history in panel.histories.items() if name in on_one}
    like_base = next((name for name, others in on_one.items() if panel.reference in others), None)
    return replace(panel, histories=lines, base=panel.histories.get(panel.reference or ""), like_base=like_base)


# ---- long histories ----


def swings(history: History, column: str) -> int:
    """Return how often a history swings through its mean, by over a twentieth of its range to either side."""
    values = history.columns[column] - history.columns[column].mean()
    far = values[np.abs(values) > HALF * np.ptp(values)]
    return int(np.count_nonzero(np.diff(np.signbit(far))))


def start_of(panels: HistoryPanels, column: str) -> float | None:
    """Return until when [s] the start is drawn by itself, None where all swings can be seen."""
    spans = []
    for panel in panels:
        for history in panel.drawn(column).values():
            if (count := swings(history, column)) > SWINGS:
                spans.append(float(history.time[-1]) * START / count)
    return max(spans, default=None)


def _until(panel: HistoryPanel, span: float) -> HistoryPanel:
    cut = {name: history.until(span) for name, history in panel.histories.items()}
    return replace(panel, histories=cut, finer={name: history.until(span) for name, history in panel.finer.items()})


# ---- rows ----


def _columns(count: int) -> int:
    """Return the number of columns that fills the rows evenly, at most five."""
    rows = -(-count // 5)
    return -(-count // rows)


def _history_row(
    shown: HistoryPanels, panels: HistoryPanels, column: str, notes: Mapping[str, str]
) -> list[ChartPanel]:
    """Return a column of the histories of some panels, in its range in all."""
    low, high = common_range(panels, column)
    name, unit = axis_of(column, panels[0].own if panels else NO_OWN)
    factor, unit = engineering(max(abs(low), abs(high)), unit)
    pad = 0.05 * (high - low) or 1.0
    label = f"{name}\n[{unit}]" if unit else name
    charts = []
    for panel in shown:
        lines = []
        for solver, history in panel.drawn(column).items():
            values = factor * np.clip(history.columns[column], low - 9 * pad, high + 9 * pad)
            line = ChartLine(solver, history.time, values, note=notes.get(solver, ""))
            lines += _filled(line) if swings(history, column) > SWINGS else [line]
        levels = {"": factor * panel.static[column]} if column in panel.static else {}
        y_range = (factor * (low - pad), factor * (high + pad))
        charts.append(ChartPanel("", "", label, lines, _span(panel), y_range, levels=levels, y_ticks=5))
    return _with_all_names(charts)


def _filled(line: ChartLine) -> list[ChartLine]:
    """Return a line of more swings than can be seen as a band."""
    middles, low, high = band(line.x, line.y, BINS)
    shade = line.shade
    edges = [
        ChartLine("", middles, low, shade, width=0.6, shaded=(low, high)),
        ChartLine("", middles, high, shade, width=0.6),
    ]
    return [*edges, _named(line)]


def _named(line: ChartLine) -> ChartLine:
    """Return the end of a line, of which only the name is seen."""
    return ChartLine(line.name, line.x[-1:], line.y[-1:], line.shade, width=0, note=line.note)


def _with_all_names(charts: list[ChartPanel]) -> list[ChartPanel]:
    """Return panels, the last with the names of lines that end in another: names stand beside it."""
    last = charts[-1]
    present = {line.name for line in last.lines}
    missing: dict[str, ChartLine] = {}
    for chart in charts[:-1]:
        missing |= {line.name: _named(line) for line in chart.lines if line.name and line.name not in present}
    return [*charts[:-1], replace(last, lines=[*last.lines, *missing.values()])]


def _difference_row(shown: HistoryPanels, column: str, notes: Mapping[str, str]) -> list[ChartPanel]:
    curves = [differences(panel, column) for panel in shown]
    values = np.zeros(0)
    for lines in curves:
        values = np.concatenate([values, *(y for _, y in lines.values())])
    values = values[(values > FLOOR) & np.isfinite(values)]
    least, largest = (values.min(), values.max()) if values.size else (FLOOR, 1.0)
    low = 10.0 ** math.floor(math.log10(least))
    high = 10.0 ** min(2, math.ceil(math.log10(largest) + 0.05))
    scale = "static" if any(panel.static.get(column) for panel in shown) else "largest"
    charts = []
    for panel, of_panel in zip(shown, curves, strict=True):
        drawn = []
        for solver, (x, y) in of_panel.items():
            visible = np.where(y > FLOOR, np.minimum(y, 1e3 * high), np.nan)
            drawn.append(ChartLine(solver, x, visible, note=notes.get(solver, "")))
        y_range = (min(low, high / 10), high)
        charts.append(ChartPanel("", "", f"|Δ| / {scale}", drawn, _span(panel), y_range, (False, True)))
    return _with_all_names(charts)


def _span(panel: HistoryPanel) -> tuple[float, float]:
    return 0.0, max((float(history.time[-1]) for history in panel.histories.values()), default=1.0)
