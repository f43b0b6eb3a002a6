"""The chapter of the study `columns`: stacks over time, solves of the open-close iteration, spalls, joints, slips."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, FigureBlock, Heading, Paragraph, Table, table
from validation.report.chapters.data import (
    CaseResults,
    DerivedRows,
    Groups,
    cases_of,
    derived_rows,
    groups_by_name,
    verdicts_of,
)
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, cell
from validation.report.figures.charts import BESIDE, DOTS, ChartLine, ChartPanel, chart_figure
from validation.report.figures.histories import saved
from validation.report.figures.space_time import SpaceTime, space_time_figure
from validation.runs.history import History
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.scenes.scene import Scene
from validation.solvers.columns.names import column_of
from validation.studies.columns import study
from validation.theory import columns

DDA = "dda"
DELTA_COLORS = {0.5: "#0072b2", 0.55: "#56b4e9", 0.6: "#009e73", 0.75: "#e69f00", 1.0: "#d55e00"}
PIECES = (0.7, 6.3)  # of the axis
PIECE_COLORS = {1: "#d55e00", 4: "#e69f00", 16: "#009e73", 64: "#0072b2"}  # by blocks in a piece
LEAD = (
    "No step of such a column needs to be cut: the forces of its contacts are the one solution of a convex problem, "
    "whatever the damping, and N contacts of rigid blocks take at most N + 1 solves."
)
DROP_CAPTION = (
    "A stack dropped on its base, contact by contact. Every band is a block, its colour the mean force of its two "
    "contacts, white a gap. Left: exact in time. Right: (1/2, 1) at dt = 0.08 ms."
)
DROPPED = (("columns-drop-average", study.EVENTS, "exact in time"), ("columns-drop-constant", DDA, "dda, (1/2, 1)"))
OTHERS = (
    ("columns-spall", study.BARS, "a pulse on elastic bars"),
    ("columns-weight", study.EVENTS, "weight put on at once"),
)
TIME_CAPTION = (
    "Left: a pulse on six elastic bars; the uppermost takes nearly all of its momentum along. Right: ten rigid blocks "
    "whose weight is put on at once do not stay together, the top leaves at 53 ms. Both exact."
)
SOLVES_CAPTION = (
    "The step acts without damping, damping through the number of switches alone. Mean solves a step of twenty rigid "
    "blocks over ω dt, ω = 2 √(k/m). Left: a stack that comes to rest, in 0.316 s, all schemes at α = 1/2 and so with "
    "one matrix. Right: on a base that never stops shaking."
)
SPALL_CAPTION = (
    "One strain a block tears off other pieces than a bar. Final velocity of six pieces of a column under a pulse on "
    "its top, elastic bars (black) and blocks with 1, 4, 16 and 64 of them in a piece."
)
SOLVES_TEXT = (
    "What a step takes is decided by the free gaps and a matrix without δ; gg changes the gaps alone. With no damping "
    "the mean rises from 1.2 to 3 solves as ω dt goes from 0.1 to 10. At one step damping lowers it, since fewer "
    "contacts switch. Under (1/2, 1) both act against each other in a stack that comes to rest: up to ω dt = 2 the "
    "mean stays at 1.2; where the base shakes on, it rises. A limit of six solves with a step of 0.3 dt after it never "
    "gets through the first impact of six or more rigid blocks that touch."
)
SPALL_TEXT = (
    "Below c dt/h = 1/√(6α) a block of one strain answers a push at its foot with its top moving the wrong way, so "
    "that joints open before the pulse arrives, and its momentum spreads over several pieces. Sub-blocks cure both."
)
SLIP_TEXT = (
    "A stack under pressure comes to rest in the same place under every scheme; step and discount decide when. What "
    "slips remembers its path: step and discount decide where it ends, and even in which direction."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter."""
    groups = groups_by_name(results, manifest)
    rows = derived_rows(manifest)
    blocks = opening(manifest, verdicts_of(groups.values()), LEAD)
    blocks += over_time(groups, directory, "columns-drop.svg", DROPPED, DROP_CAPTION)
    if groups.get("columns-solves-rest"):
        blocks += [Heading("What the open-close iteration takes", 2), Paragraph(SOLVES_TEXT)]
        blocks += [solves_figure(groups, directory), solves_table(groups)]
    if groups.get(study.SPALL_BLOCKS):
        blocks += [Heading("Pieces of a spall", 2), Paragraph(SPALL_TEXT), spall_figure(groups, rows, directory)]
        blocks += over_time(groups, directory, "columns-time.svg", OTHERS, TIME_CAPTION, 36.0)
    tables = (joint_table(rows), slip_table(groups, rows), rest_table(groups, rows))
    blocks += [Heading("Joints that slip, and stacks that rest", 2), Paragraph(SLIP_TEXT)]
    return [*blocks, *(one for one in tables if one.rows)]


# ---- stacks over time -----------------------------------------------------------------------------------------------


