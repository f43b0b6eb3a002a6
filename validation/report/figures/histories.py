"""Figures in one house style: lines carry their names at their ends, axes carry units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.report.blocks import FigureBlock
from validation.report.figures.curves import (
    HAIR,
    nudge,
)
from validation.runs.files import write_atomically

HOUSE_STYLE = mpl.rc_params_from_file(str(Path(__file__).with_name("house.mplstyle")), use_default_template=False)
EndLabel = tuple[float, str, str]  # value at the end of a line, its name, its colour
WIDTH = 166.0  # mm, text width of the report
SLIDE = (136.0, 76.5)  # mm, width and height of a figure for a slide of 16 to 9, on which its letters have 13 pt
LABEL_GAP = 3.0  # mm between the names of two lines
LETTER = 1.5  # mm, width of a letter of a name, amply
COLUMN_GAP = 4.0  # mm between two panels
TITLE_LETTER = 1.6  # mm, width of a letter of a panel's title, amply
TITLE_LINE = 3.2  # mm, height of a line of it, amply


@contextmanager
def house_style() -> Iterator[None]:
    """Apply the house style while drawing or saving."""
    with mpl.rc_context(HOUSE_STYLE):
        yield


def save(figure: Figure, path: Path) -> Path:
    """Write a figure as SVG, text as paths, the same bytes every time; return the path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with house_style():
        write_atomically(path, lambda stream: figure.savefig(stream, format="svg", metadata={"Date": None}))
    return path


def saved(figure: Figure, directory: Path, file: str, caption: str, scene: str = "") -> FigureBlock:
    """Write a figure, of one scene or of none, into a directory; return its block."""
    save(figure, directory / file)
    return FigureBlock(file, caption, scene)


@dataclass(frozen=True)
class Margins:
    """Margins of a figure, and the gap between its columns [mm]."""

    left: float = 13.0
    right: float = 21.0
    top: float = 5.0
    bottom: float = 8.5
    between: float = COLUMN_GAP


def axes_grid(
    rows: Sequence[tuple[float, float]], columns: int, margins: Margins, width: float = WIDTH
) -> tuple[Figure, list[list[Axes]]]:
    """Return a figure with axes placed in millimetres: each row has a height and a gap below it."""
    height = margins.top + sum(map(sum, rows)) - rows[-1][1] + margins.bottom
    across = (width - margins.left - margins.right - margins.between * (columns - 1)) / columns
    left_edges = [margins.left + j * (across + margins.between) for j in range(columns)]
    figure = Figure(figsize=(width / 25.4, height / 25.4))
    grid = []
    y = height - margins.top
    for row, gap in rows:
        y -= row
        grid.append([figure.add_axes((x / width, y / height, across / width, row / height)) for x in left_edges])
        y -= gap
    return figure, grid


def size_of(axes: Axes) -> tuple[float, float]:
    """Return width and height of the axes [mm]."""
    figure = axes.get_figure()
    if not isinstance(figure, Figure):
        raise ValueError("axes: must belong to a figure, got none")
    box = axes.get_position()
    return box.width * figure.get_figwidth() * 25.4, box.height * figure.get_figheight() * 25.4


def label_ends(axes: Axes, labels: Sequence[EndLabel], below: float = 1.0) -> None:
    """Write the names of lines beside their ends, nudged apart, with a thin leader.

    The limits of the axes must be set before; names stand at most `below` mm below the axes.
    """
    if not labels:
        return
    width, height = size_of(axes)
    right = axes.get_xlim()[1]
    to_axes = axes.transAxes.inverted()
    points = [to_axes.transform(axes.transData.transform((right, y))) for y, _, _ in labels]
    heights = [float(np.clip(point[1], 0, 1)) for point in points]
    places = nudge(heights, LABEL_GAP / height, -below / height, 1 + 1.0 / height)
    for (_, name, color), start, place in zip(labels, heights, places, strict=True):
        where: dict[str, Any] = {"transform": axes.transAxes, "color": color}
        axes.plot([1, 1 + 2.5 / width], [start, place], lw=HAIR, clip_on=False, **where)
        axes.text(1 + 3.1 / width, place, name, va="center_baseline", ha="left", **where)


def share_left(row: Sequence[Axes], count: int, label: str) -> None:
    """Label the y axis at the left; hide the other panels' tick labels and all axes beyond the count."""
    row[0].set_ylabel(label)
    for axes in row[1:count]:
        axes.tick_params(labelleft=False)
    for axes in row[count:]:
        axes.set_axis_off()


def outer_ticks(axes: Axes, last: float, texts: Mapping[float, str]) -> None:
    """Set labelled ticks on the x axis; the outer labels stay inside, clear of the next panels."""
    axes.set_xticks(list(texts), list(texts.values()))
    labels = axes.get_xticklabels()
    labels[0].set_horizontalalignment("left")
    if max(texts) > 0.95 * last:
        labels[-1].set_horizontalalignment("right")
