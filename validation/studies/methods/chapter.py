"""The chapter of the study `methods`: which scheme where contact is locked, which where it opens, what never to use."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, Callout, Heading, Paragraph, Table
from validation.report.chapters.data import (
    CaseResults,
    DerivedRows,
    Groups,
    cases_of,
    derived_rows,
    groups_by_name,
    verdicts_of,
)
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, cell, short
from validation.report.figures.charts import ChartLine
from validation.runs.case_name import CaseName
from validation.runs.history import Array
from validation.runs.records import Manifest
from validation.runs.results import Results

PAGE = Description(__file__)
LOOKS: Mapping[str, tuple[str, tuple[float, ...]]] = {  # colour by the kind of method, stroke by its number
    "constant": ("#d55e00", ()),
    "average": ("#0072b2", ()),
    "ch-0.8": ("#009e73", ()),
    "ch-0.5": ("#009e73", (4.0, 1.5)),
    "ch-0": ("#009e73", (1.2, 1.2)),
    "hht-0.1": ("#8c6d1f", ()),
    "bathe-half": ("#cc79a7", ()),
    "tr-bdf2": ("#cc79a7", (4.0, 1.5)),
    "leapfrog": ("#e69f00", ()),
    "kane": ("#000000", (1.2, 1.2)),
}
DAMPING = ("constant", "ch-0", "ch-0.5", "ch-0.8", "hht-0.1", "bathe-half")  # lines of the figure of damping
IMPACTS = ("constant", "ch-0", "ch-0.8", "hht-0.1", "bathe-half")
COST = ("constant", "average", "ch-0.8", "ch-0", "bathe-half", "leapfrog", "kane")
RATIOS = (1.0, 100.0)  # p/E of the tables
PART = "methods-"
FORCE = 2e6  # N, of the base that 1 MPa presses
STOP_NAMES = {
    "displacements": "rigid stop in displacements, (1/2, 1)",
    "impulses": "Moreau and Jean, e = 0, θ = 1/2",
    "impulses-euler": "Moreau and Jean, e = 0, θ = 1",
}


@dataclass(frozen=True)
class MethodResults:
    """What the study holds: scenes, derived rows, closed forms and the labels of the methods."""

    groups: Groups
    derived: DerivedRows
    data: Mapping[str, Any]
    labels: Mapping[str, str]

    def number(self, scene: str, name: str, metric: str) -> float | None:
        """Return a number of a derived row."""
        value = self.derived.get((scene, name), {}).get(metric)
        return float(value) if isinstance(value, int | float) and math.isfinite(value) else None

    def number_at(self, scene: str, name: str, metric: str, step: str) -> float | None:
        """Return a number of the derived row of that case of a scene whose step is written so."""
        for case, row_name in self.derived:
            parts = CaseName.parse(case)
            if row_name == name and parts.scene == scene and parts.values.get("time.step") == step:
                return self.number(case, name, metric)
        return None

    def case(self, scene: str, ratio: float) -> CaseResults | None:
        """Return the case of p/E at a step of 1 ms."""
        for case in cases_of(self.groups, scene):
            own_ratio = case.scene.contact.stiffness / case.scene.block.young
            if math.isclose(own_ratio, ratio) and math.isclose(case.scene.time.step, 1e-3):
                return case
        return None


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: three answers, then locked contact, contact that opens, cost, and other scenes."""
    groups = groups_by_name(results, manifest)
    data = manifest.get("data") or {}
    methods = MethodResults(groups, derived_rows(manifest), data, data.get("labels", {}))
    blocks = [*opening(manifest, verdicts_of(groups.values())), *answers(methods)]
    if data.get("methods"):
        blocks += locked_blocks(methods, directory)
        blocks += opening_blocks(methods, directory)
    return [*blocks, *cost_blocks(methods, directory), *other_blocks(methods)]


