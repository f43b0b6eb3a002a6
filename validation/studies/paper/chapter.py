"""The chapter of the study `paper`: claims, figures 1 and 3 to 9."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.data import CaseGroup, CaseResults, Groups, cases_of, groups_by_name
from validation.report.chapters.described import Description
from validation.report.chapters.text import capital
from validation.report.figures.charts import ChartLine, ChartPanel
from validation.report.figures.curves import style_of
from validation.runs.numbers import DASH, bounded, short
from validation.runs.records import Manifest
from validation.runs.results import Results

SOLVERS = ("continuum", "bar", "fem", "dda")
COARSE = 6  # steps a period; with fewer the undamped continuum is not a curve any more
WORDS = {0: "refuted", 1: "under a condition", 2: "confirmed"}
NAMELESS = "under a condition that the paper does not name"
VERBS = {  # of one, of several
    "confirmed": ("is confirmed", "are confirmed"),
    "under a condition": (f"holds {NAMELESS}", f"hold {NAMELESS}"),
    "refuted": ("is refuted", "are refuted"),
}
CLAIMS = "claims"
SCHEME_COLORS = ("#009e73", "#5d3a9b", "#cc79a7", "#8c6d1f")  # schemes are no solvers: colours of their own


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper over time steps: its scene, quantity, scale and window."""

    number: int
    scene: str
    quantity: str  # displacement or pressure
    last: int  # steps shown
    caption: str
    relative: bool = False  # value / static - 1 instead of the value


PAGE = Description(__file__)
FIGURES = tuple(PaperFigure(**entry) for entry in PAGE.entries("figures"))
COLUMNS = {
    "displacement": ("displacement", 1e3, "Displacement [mm]"),
    "pressure": ("contact_pressure", 1e-6, "Contact pressure [MPa]"),
}


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: conclusion, register of claims, figures."""
    groups = groups_by_name(results, manifest)
    rows = {row["name"]: row["metrics"] for row in manifest.get("derived", []) if row["scene"] == CLAIMS}
    claims = manifest.get("data", {}).get("claims", [])
    lead = conclusion(rows, {claim["id"] for claim in claims if claim.get("misprint")})
    blocks: Blocks = [Heading(manifest.get("title") or manifest["study"]), Paragraph(lead, "lead")]
    for title, letter in (("Statements", "C"), ("Slips of the equations", "S")):
        blocks += [Heading(title, 2), claims_table([c for c in claims if c["id"].startswith(letter)], rows)]
    blocks += [Heading("The figures", 2), *figure_1(manifest, groups, directory)]
    for figure in FIGURES:
        if figure.scene in groups:
            blocks.append(figure_block(figure, groups[figure.scene], directory))
    return blocks


def conclusion(rows: Mapping[str, Mapping[str, Any]], misprints: Collection[str] = ()) -> str:
    """Return one sentence on the register, and how many of the refuted are slips of print."""
    parts = counted_verdicts(rows, VERBS)
    refuted = {name for name, metrics in rows.items() if verdict_of(metrics) == "refuted"}
    slips = len(refuted.intersection(misprints))
    remark = ""
    if slips:
        remark = PAGE.text("misprint" if slips == 1 else "misprints", count=slips, refuted=len(refuted))
    return f"Of {len(rows)} statements and equations of the paper @feng2017 that were tested, {parts}.{remark}"


def counted_verdicts(rows: Mapping[str, Mapping[str, Any]], verbs: Mapping[str, tuple[str, str]]) -> str:
    """Return how many claims have each verdict, with the verbs of one and of several."""
    count = Counter(map(verdict_of, rows.values()))
    return ", ".join(f"{count[word]} {both[count[word] > 1]}" for word, both in verbs.items() if count[word])


def claims_table(claims: Sequence[Mapping[str, Any]], rows: Mapping[str, Mapping[str, Any]]) -> Table:
    """Return the register: verdict, statement, reason and measured numbers."""
    lines = []
    for claim in claims:
        metrics = rows.get(claim["id"], {})
        word = verdict_of(metrics)
        statement = f"{claim['says']} ({claim['place']})"
        lines.append((claim["id"], word, statement, reason_of(claim, word), measured_of(metrics)))
    return PAGE.table("claims", lines)


def verdict_of(metrics: Mapping[str, Any]) -> str:
    """Return the verdict on a claim as a word."""
    return WORDS.get(int(metrics.get("verdict", -1)), "not tested")


def reason_of(claim: Mapping[str, Any], word: str) -> str:
    """Return why a claim has its verdict, and the condition of one that holds under a condition."""
    condition = f" Condition: {claim['condition']}." if word == WORDS[1] and claim["condition"] else ""
    return f"{capital(claim['why'])}.{condition}"


def measured_of(metrics: Mapping[str, Any]) -> str:
    """Return the numbers of a claim with their names."""
    return "; ".join(f"{name} {_number(value)}" for name, value in metrics.items() if name != "verdict")


def _number(value: object) -> str:
    return bounded(value, short(value)) if isinstance(value, int | float) else str(value or DASH)


def figure_1(manifest: Manifest, groups: Groups, directory: Path) -> Blocks:
    """Return Figure 1, with the spectral radii of the study's own constant-acceleration operators."""
    data = manifest.get("data", {})
    if "schemes" not in data:
        return []
    points = _points(cases_of(groups, "damping-map"))
    return [PAGE.figure("radius", [radius_panel(data, points)], directory)]


