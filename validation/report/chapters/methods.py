"""The chapter of the study `methods`: which scheme where contact is locked, which where it opens, what never to use."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, Callout, Heading, Paragraph, Table, table
from validation.report.chapters.data import CaseResults, DerivedRows, Groups, derived_rows, groups_by_name, verdicts_of
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, cell, plain, short
from validation.report.figures import histories
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.histories import Margins
from validation.runs.case_name import CaseName
from validation.runs.history import Array
from validation.runs.records import Manifest
from validation.runs.results import Results

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
PART = "methods-"
FORCE = 2e6  # N, of the base that 1 MPa presses


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: three answers, then locked contact, contact that opens, cost, and other scenes."""
    groups = groups_by_name(results, manifest)
    derived = derived_rows(manifest)
    data = manifest.get("data") or {}
    labels = data.get("labels", {})
    blocks = opening(manifest, verdicts_of(groups.values()))
    blocks += answers(derived)
    if data.get("methods"):
        blocks += locked_blocks(data, groups, derived, labels, directory)
        blocks += opening_blocks(data, groups, derived, labels, directory)
    blocks += cost_blocks(groups, derived, labels, directory)
    return blocks + other_blocks(derived, labels)


def number(derived: DerivedRows, scene: str, name: str, metric: str) -> float | None:
    """Return a number of a derived row."""
    value = derived.get((scene, name), {}).get(metric)
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None


def answers(derived: DerivedRows) -> Blocks:
    """Return the three answers, with the numbers that they rest on."""
    cost = derived.get(("methods-cost", "displacement error"), {})
    ratios = [float(value) for name, value in cost.items() if name != "average" and isinstance(value, float)]
    slow = number(derived, "methods-cost", "order", "constant over ch-0")
    rebounds = {
        name: number(derived, f"{PART}impact-{name}", "rebound on a rigid contact", "most")
        for name in ("ch-0.8", "hht-0.1", "bathe-half", "ch-0")
    }
    locked = (
        "Where contact is locked: average acceleration, (1/4, 1/2) from the consistent start, if nothing is to be "
        "damped; generalised-alpha (Chung–Hulbert, ρ∞ 0.5 to 0.8) if the contact mode is to go and the first mode to "
        "stay: it damps with the cube of ω dt where DDA's own (1/2, 1) damps with ω dt. "
    )
    if ratios:
        locked += (
            f"A composite scheme costs two solves a step and has {short(min(ratios), 3)} to {short(max(ratios), 3)} "
            "times the error of average acceleration for the same solves."
        )
    opens = (
        "Where contact opens: up to ω_c dt = 0.3 average acceleration or, with the least work, the leapfrog; with "
        "stiffer contact Chung–Hulbert with ρ∞ = 0, Kane's implicit contact, DDA's own (1/2, 1), or energy-conserving "
        "contact, none of which gains energy. "
    )
    if slow is not None:
        opens += (
            f"Of these CH 0 is of second order: 1 % of the motion takes {slow:.0f} times fewer steps than (1/2, 1)."
        )
    never = "Never: stiff contact that opens under a scheme chosen for its damping of closed contact. "
    if None not in rebounds.values():
        listed = (
            f"{rebounds['ch-0.8']:.2f} (CH 0.8), {rebounds['hht-0.1']:.2f} (HHT −0.1), {rebounds['bathe-half']:.2f}"
        )
        never += (
            f"A rigid block leaves with up to {listed} (Bathe 1/2) times the speed with which it landed, and with at "
            f"most {rebounds['ch-0']:.2f} under CH 0. "
        )
    never += (
        "Nor a rigid stop in displacements (an LCP, or the augmented Lagrangian that leads to it) for impacts, which "
        "no step lets converge, nor the leapfrog beyond its limit, whose history stays finite."
    )
    return [Callout(locked, "rule"), Callout(opens, "rule"), Callout(never, "fail")]


# ---- locked contact -------------------------------------------------------------------------------------------------


