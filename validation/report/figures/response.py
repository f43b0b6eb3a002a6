"""Figures of frequency responses: amplitude and phase of displacement and contact pressure, a line for each answer."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.report.figures.curves import COLUMNS, dash_style, engineering, style_of
from validation.report.figures.histories import Margins, axes_grid, house_style, label_ends, one_axes, save
from validation.runs.files import write_atomically
from validation.runs.history import DISPLACEMENT, PRESSURE, Array

COLORS = ("#d55e00", "#0072b2", "#009e73")
DASHED = (4.0, 1.6)
BETWEEN = 12.0  # two panels [mm]: the powers of ten of the right one stand there
DOTS = 200  # an inch, of PNG files
UNDATED: dict[str, dict[str, None]] = {".pdf": {"CreationDate": None}, ".png": {"Software": None}}


@dataclass(frozen=True)
class ResponseCurve:
    """Amplitude [m, Pa] and phase [rad] of each column over frequency, and how its line looks."""

    name: str
    solver: str  # whose colour it has
    dashed: bool  # exact in time
    frequency: Array  # Hz
    columns: Mapping[str, tuple[Array, Array]]  # column -> amplitude and phase


def response_figure(curves: Sequence[ResponseCurve], logarithmic: bool, per_metre: bool = False) -> Figure:
    """Draw amplitudes on a logarithmic axis above phases, displacement beside contact pressure."""
    with house_style():
        figure, (sizes, phases) = axes_grid([(46.0, 4.0), (24.0, 0.0)], 2, Margins(14.0, 34.0, 5.0, 9.5, BETWEEN))
        limits = (min(c.frequency[0] for c in curves), max(c.frequency[-1] for c in curves))
        scale = "log" if logarithmic else "linear"
        for above, below, column in zip(sizes, phases, (DISPLACEMENT, PRESSURE), strict=True):
            ends = _draw(above, below, curves, column, per_metre)
            for axes in (above, below):
                axes.set(xscale=scale, xlim=limits)
            above.tick_params(labelbottom=False)
            below.set(xlabel="frequency [Hz]", ylim=(-3.4, 3.4))
            below.set_yticks([-np.pi, 0, np.pi], ["−π", "0", "π"])
        colors = {curve.name: style_of(curve.solver).color for curve in curves}
        phases[0].set_ylabel("phase [rad]")
        label_ends(sizes[1], ends, colors=colors)
    return figure


def ratio_figure(frequency: Array, lines: Mapping[str, Array]) -> Figure:
    """Draw damping ratios over frequency, the first line solid and the others dashed."""
    with house_style():
        figure, axes = one_axes(46.0, Margins(14.0, 46.0, 3.0, 9.5), ("frequency [Hz]", "steady ratio [%]"))
        axes.set(xscale="log", xlim=(frequency[0], frequency[-1]))
        colors = dict(zip(lines, itertools.cycle(COLORS), strict=False))
        for i, (name, values) in enumerate(lines.items()):
            dash = DASHED if i else ()
            axes.plot(frequency, 100 * values, color=colors[name], lw=1.0, ls=dash_style(dash))
        axes.set_ylim(bottom=0)
        label_ends(axes, {name: 100 * float(values[-1]) for name, values in lines.items()}, colors=colors)
    return figure


def save_as(figure: Figure, path: Path) -> Path:
    """Write a figure as the ending of its path says, .svg, .pdf or .png, the same bytes every time; return the path."""
    ending = path.suffix.lower()
    if ending == ".svg":
        return save(figure, path)
    with house_style():
        write_atomically(
            path,
            lambda stream: figure.savefig(stream, format=ending[1:], dpi=DOTS, metadata=UNDATED[ending]),
        )
    return path


def _draw(above: Axes, below: Axes, curves: Sequence[ResponseCurve], column: str, per_metre: bool) -> dict[str, float]:
    """Draw one column of all curves; return the ends of its amplitudes."""
    name, unit = COLUMNS[column]
    largest = max(float(np.nanmax(curve.columns[column][0])) for curve in curves)
    factor, unit = (1.0, {"m": "m/m", "Pa": "Pa/m"}[unit]) if per_metre else engineering(largest, unit)
    above.set_yscale("log")
    above.set_title(f"{name} [{unit}]")
    ends = {}
    for curve in curves:
        style = style_of(curve.solver)
        width = 0.6 * style.width if curve.dashed else style.width
        look: dict[str, Any] = {"color": style.color, "zorder": 2 + style.layer, "lw": width}
        size, phase = curve.columns[column]
        dash = dash_style(DASHED if curve.dashed else ())
        above.plot(curve.frequency, factor * size, ls=dash, **look)
        below.plot(curve.frequency, phase, ls=dash, **look)
        drawn = factor * size[np.isfinite(size) & (size > 0)]
        ends[curve.name] = float(drawn[-1]) if drawn.size else 1.0
    return ends
