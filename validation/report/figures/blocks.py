"""Blocks in the plane as they are cut, side by side: clamps hatched, loads as arrows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from validation.report.figures.curves import GREY
from validation.report.figures.histories import Margins, axes_grid, house_style
from validation.scenes.plane import PlaneSection, Segment

FACE = "#fbe3d3"  # DDA's colour, pale
ARROWS = 4  # along a loaded edge
LONGEST = 0.16  # arrow, of the larger side of the body
MARGINS = Margins(4.0, 4.0, 6.0, 3.0, 8.0)  # mm


def blocks_figure(drawn: Sequence[tuple[str, PlaneSection]], height: float) -> Figure:
    """Draw bodies side by side, each under its title, to one scale of its own, so many mm high."""
    with house_style():
        figure, ((*row,),) = axes_grid([(height, 0.0)], len(drawn), MARGINS)
        for axes, (title, plane) in zip(row, drawn, strict=True):
            _draw(axes, plane)
            axes.set_title(title)
    return figure


def _draw(axes: Axes, plane: PlaneSection) -> None:
    for polygon in plane.polygons:
        axes.add_patch(Polygon(polygon, facecolor=FACE, edgecolor="black", lw=0.35))
    corners = np.vstack([np.array(polygon) for polygon in plane.polygons])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = float(np.max(high - low))
    for clamp in plane.clamp:
        band = _band(clamp.edge, 0.06 * size, corners)
        axes.add_patch(Polygon(band, facecolor="none", edgecolor=GREY, hatch="////", lw=0))
        axes.plot(*np.array(clamp.edge).T, color="black", lw=1.2)
    largest = max([float(np.hypot(*load.traction)) for load in plane.load], default=0.0)
    for load in plane.load:
        for share in (np.arange(ARROWS) + 0.5) / ARROWS:
            tip = (1 - share) * np.array(load.edge[0]) + share * np.array(load.edge[1])
            arrow = LONGEST * size * np.array(load.traction) / largest
            axes.annotate("", tip + arrow, tip, arrowprops={"arrowstyle": "-|>", "lw": 0.6, "shrinkA": 0, "shrinkB": 0})
    margin = ((LONGEST if plane.load or plane.clamp else 0.0) + 0.02) * size
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _band(edge: Segment, width: float, corners: np.ndarray) -> np.ndarray:
    """Return the band along an edge that lies outside the body."""
    start, end = (np.array(point) for point in edge)
    along = (end - start) / np.hypot(*(end - start))
    normal = np.array([-along[1], along[0]])
    outward = -normal if (corners.mean(axis=0) - start) @ normal > 0 else normal
    return np.array([start, end, end + width * outward, start + width * outward])