def answers(methods: MethodResults) -> Blocks:
    """Return the three answers, with the numbers that they rest on."""
    cost = methods.derived.get(("methods-cost", "displacement error"), {})
    ratios = [float(value) for name, value in cost.items() if name != "average" and isinstance(value, float)]
    slow = methods.number("methods-cost", "order", "constant over ch-0")
    rebounds = {}
    for word, name in (("ch08", "ch-0.8"), ("hht", "hht-0.1"), ("bathe", "bathe-half"), ("ch0", "ch-0")):
        rebounds[word] = methods.number(f"{PART}impact-{name}", "rebound on a rigid contact", "most")
    locked = PAGE.text("locked")
    if ratios:
        locked += PAGE.text("locked-cost", least=short(min(ratios), 3), most=short(max(ratios), 3))
    opens = PAGE.text("opens")
    if slow is not None:
        opens += PAGE.text("opens-cost", slow=slow)
    never = PAGE.text("never")
    if None not in rebounds.values():
        never += PAGE.text("never-rebounds", **rebounds)
    never += PAGE.text("never-stops")
    return [Callout(locked, "rule"), Callout(opens, "rule"), Callout(never, "fail")]


def locked_blocks(methods: MethodResults, directory: Path) -> Blocks:
    """Return damping over w dt as a figure, damping and errors of the locked block as a table."""
    omega = np.array(methods.data["omega"]["damping"])
    lines = []
    for name in DAMPING:
        damping = _values(methods.data["methods"][name]["damping"])
        lines.append(ChartLine(methods.labels[name], omega, 100 * damping, *LOOKS[name]))
    panel = PAGE.panel("damping", lines, x_range=(float(omega[0]), float(omega[-1])))
    return [Heading("Locked contact", 2), PAGE.figure("damping", [panel], directory), locked_table(methods)]


def _values(values: list[float | None]) -> Array:
    return np.array([math.nan if value is None else value for value in values])


def locked_table(methods: MethodResults) -> Table:
    """Return damping ratios of both modes and errors of the locked block at 1 ms, by method."""
    own = {
        "first": lambda case: _damping(case, "mode1.damping"),
        "contact": lambda case: _damping(case, "contact.damping"),
        "error": lambda case: methods.number(case.name, "displacement error", "largest"),
    }
    rows = []
    for name, label in methods.labels.items():
        scene = f"{PART}locked-{name}"
        if scene in methods.groups:
            rows.append([label])
            for ratio in RATIOS:
                rows[-1] += PAGE.cells("locked", methods.case(scene, ratio), own)
    titles = [column.title for column in PAGE.columns("locked")]
    return PAGE.table("locked", rows, ("Method", ("p = 1E", *titles), ("p = 100E", *titles)))


def _damping(case: CaseResults, metric: str) -> float | None:
    """Return a damping ratio; what is rounding is none."""
    value = case.number("dda", metric)
    return 0.0 if value is not None and abs(value) < 1e-11 else value


def _signed(value: float | None, factor: float = 1.0) -> str:
    """Return a number with its sign; what is rounding is none."""
    if value is None:
        return DASH
    if abs(value) < 1e-9:
        return "0"
    number_format = "+.0f" if abs(factor * value) >= 1000 else "+.3g"  # without a power of ten
    return f"{factor * value:{number_format}}".replace("-", "−")


def opening_blocks(methods: MethodResults, directory: Path) -> Blocks:
    """Return the restitution map as a figure, and what the methods make of the block that opens as a table."""
    omega = np.array(methods.data["omega"]["impact"])
    panels = []
    for name in IMPACTS:
        curves = methods.data["methods"].get(name, {})
        if "mean" in curves:
            mean, least, most = (_values(curves[part]) for part in ("mean", "least", "most"))
            line = ChartLine("", omega, mean, LOOKS[name][0], shaded=(least, most))
            x_range = (float(omega[0]), float(omega[-1]))
            panels.append(PAGE.panel("restitution", (line,), title=methods.labels[name], x_range=x_range))
    return [
        Heading("Contact that opens", 2),
        PAGE.figure("restitution", panels, directory),
        opening_table(methods),
        Paragraph(PAGE.text("opening")),
    ]


