"""The paper's figures redrawn, and the damping budget, in the house style of `figures`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, NullLocator

from validation.report.figures.curves import GREY, HAIR, dash_style, style_of, thin
from validation.report.figures.histories import (
    Margins,
    axes_grid,
    draw_line,
    house_style,
    label_ends,
    one_axes,
    outer_ticks,
    share_left,
    size_of,
    small_multiples,
)
from validation.runs.history import Array
from validation.runs.records import BudgetRecord

SCHEME_COLORS = ("#009e73", "#5d3a9b", "#cc79a7", "#8c6d1f")  # schemes are no solvers: colours of their own
CONTACT_COLOR = "#5d3a9b"
BUDGET_PANELS = 4  # in a row
LEAST_RATIO = 1e-4  # damping ratios below are off the axis


@dataclass(frozen=True)
class StepPanel:
    """One panel over the number of time steps: lines by solver, an optional level, and where DDA has settled."""

    title: str
    lines: Mapping[str, Array]
    level: float | None = None
    settled: float | None = None


def steps_figure(panels: Sequence[StepPanel], label: str, last: int) -> Figure:
    """Draw histories over the step number, one panel a case, up to step `last`; the settling step is marked."""
    low, high = _range(panels, last)
    with house_style():
        figure, (row,) = axes_grid([(36.0, 0.0)], len(panels), Margins(right=22.0, bottom=9.5))
        for axes, panel in zip(row, panels, strict=True):
            axes.set(title=panel.title, xlim=(0, last), ylim=(low, high))
            for name, values in panel.lines.items():
                x, y = thin(np.arange(1.0, min(last, values.size) + 1), values[:last])
                draw_line(axes, name, x, y)
            _mark(axes, panel)
            _step_axis(axes, last)
        share_left(row, len(row), label)
        label_ends(row[-1], {n: float(v[min(last, v.size) - 1]) for n, v in panels[-1].lines.items()})
    return figure


def _range(panels: Sequence[StepPanel], last: int) -> tuple[float, float]:
    lines = [np.zeros(1)]
    for panel in panels:
        lines += [line[:last] for line in panel.lines.values()]
    values = np.concatenate(lines)
    values = values[np.isfinite(values)]
    pad = 0.06 * float(np.ptp(values)) or 1.0
    return float(values.min()) - pad, float(values.max()) + pad


def _mark(axes: Axes, panel: StepPanel) -> None:
    if panel.level is not None:
        axes.axhline(panel.level, color="#bbbbbb", lw=HAIR, zorder=1)
    if panel.settled is None or panel.settled > axes.get_xlim()[1]:
        return
    color = style_of("dda").color
    axes.axvline(panel.settled, color=color, lw=HAIR, zorder=1, ls=(0, (2, 2)))
    # The words stand on the side of the line where there is more room.
    side, shift = ("right", -2.0) if panel.settled > 0.6 * axes.get_xlim()[1] else ("left", 2.0)
    axes.annotate(
        f"{panel.settled:.0f} steps",
        (panel.settled, 1.0),
        (shift, -1.0),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        color=color,
        va="top",
        ha=side,
        fontsize=6,
    )


def _step_axis(axes: Axes, last: int) -> None:
    least_width = 34 if last < 1000 else 60  # mm
    count = 4 if size_of(axes)[0] > least_width else 2
    ticks = MaxNLocator(count, integer=True, steps=[1, 2, 5, 10]).tick_values(0, last)
    texts = {float(tick): f"{tick:,.0f}".replace(",", "\u202f") for tick in ticks if 0 <= tick <= last}
    outer_ticks(axes, last, texts)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.set_xlabel("Time step", labelpad=1.5)


# ---- figure 1 -----------------------------------------------------------------------------------------------------


def radius_figure(data: Mapping[str, Any], points: Sequence[tuple[float, float]]) -> Figure:
    """Draw spectral radius over w dt for some schemes, what the paper prints dashed, and the code's own operators."""
    omega = np.array(data["omega"])
    with house_style():
        figure, axes = one_axes(58.0, Margins(13.0, 56.0, 4.0, 9.5), ("ω dt", "Spectral radius |λ|"))
        axes.set(xscale="log", xlim=(omega[0], omega[-1]), ylim=(0, 1.06))
        ends: dict[str, float] = {}
        colors: dict[str, str] = {}
        for (name, curve), color in zip(data["schemes"].items(), SCHEME_COLORS, strict=True):
            radius = np.array(curve["radius"])
            printed = np.array(curve["printed"])
            axes.plot(omega, radius, color=color, lw=1.2, zorder=3)
            ends[name] = float(radius[-1])
            colors[name] = color
            departs = np.abs(printed - radius) > 1e-6
            if departs.any():
                axes.plot(omega[departs], printed[departs], color=color, lw=0.9, ls=(0, (4, 2)), zorder=2)
                name = f"{name.split(' (')[0]}: √(1+h), as printed"
                ends[name] = float(printed[-1])
                colors[name] = color
        if points:
            x, y = np.array(points).T
            axes.plot(x, y, "o", ms=2.6, mfc="none", mec=style_of("dda").color, mew=0.6, zorder=5)
            axes.annotate(
                "one-step operators of dda", (0.04, 0.06), xycoords="axes fraction", color=style_of("dda").color
            )
        axes.axvline(4.0, color=GREY, lw=HAIR, ls=(0, (2, 2)))
        axes.annotate("ω dt = 4", (4.0, 0.02), (3, 0), textcoords="offset points", color=GREY)
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        label_ends(axes, ends, colors=colors, below=0.0)
    return figure