def locked_blocks(
    data: Mapping[str, Any], groups: Groups, derived: DerivedRows, labels: Mapping[str, str], directory: Path
) -> Blocks:
    """Return damping over w dt as a figure, damping and errors of the locked block as a table."""
    omega = np.array(data["omega"]["damping"])
    lines = []
    for name in DAMPING:
        color, dash = LOOKS[name]
        lines.append(ChartLine(labels[name], omega, 100 * _values(data["methods"][name]["damping"]), color, dash))
    panel = ChartPanel(
        "",
        r"$\omega\,dt$",
        "Damping ratio [%]",
        lines,
        (float(omega[0]), float(omega[-1])),
        (1e-4, 150.0),
        (True, True),
        {"1": 1.0},
    )
    caption = (
        "Damping ratio of a mode over ω dt, in closed form; a line ends where its roots are real. Second-order schemes "
        "damp low modes with (ω dt)³, (1/2, 1) with ω dt / 4; (1/4, 1/2) and the leapfrog damp nothing."
    )
    figure = chart_figure([panel], 52.0, Margins(12.0, 26.0, 4.0, 9.5))
    return [
        Heading("Locked contact", 2),
        histories.saved(figure, directory, "methods-damping.svg", caption),
        locked_table(groups, derived, labels),
    ]


def _values(values: list[float | None]) -> Array:
    return np.array([math.nan if value is None else value for value in values])


def locked_table(groups: Groups, derived: DerivedRows, labels: Mapping[str, str]) -> Table:
    """Return damping ratios of both modes and errors of the locked block at 1 ms, by method."""
    rows = []
    for name, label in labels.items():
        group = groups.get(f"{PART}locked-{name}")
        if group is None:
            continue
        cells = []
        for stiffness in (1.0, 100.0):
            case = _case(group.cases, stiffness, 1e-3)
            for metric in ("mode1.damping", "contact.damping"):
                value = None if case is None else case.number("dda", metric)
                cells.append(_percent(value))
            error = None if case is None else number(derived, case.name, "displacement error", "largest")
            cells.append(cell(error, digits=3))
        rows.append((label, *cells))
    titles = ("first ξ [%]", "contact ξ [%]", "error")
    caption = (
        "Locked block, dt = 1 ms, dda: damping ratios of both modes, and the largest displacement error of 0.2 s from "
        "rest over the largest displacement. Near 0.5 an error means damped to rest, near 1 out of phase."
    )
    return table(("Method", ("p = 1E", *titles), ("p = 100E", *titles)), rows, caption)


def _signed(value: float | None, factor: float = 1.0) -> str:
    """Return a number with its sign; what is rounding is none."""
    if value is None:
        return DASH
    return "0" if abs(value) < 1e-9 else f"{factor * value:+.3g}".replace("-", "−")


def _percent(value: float | None) -> str:
    """Return a damping ratio in per cent; what is rounding is none."""
    if value is None:
        return DASH
    return "0" if abs(value) < 1e-11 else plain(100 * value, 3)


def _case(cases: tuple[CaseResults, ...], stiffness: float, step: float) -> CaseResults | None:
    """Return the case of p/E and a step."""
    for case in cases:
        ratio = case.scene.contact.stiffness / case.scene.block.young
        if math.isclose(ratio, stiffness) and math.isclose(case.scene.time.step, step):
            return case
    return None


# ---- contact that opens ---------------------------------------------------------------------------------------------


