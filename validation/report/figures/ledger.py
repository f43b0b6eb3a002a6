"""The error ledger as a figure: what part of a difference is code, mesh, model form and time, case by case."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from validation.report.figures.curves import HAIR
from validation.report.figures.histories import WIDTH, Margins, axes_grid, house_style

DOT_COLOR = "#0072b2"
ROUNDING_COLOR = "#b0b0b0"
ROUNDING = 1e-12  # smaller differences are rounding; they stand between the edge and this
EDGE = 1e-13  # of the axis
LABELS = 50.0  # mm for the cases' names


@dataclass(frozen=True)
class LedgerLine:
    """One case of the ledger: for each part the displacement's and the pressure's relative L2 error, or None."""

    label: str
    parts: Mapping[str, tuple[float | None, float | None]]


def ledger_figure(lines: Sequence[LedgerLine]) -> Figure:
    """Draw the parts of the error side by side, one line per case: displacement filled, contact pressure open.

    What is below 1e-12 stands in a grey strip at the left, without a place of its own; a part of no case has no panel.
    """
    parts: dict[str, None] = {}
    values: list[float] = []
    for line in lines:
        for part, pair in line.parts.items():
            if pair != (None, None):
                parts[part] = None
                values += [value for value in pair if value]
    high = 10.0 ** math.ceil(math.log10(min(max(values, default=1.0), 1e3)) + 0.05)
    with house_style():
        figure, (row,) = axes_grid([(max(12.0, 3.1 * len(lines)), 0.0)], len(parts), Margins(left=LABELS, right=4.0))
        for axes, part in zip(row, parts, strict=True):
            axes.set_title(part)
            _ledger_axes(axes, [line.parts.get(part, (None, None)) for line in lines], high)
        row[0].set_yticks(range(len(lines)), [line.label for line in lines])
        row[0].tick_params(axis="y", length=0, pad=5.0, labelsize=6)
        middle = (LABELS + (WIDTH - LABELS - 4.0) / 2) / WIDTH
        bottom = 0.5 / (figure.get_figheight() * 25.4)
        figure.text(middle, bottom, "Relative L2 difference", ha="center", va="bottom")
    return figure


def _ledger_axes(axes: Axes, pairs: Sequence[tuple[float | None, float | None]], high: float) -> None:
    axes.set(xscale="log", xlim=(EDGE, high), ylim=(len(pairs) - 0.4, -0.6))
    axes.axvspan(EDGE, ROUNDING, color="#f0f0f0", zorder=0)
    axes.hlines(range(len(pairs)), EDGE, high, color="#dddddd", lw=HAIR, zorder=0)
    for y, pair in enumerate(pairs):
        for value, filled, shift in zip(pair, (True, False), (-0.17, 0.17), strict=True):
            if value is not None:
                color = DOT_COLOR
                place = min(value, high)
                if value <= ROUNDING:
                    color = ROUNDING_COLOR
                    place = math.sqrt(EDGE * ROUNDING)
                face = color if filled else "white"
                axes.plot(place, y + shift, "o", ms=2.6, mfc=face, mec=color, mew=0.6, clip_on=False)
    first = round(math.log10(ROUNDING))
    last = round(math.log10(high))
    powers = range(first, last, max(1, math.ceil((last - first) / 3)))
    axes.set_xticks([10.0**power for power in powers])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
