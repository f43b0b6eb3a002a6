"""The chapters of the studies `rocking` and `toppling`: DDA against rigid blocks, a table and a figure each."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, Paragraph, Table, table
from validation.report.chapters.data import CaseGroup, CaseGroups, CaseResults, case_groups, verdicts_of
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, plain, short
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.histories import Margins, saved
from validation.runs.history import Array
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.rocking.read import increments, rectangle
from validation.studies.rocking.rocking import DURATION, LET_GO, PULSE, PUSH
from validation.studies.rocking.toppling import TURN, beyond

COLORS = ("#d55e00", "#0072b2", "#009e73", "#666666")
SWINGS = (
    "The quarter period of a rigid block, by quadrature, is met up to the settlement of the corner. How much of its "
    "rate a block keeps after an impact is no property of DDA: springs have no restitution of their own, and the ratio "
    "depends on time step, springs and scheme. Constant acceleration gains no energy, so that it stays below one."
)
PULSES = (
    "The threshold of the acceleration is that of the rigid block, in closed form; tilt and time are DDA's over the "
    "rigid block's."
)
FALLS = (
    f"Times are those of a turn by {TURN} rad over the rigid block's. A tower that stands on its base is early, "
    "because its upper corner pushes before it lifts, by an amount proportional to 1/√p. First-order rotation, "
    "x − r y, y + r x, multiplies the area by 1 + r² in every step."
)
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
    caption = (
        "Left: tilt over that of the release, over time in quarter periods of the rigid block, which lies flat at 1. "
        "Right: tilt over the tipping angle on a base that accelerates for 0.36 s, by the pulse over the least that "
        "overturns the rigid block."
    )
    blocks = [*opening(manifest, verdicts_of(groups)), Paragraph(SWINGS), swing_table(swings)]
    blocks += [Paragraph(PULSES), pulse_table(pulses)]
    return [*blocks, *drawn(panels, directory, "rocking.svg", caption)]


def toppling_chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter of `toppling`."""
    groups = case_groups(results, manifest)
    caption = (
        "Left: turn of a tower of 10 m × 25 m on a slope of 40° (dashed: rigid block, released on its corner). Right: "
        "its area over that of the start (dashed: the product of 1 + r² over the steps)."
    )
    panels = [fall_panel(groups), area_panel(groups)]
    blocks = [*opening(manifest, verdicts_of(groups)), Paragraph(FALLS), fall_table(groups)]
    return [*blocks, *drawn(panels, directory, "toppling.svg", caption)]


def drawn(panels: Sequence[ChartPanel], directory: Path, file: str, caption: str) -> Blocks:
    """Return the figure of the panels that have lines, nothing where no case finished."""
    filled = [panel for panel in panels if panel.lines]
    margins = Margins(13.0, 20.0, 6.0, 10.0, 33.0)
    return [saved(chart_figure(filled, 42.0, margins), directory, file, caption)] if filled else []


def coloured(curves: Sequence[tuple[str, Array, Array]]) -> list[ChartLine]:
    """Return lines of (name, x, y), each in a colour of its own."""
    return [ChartLine(*curve, color) for curve, color in zip(curves, COLORS, strict=False)]


def rigid(name: str, x: Array, y: Array) -> ChartLine:
    """Return the line of a rigid block or of a closed form, to compare with."""
    return ChartLine(name, x, y, "#000000", (3.0, 2.0))


def judged(group: CaseGroup, case: CaseResults, metric: str) -> str:
    """Return the value that a gate saw, as text."""
    values = [v["value"] for v in group.verdicts if v["scene"] == case.name and v["metric"] == metric]
    return short(values[0]) if values and isinstance(values[0], int | float) else DASH


def swing_table(swings: CaseGroups) -> Table:
    """Return quarter periods and rate ratios."""
    rows = []
    for group in swings:
        for case in group.cases:
            block = rectangle(case.scene)
            tilt = math.radians(case.scene.block.tilt)
            measured = (judged(group, case, metric) for metric in ("quarter period", "rate ratio"))
            ratio = plain(block.height / block.width, 2)
            rows.append((ratio, plain(tilt / block.alpha, 2), *measured, plain(block.housner, 3)))
    caption = (
        "Blocks of a = 2 m released from a tilt. Quarter period over the rigid block's; rate after over before the "
        "impact."
    )
    return table(("h/a", "tilt / tipping", "quarter period", "rate ratio", "Housner"), rows, caption)


def size(case: CaseResults) -> float:
    """Return the pulse over the least one that overturns the rigid block [-]."""
    block = rectangle(case.scene)
    return PUSH / block.gravity / block.pulse_threshold(DURATION)


def pulse_table(pulses: CaseGroups) -> Table:
    """Return peaks, and times of tipping, after pulses."""
    rows = []
    for group in pulses:
        for case in group.cases:
            rows.append((plain(size(case), 3), judged(group, case, "peak"), judged(group, case, "time")))
    return table(
        ("pulse / threshold", "peak tilt", "time of tipping"),
        rows,
        "Towers of 4 m on a base that accelerates; DDA over the rigid block.",
    )


def fall_table(groups: CaseGroups) -> Table:
    """Return what the gates of blocks on slopes measured, with their bands."""
    rows = []
    for group in groups:
        for case in group.cases:
            label = f"{group.name.removeprefix('toppling-')} {case.label if len(group.cases) > 1 else ''}".strip()
            for verdict in (v for v in group.verdicts if v["scene"] == case.name):
                words = QUANTITIES.get(verdict["metric"], verdict["metric"])
                edges = (short(edge, 7) for edge in verdict["band"])
                rows.append((label, words, judged(group, case, verdict["metric"]), *edges))
                label = ""
    return table(("Scene", "Quantity", "DDA", "from", "to"), rows)


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
    return ChartPanel("Released", "t / T", "tilt / first tilt", coloured(lines), levels={"": 0.0}, marks={"": 1.0})


def pulse_panel(group: CaseGroup) -> ChartPanel:
    """Return tilt over time of blocks on a base that accelerates."""
    lines = []
    for case in group.cases:
        if (history := case.histories.get("dda")) is not None:
            tilt = history.columns["rotation"] / rectangle(case.scene).alpha
            lines.append((f"{size(case):.2f}", history.time, tilt))
    title = "A pulse of the base"
    y_label = "tilt / tipping angle"
    return ChartPanel(title, "t [s]", y_label, coloured(lines), levels={"": 1.0}, marks={"": DURATION})


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
    return ChartPanel("Toppling", "t [s]", "turn [rad]", lines)


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
    return ChartPanel("Growth of the area", "t [s]", "area / first area − 1 [%]", lines)
