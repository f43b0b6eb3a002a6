"""The damping budget of a scene of one's own: damping ratios of both modes over the time step, with its limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks
from validation.report.chapters.data import CaseGroup
from validation.report.chapters.text import case_label
from validation.report.figures import histories
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.curves import style_of
from validation.report.figures.histories import Margins
from validation.runs.records import BudgetRecord

FIRST = "first axial"
OVER = ("time.step", "time.steps", "fem.elements")  # what a budget is drawn over or does not depend on
IN_A_ROW = 4  # settings
MARGINS = Margins(right=24.0, top=9.5, bottom=9.5)
CONTACT_COLOR = "#5d3a9b"
LEAST_RATIO = 1e-2  # %; damping ratios below are off the axis
DASHES = {"algorithmic": (4.0, 2.0), "kinetic": (1.0, 1.5), "viscous": (6.0, 1.5)}


def budget_blocks(group: CaseGroup, directory: Path) -> Blocks:
    """Return the damping budget of a scene, a figure for each four settings; nothing where there is none."""
    scenes = {case.name: case.scene for case in group.cases}
    panels = []
    for budget in group.budgets:
        name = budget["scene"]
        has_title = name in scenes and len(group.budgets) > 1
        panels.append(budget_panel(case_label(name, scenes[name], OVER) if has_title else "", budget))
    blocks: Blocks = []
    for first in range(0, len(panels), IN_A_ROW):
        figure = chart_figure(panels[first : first + IN_A_ROW], 40.0, MARGINS, shared=True)
        file = f"{group.slug}-damping-budget{first // IN_A_ROW or ''}.svg"
        blocks.append(histories.saved(figure, directory, file, _caption(group.budgets), group.name))
    return blocks


def budget_panel(title: str, budget: BudgetRecord) -> ChartPanel:
    """Return total damping ratio and its parts over dt, with limits; dots at the bottom are cases."""
    dt = np.array(budget["dt"])
    lines = []
    for line in budget_lines(budget):
        ends = np.flatnonzero(np.isfinite(line.y))[-1:]
        lines.append(line)
        if ends.size and ends[0] < dt.size - 1:
            lines.append(ChartLine("", dt[ends], line.y[ends], line.color, width=0, dots=2.6, hollow=True))
    steps = np.array(budget["steps"])
    at_least_step = budget["modes"][FIRST]["total"][0]
    is_overdamped = at_least_step is not None and at_least_step >= 1
    lines.append(ChartLine("", steps, np.full(steps.size, LEAST_RATIO), "black", width=0, dots=3.4))
    return ChartPanel(
        title,
        "dt [s]",
        "Damping ratio ξ [%]",
        lines,
        (dt[0], dt[-1]),
        (LEAST_RATIO, 1e3),
        (True, True),
        {"a/c": budget["transit"]},
        {"overdamped": 100.0} if is_overdamped else {},
    )


def budget_lines(budget: BudgetRecord) -> list[ChartLine]:
    """Return the damping ratios [%] of both modes; parts of the first where it has several."""
    colors = {FIRST: style_of("dda").color, "contact": CONTACT_COLOR}
    lines = []
    for name, curves in budget["modes"].items():
        parts = {}
        for part, values in curves.items():
            ratios = 100 * np.array(values, dtype=float)
            parts[part] = np.where(ratios > LEAST_RATIO / 10, ratios, math.nan)
        line = ChartLine(name, np.array(budget["dt"]), parts["total"], colors[name], width=1.3)
        lines.append(line)
        least = min(np.nanmax(parts[part], initial=0.0) for part in ("algorithmic", "kinetic"))
        is_split = least > LEAST_RATIO
        for part, dash in DASHES.items() if name == FIRST else ():
            if part in parts and (is_split or ("viscous" in parts and part != "kinetic")):
                lines.append(replace(line, name=f"{part} part", y=parts[part], width=0.9, dash=dash))
    return lines


def _caption(budgets: Sequence[BudgetRecord]) -> str:
    sentences = [
        "Damping budget of DDA's first axial and contact mode over the time step (dots at the bottom: the cases).",
        "Open circles: the roots of the step turn real and there is no damping ratio beyond; one root returns to −1.",
    ]
    sentences.append("a/c: travel time of the wave from top to base; a larger dt does not resolve it.")
    ratios = sorted({budget["floor"] for budget in budgets if budget["floor"]})
    if ratios:
        span = f"{ratios[0]:.3f}"
        if ratios[-1] != ratios[0]:
            span += f" to {ratios[-1]:.3f}"
        sentences.append(f"DDA's first natural frequency is {span} times the bar's; a long step lowers both.")
    if any(budget["gg_rate"] for budget in budgets):
        sentences.append("The discount is held as a rate.")
    elif any(budget["gg"] < 1 for budget in budgets):
        sentences.append("gg acts per step: towards small dt the kinetic part grows without bound.")
    return " ".join(sentences)
