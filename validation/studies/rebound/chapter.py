"""The chapter of the study `rebound`: the restitution map, and the paper's block over time step and springs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, Heading, Paragraph, Table
from validation.report.chapters.data import CaseGroup, CaseGroups, CaseResults, Verdicts, case_groups, verdicts_of
from validation.report.chapters.described import Description
from validation.report.chapters.scene import gate_count, opening
from validation.report.chapters.text import DASH, capital, short
from validation.report.figures import histories
from validation.report.figures.charts import ChartLine
from validation.report.figures.maps import MapScale, NumberMap, map_figure
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.theory import landing

PAGE = Description(__file__)
EXACT = "block-events"
IMPACT = "rebound-"  # prefix of the scenes of single landings
MAP = "contact-map-"  # prefix of the scenes over step and springs
COLORS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7")
SHADES = MapScale("Greys", 1.6, cell=6.5)
WORDS = {  # the ends of the scenes' names
    "constant": "constant acceleration (1/2, 1)",
    "average": "average acceleration (1/4, 1/2)",
    "implicit": "implicit contact, (1/4, 1/2) in the block",
    "conserving": "energy-conserving contact",
}
TITLES = {  # of the panels
    "constant": "constant acceleration",
    "average": "average acceleration",
    "implicit": "implicit contact",
    "conserving": "energy-conserving contact",
}
BUDGET_STEPS = (1e-3, 2e-4)  # time steps in the table of budgets [s]


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: restitution, then energy, switches and solves."""
    groups = case_groups(results, manifest)
    impacts = [group for group in groups if group.name.startswith(IMPACT)]
    maps = [group for group in groups if group.name.startswith(MAP)]
    blocks = opening(manifest)
    blocks += [Paragraph(conclusion(maps), "lead")] if maps else []
    if (data := manifest.get("data")) and data.get("schemes"):
        blocks += restitution_blocks(data, impacts, directory)
    return blocks + map_blocks(maps, verdicts_of(groups), directory)


# ---- restitution --------------------------------------------------------------------------------------------------


def restitution_blocks(data: dict[str, Any], impacts: CaseGroups, directory: Path) -> Blocks:
    """Return the restitution map as a figure, and what it is on a rigid contact."""
    omega = np.array(data["omega"])
    top = 1.05 * max(max(rows["high"]) for rows in data["schemes"].values())
    panels = []
    for (name, rows), color in zip(data["schemes"].items(), COLORS, strict=False):
        dots: list[tuple[float, float]] = []
        for group in impacts:
            if kind(group) == name:
                dots += [(x, e) for x, e in impact_dots(group) if omega[0] <= x <= omega[-1]]
        x, e = np.array(dots).reshape(-1, 2).T
        mean, low, high = (np.array(rows[part]) for part in ("mean", "low", "high"))
        lines = (
            ChartLine("", omega, mean, color, shaded=(low, high)),
            ChartLine("", x, e, color, width=0, dots=2.4, hollow=True),
        )
        ranges = {"x_range": (omega[0], omega[-1]), "y_range": (0.0, top)}
        panels.append(PAGE.panel("restitution", lines, title=TITLES.get(name, name), **ranges))
    exact = {f"at{ratio:g}": landing.own_landing(2 * ratio).restitution for ratio in (1.0, 10.0, 100.0)}  # of a square
    return [
        Heading("What a landing returns", 2),
        PAGE.figure("restitution", panels, directory),
        Paragraph(PAGE.text("restitution", **exact)),
    ]


def kind(group: CaseGroup) -> str:
    """Return the kind of contact and scheme, the end of the scene's name."""
    return group.name.rpartition("-")[2]


def impact_dots(group: CaseGroup) -> list[tuple[float, float]]:
    """Return Omega and restitution of the impacts that were run."""
    dots = []
    for case in group.cases:
        width, height = np.ptp(np.array(case.scene.block.outline), axis=0)
        mass = case.scene.block.density * float(width) * float(height)
        e = case.number("dda", "contact.restitution")
        if e is not None:
            dots.append((math.sqrt(2 * case.scene.contact.stiffness / mass) * case.scene.time.step, e))
    return dots


# ---- over step and springs ----------------------------------------------------------------------------------------


def ratio(case: CaseResults) -> float:
    """Return p/E."""
    return case.scene.contact.stiffness / case.scene.block.young


def exact_switches(maps: CaseGroups) -> dict[float, float]:
    """Return the switches of the exact block by p/E."""
    switches = {}
    for group in maps:
        for case in group.cases:
            count = case.number(EXACT, "switches.count")
            if count is not None:
                switches[ratio(case)] = count
    return switches