def radius_panel(data: Mapping[str, Any], points: Sequence[tuple[float, float]]) -> ChartPanel:
    """Return the spectral radius over w dt of some schemes, what the paper prints dashed, the code's as circles."""
    omega = np.array(data["omega"])
    lines = []
    for (name, curve), color in zip(data["schemes"].items(), SCHEME_COLORS, strict=True):
        radius = np.array(curve["radius"])
        printed = np.array(curve["printed"])
        lines.append(ChartLine(name, omega, radius, color))
        departs = np.abs(printed - radius) > 1e-6
        if departs.any():
            words = f"{name.split(' (')[0]}: √(1+h), as printed"
            lines.append(ChartLine(words, omega[departs], printed[departs], color, (4.0, 2.0), 0.9))
    x, y = np.array(points).reshape(-1, 2).T
    lines.append(ChartLine("", x, y, style_of("dda").color, width=0, dots=2.6, hollow=True))
    return PAGE.panel("radius", lines, x_range=(omega[0], omega[-1]))


def _points(cases: Sequence[CaseResults]) -> list[tuple[float, float]]:
    points = []
    for case in cases:
        for mode in ("mode1", "contact"):
            frequency = case.number("dda", f"{mode}.frequency")
            radius = case.number("dda", f"{mode}.spectral_radius")
            if frequency is not None and radius is not None and 0.1 <= frequency * case.scene.time.step <= 100:
                points.append((frequency * case.scene.time.step, radius))
    return points


def figure_block(figure: PaperFigure, group: CaseGroup, directory: Path) -> FigureBlock:
    """Draw one of the paper's figures and return its block."""
    panels = [_panel(figure, case, len(group.cases)) for case in group.cases]
    label = "Relative error of displacement [%]" if figure.relative else COLUMNS[figure.quantity][2]
    remarks = ""
    if any(panel.marks for panel in panels):
        remarks += PAGE.text("settled")
    pairs = zip(group.cases, panels, strict=True)
    if any("continuum" in case.histories and not _has_line(panel, "continuum") for case, panel in pairs):
        remarks += PAGE.text("coarse", steps=COARSE)
    panels = [replace(panel, y_label=label, y_range=_range(panels)) for panel in panels]
    return PAGE.figure("step", panels, directory, number=figure.number, caption=figure.caption, remarks=remarks)


def _has_line(panel: ChartPanel, name: str) -> bool:
    return any(line.name == name for line in panel.lines)


def _range(panels: Sequence[ChartPanel]) -> tuple[float, float]:
    """Return the range of all lines and of rest."""
    values = np.zeros(1)
    for panel in panels:
        values = np.concatenate([values, *(line.y for line in panel.lines)])
    values = values[np.isfinite(values)]
    pad = 0.06 * float(np.ptp(values)) or 1.0
    return float(values.min()) - pad, float(values.max()) + pad


def _panel(figure: PaperFigure, case: CaseResults, count: int) -> ChartPanel:
    """Return one case of the `count` that a figure has side by side."""
    column, factor, _ = COLUMNS[figure.quantity]
    static = case.number("dda", f"{figure.quantity}.static") or 0.0
    w = case.number("bar", "mode1.frequency")
    is_coarse = w is not None and 2 * np.pi / w < COARSE * case.scene.time.step
    lines = []
    for solver in SOLVERS:
        if solver not in case.histories or (solver == "continuum" and is_coarse):
            continue
        values = case.histories[solver].columns[column][: figure.last]
        scaled = 100 * (values / static - 1) if figure.relative and static else factor * values
        lines.append(ChartLine(solver, np.arange(1.0, values.size + 1), scaled))
    level = 0.0 if figure.relative else factor * static
    settled = None if figure.relative else case.number("dda", f"{figure.quantity}.settling_step")
    marks = {} if settled is None else {f"{settled:.0f} steps": settled}
    is_wide = count <= (3 if figure.last < 1000 else 2)
    return PAGE.panel(
        "step",
        lines,
        title=case.label,
        x_range=(0.0, float(figure.last)),
        marks=marks,
        levels={"": level},
        x_ticks=4 if is_wide else 2,
    )
