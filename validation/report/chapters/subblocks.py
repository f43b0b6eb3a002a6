"""The chapter of sub-blocks: error against run time, locking, glue and rocking."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, Heading, Paragraph, Table, table
from validation.report.chapters.data import CaseGroup, CaseResults, Groups, groups_by_name
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, percent, short
from validation.report.figures import histories
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.histories import Margins
from validation.runs.records import Manifest
from validation.runs.results import Results

PRACTICE = (
    "For practice: cut the block into triangles and glue them stiffly (the joints' forces are unknowns of their own, "
    "so stiff glue costs no digits). Squares are right for the axial motion only; more of them do not help."
)
LOCKED = (
    "Affine squares that meet at their corners can only move as u = f(x) + g(y): no square can shear without its "
    "whole row and column. Their error in the rocking motion falls to a limit, not to zero; triangles converge."
)
GLUED = (
    "Glue is a spring in series: the n − 1 joints of a column add (n − 1) w / (2 glue_ratio h) of its compliance, a "
    "floor that more sub-blocks raise. Squares of soft glue give way in rows and squares of stiff glue lock, so that "
    "some glue shares the error between both motions, and none removes it."
)
TURNING = (
    "Two corner springs resist rocking with p a² / 2, a foundation over the whole base with p a² / 6. No width of the "
    "patches brings the finite elements to the block's rocking frequency: whoever needs rocking or sideways answers "
    "must model how the contact spreads its force, since neither time step nor mesh can repair it."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: conclusions over all scenes."""
    groups = groups_by_name(results, manifest)
    return [
        *opening(manifest),
        Paragraph(PRACTICE, "lead"),
        Heading("Error against run time", 2),
        *_time_figures(groups, directory),
        Paragraph(LOCKED),
        *_tables(groups, _patterns, ("subblocks-axial", "subblocks-rocking")),
        Heading("Glue", 2),
        Paragraph(GLUED),
        *_tables(groups, _glue, ("subblocks-best-glue",)),
        Heading("Rocking", 2),
        Paragraph(TURNING),
        *_tables(groups, _rocking, ("rocking",)),
    ]


def _tables(groups: Groups, make: Any, names: tuple[str, ...]) -> Blocks:
    return [make(groups[name]) for name in names if name in groups]


def _seconds(case: CaseResults) -> float:
    row = case.rows.get("dda")
    return float(sum(row.seconds.values())) if row else 0.0


def _count(case: CaseResults) -> int:
    return (case.scene.block.subdivide or (1, 1))[1]


def _line(name: str, group: CaseGroup, cases: list[CaseResults], reference: str, metric: str) -> ChartLine | None:
    """Return one method of refinement as a line: seconds and error, each point with its count."""
    points = []
    for case in cases:
        seconds = _seconds(case)
        error = group.number_of_pair(case, "dda", reference, metric)
        if seconds > 0 and error:
            points.append((seconds, error, str(_count(case))))
    if not points:
        return None
    x, y, notes = zip(*points, strict=True)
    return ChartLine(name, np.array(x), np.array(y), dots=3.0, notes=notes)


def _time_figures(groups: Groups, directory: Path) -> Blocks:
    """Return error against seconds for both motions; a number at a point counts the sub-blocks upwards."""
    blocks: Blocks = []
    motions = {
        "axial": ("displacement.l2", "Displacement under pressure"),
        "rocking": ("horizontal.l2", "Horizontal displacement under a sideways traction"),
    }
    for kind, (metric, title) in motions.items():
        group = groups.get(f"subblocks-{kind}")
        if group is None:
            continue
        lines = [_line(name, group, _of_pattern(group.cases, name), "fem", metric) for name in ("squares", "triangles")]
        column = groups.get("subblocks-column")
        if kind == "axial" and column is not None:
            lines.append(_line("columns, μ = 0", column, list(column.cases), "bar", metric))
        lines_with_points = [line for line in lines if line is not None]
        if lines_with_points:
            caption = f"{title}: error against run time. A number at a point counts the sub-blocks along a side."
            panel = ChartPanel(
                "", "Seconds of the run", "Relative L2 error", lines_with_points, logarithmic=(True, True)
            )
            figure = chart_figure([panel], 46.0, Margins(16.0, 34.0, 3.0, 9.5))
            blocks.append(histories.saved(figure, directory, f"subblocks-time-{kind}.svg", caption))
    return blocks


def _of_pattern(cases: Iterable[CaseResults], pattern: str) -> list[CaseResults]:
    return [case for case in cases if case.scene.block.pattern == pattern]


def _frequency_error(case: CaseResults) -> float | None:
    """Return the error of DDA's first frequency against the elements' [1]."""
    dda, fem = (case.number(solver, "mode1.frequency") for solver in ("dda", "fem"))
    return None if dda is None or not fem else dda / fem - 1


def _percent(value: float | None) -> str:
    if value is None:
        return DASH
    return f"−{percent(-value)}" if value < 0 else percent(value)


def _patterns(group: CaseGroup) -> Table:
    """Return errors and cost for each pattern and count."""
    metric = "horizontal.l2" if group.cases[0].scene.load.traction else "displacement.l2"
    rows = []
    for case in group.cases:
        work = case.rows["dda"].work if "dda" in case.rows else {}
        errors = (_percent(_frequency_error(case)), _percent(group.number_of_pair(case, "dda", "fem", metric)))
        cost = (str(work.get("unknowns", DASH)), short(1e3 * _seconds(case), 3))
        rows.append((case.scene.block.pattern, str(_count(case)), *errors, *cost))
    return table(
        ("Pattern", "n", "Error of ω₁", "L2 error", "Unknowns", "ms"),
        rows,
        f"{group.title}, against quadratic elements",
    )


def _glue(group: CaseGroup) -> Table:
    """Return the error of the first frequency of squares for each glue, in both motions."""
    errors: dict[float, dict[bool, str]] = {}
    for case in group.cases:
        errors_by_motion = errors.setdefault(case.scene.block.glue_ratio, {False: DASH, True: DASH})
        errors_by_motion[bool(case.scene.load.traction)] = _percent(_frequency_error(case))
    rows = tuple((short(ratio), *errors_by_motion.values()) for ratio, errors_by_motion in errors.items())
    return table(
        ("glue_ratio", "Axial ω₁", "Rocking ω₁"),
        rows,
        "8 × 8 squares at p = 1E, μ = 0: error of the first frequency by glue",
    )


def _rocking(group: CaseGroup) -> Table:
    """Return the rocking frequencies and damping ratios of block and elements for each patch width."""
    rows = []
    for case in group.cases:
        cells = []
        for metric in ("mode1.frequency", "mode1.damping"):
            values = [case.number(solver, metric) for solver in ("dda", "fem")]
            cells += [DASH if value is None else short(value) for value in values]
        width = case.scene.fem.patch_width or case.scene.block.base_length
        rows.append((short(width), *cells, _percent(_frequency_error(case))))
    return table(
        ("Patch width [m]", ("ω₁ [rad/s]", "dda", "fem"), ("ξ₁ [1]", "dda", "fem"), "Block above elements"),
        rows,
        "First rocking mode on springs of equal total stiffness",
    )