def opening_table(methods: MethodResults) -> Table:
    """Return peak pressure and energy of the block that opens, and the rebound of a rigid contact, by method."""
    rows = []
    for name, label in methods.labels.items():
        scene = f"{PART}unlocked-{name}"
        if scene not in methods.groups:
            continue
        row = [label]
        for ratio in RATIOS:
            case = methods.case(scene, ratio)
            force = None if case is None else case.number("dda", "contact.peak_force")
            energy = None if case is None else methods.number(case.name, "energy at the end", "share")
            row += [cell(force, 1 / FORCE), _signed(energy)]
        rebound = {}
        for column in PAGE.columns("opening")[len(row) :]:
            rebound[column] = methods.number(f"{PART}impact-{name}", "rebound on a rigid contact", column.of)
        rows.append([*row, *(column.text(value) for column, value in rebound.items())])
    return PAGE.table("opening", rows)


def cost_blocks(methods: MethodResults, directory: Path) -> Blocks:
    """Return error over solves and over run time as a figure, and solves to 1 % as a table."""
    by_solves = []
    by_seconds = []
    rows = []
    for name, label in methods.labels.items():
        scene = f"{PART}refined-{name}"
        row = methods.derived.get((scene, "order"), {})
        if scene not in methods.groups or not row:
            continue
        rows.append((label, *_row_cells("cost", row)))
        if name in COST:
            solves, seconds, errors = _cost_of(methods.groups[scene].cases, row)
            by_solves.append(ChartLine(label, solves, errors, *LOOKS[name], dots=2.2))
            by_seconds.append(ChartLine(label, seconds, errors, *LOOKS[name], dots=2.2))
    if not by_solves:
        return []
    panels = [PAGE.panel("solves", by_solves), PAGE.panel("seconds", by_seconds)]
    return [Heading("Error and cost", 2), PAGE.figure("cost", panels, directory), PAGE.table("cost", rows)]


def _row_cells(table: str, row: Mapping[str, Any]) -> list[str]:
    """Return the cells of a derived row, behind the name of what it is of; a dash where there is no number."""
    numbers = {name: value for name, value in row.items() if not isinstance(value, str)}
    return [column.text(numbers.get(column.of)) for column in PAGE.columns(table)[1:]]


def _cost_of(cases: tuple[CaseResults, ...], row: Mapping[str, Any]) -> tuple[Array, Array, Array]:
    """Return solves, stepping time [s] and error of the runs of a method."""
    points = []
    for case in cases:
        run = case.rows.get("dda")
        error = row.get(f"error of {case.scene.time.steps} steps")
        if run is not None and isinstance(error, float):
            stages = 2 if case.scene.time.scheme == "composite" else 1
            points.append((case.scene.time.steps * stages, run.seconds.get("stepping", math.nan), error))
    solves, seconds, errors = np.array(points, float).reshape(-1, 3).T
    return solves, seconds, errors


def other_blocks(methods: MethodResults) -> Blocks:
    """Return rigid stops, columns and sliding as tables."""
    stops = []
    for stop, name in STOP_NAMES.items():
        row = methods.derived.get((f"{PART}rigid-{stop}", "approach"), {})
        if row:
            stops.append((name, *_row_cells("stops", row)))
    others = []
    for name, label in methods.labels.items():
        scene = f"{PART}column-{name}"
        errors = [methods.number_at(scene, "column error", "l2", step) for step in ("0.001", "0.0002")]
        slid = methods.number_at(f"{PART}sliding-{name}", "distance", "error", "0.01")
        if any(value is not None for value in (*errors, slid)):
            others.append((label, *(cell(value, 100.0, 3) for value in errors), _signed(slid, 100.0)))
    tables = [PAGE.table(name, rows) for name, rows in (("stops", stops), ("others", others)) if rows]
    return [Heading("Rigid stops, columns, sliding", 2), *tables]
