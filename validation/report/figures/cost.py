"""Figures of error against cost."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.curves import HAIR, style_of
from validation.report.figures.histories import Margins, axes_grid, house_style
from validation.studies.work.points import COSTS, ROUNDING, Point, floor, front

QUANTITIES = ("displacement", "contact pressure")
NOTHING = 1e-12  # smaller differences are rounding
REFERENCES = {"bar": "model form and mesh", "continuum": "everything"}


def work_figure(points: Sequence[Point]) -> Figure:
    """Draw error against seconds and against work for each quantity that has one, a line for each method.

    Grey steps are the front that no run beats in both, the dotted level is DDA's model form, hollow points lie below
    the reference's own uncertainty.
    """
    with house_style():
        margins = Margins(15.0, 4.0, 13.0, 9.5)
        quantities = [name for name in QUANTITIES if _differs(points, name)]
        panels = list(itertools.product(COSTS, REFERENCES))
        figure, grid = axes_grid([(34.0, 4.0)] * len(quantities), len(panels), margins)
        for row, quantity in zip(grid, quantities, strict=True):
            for axes, (cost, reference) in zip(row, panels, strict=True):
                _panel(axes, points, quantity, cost, reference)
                if row is grid[0]:
                    axes.set_title(f"{REFERENCES[reference]}\n(against the {reference})")
                if row is grid[-1]:
                    label = "Seconds" if cost == "seconds" else "Unknowns × steps"
                    axes.set_xlabel(label, labelpad=1.5)
                else:
                    axes.tick_params(labelbottom=False)
            row[0].set_ylabel(quantity.capitalize())
            _share_limits(row)
        _legend(figure, points)
    return figure


def _differs(points: Sequence[Point], quantity: str) -> bool:
    """Whether some run has an error in a quantity that is more than rounding."""
    pairs = itertools.product(points, REFERENCES)
    return any(point.errors.get((quantity, reference), 0.0) > NOTHING for point, reference in pairs)


def _panel(axes: Axes, points: Sequence[Point], quantity: str, cost: str, reference: str) -> None:
    axes.set(xscale="log", yscale="log")
    pairs_by_method: dict[str, list[tuple[float, float]]] = {}
    for point in points:
        x = COSTS[cost](point)
        y = point.errors.get((quantity, reference), 0.0)
        if x > 0 and y > 0:
            pairs_by_method.setdefault(point.method, []).append((x, y))
    for method, pairs in pairs_by_method.items():
        color = style_of(method).color
        axes.plot(*np.array(pairs).T, lw=0.8, color=color, zorder=3)
        for x, y in pairs:
            face = "white" if y < ROUNDING else color
            axes.plot(x, y, "o", ms=2.6, mec=color, mew=0.6, mfc=face, zorder=4)
    best = front(list(itertools.chain(*pairs_by_method.values())))
    if best:
        axes.step(*np.array(best).T, where="post", color="#bbbbbb", lw=2.2, zorder=1)
    level = floor(points, quantity, reference)
    if level:
        axes.axhline(level, color=style_of("dda").color, lw=HAIR, ls=":", zorder=2)


def _share_limits(row: Sequence[Axes]) -> None:
    """Give a row one error axis; tick labels at the left only."""
    low = min(axes.get_ylim()[0] for axes in row)
    high = max(axes.get_ylim()[1] for axes in row)
    for i, axes in enumerate(row):
        axes.set_ylim(max(low, 1e-13), high)
        axes.yaxis.set_major_locator(LogLocator(numticks=5))
        axes.xaxis.set_major_locator(LogLocator(numticks=4))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_locator(NullLocator())
            axis.set_minor_formatter(NullFormatter())
        axes.tick_params(labelleft=i == 0)


def _legend(figure: Figure, points: Sequence[Point]) -> None:
    """Name the methods in their colours above the panels."""
    x = 0.09
    for method in dict.fromkeys(point.method for point in points):
        figure.text(x, 0.995, method, color=style_of(method).color, va="top")
        x += 0.04 + 0.009 * len(method)


def columns_figure(names: tuple[str, str], series: dict[str, list[tuple[float, float]]]) -> Figure:
    """Draw one column of a study's table against another, a line for each solver, both logarithmic."""
    lines = []
    for name, pairs in series.items():
        x, y = np.array(sorted(pairs)).T
        lines.append(ChartLine(name, x, y, style_of(name).color, width=0.8, dots=2.6))
    panel = ChartPanel("", *names, lines, logarithmic=(True, True))
    return chart_figure([panel], 70.0, Margins(16.0, 62.0, 3.0, 9.5))
