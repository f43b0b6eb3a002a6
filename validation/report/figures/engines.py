"""Work-precision curves of the field of engines: error over steps and over seconds, a row for each family."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.curves import style_of
from validation.report.figures.histories import LABEL_GAP, Margins
from validation.studies.engines.best import FAMILIES, best_of_family, curves
from validation.studies.engines.table import EngineTable, WorkPoint
from validation.studies.field.table import ProgramLine

LEAST = 1e-3  # of what is allowed: smaller errors are drawn here
LARGEST = 1e3
STAR = " ★"  # behind the name of the best of its family
BACKGROUND = "#dcdcdc"  # of the other families' lines
DASHED = (3.0, 1.6)  # pt, of programs as they come
ROW = 30.0  # mm, least height
GAP = 8.5  # mm, between rows
MARGINS = Margins(13.0, 41.0, 7.0, 9.5, 7.0)


def engine_figure(table: EngineTable, problem: str) -> Figure | None:
    """Draw error, over what is allowed, over steps and over seconds; None where no program has a curve.

    Solid lines are chosen settings and dashed ones defaults, a colour for each program; the other families stand behind
    in grey. The star marks the best of a family (`best_of_family`).
    """
    drawn = [(program, cell.points) for program, cell in curves(table, problem)]
    families = [family for family in FAMILIES if any(program.family == family for program, _ in drawn)]
    if not families:
        return None
    x_ranges = [_range([_cost(point, place) for _, points in drawn for point in points]) for place in range(2)]
    panels = []
    heights = []
    for family in families:
        own = [(program, points) for program, points in drawn if program.family == family]
        others = [(program, points) for program, points in drawn if program.family != family]
        best = {program.name for program, _ in best_of_family(table, problem, family)} if len(own) > 1 else set()
        for place, cost in enumerate(("steps", "seconds")):
            lines = [_background(points, place) for _, points in others]
            lines += [_line(program, points, place, program.name in best) for program, points in own]
            panel = ChartPanel(
                FAMILIES[family] if place == 0 else "",
                cost if family == families[-1] else "",
                "error / allowed",
                [line for line in lines if len(line.x)],
                x_range=x_ranges[place],
                y_range=(LEAST / 2, LARGEST * 2),
                logarithmic=(True, True),
                levels={"": 1.0},
                names="none" if place == 0 else "ends",
            )
            panels.append(panel)
        heights.append((max(ROW, LABEL_GAP * len(own) + 4.0), GAP))
    return chart_figure(panels, heights, MARGINS, shared=True)


def _cost(point: WorkPoint, place: int) -> float | None:
    """Return the steps of a run, or its seconds; None where there is nothing to draw."""
    if point.error is None:
        return None
    return float(point.steps) if place == 0 else point.seconds


def _range(costs: Sequence[float | None]) -> tuple[float, float]:
    """Return the range of an axis that shows all costs."""
    values = [cost for cost in costs if cost is not None]
    return (min(values) / 1.5, max(values) * 1.5) if values else (0.1, 10.0)


def _line(program: ProgramLine, points: Sequence[WorkPoint], place: int, is_best: bool) -> ChartLine:
    style = style_of(program.name)
    pairs = [(cost, point.error) for point in points if (cost := _cost(point, place)) is not None]
    x = np.array([cost for cost, _ in pairs])
    y = np.clip(np.array([error for _, error in pairs], dtype=float), LEAST, LARGEST)
    is_default = program.kind == "default"
    return ChartLine(
        f"{program.title.partition(', ')[0]}, default" if is_default else program.title,
        x,
        y,
        style.color,
        dash=DASHED if is_default else (),
        width=1.9 if is_best else 0.9,
        dots=2.6,
        hollow=is_default,
        note=STAR if is_best else "",
    )


def _background(points: Sequence[WorkPoint], place: int) -> ChartLine:
    drawn = [(cost, point.error) for point in points if (cost := _cost(point, place)) is not None]
    x = np.array([cost for cost, _ in drawn])
    y = np.clip(np.array([error for _, error in drawn], dtype=float), LEAST, LARGEST)
    return ChartLine("", x, y, BACKGROUND, width=0.6)
