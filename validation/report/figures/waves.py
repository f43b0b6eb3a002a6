"""Figures of waves in columns: speed and loss over blocks a wavelength, and what a site shows of a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from validation.report.figures.curves import GREY, HAIR, dash_style, engineering
from validation.report.figures.histories import Margins, axes_grid, house_style, label_ends
from validation.runs.history import Array

COLORS = {"(1/2, 1)": "#d55e00", "(1/4, 1/2)": "#0072b2"}
STROKES = {0.1: (1.0, 1.2), 0.25: (2.5, 1.2), 0.5: (5.0, 1.5), 1.0: ()}
TICKS = (8, 10, 20, 40, 100)


@dataclass(frozen=True)
class Travel:
    """Waves of one scheme and one c dt/h: closed form, or what was measured."""

    scheme: str  # "(1/2, 1)" or "(1/4, 1/2)"
    courant: float  # c dt/h [-]
    blocks: Array  # a wavelength [-]
    speed: Array  # error of the phase speed [-]
    amplitude: Array  # after ten wavelengths, over that at the start [-]


def travel_figure(curves: Sequence[Travel], measured: Sequence[Travel]) -> Figure:
    """Draw the closed forms as lines and the measured waves as dots: the error of the speed, and what is left."""
    with house_style():
        figure, ((speeds, amplitudes),) = axes_grid([(52.0, 0.0)], 2, Margins(13.0, 34.0, 6.0, 9.5))
        for line in curves:
            look: dict[str, Any] = {"color": COLORS[line.scheme], "lw": 0.9}
            look["ls"] = dash_style(STROKES.get(line.courant, ()))
            speeds.plot(line.blocks, 100 * line.speed, **look)
            amplitudes.plot(line.blocks, line.amplitude, **look)
        for dots in measured:
            color = COLORS[dots.scheme]
            speeds.plot(dots.blocks, 100 * dots.speed, "o", ms=2.6, color=color)
            amplitudes.plot(dots.blocks, dots.amplitude, "o", ms=2.6, color=color)
        _blocks_axis(speeds)
        _blocks_axis(amplitudes)
        speeds.axhline(0.0, color=GREY, lw=HAIR)
        speeds.set_ylim(-3.0, 4.0)
        speeds.set_title("Error of the phase speed [%]")
        amplitudes.set_ylim(-0.02, 1.04)
        amplitudes.set_yticks([0.2, 0.4, 0.6, 0.8, 1.0])  # a zero would meet the other panel's last tick
        amplitudes.set_title("Amplitude left after ten wavelengths")
        ends = {}
        for line in curves:
            if line.scheme == "(1/2, 1)":
                ends[f"{line.scheme}, c dt/h = {line.courant:g}"] = float(line.amplitude[-1])
        colors = dict.fromkeys(ends, COLORS["(1/2, 1)"])
        undamped = "(1/4, 1/2), every dt"
        ends[undamped] = 1.0
        colors[undamped] = COLORS["(1/4, 1/2)"]
        label_ends(amplitudes, ends, colors=colors)
    return figure


def _blocks_axis(axes: Axes) -> None:
    """Set the axis of blocks a wavelength."""
    axes.set(xscale="log", xlim=(7, 115), xlabel="blocks a wavelength")
    axes.set_xticks(TICKS, [str(tick) for tick in TICKS])
    axes.xaxis.set_minor_formatter(NullFormatter())


@dataclass(frozen=True)
class SiteTrace:
    """A column of a history."""

    name: str
    color: str
    width: float  # pt
    time: Array  # [s]
    values: Array  # [m] or [Pa]


def site_figure(rows: Sequence[tuple[str, str, Sequence[SiteTrace]]]) -> Figure:
    """Draw traces on common axes, one panel for each (title, unit, traces), on one axis of time."""
    with house_style():
        bands = [(42.0, 9.0)] * (len(rows) - 1) + [(42.0, 0.0)]
        figure, grid = axes_grid(bands, 1, Margins(13.0, 36.0, 6.0, 9.0))
        for (axes,), (title, unit, traces) in zip(grid, rows, strict=True):
            factor, unit = engineering(max(float(np.abs(trace.values).max()) for trace in traces), unit)
            axes.set(title=f"{title} [{unit}]", xlim=(0.0, float(traces[0].time[-1])))
            for trace in traces:
                axes.plot(trace.time, factor * trace.values, color=trace.color, lw=trace.width)
            for number, trace in enumerate(traces):
                label = f"{trace.name}\n{factor * float(np.abs(trace.values).max()):.3g} {unit} at most"
                place = 0.97 - 0.3 * number
                axes.text(1.02, place, label, transform=axes.transAxes, color=trace.color, va="top", linespacing=1.4)
        grid[-1][0].set_xlabel("Time [s]")
    return figure
