"""Small pictures of scenes for the first page: the first column of one case, a line for each solver."""

from __future__ import annotations

import math

import numpy as np

from validation.gallery.cases import GalleryScene, PlainData
from validation.report.figures.curves import style_of, thin
from validation.runs.history import Array
from validation.runs.results import Results
from validation.runs.run import Outcome

WIDTH = 120.0
HEIGHT = 48.0
MARGIN = 3.0
SAMPLES = 48  # of a line
MOST_LINES = 3  # lines that can be told apart at this size
Curve = tuple[str, Array, Array]  # colour, instants, values


def thumbnail(results: Results, scene: GalleryScene) -> PlainData | None:
    """Return name and lines of the picture of a scene, None where no history of it is complete."""
    for case in scene.cases:
        column = case.scene.run.columns[0]
        curves: list[Curve] = []
        for solver, row in case.rows.items():
            history = results.history(row.key) if row.outcome is Outcome.COMPLETED else None
            if history is None or len(history.time) < 2 or len(curves) == MOST_LINES:
                continue
            time, values = thin(history.time, history.columns[column], SAMPLES)
            if np.isfinite(values).all():
                curves.append((style_of(solver).color, time, values))
        if curves:
            return {"column": column.replace("_", " "), "lines": _placed(curves)}
    return None


def _placed(curves: list[Curve]) -> list[PlainData]:
    """Return colour and points of each curve, scaled to the picture."""
    start = min(float(time[0]) for _, time, _ in curves)
    end = max(float(time[-1]) for _, time, _ in curves)
    low = min(float(values.min()) for _, _, values in curves)
    high = max(float(values.max()) for _, _, values in curves)
    height = high - low
    lines = []
    for color, time, values in curves:
        x = MARGIN + (WIDTH - 2 * MARGIN) * (time - start) / (end - start)
        share = (values - low) / height if height > 0 and math.isfinite(height) else np.full(len(values), 0.5)
        y = HEIGHT - MARGIN - (HEIGHT - 2 * MARGIN) * share
        points = " ".join(f"{a:.0f},{b:.1f}" for a, b in zip(x, y, strict=True))
        lines.append({"color": color, "points": points})
    return lines[::-1]  # the first solver on top
