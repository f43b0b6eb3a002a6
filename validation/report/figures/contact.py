"""Figures of contact that opens: the restitution map, and maps of numbers over time step and springs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from validation.report.figures.histories import WIDTH, Margins, axes_grid, house_style, share_left
from validation.runs.history import Array

COLORS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7")
CELL, LEFT, TOP, BOTTOM, GAP = 6.5, 16.0, 6.0, 9.0, 6.0  # mm


@dataclass(frozen=True)
class Curve:
    """The restitution of a scheme over Omega, and impacts that were run."""

    name: str
    omega: Array
    mean: Array
    low: Array
    high: Array
    impacts: tuple[tuple[float, float], ...] = ()  # Omega and e


def restitution_figure(curves: Sequence[Curve], marks: Mapping[float, str]) -> Figure:
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
    across = (WIDTH - LEFT - 2.0 - GAP * (len(maps[0]) - 1)) / len(maps[0])
    each = TOP + CELL * len(rows)
    height = each * len(maps) + BOTTOM
    with house_style():
        figure = Figure(figsize=(WIDTH / 25.4, height / 25.4))
        for i, line in enumerate(maps):
            bottom = height - each * (i + 1)
            for k, shown in enumerate(line):
                left = LEFT + k * (across + GAP)
                axes = figure.add_axes((left / WIDTH, bottom / height, across / WIDTH, CELL * len(rows) / height))
                axes.imshow(np.nan_to_num(shown.values), cmap="Greys", vmin=0, vmax=1.6, aspect="auto")
                for (r, c), value in np.ndenumerate(shown.values):
                    axes.text(
                        c, r, shown.texts[r][c], ha="center", va="center", color="white" if value > 0.9 else "black"
                    )
                axes.set_title(shown.title)
                last = i == len(maps) - 1
                axes.set_xticks(range(len(columns)), list(columns) if last else [""] * len(columns))
                axes.set_yticks(range(len(rows)), list(rows) if k == 0 else [""] * len(rows))
                axes.tick_params(length=0)
                if last:
                    axes.set_xlabel("dt [ms]")
    return figure
