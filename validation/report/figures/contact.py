"""Figures of contact that opens: the restitution map, and maps of numbers over time step and springs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from validation.report.figures.histories import Margins, axes_grid, house_style, map_axes, share_left
from validation.runs.history import Array

COLORS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7")
CELL = 6.5  # mm, height of a cell of a map


@dataclass(frozen=True)
class RestitutionCurve:
    """The restitution of a scheme over Omega, and impacts that were run."""

    name: str
    omega: Array
    mean: Array
    low: Array
    high: Array
    impacts: tuple[tuple[float, float], ...] = ()  # Omega and e


def restitution_figure(curves: Sequence[RestitutionCurve], marks: Mapping[float, str]) -> Figure:
    """Draw mean and range of e over Omega, a panel for each scheme; dots are impacts that were run."""
    top = 1.05 * max(float(np.max(curve.high)) for curve in curves)
    with house_style():
        figure, (row,) = axes_grid([(45.0, 0.0)], len(curves), Margins(13.0, 3.0, 6.0, 10.0))
        for axes, curve, color in zip(row, curves, COLORS, strict=False):
            axes.set(xscale="log", xlim=(float(curve.omega[0]), float(curve.omega[-1])), ylim=(0.0, top))
            axes.fill_between(curve.omega, curve.low, curve.high, color=color, alpha=0.2, lw=0)
            axes.plot(curve.omega, curve.mean, color=color, lw=1.1)
            for x, e in curve.impacts:
                if curve.omega[0] <= x <= curve.omega[-1]:
                    axes.plot(x, e, "o", ms=2.4, mfc="white", mec=color, mew=0.6, clip_on=False, zorder=4)
            for x, text in marks.items():
                axes.axvline(x, color="#999999", lw=0.5)
                axes.text(x * 1.08, top * 0.97, text, color="#666666", va="top", ha="left")
            axes.axhline(1.0, color="#999999", lw=0.5)
            axes.set(title=curve.name, xlabel=r"$\Omega = \omega_c\,dt$")
        share_left(row, len(curves), "Restitution e")
    return figure


@dataclass(frozen=True)
class NumberMap:
    """A map of numbers by rows and columns, NaN where there is none, and the text of each."""

    title: str
    values: Array  # between 0, drawn light, and 1, drawn dark
    texts: tuple[tuple[str, ...], ...]


def number_maps(maps: Sequence[Sequence[NumberMap]], rows: Sequence[str], columns: Sequence[str]) -> Figure:
    """Draw maps in a grid; shade and number say the same."""
    with house_style():
        figure, grid = map_axes(len(maps), len(maps[0]), rows, columns, CELL)
        for line, axes_of_line in zip(maps, grid, strict=True):
            for number_map, axes in zip(line, axes_of_line, strict=True):
                axes.imshow(np.nan_to_num(number_map.values), cmap="Greys", vmin=0, vmax=1.6, aspect="auto")
                for (r, c), value in np.ndenumerate(number_map.values):
                    color = "white" if value > 0.9 else "black"
                    axes.text(c, r, number_map.texts[r][c], ha="center", va="center", color=color)
                axes.set_title(number_map.title)
        for axes in grid[-1]:
            axes.set_xlabel("dt [ms]")
    return figure
