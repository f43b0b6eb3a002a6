"""The figure of error against cost."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from validation.report.figures.charts import ChartLine, ChartPanel, Figure, chart_figure, name_above
from validation.report.figures.curves import style_of
from validation.report.figures.histories import Margins
from validation.studies.work_precision.points import COSTS, ROUNDING, Point, floor, front

QUANTITIES = ("displacement", "contact pressure")
NOTHING = 1e-12  # smaller differences are rounding
LEAST = 1e-13  # error; smaller ones have no place on the axis
REFERENCES = {"bar": "model form and mesh", "continuum": "everything"}


def work_figure(points: Sequence[Point]) -> Figure:
    """Draw error against seconds and against work for each quantity that has one, a line for each method.

    Grey steps are the front that no run beats in both, the level is DDA's model form, hollow points lie below the
    reference's own uncertainty.
    """
    quantities = [name for name in QUANTITIES if _differs(points, name)]
    panels = []
    for quantity, cost, reference in itertools.product(quantities, COSTS, REFERENCES):
        panel = ChartPanel(
            f"{REFERENCES[reference]}\n(against the {reference})" if quantity == quantities[0] else "",
            {"seconds": "Seconds"}.get(cost, "Unknowns × steps") if quantity == quantities[-1] else "",
            quantity.capitalize(),
            _lines(points, quantity, cost, reference),
            logarithmic=(True, True),
            names="none",
        )
        level = floor(points, quantity, reference)
        panels.append(replace(panel, levels={"": level}) if level else panel)
    figure = chart_figure(panels, [(25.0, 4.0)] * len(quantities), Margins(15.0, 4.0, 13.0, 9.5), shared=True)
    name_above(figure, {point.method: style_of(point.method).color for point in points})
    return figure


def _differs(points: Sequence[Point], quantity: str) -> bool:
    """Whether some run has an error in a quantity that is more than rounding."""
    pairs = itertools.product(points, REFERENCES)
    return any(point.errors.get((quantity, reference), 0.0) > NOTHING for point, reference in pairs)


def _lines(points: Sequence[Point], quantity: str, cost: str, reference: str) -> list[ChartLine]:
    """Return the front, and a line for each method with its runs as dots."""
    pairs_by_method: dict[str, list[tuple[float, float]]] = {}
    for point in points:
        x = COSTS[cost](point)
        y = point.errors.get((quantity, reference), 0.0)
        if x > 0 and y > LEAST:
            pairs_by_method.setdefault(point.method, []).append((x, y))
    lines = []
    best = front(list(itertools.chain(*pairs_by_method.values())))
    if best:
        x, y = np.array(best).repeat(2, axis=0).T
        lines.append(ChartLine("", x[1:], y[:-1], "#bbbbbb", width=2.2))
    for method, pairs in pairs_by_method.items():
        color = style_of(method).color
        x, y = np.array(pairs).T
        is_rounding = y < ROUNDING
        lines += [
            ChartLine("", x, y, color, width=0.8),
            ChartLine("", x[~is_rounding], y[~is_rounding], color, width=0, dots=2.6),
            ChartLine("", x[is_rounding], y[is_rounding], color, width=0, dots=2.6, hollow=True),
        ]
    return lines
