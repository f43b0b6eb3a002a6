"""The chapter of the study `work-precision`: error against run time and work, the cheapest answer, the orders."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.report.blocks import Block, Column, Heading, Paragraph, Table, columns
from validation.report.chapters.scene import gate_count, opening
from validation.report.chapters.text import DASH, percent, plain, short
from validation.report.figures import histories
from validation.report.figures.cost import work_figure
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.studies.work.points import Point, cheapest, floor, points

SCHEMES = {"work-constant": "Constant acceleration", "work-average": "Average acceleration, consistent start"}
ASKED = (0.1, 0.01, 0.001)


def chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter."""
    verdicts = results.verdicts(manifest["study"])
    blocks = opening(manifest)
    for prefix, title in SCHEMES.items():
        blocks += scheme_blocks(points(results, manifest, prefix), prefix, title, directory)
    blocks += [Heading("Orders of convergence", 2), Paragraph(f"{gate_count(verdicts).capitalize()}.")]
    return [*blocks, order_table(verdicts)]


def scheme_blocks(found: Sequence[Point], prefix: str, title: str, directory: Path) -> list[Block]:
    """Return the figure and the sentences of one scheme."""
    if not found:
        return [Heading(title, 2), Paragraph("No run completed.")]
    caption = (
        "Error against cost, step and mesh refined together. Left of each pair against the bar under the same scheme, "
        "right against the continuum; relative L2. Grey: what no run beats in both; dotted: the model form of DDA; "
        "hollow: below the reference's own uncertainty."
    )
    return [
        Heading(title, 2),
        Paragraph(cheapest_sentence(found), "lead"),
        Paragraph(floor_sentence(found)),
        histories.saved(work_figure(found), directory, f"{prefix}.svg", caption),
    ]


def cheapest_sentence(found: Sequence[Point]) -> str:
    """Say what is cheapest at 10, 1 and 0.1 % of the continuum, in displacement and contact pressure both."""
    parts = []
    for error in ASKED:
        best = cheapest(found, error)
        block = [p for p in found if p.method != "bar"]
        other = cheapest(block, error)
        named = f"{_name(best)}" if best else "no run gets there"
        if best and best.method == "bar":
            named += f", and of the block's own models {_name(other)}" if other else ", and no model of the block does"
        parts.append(f"at {percent(error)}: {named}")
    return f"Cheapest against the continuum, {'; '.join(parts)}."


def _name(point: Point | None) -> str:
    if point is None:
        return DASH
    mesh = f", {point.scene.fem.per_side} elements a side" if point.method.startswith("fem") else ""
    step, spent = short(1e3 * point.scene.time.step, 3), short(1e3 * point.seconds, 2)
    return f"{point.method} with dt = {step} ms{mesh} (in {spent} ms)"


def _window(found: Sequence[Point]) -> str:
    """Return the time that the runs take [s], over which their errors are measured."""
    return " to ".join(sorted({short(point.scene.time.step * point.scene.time.steps, 3) for point in found}))


def floor_sentence(found: Sequence[Point]) -> str:
    """Say where DDA's model form stops it."""
    levels = [floor(found, name, "continuum") for name in ("displacement", "contact pressure")]
    if None in levels:
        return "DDA was not run."
    v, p = (percent(float(level)) for level in levels if level is not None)
    return (
        f"At the finest step DDA is {v} from the continuum in displacement and {p} in contact pressure (relative L2 "
        f"over {_window(found)}\u00a0s): its model form, which no finer step removes."
    )


def order_table(verdicts: Sequence[VerdictRecord]) -> Table:
    """Return the orders that were fitted: what was refined, and the order of each quantity."""
    found: dict[str, dict[str, str]] = {}
    for v in verdicts:
        kind, _, quantity = v["metric"].partition(".")
        if kind == "order" and isinstance(v["value"], int | float):
            found.setdefault(v["scene"], {})[quantity] = plain(float(v["value"]), 4)
    rows = [(name, own.get("displacement", DASH), own.get("pressure", DASH)) for name, own in found.items()]
    titles = (Column("Refined", "code"), *columns("decimal", "displacement", "pressure", group="Order"))
    note = (
        "Fitted with their sign on four levels or more; for mu = 0.25 from successive changes, with the finest mesh's "
        "grid-convergence index as its uncertainty."
    )
    return Table(titles, tuple(rows), notes=(note,))
