"""Figures of error against work, both logarithmic, one line for each method of refinement."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from validation.report.figures.curves import style_of
from validation.report.figures.histories import Line, Margins, draw_line, house_style, label_ends, one_axes


def work_figure(lines: Sequence[Line], x_label: str, y_label: str) -> Figure:
    """Draw errors over seconds in the order of refinement; each point carries its note, one for each point."""
    with house_style():
        figure, axes = one_axes(46.0, Margins(16.0, 34.0, 3.0, 9.5), (x_label, y_label), logarithmic=True)
        for line in lines:
            draw_line(axes, line.name, line.x, line.y)
            axes.plot(line.x, line.y, "o", ms=3, color=style_of(line.name).color, zorder=9)
            for x, y, note in zip(line.x, line.y, line.note.split(), strict=True):
                axes.annotate(note, (x, y), (2.0, 2.5), textcoords="offset points", fontsize=5.5)
        for axis in (axes.xaxis, axes.yaxis):  # often less than a decade, which would have one tick
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(lambda value, _: f"{value:g}")
            axis.set_minor_formatter(NullFormatter())
        axes.margins(0.06, 0.1)
        axes.autoscale_view()
        label_ends(axes, {line.name: float(line.y[int(np.argmax(line.x))]) for line in lines})
    return figure