# ---- the damping budget -------------------------------------------------------------------------------------------


BudgetLine = tuple[Array, str, float, Any]  # values, colour, width, dashes


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
            _budget_labels(row[len(band) - 1], band[-1].budget)
    return figure


def _lines(budget: BudgetRecord) -> dict[str, BudgetLine]:
    """Lines of a panel: label -> values, colour, width, dashes; parts only where there is kinetic damping."""
    colors = {"first axial": style_of("dda").color, "contact": CONTACT_COLOR}
    lines: dict[str, BudgetLine] = {}
    for name, curves in budget["modes"].items():
        parts = {part: np.array(values, dtype=float) for part, values in curves.items()}
        color = colors[name]
        lines[name] = (parts["total"], color, 1.3, "-")
        if name != "first axial":
            continue
        algorithmic = (parts["algorithmic"], color, 0.8, (0, (4, 2)))
        if min(np.nanmax(parts[part], initial=0.0) for part in ("algorithmic", "kinetic")) > LEAST_RATIO:
            lines["algorithmic part"] = algorithmic
            lines["kinetic part"] = (parts["kinetic"], color, 0.9, (0, (1, 1.5)))
        if "viscous" in parts:
            lines["algorithmic part"] = algorithmic
            lines["viscous part"] = (parts["viscous"], color, 0.9, (0, (6, 1.5)))
    return lines


def _budget_axes(axes: Axes, panel: BudgetPanel) -> None:
    dt = np.array(panel.budget["dt"])
    axes.set(xscale="log", yscale="log", xlim=(dt[0], dt[-1]), ylim=(100 * LEAST_RATIO, 1e3))
    axes.set_title(panel.title, pad=9.0)
    axes.axhspan(100, 1e3, color="#f0f0f0", zorder=0)
    if panel.budget["limits"].get("overdamped below"):
        axes.text(0.97, 0.97, "overdamped", transform=axes.transAxes, va="top", ha="right", color=GREY, fontsize=6)
    for values, color, width, dash in _lines(panel.budget).values():
        y = 100 * np.where(values > LEAST_RATIO / 10, values, math.nan)
        axes.plot(dt, y, color=color, lw=width, ls=dash, zorder=4)
        ends = np.flatnonzero(np.isfinite(y))
        if ends.size and ends[-1] < dt.size - 1:
            axes.plot(dt[ends[-1]], y[ends[-1]], "o", ms=2.6, mfc="white", mec=color, mew=0.7, zorder=6)
    if all(np.nanmax(values, initial=0.0) < LEAST_RATIO for values, *_ in _lines(panel.budget).values()):
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


def _budget_labels(axes: Axes, budget: BudgetRecord) -> None:
    ends: dict[str, float] = {}
    colors: dict[str, str] = {}
    for name, (values, color, *_) in _lines(budget).items():
        drawn = values[np.isfinite(values) & (values > LEAST_RATIO)]
        if drawn.size:
            ends[name] = 100 * float(drawn[-1])
            colors[name] = color
    label_ends(axes, ends, colors=colors, below=0.0)
