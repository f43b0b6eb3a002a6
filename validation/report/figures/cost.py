"""Figures of error against cost."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from validation.report.figures.curves import HAIR, style_of
from validation.report.figures.histories import Margins, axes_grid, house_style, label_ends
from validation.studies.work.points import COSTS, QUANTITIES, ROUNDING, Point, floor, front

NOTHING = 1e-12  # a difference of damping ratios below is rounding: the scheme damps nothing
REFERENCES = {"bar": "model form and mesh", "continuum": "everything"}


def work_figure(found: Sequence[Point]) -> Figure:
    """Draw error against seconds and against work for each quantity, a line for each method as it is refined.

    Grey steps are the front that no run beats in both, the dotted level is DDA's model form, hollow points lie below
    the reference's own uncertainty.
    """
    with house_style():
        margins = Margins(15.0, 4.0, 13.0, 9.5)
        shown = [
            name
            for name in QUANTITIES
            if any(y > NOTHING for p in found for (q, _), y in p.errors.items() if q == name)
        ]
        figure, grid = axes_grid([(27.0, 4.0)] * len(shown), len(COSTS) * len(REFERENCES), margins)
        for row, quantity in zip(grid, shown, strict=True):
            panels = [(cost, reference) for cost in COSTS for reference in REFERENCES]
            for axes, (cost, reference) in zip(row, panels, strict=True):
                _panel(axes, found, quantity, cost, reference)
                if row is grid[0]:
                    axes.set_title(f"{REFERENCES[reference]}\n(against the {reference})")
                if row is grid[-1]:
                    axes.set_xlabel("Seconds" if cost == "seconds" else "Unknowns × steps", labelpad=1.5)
                else:
                    axes.tick_params(labelbottom=False)
            row[0].set_ylabel(quantity.capitalize())
            _share_limits(row)
        _legend(figure, found)
    return figure


def _panel(axes: Axes, found: Sequence[Point], quantity: str, cost: str, reference: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    shown = [(p, COSTS[cost](p), p.errors[quantity, reference]) for p in found if (quantity, reference) in p.errors]
    shown = [(p, x, y) for p, x, y in shown if x > 0 and y > 0]
    for method in dict.fromkeys(p.method for p, _, _ in shown):
        own = [(x, y) for p, x, y in shown if p.method == method]
        x, y = np.array(own).T
        color = style_of(method).color
        axes.plot(x, y, lw=0.8, color=color, zorder=3)
        for a, b in own:
            axes.plot(a, b, "o", ms=2.6, mec=color, mew=0.6, mfc="white" if b < ROUNDING else color, zorder=4)
    best = front([(x, y) for _, x, y in shown])
    if best:
        x, y = np.array(best).T
        axes.step(x, y, where="post", color="#bbbbbb", lw=2.2, zorder=1)
    level = floor(found, quantity, reference)
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


def _legend(figure: Figure, found: Sequence[Point]) -> None:
    """Name the methods in their colours above the panels."""
    x = 0.09
    for method in dict.fromkeys(p.method for p in found):
        figure.text(x, 0.995, method, color=style_of(method).color, va="top")
        x += 0.04 + 0.009 * len(method)


def columns_figure(names: tuple[str, str], series: dict[str, list[tuple[float, float]]]) -> Figure:
    """Draw one column of a study's table against another, a line for each solver, both logarithmic."""
    with house_style():
        figure, ((axes,),) = axes_grid([(70.0, 0.0)], 1, Margins(16.0, 62.0, 3.0, 9.5))
        axes.set_xscale("log")
        axes.set_yscale("log")
        ends = {}
        for name, pairs in series.items():
            x, y = np.array(sorted(pairs)).T
            axes.plot(x, y, "o-", ms=2.6, lw=0.8, color=style_of(name).color)
            ends[name] = float(y[-1])
        axes.set_xlabel(names[0])
        axes.set_ylabel(names[1])
        axes.autoscale_view()
        label_ends(axes, ends)
    return figure
