"""The chapter of the study `paper`: claims, figures 1 and 3 to 9."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Block, FigureBlock, Heading, Paragraph, Table, columns
from validation.report.chapters.data import CaseGroup, CaseResults, groups_by_name
from validation.report.chapters.text import DASH, bounded, short
from validation.report.figures import histories
from validation.report.figures.paper import StepPanel, radius_figure, steps_figure
from validation.runs.history import Array
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


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper over time steps: its scene, quantity, scale and window."""

    number: int
    scene: str
    quantity: str  # displacement or pressure
    last: int  # steps shown
    caption: str
    relative: bool = False  # value / static - 1 instead of the value


FIGURES = (
    PaperFigure(3, "figures-3-4", "displacement", 100, "Displacement of the centroid at p = 1E for three time steps"),
    PaperFigure(4, "figures-3-4", "pressure", 100, "Contact pressure at p = 1E for three time steps"),
    PaperFigure(
        5, "figures-5-6", "displacement", 100, "Displacement of the centroid at dt = 0.002 s, three stiffnesses"
    ),
    PaperFigure(6, "figures-5-6", "pressure", 100, "Contact pressure at dt = 0.002 s for three stiffnesses"),
    PaperFigure(7, "figure-7", "displacement", 20000, "Displacement of the centroid at dt = 0.00001 s"),
    PaperFigure(8, "figure-8", "displacement", 200, "Relative error of the displacement, dt = 0.001 s, p = 1E", True),
    PaperFigure(9, "figure-9", "displacement", 200, "Displacement for four discounts, dt = 0.001 s, p = 1E"),
)
COLUMNS = {
    "displacement": ("displacement", 1e3, "Displacement [mm]"),
    "pressure": ("contact_pressure", 1e-6, "Contact pressure [MPa]"),
}


def paper_chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter: conclusion, register of claims, figures."""
    groups = groups_by_name(results, manifest)
    rows = {row["name"]: row["metrics"] for row in manifest.get("derived", []) if row["scene"] == CLAIMS}
    claims = manifest.get("data", {}).get("claims", [])
    blocks: list[Block] = [Heading(manifest.get("title") or manifest["study"]), Paragraph(conclusion(rows), "lead")]
    for title, letter in (("Statements", "C"), ("Slips of the equations", "S")):
        blocks += [Heading(title, 2), claims_table([c for c in claims if c["id"].startswith(letter)], rows)]
    blocks += [Heading("The figures", 2), *figure_1(manifest, groups, directory)]
    for figure in FIGURES:
        if figure.scene in groups:
            blocks.append(figure_block(figure, groups[figure.scene], directory))
    return blocks


def conclusion(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """Return one sentence on the register."""
    count = Counter(WORDS.get(int(metrics.get("verdict", -1)), "not tested") for metrics in rows.values())
    parts = [f"{count[word]} {verbs[count[word] > 1]}" for word, verbs in VERBS.items() if count[word]]
    return f"Of {len(rows)} statements and equations of the paper that were tested, {', '.join(parts)}."


def claims_table(claims: Sequence[Mapping[str, str]], rows: Mapping[str, Mapping[str, Any]]) -> Table:
    """Return the register: verdict, statement, reason and measured numbers."""
    lines = []
    for claim in claims:
        metrics = rows.get(claim["id"], {})
        word = WORDS.get(int(metrics.get("verdict", -1)), "not tested")
        condition = f" Condition: {claim['condition']}." if word == WORDS[1] and claim["condition"] else ""
        measured = "; ".join(f"{name} {_number(value)}" for name, value in metrics.items() if name != "verdict")
        statement = f"{claim['says']} ({claim['place']})"
        why = f"{claim['why'][:1].upper()}{claim['why'][1:]}.{condition}"
        lines.append((claim["id"], word, statement, why, measured))
    titles = (*columns("text", "Id", "Verdict"), *columns("fill", "The paper says", "Why", "Measured"))
    return Table(titles, tuple(lines))


def _number(value: object) -> str:
    return bounded(value, short(value)) if isinstance(value, int | float) else str(value or DASH)


def figure_1(manifest: Manifest, groups: Mapping[str, CaseGroup], directory: Path) -> list[Block]:
    """Return Figure 1, with the spectral radii of the study's own constant-acceleration operators."""
    data = manifest.get("data", {})
    if "schemes" not in data:
        return []
    cases = groups["damping-map"].cases if "damping-map" in groups else ()
    caption = (
        "Figure 1. Spectral radius over ω dt. Dashed: √(1+h), which the paper prints for every ω dt; it holds for a "
        "complex pair only. Circles: both modes of the DDA block at every dt and p of the damping map."
    )
    return [histories.saved(radius_figure(data, _points(cases)), directory, "figure-1.svg", caption)]


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
    panels = [_panel(figure, case) for case in group.cases]
    label = "Relative error of displacement [%]" if figure.relative else COLUMNS[figure.quantity][2]
    caption = f"Figure {figure.number}. {figure.caption}. Hairline: static value."
    if any(panel.settled is not None for panel in panels):
        caption += " Dashed: step from which DDA stays within 1 % of static."
    pairs = zip(group.cases, panels, strict=True)
    if any("continuum" in case.histories and "continuum" not in panel.lines for case, panel in pairs):
        caption += f" The continuum is left out where its period has fewer than {COARSE} steps."
    chart = steps_figure(panels, label, figure.last)
    return histories.saved(chart, directory, f"figure-{figure.number}.svg", caption)


def _panel(figure: PaperFigure, case: CaseResults) -> StepPanel:
    column, factor, _ = COLUMNS[figure.quantity]
    static = case.number("dda", f"{figure.quantity}.static") or 0.0
    lines: dict[str, Array] = {}
    for solver in SOLVERS:
        if solver in case.histories:
            values = case.histories[solver].columns[column]
            lines[solver] = 100 * (values / static - 1) if figure.relative and static else factor * values
    w = case.number("bar", "mode1.frequency")
    if w is not None and 2 * np.pi / w < COARSE * case.scene.time.step:
        lines.pop("continuum", None)
    if figure.relative:
        return StepPanel(case.label, lines, level=0.0)
    settled = case.number("dda", f"{figure.quantity}.settling_step")
    return StepPanel(case.label, lines, factor * static, settled)
