"""The chapter of sub-blocks: error against run time, locking, glue and rocking before the pages of the scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Block, Column, FigureBlock, Heading, PageBreak, Paragraph, Table
from validation.report.chapters.data import Case, Group, groups
from validation.report.chapters.scene import scene_chapter
from validation.report.chapters.text import DASH, percent, short
from validation.report.figures import histories as figures
from validation.report.figures.work import work_figure
from validation.runs.records import Manifest
from validation.runs.results import Results

PRACTICE = (
    "For practice: cut the block into triangles and glue them stiffly (the joints' forces are unknowns of their own, "
    "so stiff glue costs no digits). Squares answer for the axial motion only; more of them do not help."
)
LOCKED = (
    "Affine squares that meet at their corners can only move as u = f(x) + g(y): no square can shear without its "
    "whole row and column. Their error in the rocking motion falls to a limit, not to zero; triangles converge."
)
GLUED = (
    "Glue is a spring in series: the n − 1 joints of a column add (n − 1) / (2 glue_ratio) of its compliance, a floor "
    "that more sub-blocks raise. Squares of soft glue give way in rows and squares of stiff glue lock, so that some "
    "glue shares the error between both motions, and none removes it."
)
TURNING = (
    "Two corner springs resist rocking with p a² / 2, a foundation over the whole base with p a² / 6. No width of the "
    "patches brings the finite elements to the block's rocking frequency: whoever needs rocking or sideways answers "
    "must model how the contact spreads its force, since neither time step nor mesh can repair it."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter: conclusions over all scenes, then the pages of the scenes."""
    found = {group.name: group for group in groups(results, manifest)}
    pages = scene_chapter(results, manifest, directory)
    first = next((i for i, block in enumerate(pages) if isinstance(block, Heading) and block.level == 2), len(pages))
    blocks: list[Block] = [Paragraph(PRACTICE, "lead"), Heading("Error against run time", 2)]
    blocks += _time_figures(found, directory)
    blocks += [Paragraph(LOCKED), *_tables(found, _patterns, ("subblocks-axial", "subblocks-rocking"))]
    blocks += [*_growth(found), Heading("Glue", 2), Paragraph(GLUED), *_tables(found, _glue, ("subblocks-best-glue",))]
    blocks += [Heading("Rocking", 2), Paragraph(TURNING), *_tables(found, _rocking, ("rocking",))]
    return [*pages[:first], *blocks, PageBreak(), *pages[first:]]


def _tables(found: dict[str, Group], make: Any, names: tuple[str, ...]) -> list[Block]:
    return [make(found[name]) for name in names if name in found]


def _seconds(case: Case) -> float:
    row = case.rows.get("dda")
    return float(sum(row.seconds.values())) if row else 0.0


def _count(case: Case) -> int:
    return (case.scene.block.subdivide or (1, 1))[1]


def _error(group: Group, case: Case, reference: str, metric: str) -> float | None:
    value = (group.compared(case, "dda", reference) or {}).get(metric)
    return float(value) if isinstance(value, int | float) else None


def _line(name: str, group: Group, cases: list[Case], reference: str, metric: str) -> figures.Line | None:
    """Return one way to refine as a line: seconds and error, each point with its count."""
    points = [(_seconds(case), _error(group, case, reference, metric), _count(case)) for case in cases]
    kept = [(s, e, n) for s, e, n in points if s > 0 and e]
    if not kept:
        return None
    x, y, notes = zip(*kept, strict=True)
    return figures.Line(name, np.array(x), np.array(y), " ".join(map(str, notes)))


def _time_figures(found: dict[str, Group], directory: Path) -> list[Block]:
    """Return error against seconds for both motions; a number at a point counts the sub-blocks upwards."""
    blocks: list[Block] = []
    wanted = {
        "axial": ("displacement.l2", "Displacement under pressure"),
        "rocking": ("horizontal.l2", "Horizontal displacement under a sideways traction"),
    }
    for kind, (metric, title) in wanted.items():
        group = found.get(f"subblocks-{kind}")
        if group is None:
            continue
        patterns = {
            name: [c for c in group.cases if c.scene.block.pattern == name] for name in ("squares", "triangles")
        }
        lines = [_line(name, group, cases, "fem", metric) for name, cases in patterns.items()]
        if kind == "axial" and (column := found.get("subblocks-column")) is not None:
            lines.append(_line("columns, μ = 0", column, list(column.cases), "bar", metric))
        drawn = [line for line in lines if line is not None]
        if drawn:
            file = f"subblocks-time-{kind}.svg"
            figures.save(work_figure(drawn, "Seconds of the run", "Relative L2 error"), directory / file)
            caption = f"{title}: error against run time. A number at a point counts the sub-blocks along a side."
            blocks.append(FigureBlock(file, caption))
    return blocks


