"""The chapter of the study `rocking`: DDA against rigid blocks, tables and a figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from validation.report.blocks import Blocks, Paragraph, Table
from validation.report.chapters.data import CaseGroup, CaseGroups, CaseResults, case_groups, verdicts_of
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.report.figures.charts import ChartLine, ChartPanel
from validation.runs.history import Array
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Value
from validation.studies.rocking.formulas import DURATION, LET_GO, PULSE, PUSH
from validation.theory.rocking import rectangle

COLORS = ("#d55e00", "#0072b2", "#009e73", "#666666")
PAGE = Description(__file__)
ABSENT: dict[str, Any] = dict.fromkeys(("quarter period", "rate ratio", "peak", "time"))  # numbers without a gate


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter of `rocking`."""
    groups = case_groups(results, manifest)
    swings = [group for group in groups if group.name in LET_GO]
    pulses = [group for group in groups if group.name == PULSE]
    panels = [swing_panel(group) for group in swings[-1:]] + [pulse_panel(group) for group in pulses]
    blocks = [*opening(manifest, verdicts_of(groups)), Paragraph(PAGE.text("swings")), swing_table(swings)]
    blocks += [Paragraph(PAGE.text("pulses")), pulse_table(pulses)]
    return [*blocks, *drawn("rocking", panels, directory)]


def drawn(name: str, panels: Sequence[ChartPanel], directory: Path) -> Blocks:
    """Return the figure of the panels that have lines, nothing where no case finished."""
    filled = [panel for panel in panels if panel.lines]
    return [PAGE.figure(name, filled, directory)] if filled else []


def coloured(curves: Sequence[tuple[str, Array, Array]]) -> list[ChartLine]:
    """Return lines of (name, x, y), each in a colour of its own."""
    return [ChartLine(*curve, color) for curve, color in zip(curves, COLORS, strict=False)]


def judged(group: CaseGroup, case: CaseResults) -> dict[str, Value]:
    """Return the numbers that the gates of a case saw, by metric."""
    own = [v for v in reversed(group.verdicts) if v["scene"] == case.name]
    return {v["metric"]: v["value"] for v in own if isinstance(v["value"], int | float)}


def swing_table(swings: CaseGroups) -> Table:
    """Return quarter periods and rate ratios."""
    rows = []
    for group in swings:
        for case in group.cases:
            block = rectangle(case.scene)
            own: dict[str, Any] = {
                "slenderness": block.height / block.width,
                "tilt": math.radians(case.scene.block.tilt) / block.alpha,
                "housner": block.housner,
            }
            rows.append(PAGE.cells("swings", case, ABSENT | own | judged(group, case)))
    return PAGE.table("swings", rows)


def size(case: CaseResults) -> float:
    """Return the pulse over the least one that overturns the rigid block [-]."""
    block = rectangle(case.scene)
    return PUSH / block.gravity / block.pulse_threshold(DURATION)


def pulse_table(pulses: CaseGroups) -> Table:
    """Return peaks, and times of tipping, after pulses."""
    rows = []
    for group in pulses:
        for case in group.cases:
            rows.append(PAGE.cells("pulses", case, ABSENT | {"size": size} | judged(group, case)))
    return PAGE.table("pulses", rows)


def swing_panel(group: CaseGroup) -> ChartPanel:
    """Return tilt over time of blocks released."""
    lines = []
    for case in group.cases:
        if (history := case.histories.get("dda")) is not None:
            block = rectangle(case.scene)
            tilt = math.radians(case.scene.block.tilt)
            x = history.time / block.quarter_period(tilt)
            y = 1 + history.columns["rotation"] / tilt
            lines.append((f"h/a = {block.height / block.width:g}", x[x < 2], y[x < 2]))
    return PAGE.panel("swings", coloured(lines))


def pulse_panel(group: CaseGroup) -> ChartPanel:
    """Return tilt over time of blocks on a base that accelerates."""
    lines = []
    for case in group.cases:
        if (history := case.histories.get("dda")) is not None:
            tilt = history.columns["rotation"] / rectangle(case.scene).alpha
            lines.append((f"{size(case):.2f}", history.time, tilt))
    return PAGE.panel("pulses", coloured(lines), marks={"": DURATION})