def over_time(
    groups: Groups,
    directory: Path,
    file: str,
    drawn_cases: Sequence[tuple[str, str, str]],
    caption: str,
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
    return [saved(space_time_figure(drawn, height), directory, file, caption)] if drawn else []


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
    axes: dict[str, Any] = {"logarithmic": (True, False), "y_range": (1.0, 3.4)}
    axes["x_ticks"] = {0.1: "0.1", 0.5: "0.5", 2.0: "2", 10.0: "10"}
    for name, title in (("columns-solves-rest", "Comes to rest"), ("columns-solves-shaken", "Shaken on")):
        lines = []
        for delta, stacks in by_delta(groups, name).items():
            points = [(study.STIFF * case.scene.time.step, case.number(DDA, "contact.mean_solves")) for case in stacks]
            steps, means = np.array([(x, y) for x, y in points if y is not None]).reshape(-1, 2).T
            lines.append(ChartLine(f"δ = {delta:g}", steps, means, DELTA_COLORS[delta], dots=DOTS))
        panels.append(ChartPanel(title, "ω dt", "mean solves a step", lines, names="upper left", **axes))
    return saved(chart_figure(panels, 40.0, margins=BESIDE), directory, "columns-solves.svg", SOLVES_CAPTION)


def solves_table(groups: Groups) -> Table:
    """Return mean and most solves by step and delta."""
    rows = []
    for name, words in (("columns-solves-rest", "comes to rest"), ("columns-solves-shaken", "shaken on")):
        for delta, stacks in by_delta(groups, name).items():
            cells = dict.fromkeys(study.STEPS, DASH)
            for case in stacks:
                mean, most = (case.number(DDA, f"contact.{part}_solves") for part in ("mean", "most"))
                if mean is not None and most is not None:
                    cells[round(study.STIFF * case.scene.time.step, 3)] = f"{mean:.3f} / {most:.0f}"
            rows.append((words, f"{delta:g}", *cells.values()))
    heads = ("Stack", "δ", ("Mean / most solves by ω dt", *(f"{step:g}" for step in study.STEPS)))
    return table(heads, rows, "Twenty rigid blocks at α = 1/2; at most 21 solves are possible.")


# ---- spalls ---------------------------------------------------------------------------------------------------------


def velocities(metrics: Mapping[str, Any]) -> list[float]:
    """Return the velocities of the pieces, from the base upwards."""
    return [metrics[name] for name in sorted(metrics) if name.startswith("piece ")]


def spall_figure(groups: Groups, rows: DerivedRows, directory: Path) -> FigureBlock:
    """Return the final velocities of the pieces by blocks in each of them, under two schemes."""
    panels = []
    for delta, title in ((0.5, "(1/4, 1/2)"), (1.0, "(1/2, 1)")):
        lines = list(_pieces(groups, rows, delta))
        panels.append(
            ChartPanel(title, "piece, from the base", "velocity [m/s]", lines, x_range=PIECES, names="upper left")
        )
    return saved(chart_figure(panels, 32.0, margins=BESIDE), directory, "columns-spall.svg", SPALL_CAPTION)


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
            numbers += [f"{value:.4f}", *(cell(metrics.get(part, DASH), 1.0, 4) for metrics in of_solvers)]
        lines.append((f"{strength:g}", *numbers))
    each = ("exact", "bars", "dda")
    heads = ("Strength", ("T", *each), ("R", *each), ("A", *each))
    caption = (
        "A sine at a rigid joint, by its strength over the stress of the wave: shares by amplitude, A that of slip."
    )
    return table(heads, lines if rows else [], caption)


def scheme_words(scene: Scene) -> Sequence[str]:
    """Return scheme, discount and step of a case."""
    t = scene.time
    scheme = "(1/2, 1)" if t.delta == 1 else "(1/4, 1/2)"
    return scheme, f"{t.discount:g}", f"{1e3 * t.step:g}"


def slip_table(groups: Groups, rows: DerivedRows) -> Table:
    """Return the slips that remain, by scheme, discount and step."""
    slips = rows.get(("columns-slips", study.SAMPLES), {})
    exact = [slips.get(f"slip_{number} at 0.4 s", DASH) for number in (3, 7)]
    lines = [("exact in time", DASH, DASH, *(cell(value, 1e3, 4) for value in exact))]
    for case in cases_of(groups, study.SLIPS):
        metrics = rows.get((case.name, study.SAMPLES), {})
        numbers = (cell(metrics.get(part, DASH), 1e3, 4) for part in ("lowest", "highest"))
        lines.append((*scheme_words(case.scene), *numbers))
    heads = ("α, δ", "gg", "dt [ms]", ("Slip that remains [mm]", "lowest joint", "highest joint"))
    caption = "Six blocks on a half-space under one pulse; joints of tan 30° times the weight above."
    return table(heads, lines if len(lines) > 1 else [], caption)


def rest_table(groups: Groups, rows: DerivedRows) -> Table:
    """Return the time in which a stack comes to rest: closed form and as stepped."""
    lines = []
    for case in cases_of(groups, study.SETTLE):
        t = case.scene.time
        column = column_of(case.scene)
        layer = column.layer[0]
        mass = layer.density * layer.thickness / layer.blocks
        omega = columns.lowest_frequency(column.contacts[0].stiffness, mass, layer.blocks)
        predicted = columns.settling_time(omega, t.step, t.delta, t.discount)
        measured = rows.get((case.name, study.REST), {}).get("time", DASH)
        lines.append((*scheme_words(case.scene), f"{predicted:.3f}", cell(measured, 1.0, 4)))
    heads = ("α, δ", "gg", "dt [ms]", ("Rests after [s]", "closed form", "as stepped"))
    caption = (
        "Ten rigid blocks under their weight, put on at once: until the top is within a thousandth of its settlement."
    )
    return table(heads, lines, caption)
