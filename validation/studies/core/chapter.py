"""The chapter of the study `core`: the paper's scenes, then what mesh, lateral strain and point springs do."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, Heading, Table
from validation.report.chapters.data import CaseResults, Groups, groups_by_name
from validation.report.chapters.described import Description
from validation.report.chapters.ledger import ledger_blocks
from validation.report.chapters.scene import drift_panel, drift_values, opening, scene_section
from validation.report.chapters.text import percent, plain
from validation.report.figures.charts import DOTS, ChartLine, ChartPanel
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

PAGE = Description(__file__)
DRAWN_COLUMNS = {  # scene -> columns that its figure holds
    "figures-3-4": (DISPLACEMENT, PRESSURE),
    "figures-5-6": (DISPLACEMENT, PRESSURE),
    "figure-7": (DISPLACEMENT,),
    "figure-8": (DISPLACEMENT,),
    "figure-9": (DISPLACEMENT,),
    "model-form": (DISPLACEMENT, PRESSURE),
}
UNDER_THE_STEP = ("figures-3-4", "figures-5-6", "model-form")  # where the undamped continuum would hide the rest
IN_WORDS = ("mesh-convergence", "poisson", "poisson-statics", "corner-springs")  # without histories


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: a section for each figure of the paper, then mesh and springs, then the ledger."""
    groups = groups_by_name(results, manifest)
    blocks = opening(manifest)
    for name, group in groups.items():
        if name not in IN_WORDS:
            without = tuple(by_role(Role.TRUTH)) if name in UNDER_THE_STEP else ()
            blocks += scene_section(group, directory, DRAWN_COLUMNS.get(name), without=without)
    return [*blocks, *mesh_blocks(groups, directory), *ledger_blocks(list(groups.values()), "core", directory)]


def mesh_blocks(groups: Groups, directory: Path) -> Blocks:
    """Return what mesh, point springs and lateral strain do to the finite elements beside DDA."""
    charts: list[ChartPanel] = []
    sentences: list[str] = []
    points = mesh_errors(groups)
    if points is not None:
        n, error = points
        slope = float(np.polyfit(np.log(n), np.log(error), 1)[0])
        ranges = {"x_range": (n[0] / 1.3, n[-1] * 1.3), "y_range": (error.min() / 3, 3 * error.max())}
        charts.append(PAGE.panel("mesh", (ChartLine("fem", n, error, dots=DOTS),), **ranges))
        ends = {"first": percent(error[0]), "last": percent(error[-1])}
        sentences.append(PAGE.text("mesh", slope=plain(slope, 3), **ends))
    drift = drift_values(groups["corner-springs"]) if "corner-springs" in groups else []
    if len(drift) > 1:
        chart, sentence = drift_panel(groups["corner-springs"], drift)
        charts.append(chart)
        sentences.append(sentence)
    if not charts:
        return []
    figure = PAGE.figure("mesh", charts, directory, sentences=" ".join(sentences))
    table = lateral_table(groups)
    return [Heading("Mesh, point springs and lateral strain", 2), figure, *([table] if table.rows else [])]


def mesh_errors(groups: Groups) -> tuple[np.ndarray, np.ndarray] | None:
    """Return elements a side and relative L2 error of fem against the bar; None for fewer than two meshes."""
    group = groups.get("mesh-convergence")
    if group is None:
        return None
    points = []
    for case in group.cases:
        error = group.number_of_pair(case, "fem", "bar", "displacement.l2")
        if error is not None:
            points.append((float(case.scene.fem.per_side), error))
    if len(points) < 2:
        return None
    n, errors = np.array(sorted(points)).T
    return n, errors


def lateral_table(groups: Groups) -> Table:
    """Return the displacement at rest of block and elements for a Poisson ratio above 0."""
    lateral = [groups[name] for name in ("poisson-statics",) if name in groups]
    return PAGE.case_table("lateral", lateral, {"apart": apart})


def apart(case: CaseResults) -> float | None:
    """Return how far DDA's displacement at rest is from that of the elements [1]."""
    dda, fem = (case.number(solver, "displacement.static") for solver in ("dda", "fem"))
    return abs(dda / fem - 1) if dda and fem else None
