"""The error ledger: what part of a difference is code, mesh, model form and time."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, Heading, Paragraph
from validation.report.chapters.data import CaseGroup, CaseGroups, CaseResults
from validation.report.chapters.text import span
from validation.report.figures import histories
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.curves import HAIR
from validation.report.figures.histories import Margins
from validation.runs.numbers import percent
from validation.scenes import features

PARTS = {
    "code": ("dda", "dda-textbook"),
    "mesh": ("fem", "bar"),
    "model form": ("dda", "bar"),
    "time": ("bar", "continuum"),
}
OPENING_PARTS = {  # contact that opens: no recursion is printed for it, and both models are known exact in time
    "code": ("fem", "fenicsx"),
    "mesh": ("fem", "bar"),
    "model form": ("block-events", "bar-events"),
    "time": ("dda", "block-events"),
}
METRICS = ("displacement.l2", "pressure.l2")
Values = tuple[float | None, float | None]  # relative L2 of displacement and contact pressure [1]
NOTHING: Values = (None, None)
LedgerLines = Sequence[tuple[str, Mapping[str, Values]]]  # label of a case, and its parts

DOT_COLOR = "#0072b2"
ROUNDING_COLOR = "#b0b0b0"
RULE_COLOR = "#dddddd"
ROUNDING = 1e-12  # smaller differences are rounding; they stand between the edge of the axis and this
EDGE = 1e-13
LINE = 3.1  # mm, height of a case
MARGINS = Margins(left=50.0, right=4.0)


def parts_of(case: CaseResults) -> Mapping[str, tuple[str, str]]:
    """Return the parts of the ledger, each with solver and reference."""
    return PARTS if features.linear(case.scene) else OPENING_PARTS


def entry(group: CaseGroup, case: CaseResults, part: str) -> Values:
    """Return a part of the ledger for one case, None where its pair was not compared."""
    displacement, pressure = (group.number_of_pair(case, *parts_of(case)[part], name) for name in METRICS)
    return displacement, pressure


def with_entries(groups: CaseGroups, parts: Mapping[str, tuple[str, str]]) -> list[CaseGroup]:
    """Return the groups with the cases that some of these parts apply to."""
    compared_groups = []
    for group in groups:
        cases = [case for case in group.cases if parts_of(case) is parts]
        compared = tuple(case for case in cases if any(entry(group, case, part) != NOTHING for part in parts))
        if compared:
            compared_groups.append(replace(group, cases=compared))
    return compared_groups


def ledger_blocks(groups: CaseGroups, name: str, directory: Path) -> Blocks:
    """Return the ledger of scenes as a figure and a sentence; nothing where fewer than two cases have one."""
    blocks: Blocks = []
    for parts in (PARTS, OPENING_PARTS):
        compared = with_entries(groups, parts)
        if sum(len(group.cases) for group in compared) > 1:
            pairs = ", ".join(f"{part}: {solver} − {reference}" for part, (solver, reference) in parts.items())
            caption = (
                "Each case on its line; displacement filled, contact pressure open; relative L2 over the history. "
                f"{pairs}. Grey: below 10⁻¹², which is rounding."
            )
            file = f"{name}-ledger{'-opening' * (parts is OPENING_PARTS)}.svg"
            lines = ledger_lines(compared, parts)
            chart = chart_figure(ledger_panels(lines), max(12.0, LINE * len(lines)), MARGINS, shared=True)
            figure = histories.saved(chart, directory, file, caption)
            blocks += [Heading("What the differences are made of", 2), Paragraph(headline(compared)), figure]
    return blocks


def headline(groups: CaseGroups) -> str:
    """Return what code, mesh and model form contribute, in sentences."""
    displacement = part_values(groups, "model form", 0)
    pressure = part_values(groups, "model form", 1)
    if not displacement or not pressure:
        return "The model form is not known here: its pair was not compared."
    return (
        f"The model form is {span(displacement)} in displacement and {span(pressure)} in contact pressure "
        f"(relative L2){_shares(groups, min(displacement))}."
    )


def _shares(groups: CaseGroups, model_form: float) -> str:
    """Say what code and mesh contribute; the rest is model form where both are below its least."""
    parts = {
        "code and rounding are": part_values(groups, "code", 0),
        "the finite-element mesh is": part_values(groups, "mesh", 0),
    }
    largest = {name: max(values) for name, values in parts.items() if values}
    if not largest:
        return ""
    sentence = " and ".join(f"{name} at most {percent(value)}" for name, value in largest.items())
    remainder = ""
    if max(largest.values()) < model_form:
        remainder = ", so that neither explains it: it is one strain in the block in place of a wave"
    return f"; of the displacement's difference {sentence}{remainder}"


def ledger_lines(groups: CaseGroups, parts: Mapping[str, tuple[str, str]]) -> LedgerLines:
    """Return the lines of the figure."""
    lines = []
    for group in groups:
        for case in group.cases:
            label = f"{group.name}: {case.label}" if len(group.cases) > 1 else group.name
            lines.append((label, {part: entry(group, case, part) for part in parts}))
    return lines


def ledger_panels(lines: LedgerLines) -> list[ChartPanel]:
    """Return a panel for each part that a case has: cases from above, displacement filled, contact pressure open.

    What is below 1e-12 stands grey at the left edge, without a place of its own.
    """
    largest = 0.0
    names: dict[str, None] = {}
    for _, parts in lines:
        for part, values in parts.items():
            if values != NOTHING:
                names[part] = None
                largest = max(largest, *(value or 0.0 for value in values))
    last = math.ceil(math.log10(min(max(largest, ROUNDING), 1e3)) + 0.05)
    high = 10.0**last
    heights = np.arange(len(lines), dtype=float)[::-1]
    powers = range(-12, last, math.ceil((last + 12) / 3))
    panels = []
    for part in names:
        dots = [ChartLine("", np.array([EDGE, high]), np.full(2, y), RULE_COLOR, width=HAIR) for y in heights]
        for column, shift in enumerate((0.17, -0.17)):
            errors = np.array([parts.get(part, NOTHING)[column] for _, parts in lines], dtype=float)
            is_rounding = errors <= ROUNDING
            places = np.where(is_rounding, math.sqrt(EDGE * ROUNDING), np.minimum(errors, high))
            for is_chosen, color in ((errors > ROUNDING, DOT_COLOR), (is_rounding, ROUNDING_COLOR)):
                x = places[is_chosen]
                y = heights[is_chosen] + shift
                dots.append(ChartLine("", x, y, color, width=0, dots=2.6, hollow=column == 1))
        panels.append(
            ChartPanel(
                part,
                "relative L2",
                "",
                dots,
                (EDGE, high),
                (-0.6, len(lines) - 0.4),
                (True, False),
                x_ticks={10.0**power: f"$10^{{{power}}}$" for power in powers},
                y_ticks={y: label for y, (label, _) in zip(heights, lines, strict=True)},
                names="none",
            )
        )
    return panels


def part_values(groups: CaseGroups, part: str, column: int) -> list[float]:
    """Return all numbers of a part, for displacement (0) or pressure (1)."""
    values = []
    for group in groups:
        values += [entry(group, case, part)[column] for case in group.cases]
    return [value for value in values if value is not None]
