"""The chapter of the study `work-precision`: error against run time and work, the cheapest answer, the orders."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

from validation.report.blocks import Blocks, Heading, Paragraph, Table, TableColumn, table
from validation.report.chapters.data import Verdicts
from validation.report.chapters.scene import gate_count, opening
from validation.report.figures import histories
from validation.runs.numbers import DASH, percent, plain, short
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.work_precision.figure import work_figure
from validation.studies.work_precision.points import METHODS, Point, cheapest, floor, points

SCHEMES = {"work-constant": "Constant acceleration", "work-average": "Average acceleration, consistent start"}
MESHED = {method for (solver, _), method in METHODS.items() if solver == "fem"}
TARGET_ERRORS = (0.1, 0.01, 0.001)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter."""
    verdicts = results.verdicts(manifest["study"])
    blocks = opening(manifest)
    for prefix, title in SCHEMES.items():
        blocks += scheme_blocks(points(results, manifest, prefix), prefix, title, directory)
    blocks += [Heading("Orders of convergence", 2), Paragraph(f"{gate_count(verdicts).capitalize()}.")]
    return [*blocks, order_table(verdicts)]


def scheme_blocks(runs: Sequence[Point], prefix: str, title: str, directory: Path) -> Blocks:
    """Return the figure and the sentences of one scheme."""
    if not runs:
        return [Heading(title, 2), Paragraph("No run completed.")]
    caption = (
        "Error against cost, step and mesh refined together. Left of each pair against the bar under the same scheme, "
        "right against the continuum; relative L2. Grey: what no run beats in both; hairline: the model form of DDA; "
        "hollow: below the reference's own uncertainty."
    )
    return [
        Heading(title, 2),
        Paragraph(cheapest_sentence(runs), "lead"),
        Paragraph(floor_sentence(runs)),
        histories.saved(work_figure(runs), directory, f"{prefix}.svg", caption),
    ]


def cheapest_sentence(runs: Sequence[Point]) -> str:
    """Say what is cheapest at 10, 1 and 0.1 % of the continuum, in displacement and contact pressure both."""
    parts = []
    for error in TARGET_ERRORS:
        best = cheapest(runs, error)
        text = _run_text(best) if best else "no run gets there"
        if best and best.method == "bar":
            of_block = cheapest([run for run in runs if run.method != "bar"], error)
            if of_block:
                text += f", and of the block's own models {_run_text(of_block)}"
            else:
                text += ", and no model of the block does"
        parts.append(f"at {percent(error)}: {text}")
    return f"Cheapest against the continuum, {'; '.join(parts)}."


def _run_text(run: Point) -> str:
    return f"{run.method} with {refinement(run)} (in {short(1e3 * run.seconds, 2)} ms)"


def refinement(run: Point) -> str:
    """Return time step and mesh of a run."""
    mesh = f", {run.scene.fem.per_side} elements a side" if run.method in MESHED else ""
    return f"dt = {short(1e3 * run.scene.time.step, 3)} ms{mesh}"


def floor_sentence(runs: Sequence[Point]) -> str:
    """Say where DDA's model form stops it."""
    v = floor(runs, "displacement", "continuum")
    p = floor(runs, "contact pressure", "continuum")
    if v is None or p is None:
        return "DDA was not run."
    durations = [run.scene.time.duration for run in runs]
    window = " to ".join(dict.fromkeys(short(end, 3) for end in (min(durations), max(durations))))
    return (
        f"At the finest step DDA is {percent(v)} from the continuum in displacement and {percent(p)} in contact "
        f"pressure (relative L2 over {window}\u00a0s): its model form, which no finer step removes."
    )


def order_table(verdicts: Verdicts) -> Table:
    """Return the orders that were fitted: what was refined, and the order of each quantity."""
    orders_by_name: dict[str, dict[str, str]] = {}
    for v, quantity in itertools.product(verdicts, ("displacement", "pressure")):
        if v["metric"] == f"order.{quantity}" and isinstance(v["value"], int | float):
            orders_by_name.setdefault(v["scene"], {})[quantity] = plain(float(v["value"]), 4)
    rows = []
    for name, orders in orders_by_name.items():
        rows.append((name, orders.get("displacement", DASH), orders.get("pressure", DASH)))
    note = (
        "Fitted with their sign on four levels or more; for mu = 0.25 from successive changes, with the finest mesh's "
        "grid-convergence index as its uncertainty."
    )
    return table((TableColumn("Refined", "code"), ("Order", "displacement", "pressure")), rows, notes=(note,))
