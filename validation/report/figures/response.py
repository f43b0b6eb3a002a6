"""Figures of frequency responses: amplitude and phase of displacement and contact pressure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from validation.report.figures.charts import ChartLine, ChartPanel, Names, chart_figure
from validation.report.figures.curves import engineering, style_of
from validation.report.figures.histories import Margins, house_style, save
from validation.runs.columns import axis_of
from validation.runs.files import write_atomically
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, ArrayPair

DASHED = (4.0, 1.6)
BETWEEN = 12.0  # two panels [mm]: the powers of ten of the right one stand there
HALF_TURNS = {-np.pi: "−π", 0.0: "0", np.pi: "π"}
PIXELS = 1920  # across a PNG file: those of a slide
UNDATED: dict[str, dict[str, None]] = {".pdf": {"CreationDate": None}, ".png": {"Software": None}}


@dataclass(frozen=True)
class ResponseCurve:
    """Amplitude [m, Pa] and phase [rad] of each column over frequency, and how its line looks."""

    name: str
    solver: str  # whose colour it has
    dashed: bool  # exact in time
    frequency: Array  # Hz
    columns: Mapping[str, ArrayPair]  # column -> amplitude and phase


def response_figure(curves: Sequence[ResponseCurve], logarithmic: bool, per_metre: bool = False) -> Figure:
    """Draw amplitudes on a logarithmic axis above phases, displacement beside contact pressure."""
    axes: dict[str, Any] = {"x_range": (min(c.frequency[0] for c in curves), max(c.frequency[-1] for c in curves))}
    panels = []
    for column in (DISPLACEMENT, PRESSURE):
        name, unit = axis_of(column)
        largest = max(float(np.nanmax(curve.columns[column][0])) for curve in curves)
        factor, unit = (1.0, {"m": "m/m", "Pa": "Pa/m"}[unit]) if per_metre else engineering(largest, unit)
        lines = [_line(curve, factor * curve.columns[column][0]) for curve in curves]
        names: Names = "ends" if column == PRESSURE else "none"
        scales = (logarithmic, True)
        panels.append(ChartPanel(f"{name} [{unit}]", "", "", lines, logarithmic=scales, names=names, **axes))
    for column, label in ((DISPLACEMENT, "phase [rad]"), (PRESSURE, "")):
        lines = [_line(curve, curve.columns[column][1]) for curve in curves]
        axes |= {"y_range": (-3.4, 3.4), "y_ticks": HALF_TURNS, "logarithmic": (logarithmic, False), "names": "none"}
        panels.append(ChartPanel("", "frequency [Hz]", label, lines, **axes))
    return chart_figure(panels, [(46.0, 4.0), (24.0, 0.0)], Margins(14.0, 34.0, 5.0, 9.5, BETWEEN))


def _line(curve: ResponseCurve, values: Array) -> ChartLine:
    style = style_of(curve.solver)
    width = 0.6 * style.width if curve.dashed else style.width
    return ChartLine(curve.name, curve.frequency, values, style.color, DASHED if curve.dashed else (), width)


def save_as(figure: Figure, path: Path) -> Path:
    """Write a figure as .svg, .pdf or .png by its path, the same bytes every time; return the path."""
    ending = path.suffix.lower()
    if ending == ".svg":
        return save(figure, path)
    with house_style():
        write_atomically(
            path,
            lambda stream: figure.savefig(
                stream, format=ending[1:], dpi=PIXELS / figure.get_figwidth(), metadata=UNDATED[ending]
            ),
        )
    return path