def opening_blocks(
    data: Mapping[str, Any], groups: Groups, derived: DerivedRows, labels: Mapping[str, str], directory: Path
) -> Blocks:
    """Return the restitution map as a figure, and what the methods make of the block that opens as a table."""
    omega = np.array(data["omega"]["impact"])
    panels = []
    for name in IMPACTS:
        curves = data["methods"].get(name, {})
        if "mean" not in curves:
            continue
        color = LOOKS[name][0]
        mean, least, most = (_values(curves[part]) for part in ("mean", "least", "most"))
        line = ChartLine("", omega, mean, color, shaded=(least, most))
        panels.append(
            ChartPanel(
                labels[name],
                r"$\omega_c\,dt$",
                "Restitution e",
                (line,),
                (float(omega[0]), float(omega[-1])),
                (0.0, 3.0),
                (True, False),
                levels={"": 1.0},
                x_ticks={1.0: "1", 10.0: "10", 100.0: "100"},
            )
        )
    caption = (
        "Restitution of a rigid block on a penalty spring over ω_c dt: mean (line) and range over where in the step it "
        "lands (shaded), in closed form. Without a time step e = 1. DDA follows the map in every impact that was run."
    )
    figure = chart_figure(panels, 38.0, Margins(11.0, 3.0, 6.0, 10.0, 4.0), shared=True)
    text = (
        "What rebounds is decided by how a step takes the contact force in, not by the roots of a contact that stays "
        "closed: CH 0.8, HHT and Bathe's scheme damp closed contact and gain energy from one that opens. Energy "
        "that is gained makes chaos of the motion: under CH 0.8 at p = 100E and 0.2 ms digit 13 of the load changes "
        "the peak pressure of 0.1 s by percents. With the leapfrog beyond its limit (p = 100E) the block is "
        "thrown and every number stays finite."
    )
    return [
        Heading("Contact that opens", 2),
        histories.saved(figure, directory, "methods-restitution.svg", caption),
        opening_table(groups, derived, labels),
        Paragraph(text),
    ]


def opening_table(groups: Groups, derived: DerivedRows, labels: Mapping[str, str]) -> Table:
    """Return peak pressure and energy of the block that opens, and the rebound of a rigid contact, by method."""
    rows = []
    for name, label in labels.items():
        group = groups.get(f"{PART}unlocked-{name}")
        if group is None:
            continue
        cells = []
        for stiffness in (1.0, 100.0):
            case = _case(group.cases, stiffness, 1e-3)
            force = None if case is None else case.number("dda", "contact.peak_force")
            energy = None if case is None else number(derived, case.name, "energy at the end", "share")
            cells += [cell(force, 1 / FORCE, 4), _signed(energy)]
        impact = f"{PART}impact-{name}"
        for part in ("mean", "least", "most", "mean_square"):
            value = number(derived, impact, "rebound on a rigid contact", part)
            cells.append(DASH if value is None else f"{value + 0.0:.3f}")
        rows.append((label, *cells))
    heads = (
        "Method",
        ("p = 1E", "peak [MPa]", "energy"),
        ("p = 100E", "peak [MPa]", "energy"),
        ("Rebound on a rigid contact", "mean e", "least", "most", "mean e²"),
    )
    caption = (
        "Left: the block unlocked, dt = 1 ms, dda: peak pressure (exact 13.40 and 74.52 MPa) and energy after 0.1 s "
        "over W₀ = 50 kJ (exact 0). Right: a rigid block on a rigid contact, over the phases of its landing; mean e² "
        "above 1 is energy gained on average."
    )
    return table(heads, rows, caption)


# ---- cost -----------------------------------------------------------------------------------------------------------


def cost_blocks(groups: Groups, derived: DerivedRows, labels: Mapping[str, str], directory: Path) -> Blocks:
    """Return error over solves and over run time as a figure, and solves to 1 % as a table."""
    by_solves = []
    by_seconds = []
    rows = []
    for name, label in labels.items():
        group = groups.get(f"{PART}refined-{name}")
        row = derived.get((f"{PART}refined-{name}", "order"), {})
        if group is None or not row:
            continue
        rows.append((label, *_cost_cells(row)))
        if name not in COST:
            continue
        solves, seconds, errors = _cost_of(group.cases, row)
        color, dash = LOOKS[name]
        by_solves.append(ChartLine(label, solves, errors, color, dash, dots=2.2))
        by_seconds.append(ChartLine(label, seconds, errors, color, dash, dots=2.2))
    if not by_solves:
        return []
    common: dict[str, Any] = {"logarithmic": (True, True), "levels": {"1 %": 0.01}}
    panels = [
        ChartPanel("", "Solves", "Relative error of v", by_solves, names="none", **common),
        ChartPanel("", "Run time [s]", "Relative error of v", by_seconds, **common),
    ]
    caption = (
        "The block unlocked at p = 1E over 0.05 s, steps halved: relative L2 error of v against the exact motion over "
        "the steps times the solves of one (force evaluations of the leapfrog), and over the time that dda stepped."
    )
    figure = chart_figure(panels, 48.0, Margins(13.0, 26.0, 4.0, 10.0, 14.0))
    heads = ("Method", "order of the last halving", "solves to 1 %", "error at 3200 steps")
    note = "Solves in powers of two times 100; a dash: more than the finest run."
    return [
        Heading("Error and cost", 2),
        histories.saved(figure, directory, "methods-cost.svg", caption),
        table(heads, rows, note),
    ]


