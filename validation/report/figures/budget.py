"""The damping budget: damping ratios over the time step, a panel a setting."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from validation.report.figures.charts import ChartLine, draw_chart_line, name_at_ends
from validation.report.figures.curves import GREY, HAIR, dash_style, style_of
from validation.report.figures.histories import Margins, house_style, share_left, small_multiples
from validation.runs.history import Array
from validation.runs.records import BudgetRecord

CONTACT_COLOR = "#5d3a9b"
BUDGET_PANELS = 4  # in a row
LEAST_RATIO = 1e-4  # damping ratios below are off the axis


@dataclass(frozen=True)
class BudgetPanel:
    """One setting of a scene: its title and its budget as the manifest keeps it."""

    title: str
    budget: BudgetRecord


def budget_figure(panels: Sequence[BudgetPanel]) -> Figure:
    """Draw total damping ratio over dt, split into its parts, with the limits, one panel a setting."""
    margins = Margins(right=24.0, top=8.0, bottom=9.5)
    with house_style():
        figure, bands = small_multiples(panels, min(len(panels), BUDGET_PANELS), margins, [(40.0, 15.0)])
        for band, (row,) in bands:
            for axes, panel in zip(row, band, strict=False):
                _budget_axes(axes, panel)
            share_left(row, len(band), "Damping ratio ξ [%]")
            name_at_ends(row[len(band) - 1], _lines(band[-1].budget))
    return figure


def _lines(budget: BudgetRecord) -> list[ChartLine]:
    """Return the lines of a panel [%], parts only where there is kinetic or viscous damping."""
    colors = {"first axial": style_of("dda").color, "contact": CONTACT_COLOR}
    lines = []
    for name, curves in budget["modes"].items():
        parts: dict[str, Array] = {}
        for part, values in curves.items():
            ratios = np.array(values, dtype=float)
            parts[part] = 100 * np.where(ratios > LEAST_RATIO / 10, ratios, math.nan)
        line = ChartLine(name, np.array(budget["dt"]), parts["total"], colors[name], width=1.3)
        lines.append(line)
        if name != "first axial":
            continue
        least = min(np.nanmax(parts[part], initial=0.0) for part in ("algorithmic", "kinetic"))
        is_split = least > 100 * LEAST_RATIO
        if is_split or "viscous" in parts:
            lines.append(replace(line, name="algorithmic part", y=parts["algorithmic"], width=0.8, dash=(4.0, 2.0)))
        if is_split:
            lines.append(replace(line, name="kinetic part", y=parts["kinetic"], width=0.9, dash=(1.0, 1.5)))
        if "viscous" in parts:
            lines.append(replace(line, name="viscous part", y=parts["viscous"], width=0.9, dash=(6.0, 1.5)))
    return lines


def _budget_axes(axes: Axes, panel: BudgetPanel) -> None:
    dt = np.array(panel.budget["dt"])
    axes.set(xscale="log", yscale="log", xlim=(dt[0], dt[-1]), ylim=(100 * LEAST_RATIO, 1e3))
    axes.set_title(panel.title, pad=9.0)
    axes.axhspan(100, 1e3, color="#f0f0f0", zorder=0)
    if panel.budget["limits"].get("overdamped below"):
        axes.text(0.97, 0.97, "overdamped", transform=axes.transAxes, va="top", ha="right", color=GREY, fontsize=6)
    lines = _lines(panel.budget)
    for line in lines:
        draw_chart_line(axes, line)
        ends = np.flatnonzero(np.isfinite(line.y))[-1:]
        if ends.size and ends[0] < dt.size - 1:
            draw_chart_line(axes, ChartLine("", dt[ends], line.y[ends], line.color, width=0, dots=2.6, hollow=True))
    if all(np.nanmax(line.y, initial=0.0) < 100 * LEAST_RATIO for line in lines):
        axes.text(0.5, 0.5, "no damping", transform=axes.transAxes, ha="center", color=GREY)
    if floor := panel.budget["floor"]:
        box = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
        text = f"ω₁ = {floor:.3f} × bar"
        axes.text(0.97, 0.05, text, transform=axes.transAxes, ha="right", color=GREY, fontsize=5.5, bbox=box, zorder=5)
    _limit_lines(axes, panel.budget)
    for step in panel.budget["steps"]:
        axes.plot(step, 100 * LEAST_RATIO, "^", ms=3.4, color="black", clip_on=False, zorder=8)
    axes.xaxis.set_major_locator(LogLocator(numticks=4))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_xlabel("dt [s]", labelpad=1.5)


def _limit_lines(axes: Axes, budget: BudgetRecord) -> None:
    """Draw the limits as vertical hairlines, named above the axes."""
    names = {"real roots": f"ω₁dt = {budget['real roots at']:.3g}", "wave transit": "a/c"}
    for name, step in budget["limits"].items():
        text = names.get(name, "")
        dash = () if name == "wave transit" else (2.0, 2.0)
        axes.axvline(step, color=GREY, lw=HAIR, ls=dash_style(dash), zorder=1)
        if text:
            side = "left" if name == "real roots" else "right"
            axes.text(
                step, 1.01, text, transform=axes.get_xaxis_transform(), color=GREY, fontsize=6, ha=side, va="bottom"
            )
