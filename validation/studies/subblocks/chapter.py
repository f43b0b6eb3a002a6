"""The chapter of sub-blocks: error against run time, locking, glue and rocking."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, Heading, Paragraph, Table
from validation.report.chapters.data import CaseGroup, CaseResults, Groups, groups_by_name
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, short
from validation.report.figures.charts import ChartLine
from validation.runs.records import Manifest
from validation.runs.results import Results

PAGE = Description(__file__)
MOTIONS = {
    "axial": ("displacement.l2", "Displacement under pressure"),
    "rocking": ("horizontal.l2", "Horizontal displacement under a sideways traction"),
}


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: conclusions over all scenes."""
    groups = groups_by_name(results, manifest)
    blocks = [*opening(manifest), Paragraph(PAGE.text("practice"), "lead"), Heading("Error against run time", 2)]
    blocks += _time_figures(groups, directory)
    blocks.append(Paragraph(PAGE.text("locked")))
    blocks += [patterns(groups[name]) for name in ("subblocks-axial", "subblocks-rocking") if name in groups]
    blocks += [Heading("Glue", 2), Paragraph(PAGE.text("glued"))]
    if "subblocks-best-glue" in groups:
        blocks.append(glue(groups["subblocks-best-glue"]))
    blocks += [Heading("Rocking", 2), Paragraph(PAGE.text("turning"))]
    if "rocking" in groups:
        blocks.append(rocking(groups["rocking"]))
    return blocks


def _seconds(case: CaseResults) -> float:
    row = case.rows.get("dda")
    return float(sum(row.seconds.values())) if row else 0.0


def _count(case: CaseResults) -> int:
    return (case.scene.block.subdivide or (1, 1))[1]


def _line(name: str, group: CaseGroup, cases: Iterable[CaseResults], reference: str, metric: str) -> list[ChartLine]:
    """Return one method of refinement as a line: seconds and error, each point with its count; none without points."""
    points = []
    for case in cases:
        seconds = _seconds(case)
        error = group.number_of_pair(case, "dda", reference, metric)
        if seconds > 0 and error:
            points.append((seconds, error, str(_count(case))))
    if not points:
        return []
    x, y, notes = zip(*points, strict=True)
    return [ChartLine(name, np.array(x), np.array(y), dots=3.0, notes=notes)]


def _time_figures(groups: Groups, directory: Path) -> Blocks:
    """Return error against seconds for both motions; a number at a point counts the sub-blocks upwards."""
    blocks: Blocks = []
    for kind, (metric, title) in MOTIONS.items():
        group = groups.get(f"subblocks-{kind}")
        if group is None:
            continue
        lines = []
        for pattern in ("squares", "triangles"):
            of_pattern = [case for case in group.cases if case.scene.block.pattern == pattern]
            lines += _line(pattern, group, of_pattern, "fem", metric)
        column = groups.get("subblocks-column")
        if kind == "axial" and column is not None:
            lines += _line("columns, μ = 0", column, column.cases, "bar", metric)
        if lines:
            blocks.append(PAGE.figure("time", [PAGE.panel("time", lines)], directory, kind=kind, title=title))
    return blocks


def frequency_error(case: CaseResults) -> float | None:
    """Return the error of DDA's first frequency against the elements' [1]."""
    dda, fem = (case.number(solver, "mode1.frequency") for solver in ("dda", "fem"))
    return None if dda is None or not fem else dda / fem - 1


def patterns(group: CaseGroup) -> Table:
    """Return errors and cost for each pattern and count."""
    metric = "horizontal.l2" if group.cases[0].scene.load.traction else "displacement.l2"
    own = {
        "count": _count,
        "frequency error": frequency_error,
        "error": lambda case: group.number_of_pair(case, "dda", "fem", metric),
        "unknowns": lambda case: case.rows["dda"].work.get("unknowns") if "dda" in case.rows else None,
        "seconds": _seconds,
    }
    return PAGE.case_table("patterns", [group], own, title=group.title)


def glue(group: CaseGroup) -> Table:
    """Return the error of the first frequency of squares for each glue, in both motions."""
    (*_, percent) = PAGE.columns("rocking")
    errors: dict[float, dict[bool, str]] = {}
    for case in group.cases:
        errors_by_motion = errors.setdefault(case.scene.block.glue_ratio, {False: DASH, True: DASH})
        errors_by_motion[bool(case.scene.load.traction)] = percent.text(frequency_error(case))
    return PAGE.table("glue", [(short(ratio), *errors[ratio].values()) for ratio in errors])


def rocking(group: CaseGroup) -> Table:
    """Return the rocking frequencies and damping ratios of block and elements for each patch width."""
    own = {
        "width": lambda case: case.scene.fem.patch_width or case.scene.block.base_length,
        "frequency error": frequency_error,
    }
    return PAGE.case_table("rocking", [group], own)
