"""The chapter of the stiff contact: steps to settle under two schemes, as table and figure."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, Paragraph, Table
from validation.report.chapters.data import CaseGroup, CaseResults, case_groups
from validation.report.chapters.described import Description
from validation.report.chapters.scene import gate_count, opening
from validation.report.chapters.text import short
from validation.report.figures.charts import ChartLine
from validation.runs.records import Manifest
from validation.runs.results import Results

COLORS = ("#0072b2", "#d55e00", "#56b4e9", "#8c6d1f")  # of quantities and schemes, which are no solvers
SCHEMES = {0.5: "(1/2, 1)", 0.5625: "(9/16, 1)"}
QUANTITIES = ("displacement", "pressure")
PAGE = Description(__file__)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: what rings, for how long, and what does not."""
    (group,) = case_groups(results, manifest)
    cases_by_ratio = by_ratio(group)
    longest = float(max(case.scene.time.steps for case in group.cases))
    panel = PAGE.panel("settling", curves(cases_by_ratio, longest), y_range=(10.0, 1.6 * longest))
    return [
        *opening(manifest, lead=conclusion(cases_by_ratio)),
        settling_table(cases_by_ratio),
        PAGE.figure("settling", [panel], directory, group.name, slug=group.slug),
        Paragraph(f"{PAGE.text('ring')} {gate_count(group.verdicts).capitalize()}."),
    ]


CasesByRatio = dict[float, dict[float, CaseResults]]  # p/E -> alpha -> case


def by_ratio(group: CaseGroup) -> CasesByRatio:
    """Return the cases by p/E and alpha."""
    cases: CasesByRatio = {}
    for case in group.cases:
        ratio = case.scene.contact.stiffness / case.scene.block.young
        cases.setdefault(ratio, {})[case.scene.time.alpha] = case
    return dict(sorted(cases.items()))


def _steps(case: CaseResults | None, quantity: str) -> float | None:
    return None if case is None else case.number("dda", f"{quantity}.fine_settling_step")


def curves(cases_by_ratio: CasesByRatio, longest: float) -> list[ChartLine]:
    """Return steps to settle over p/E; a hollow dot at the longest run has not settled within it."""
    ratios = np.array(list(cases_by_ratio))
    lines: list[ChartLine] = []
    for (alpha, scheme), quantity in itertools.product(SCHEMES.items(), QUANTITIES):
        color = COLORS[len(lines) // 3]
        settling = np.array([_steps(row.get(alpha), quantity) for row in cases_by_ratio.values()], dtype=float)
        settles = np.isfinite(settling)
        steps = np.where(settles, settling, longest)
        lines += [
            ChartLine(f"{quantity} {scheme}", ratios, steps, color),
            ChartLine("", ratios[settles], steps[settles], color, width=0, dots=3.0),
            ChartLine("", ratios[~settles], steps[~settles], color, width=0, dots=4.0, hollow=True),
        ]
    return lines


def conclusion(cases_by_ratio: CasesByRatio) -> str:
    """Say in one sentence how long the pressure takes under either scheme."""
    parts = []
    for alpha, name in SCHEMES.items():
        settling: list[tuple[float, float]] = []
        for ratio, row in cases_by_ratio.items():
            steps = _steps(row.get(alpha), "pressure")
            if steps is not None:
                settling.append((steps, -ratio))
        if settling:
            steps, ratio = max(settling)  # of equal steps those of the softest contact
            parts.append(f"under {name} up to {steps:.0f} steps (at p = {short(-ratio)}E)")
    return PAGE.text("lead", parts=" and ".join(parts))


def settling_table(cases_by_ratio: CasesByRatio) -> Table:
    """Return steps to settle and the contact mode's root by p/E."""
    of_scheme = [column.title for column in PAGE.columns("settling")]
    rows = []
    for ratio, row in cases_by_ratio.items():
        measured = [PAGE.cells("settling", row.get(alpha)) for alpha in SCHEMES]
        rows.append((short(ratio), *itertools.chain(*measured)))
    return PAGE.table("settling", rows, ("p / E", *((f"α, δ = {name}", *of_scheme) for name in SCHEMES.values())))
