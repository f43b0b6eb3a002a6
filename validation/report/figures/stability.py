"""Maps of correct digits, side by side in one scale, and steps to settle over the stiffness of the contact."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from validation.report.figures.histories import Margins, house_style, label_ends, map_axes, one_axes
from validation.runs.history import Array

COLORS = ("#0072b2", "#d55e00", "#56b4e9", "#8c6d1f")  # of quantities and schemes, which are no solvers
CELL = 4.6  # mm, height of a cell of a map


@dataclass(frozen=True)
class DigitMap:
    """A map: relative errors by rows and columns, NaN where no run answers."""

    title: str
    error: Array


def digits_of(error: Array) -> Array:
    """Return -log10 of the error, cut to 0 .. 16; NaN stays NaN."""
    with np.errstate(divide="ignore", invalid="ignore"):
        digits: Array = np.clip(-np.log10(np.maximum(error, 1e-16)), 0.0, 16.0) + 0.0
    return digits


def digit_maps(
    maps: Sequence[DigitMap], rows: Sequence[str], columns: Sequence[str], x_label: str, y_label: str
) -> Figure:
    """Draw maps of whole correct digits in one row; colour and number say the same, an empty cell has no run."""
    with house_style():
        figure, (row,) = map_axes(1, len(maps), rows, columns, CELL)
        for digit_map, axes in zip(maps, row, strict=True):
            digits = digits_of(digit_map.error)
            axes.imshow(digits, cmap="cividis", vmin=0, vmax=16, aspect="auto")
            for (i, j), value in np.ndenumerate(digits):
                if np.isfinite(value):
                    color = "black" if value > 8 else "white"
                    axes.text(j, i, f"{np.floor(value):.0f}", ha="center", va="center", color=color)
            axes.set(title=digit_map.title, xlabel=x_label)
        row[0].set_ylabel(y_label)
    return figure


@dataclass(frozen=True)
class Settling:
    """Steps to settle over p/E; NaN where a history never does within its steps."""

    name: str
    ratios: Array
    steps: Array


def settling_figure(lines: Sequence[Settling], longest: float) -> Figure:
    """Draw steps to settle over p/E, both logarithmic; a hollow mark at the top has not settled within the run."""
    with house_style():
        figure, axes = one_axes(
            48.0, Margins(16.0, 54.0, 4.0, 10.0), ("p / E", "Steps to settle within $10^{-4}$"), True
        )
        colors = {line.name: color for line, color in zip(lines, itertools.cycle(COLORS), strict=False)}
        ends = {}
        for line in lines:
            color = colors[line.name]
            settles = np.isfinite(line.steps)
            steps = np.where(settles, line.steps, longest)
            axes.plot(line.ratios, steps, color=color, lw=1.2)
            axes.plot(line.ratios[settles], steps[settles], "o", ms=3, color=color)
            axes.plot(line.ratios[~settles], steps[~settles], "o", ms=4, mfc="white", mec=color)
            ends[line.name] = float(steps[-1])
        axes.set_ylim(10, 1.6 * longest)
        label_ends(axes, ends, colors=colors)
    return figure
