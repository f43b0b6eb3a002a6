"""The chapters of the studies `rocking` and `toppling`: DDA against rigid blocks, a table and a figure each."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, Paragraph, Table
from validation.report.chapters.data import CaseGroup, CaseGroups, CaseResults, case_groups, verdicts_of
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, short
from validation.report.figures.charts import ChartLine, ChartPanel
from validation.runs.history import Array
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Value
from validation.studies.rocking.read import increments, rectangle
from validation.studies.rocking.rocking import DURATION, LET_GO, PULSE, PUSH
from validation.studies.rocking.toppling import TURN, beyond

COLORS = ("#d55e00", "#0072b2", "#009e73", "#666666")
PAGE = Description(__file__)
ABSENT: dict[str, Any] = dict.fromkeys(("quarter period", "rate ratio", "peak", "time"))  # numbers without a gate
QUANTITIES = {  # metric -> words
    "moved": "distance in the second half, over a sliding block's or the width",
    "identity": "u + tan φ v less the free motion, over the distance",
    "run-out": "run-out over a rigid block's",
    "time": "time over a rigid block's",
    "turned": "greatest turn [rad]",
    "area": "area over the outline's own",
    "growth": "growth of the area",
}


def rocking_chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter of `rocking`."""
    groups = case_groups(results, manifest)
    swings = [group for group in groups if group.name in LET_GO]
    pulses = [group for group in groups if group.name == PULSE]
    panels = [swing_panel(group) for group in swings[-1:]] + [pulse_panel(group) for group in pulses]
    blocks = [*opening(manifest, verdicts_of(groups)), Paragraph(PAGE.text("swings")), swing_table(swings)]
    blocks += [Paragraph(PAGE.text("pulses")), pulse_table(pulses)]
    return [*blocks, *drawn("rocking", panels, directory)]


def toppling_chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter of `toppling`."""
    groups = case_groups(results, manifest)
    blocks = [*opening(manifest, verdicts_of(groups)), Paragraph(PAGE.text("falls", turn=TURN)), fall_table(groups)]
    return [*blocks, *drawn("toppling", [fall_panel(groups), area_panel(groups)], directory)]


def drawn(name: str, panels: Sequence[ChartPanel], directory: Path) -> Blocks:
    """Return the figure of the panels that have lines, nothing where no case finished."""
    filled = [panel for panel in panels if panel.lines]
    return [PAGE.figure(name, filled, directory)] if filled else []


def coloured(curves: Sequence[tuple[str, Array, Array]]) -> list[ChartLine]:
    """Return lines of (name, x, y), each in a colour of its own."""
    return [ChartLine(*curve, color) for curve, color in zip(curves, COLORS, strict=False)]


def rigid(name: str, x: Array, y: Array) -> ChartLine:
    """Return the line of a rigid block or of a closed form, to compare with."""
    return ChartLine(name, x, y, "#000000", (3.0, 2.0))


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


def fall_table(groups: CaseGroups) -> Table:
    """Return what the gates of blocks on slopes measured, with their bands."""
    rows = []
    for group in groups:
        for case in group.cases:
            label = f"{group.name.removeprefix('toppling-')} {case.label if len(group.cases) > 1 else ''}".strip()
            for verdict in (v for v in group.verdicts if v["scene"] == case.name):
                words = QUANTITIES.get(verdict["metric"], verdict["metric"])
                edges = (short(edge, 7) for edge in verdict["band"])
                value = verdict["value"]
                measured = short(value) if isinstance(value, int | float) else DASH
                rows.append((label, words, measured, *edges))
                label = ""
    return PAGE.table("falls", rows)


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


def finished_cases(groups: CaseGroups, name: str) -> list[CaseResults]:
    """Return the cases of a scene that have a history of DDA."""
    cases = itertools.chain.from_iterable(group.cases for group in groups if group.name == name)
    return [case for case in cases if "dda" in case.histories]


def fall_panel(groups: CaseGroups) -> ChartPanel:
    """Return the turn of falling towers, and that of a rigid one."""
    curves = []
    for name, words in (("toppling-tower", "from its base"), ("toppling-fall", "released")):
        for case in finished_cases(groups, name):
            history = case.histories["dda"]
            curves.append((words, history.time, -history.columns["rotation"]))
    lines = coloured(curves)
    for case in finished_cases(groups, "toppling-fall"):
        turns = np.linspace(0.0, -float(case.histories["dda"].columns["rotation"][-1]), 101)[1:]
        times = np.array([rectangle(case.scene).fall_time(beyond(case.scene), turn) for turn in turns])
        lines.append(rigid("rigid", times, turns))
    return PAGE.panel("falls", lines)


def area_panel(groups: CaseGroups) -> ChartPanel:
    """Return the area of towers by exact and by first-order rotation."""
    curves = []
    for name, words in (("toppling-fall", "exact"), ("toppling-growth", "first-order")):
        for case in finished_cases(groups, name):
            history = case.histories["dda"]
            curves.append((words, history.time, 100 * (history.columns["area"] - 1)))
    lines = coloured(curves)
    for case in finished_cases(groups, "toppling-growth"):
        history = case.histories["dda"]
        product = 100 * (np.cumprod(1 + increments(history) ** 2) - 1)
        lines.append(rigid("product", history.time, np.asarray(product, dtype=np.float64)))
    return PAGE.panel("areas", lines)