def conclusion(maps: CaseGroups) -> str:
    """Say in one or two sentences what was gained, and how many solves it took."""
    parts = []
    for group in maps:
        rises = group.numbers("dda", "energy.rise")
        solves = group.numbers("dda", "contact.most_solves")
        if rises and solves:
            words = WORDS.get(kind(group), group.title)
            most = max(rises)
            gain = "gains no energy" if most < 1e-9 else f"gains up to {short(most, 3)} times the energy given"
            parts.append(f"{words} {gain} and needs at most {max(solves):.0f} solves a step")
    text = "; ".join(parts)
    return f"{capital(text)}: a step too large for the contact spoils the motion, not the iteration."


def map_blocks(maps: CaseGroups, verdicts: Verdicts, directory: Path) -> Blocks:
    """Return the maps over dt and p, and the budget of energy as a table."""
    if not maps:
        return []
    cases = list(itertools.chain.from_iterable(group.cases for group in maps))
    ratios = sorted({ratio(case) for case in cases})
    steps = sorted({case.scene.time.step for case in cases}, reverse=True)
    exact = exact_switches(maps)
    number_maps = [number_maps_of(group, ratios, steps, exact) for group in maps]
    rows = [f"p = {short(r)}E" for r in ratios]
    figure = map_figure(number_maps, rows, [short(1e3 * step) for step in steps], ("dt [ms]", ""), SHADES)
    schemes = ", ".join(WORDS.get(kind(group), group.title) for group in maps)
    remark = PAGE.text("horizon")
    if verdicts:
        remark += f" {gate_count(verdicts).capitalize()}."
    return [
        Heading("Energy, switches and solves", 2),
        histories.saved(figure, directory, "rebound-maps.svg", PAGE.text("maps", schemes=schemes)),
        budget_table(maps),
        Paragraph(remark),
    ]


def number_maps_of(
    group: CaseGroup, ratios: Sequence[float], steps: Sequence[float], exact: dict[float, float]
) -> list[NumberMap]:
    """Return the three maps of a scheme."""
    case_at = {(ratio(case), case.scene.time.step): case for case in group.cases}
    grid = [[case_at.get((r, step)) for step in steps] for r in ratios]
    solves = [[None if c is None else c.number("dda", "contact.mean_solves") for c in row] for row in grid]
    rises = [[None if c is None else c.number("dda", "energy.rise") for c in row] for row in grid]
    switches = [[_switches_over_exact(c, exact) for c in row] for row in grid]
    return [
        _map("solves a step", solves, lambda v: min(1.0, v - 1.0)),
        _map("energy gained", rises, lambda v: 0.0 if v < 1e-3 else min(1.0, (3 + math.log10(v)) / 6)),
        _map("switches over exact", switches, lambda v: min(1.0, abs(math.log(max(v, 1e-2))) / 4)),
    ]


def _switches_over_exact(case: CaseResults | None, exact: dict[float, float]) -> float | None:
    if case is None:
        return None
    count = case.number("dda", "switches.count")
    exact_count = exact.get(ratio(case))
    return None if count is None or not exact_count else count / exact_count


def _map(title: str, values: list[list[float | None]], shade: Any) -> NumberMap:
    shades = [[math.nan if v is None else shade(v) for v in row] for row in values]
    texts = tuple(tuple(DASH if v is None else _number(v) for v in row) for row in values)
    return NumberMap(title, np.array(shades), texts)


def _number(value: float) -> str:
    """Return a number that fits into a cell."""
    if abs(value) < 1e-9:
        return "0"
    if abs(value) < 1e-3:
        return "<0.001"
    return short(value, 3) if value < 100 else f"{value:.0f}"


def budget_table(maps: CaseGroups) -> Table:
    """Return where the energy went, the peak force and the horizon of every case."""
    rows = []
    for group in maps:
        name = kind(group)
        cases = [case for case in group.cases if case.scene.time.step in BUDGET_STEPS]
        for case in sorted(cases, key=lambda c: (ratio(c), -c.scene.time.step)):
            rows.append((name, *budget_cells(case)))
            name = ""
    return PAGE.table("budget", rows)


def budget_cells(case: CaseResults) -> list[str]:
    """Return stiffness, step, losses, peak force, penetration, share open and horizon of a case."""
    return PAGE.cells("budget", case, {"stiffness": f"{short(ratio(case))}E", "lost": lost_by_scheme})


def lost_by_scheme(case: CaseResults) -> float | None:
    """Return the energy that the scheme itself has damped over the energy given [1]."""
    lost = case.number("dda", "energy.lost_algorithmic")
    given = case.number("dda", "energy.given")
    return lost / given if lost is not None and given else None
