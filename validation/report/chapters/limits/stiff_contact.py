"""The chapter of the stiff contact: steps to settle under two schemes, as table and figure."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, Paragraph, Table, table
from validation.report.chapters.data import CaseGroup, CaseResults, case_groups
from validation.report.chapters.measures import MetricColumn, cells
from validation.report.chapters.scene import gate_count, opening
from validation.report.chapters.text import short
from validation.report.figures import histories
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.histories import Margins
from validation.runs.records import Manifest
from validation.runs.results import Results

COLORS = ("#0072b2", "#d55e00", "#56b4e9", "#8c6d1f")  # of quantities and schemes, which are no solvers
SCHEMES = {0.5: "(1/2, 1)", 0.5625: "(9/16, 1)"}
QUANTITIES = ("displacement", "pressure")
SETTLING = (
    MetricColumn("displacement.fine_settling_step", 1.0, "displ.", decimals=0),
    MetricColumn("pressure.fine_settling_step", 1.0, "press.", decimals=0),
    MetricColumn("contact.spectral_radius", 1.0, "|λ| of the contact", digits=8),
)


def contact_chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: what rings, for how long, and what does not."""
    (group,) = case_groups(results, manifest)
    cases_by_ratio = by_ratio(group)
    longest = float(max(case.scene.time.steps for case in group.cases))
    caption = (
        "Steps until displacement and contact pressure stay within 10⁻⁴ of their static values, dda; a hollow mark has "
        "not settled within the run."
    )
    panel = ChartPanel(
        "",
        "p / E",
        "Steps to settle within $10^{-4}$",
        curves(cases_by_ratio, longest),
        y_range=(10.0, 1.6 * longest),
        logarithmic=(True, True),
    )
    figure = chart_figure([panel], 48.0, Margins(16.0, 54.0, 4.0, 10.0))
    ring = (
        "The amplitude of the ringing falls as 1/p, and so does its decay per step, 8/(ω dt)²: it takes longest to "
        "settle in between, and beyond, a ringing too small to see never ends."
    )
    return [
        *opening(manifest, lead=conclusion(cases_by_ratio)),
        settling_table(cases_by_ratio),
        histories.saved(figure, directory, f"{group.slug}-settling.svg", caption, group.name),
        Paragraph(f"{ring} {gate_count(group.verdicts).capitalize()}."),
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
    return (
        f"To settle within 10⁻⁴ the contact pressure takes {' and '.join(parts)}: constant acceleration rings, "
        "(9/16, 1) does not."
    )


def settling_table(cases_by_ratio: CasesByRatio) -> Table:
    """Return steps to settle and the contact mode's root by p/E."""
    of_scheme = [measure.title for measure in SETTLING]
    rows = []
    for ratio, row in cases_by_ratio.items():
        measured = [cells(SETTLING, row.get(alpha)) for alpha in SCHEMES]
        rows.append((short(ratio), *itertools.chain(*measured)))
    return table(
        ("p / E", *((f"α, δ = {name}", *of_scheme) for name in SCHEMES.values())),
        rows,
        "Steps to settle within 10⁻⁴ of static, and the contact mode's |λ|, dda.",
    )