def _cost_cells(row: Mapping[str, Any]) -> tuple[str, str, str]:
    solves = row.get("solves to 1 %")
    count = f"{solves:.0f}" if isinstance(solves, float) else DASH
    return f"{row['last halving']:.2f}", count, cell(row.get("error of 3200 steps"), digits=3)


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


# ---- other scenes ---------------------------------------------------------------------------------------------------

STOP_NAMES = {
    "displacements": "rigid stop in displacements, (1/2, 1)",
    "impulses": "Moreau and Jean, e = 0, θ = 1/2",
    "impulses-euler": "Moreau and Jean, e = 0, θ = 1",
}


def other_blocks(derived: DerivedRows, labels: Mapping[str, str]) -> Blocks:
    """Return rigid stops, columns and sliding as tables."""
    stops = []
    for stop, name in STOP_NAMES.items():
        row = derived.get((f"{PART}rigid-{stop}", "approach"), {})
        if row:
            numbers = (f"{row[part]:.2f}".replace("-", "−") for part in ("order", "order of the peak"))
            stops.append((name, *numbers, cell(row["finest error"], 100.0, 3), cell(row["finest peak"], 1e-6, 4)))
    blocks: Blocks = [Heading("Rigid stops, columns, sliding", 2)]
    if stops:
        heads = ("What turns the block back", "order", "order of the peak", "finest error [%]", "finest peak [MPa]")
        caption = (
            "The block unlocked on a rigid stop, steps of 62.5 to 3.9 µs: order of its distance from the motion of a "
            "plastic impact, and of the peak pressure. The pressure of a rigid stop is an impulse over dt and has no "
            "limit: compare impulses."
        )
        blocks.append(table(heads, stops, caption))
    rows = []
    for name, label in labels.items():
        errors = [
            _of_scene(derived, f"{PART}column-{name}", "column error", "l2", step) for step in ("0.001", "0.0002")
        ]
        slid = _of_scene(derived, f"{PART}sliding-{name}", "distance", "error", "0.01")
        if any(value is not None for value in (*errors, slid)):
            cells = [cell(value, 100.0, 3) for value in errors]
            rows.append((label, *cells, _signed(slid, 100.0)))
    titles = ("Method", ("Five blocks dropped: error of v [%]", "dt = 1 ms", "dt = 0.2 ms"), "Distance slid: error [%]")
    caption = (
        "Left: five rigid blocks dropped on each other, over 0.06 s, against the exact motion. Right: a block that "
        "slides down 28.9° with 15° of friction, after 0.5 s in steps of 10 ms: damping of the normal ringing is "
        "all that matters, and implicit Euler is ahead by dt / T."
    )
    return [*blocks, table(titles, rows, caption)] if rows else blocks


def _of_scene(derived: DerivedRows, scene: str, name: str, metric: str, step: str) -> float | None:
    """Return a number of the derived row of that case of a scene whose step is written so."""
    for case, row_name in derived:
        parts = CaseName.parse(case)
        if row_name == name and parts.scene == scene and parts.values.get("time.step") == step:
            return number(derived, case, name, metric)
    return None
