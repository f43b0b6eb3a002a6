"""The chapter of the study `columns`: stacks over time, solves of the open-close iteration, spalls, joints, slips."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.data import (
    CaseResults,
    DerivedRows,
    Groups,
    cases_of,
    derived_rows,
    groups_by_name,
    verdicts_of,
)
from validation.report.chapters.described import CaseValue, Description
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, cell
from validation.report.figures.charts import DOTS, ChartLine
from validation.report.figures.histories import saved
from validation.report.figures.space_time import SpaceTime, space_time_figure
from validation.runs.history import History
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.scenes.scene import Scene
from validation.solvers.columns.names import column_of
from validation.studies.columns import formulas as study
from validation.theory import columns

DDA = "dda"
DELTA_COLORS = {0.5: "#0072b2", 0.55: "#56b4e9", 0.6: "#009e73", 0.75: "#e69f00", 1.0: "#d55e00"}
PIECE_COLORS = {1: "#d55e00", 4: "#e69f00", 16: "#009e73", 64: "#0072b2"}  # by blocks in a piece
PAGE = Description(__file__)
REST = ("columns-solves-rest", "comes to rest")
DROPPED = (("columns-drop-average", study.EVENTS, "exact in time"), ("columns-drop-constant", DDA, "dda, (1/2, 1)"))
OTHERS = (
    ("columns-spall", study.BARS, "a pulse on elastic bars"),
    ("columns-weight", study.EVENTS, "weight put on at once"),
)
SHAKEN = ("columns-solves-shaken", "shaken on")


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter."""
    groups = groups_by_name(results, manifest)
    rows = derived_rows(manifest)
    blocks = opening(manifest, verdicts_of(groups.values()), PAGE.text("lead"))
    blocks += over_time(groups, directory, "columns-drop.svg", DROPPED, "dropped")
    if groups.get("columns-solves-rest"):
        blocks += [Heading("What the open-close iteration takes", 2), Paragraph(PAGE.text("solves"))]
        blocks += [solves_figure(groups, directory), solves_table(groups)]
    if groups.get(study.SPALL_BLOCKS):
        blocks += [Heading("Pieces of a spall", 2), Paragraph(PAGE.text("spall"))]
        blocks.append(spall_figure(groups, rows, directory))
        blocks += over_time(groups, directory, "columns-time.svg", OTHERS, "over_time", 36.0)
    blocks += [Heading("Joints that slip, and stacks that rest", 2), Paragraph(PAGE.text("slip"))]
    tables = (joint_table(rows), slip_table(groups, rows), rest_table(groups, rows))
    return [*blocks, *(table for table in tables if table.rows)]


# ---- stacks over time -----------------------------------------------------------------------------------------------


def over_time(
    groups: Groups,
    directory: Path,
    file: str,
    drawn_cases: Sequence[tuple[str, str, str]],
    text: str,
    height: float = 46.0,
) -> Blocks:
    """Return the picture of columns over time, of the finest case of a solver that is exact, else of the coarsest."""
    drawn = []
    for name, solver, title in drawn_cases:
        stepped = sorted(cases_of(groups, name), key=lambda case: case.scene.time.step)
        case = next(iter(stepped[-1:] if solver == DDA else stepped[:1]), None)
        history = None if case is None else case.histories.get(solver)
        if case is not None and history is not None:
            drawn.append(space_time(case.scene, history, title))
    return [saved(space_time_figure(drawn, height), directory, file, PAGE.text(text))] if drawn else []


def space_time(scene: Scene, history: History, title: str) -> SpaceTime:
    """Return the blocks of a column whose middles are observed first, and all of whose contacts follow."""
    column = column_of(scene)
    faces = np.array(column.faces)
    blocks = len(faces) - 1
    start = -np.cumsum([contact.gap for contact in column.contacts])  # drawn with open gaps: the lowest one is largest
    moved = np.array([history.columns[f"displacement_{number + 1}"] for number in range(blocks)])
    forces = [history.columns[f"force_{blocks + number + 1}"] for number in range(len(column.contacts))]
    forces.append(np.zeros_like(history.time))
    carried = np.array([(below + above) / 2 for below, above in itertools.pairwise(forces)])
    return SpaceTime(title, history.time, faces, moved - start[:, None], carried)


# ---- solves ---------------------------------------------------------------------------------------------------------


def by_delta(groups: Groups, name: str) -> Mapping[float, list[CaseResults]]:
    """Return the cases of a scene by delta, each list by step."""
    stacks: dict[float, list[CaseResults]] = {}
    for case in sorted(cases_of(groups, name), key=lambda one: one.scene.time.step):
        stacks.setdefault(case.scene.time.delta, []).append(case)
    return dict(sorted(stacks.items()))


def solves_figure(groups: Groups, directory: Path) -> FigureBlock:
    """Return the mean solves over step and delta."""
    panels = []
    for name, words in (REST, SHAKEN):
        lines = []
        for delta, stacks in by_delta(groups, name).items():
            points = [(study.STIFF * case.scene.time.step, case.number(DDA, "contact.mean_solves")) for case in stacks]
            steps, means = np.array([(x, y) for x, y in points if y is not None]).reshape(-1, 2).T
            lines.append(ChartLine(f"δ = {delta:g}", steps, means, DELTA_COLORS[delta], dots=DOTS))
        panels.append(PAGE.panel("solves", lines, title=words.capitalize()))
    return PAGE.figure("solves", panels, directory)


