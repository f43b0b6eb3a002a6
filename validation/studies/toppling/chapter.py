"""The chapter of the study `toppling`: DDA against rigid blocks, a table and a figure."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validation.metrics.rotation import increments
from validation.report.blocks import Blocks, Paragraph, Table
from validation.report.chapters.data import CaseGroups, CaseResults, case_groups, verdicts_of
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, short
from validation.report.figures.charts import ChartLine, ChartPanel
from validation.runs.history import Array
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.toppling.formulas import TURN, beyond
from validation.theory.rocking import rectangle

COLORS = ("#d55e00", "#0072b2", "#009e73", "#666666")
PAGE = Description(__file__)
QUANTITIES = {  # metric -> words
    "moved": "distance in the second half, over a sliding block's or the width",
    "identity": "u + tan φ v less the free motion, over the distance",
    "run-out": "run-out over a rigid block's",
    "time": "time over a rigid block's",
    "turned": "greatest turn [rad]",
    "area": "area over the outline's own",
    "growth": "growth of the area",
}


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
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