def _of_pattern(group: Group, pattern: str) -> list[Case]:
    return [case for case in group.cases if case.scene.block.pattern == pattern]


def _ratio(case: Case, metric: str = "mode1.frequency") -> float | None:
    own, reference = case.number("dda", metric), case.number("fem", metric)
    return None if own is None or not reference else own / reference - 1


def _percent(value: float | None) -> str:
    if value is None:
        return DASH
    return f"−{percent(-value)}" if value < 0 else percent(value)


def _patterns(group: Group) -> Table:
    """Return errors and cost for each pattern and count."""
    metric = "horizontal.l2" if group.cases[0].scene.load.traction else "displacement.l2"
    rows = []
    for case in group.cases:
        work = case.rows["dda"].work if "dda" in case.rows else {}
        error = _error(group, case, "fem", metric)
        cells = (
            _percent(_ratio(case)),
            _percent(error),
            str(work.get("unknowns", DASH)),
            short(1e3 * _seconds(case), 3),
        )
        rows.append((case.scene.block.pattern, str(_count(case)), *cells))
    columns = ("Pattern", "n", "Error of ω₁", "L2 error", "Unknowns", "ms")
    kinds = ("text", "decimal", "text", "text", "decimal", "decimal")
    return Table(
        tuple(Column(title, kind) for title, kind in zip(columns, kinds, strict=True)),  # type: ignore[arg-type]
        tuple(rows),
        f"{group.title}, against quadratic elements",
    )


def _growth(found: dict[str, Group]) -> list[Block]:
    """Return one sentence on how the seconds of a step grow with the number of squares."""
    cases = [c for name in ("subblocks-rocking", "subblocks-locking") if name in found for c in found[name].cases]
    points = [
        (c.rows["dda"].work["unknowns"], c.rows["dda"].seconds["stepping"] / c.scene.time.steps)
        for c in cases
        if c.scene.block.pattern == "squares" and "dda" in c.rows and c.rows["dda"].work.get("unknowns", 0) > 300
    ]
    if len({n for n, _ in points}) < 2:
        return []
    unknowns, seconds = np.array(points).T
    slope = np.polyfit(np.log(unknowns), np.log(seconds), 1)[0]
    largest = f"{unknowns.max():.0f} unknowns"
    return [
        Paragraph(f"Beyond 300 unknowns the time of a step grows as their number to the power {slope:.2f} ({largest}).")
    ]


def _glue(group: Group) -> Table:
    """Return the error of the first frequency of squares for each glue, in both motions."""
    ratios = list(dict.fromkeys(case.scene.block.glue_ratio for case in group.cases))

    def error(ratio: float, turned: bool) -> str:
        cases = [c for c in group.cases if c.scene.block.glue_ratio == ratio and bool(c.scene.load.traction) is turned]
        return _percent(_ratio(cases[0]) if cases else None)

    rows = tuple((short(ratio), error(ratio, False), error(ratio, True)) for ratio in ratios)
    columns = (Column("glue_ratio", "decimal"), Column("Axial ω₁"), Column("Rocking ω₁"))
    return Table(columns, rows, "8 × 8 squares at p = 1E, μ = 0: error of the first frequency by glue")


def _rocking(group: Group) -> Table:
    """Return the rocking frequencies and damping ratios of block and elements for each patch width."""
    names = ("mode1.frequency", "mode1.damping")
    rows = tuple(
        (
            short(case.scene.fem.patch_width or case.scene.block.base_length),
            *(DASH if (v := case.number(s, m)) is None else short(v) for m in names for s in ("dda", "fem")),
            _percent(_ratio(case)),
        )
        for case in group.cases
    )
    columns = [Column("Patch width [m]", "decimal")]
    columns += [Column(s, "decimal", g) for g in ("ω₁ [rad/s]", "ξ₁ [1]") for s in ("dda", "fem")]
    return Table(
        (*columns, Column("Block above elements")), rows, "First rocking mode on springs of equal total stiffness"
    )