def solves_table(groups: Groups) -> Table:
    """Return mean and most solves by step and delta."""
    rows = []
    for name, words in (REST, SHAKEN):
        for delta, stacks in by_delta(groups, name).items():
            cells = dict.fromkeys(study.STEPS, DASH)
            for case in stacks:
                mean, most = (case.number(DDA, f"contact.{part}_solves") for part in ("mean", "most"))
                if mean is not None and most is not None:
                    cells[round(study.STIFF * case.scene.time.step, 3)] = f"{mean:.3f} / {most:.0f}"
            rows.append((words, f"{delta:g}", *cells.values()))
    heads = ("Stack", "δ", ("Mean / most solves by ω dt", *(f"{step:g}" for step in study.STEPS)))
    return PAGE.table("solves", rows, heads)


# ---- spalls ---------------------------------------------------------------------------------------------------------


def velocities(metrics: Mapping[str, Any]) -> list[float]:
    """Return the velocities of the pieces, from the base upwards."""
    return [metrics[name] for name in sorted(metrics) if name.startswith("piece ")]


def spall_figure(groups: Groups, rows: DerivedRows, directory: Path) -> FigureBlock:
    """Return the final velocities of the pieces by blocks in each of them, under two schemes."""
    panels = []
    for delta, title in ((0.5, "(1/4, 1/2)"), (1.0, "(1/2, 1)")):
        lines = list(_pieces(groups, rows, delta))
        panels.append(PAGE.panel("spall", lines, title=title))
    return PAGE.figure("spall", panels, directory)


def _pieces(groups: Groups, rows: DerivedRows, delta: float) -> Iterator[ChartLine]:
    bars = velocities(rows.get((study.SPALL_BARS, f"{study.BARS} {study.PIECES}"), {}))
    if bars:
        yield ChartLine("bars", np.arange(1.0, len(bars) + 1), np.array(bars), "black", width=1.6)
    for case in cases_of(groups, study.SPALL_BLOCKS):
        speeds = velocities(rows.get((case.name, f"{DDA} {study.PIECES}"), {}))
        blocks = column_of(case.scene).layer[0].blocks
        if case.scene.time.delta == delta and speeds:
            each = blocks // len(speeds)
            numbers = np.arange(1.0, len(speeds) + 1)
            name = f"{each} block{'s' * (each > 1)} a piece"
            yield ChartLine(name, numbers, np.array(speeds), PIECE_COLORS[each], dots=DOTS)


# ---- joints, slips and rest -----------------------------------------------------------------------------------------


def joint_table(rows: DerivedRows) -> Table:
    """Return what a rigid joint of fixed strength makes of a sine: closed form, bars, blocks."""
    lines = []
    for strength, exact in study.exact_parts().items():
        of_solvers = [
            rows.get((f"{study.JOINT}-{strength:g}", f"{name} {study.PARTS}"), {}) for name in (study.BARS, DDA)
        ]
        numbers: list[str] = []
        for part, value in zip(("transmitted", "reflected", "absorbed"), exact, strict=True):
            numbers += [f"{value:.4f}", *(cell(metrics.get(part, DASH)) for metrics in of_solvers)]
        lines.append((f"{strength:g}", *numbers))
    return PAGE.table("joint", lines if rows else [])


def scheme(case: CaseResults) -> str:
    """Return the weights of a case's scheme."""
    return "(1/2, 1)" if case.scene.time.delta == 1 else "(1/4, 1/2)"


def slip_table(groups: Groups, rows: DerivedRows) -> Table:
    """Return the slips that remain, by scheme, discount and step."""
    slips = rows.get(("columns-slips", study.SAMPLES), {})
    exact = [cell(slips.get(f"slip_{number} at 0.4 s"), 1e3) for number in (3, 7)]
    lines = [["exact in time", DASH, DASH, *exact]]
    for case in cases_of(groups, study.SLIPS):
        metrics = rows.get((case.name, study.SAMPLES), {})
        own = {"scheme": scheme, "lowest": metrics.get("lowest"), "highest": metrics.get("highest")}
        lines.append(PAGE.cells("slips", case, own))
    return PAGE.table("slips", lines if len(lines) > 1 else [])


def rest_table(groups: Groups, rows: DerivedRows) -> Table:
    """Return the time in which a stack comes to rest: closed form and as stepped."""
    own: dict[str, CaseValue] = {
        "scheme": scheme,
        "predicted": settling_time,
        "measured": lambda case: rows.get((case.name, study.REST), {}).get("time"),
    }
    return PAGE.table("rests", [PAGE.cells("rests", case, own) for case in cases_of(groups, study.SETTLE)])


def settling_time(case: CaseResults) -> float:
    """Return the time in which a stack comes to rest, in closed form [s]."""
    column = column_of(case.scene)
    layer = column.layer[0]
    mass = layer.density * layer.thickness / layer.blocks
    omega = columns.lowest_frequency(column.contacts[0].stiffness, mass, layer.blocks)
    time = case.scene.time
    return columns.settling_time(omega, time.step, time.delta, time.discount)
