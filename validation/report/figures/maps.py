"""Maps of numbers over two data: shade and number of a cell say the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.report.figures.histories import WIDTH, house_style
from validation.runs.history import Array

GAP = 6.0  # mm between two maps, and above each line for its titles
LEFT = 16.0  # mm
BOTTOM = 9.0  # mm
MIDDLE = 0.5  # luminance; on a darker cell the number is white


@dataclass(frozen=True)
class NumberMap:
    """A map by rows and columns: values that are shaded, NaN where there is none, and the text of each cell."""

    title: str
    values: Array
    texts: Sequence[Sequence[str]]


@dataclass(frozen=True)
class MapScale:
    """How values are shaded: the colours from 0 to the greatest value, and the height of a cell [mm]."""

    colors: str
    greatest: float
    cell: float


def map_figure(
    maps: Sequence[Sequence[NumberMap]],
    rows: Sequence[str],
    columns: Sequence[str],
    labels: tuple[str, str],
    scale: MapScale,
) -> Figure:
    """Draw lines of maps; rows are labelled at the left, columns below the last line, as both axes are by `labels`."""
    across = len(maps[0])
    width = (WIDTH - LEFT - 2.0 - GAP * (across - 1)) / across
    tall = scale.cell * len(rows)
    height = (GAP + tall) * len(maps) + BOTTOM
    with house_style():
        figure = Figure(figsize=(WIDTH / 25.4, height / 25.4))
        for i, line in enumerate(maps):
            y = height - (GAP + tall) * (i + 1)
            for k, number_map in enumerate(line):
                x = LEFT + k * (width + GAP)
                axes = figure.add_axes((x / WIDTH, y / height, width / WIDTH, tall / height))
                _draw(axes, number_map, scale)
                is_last = i == len(maps) - 1
                axes.set_xticks(range(len(columns)), list(columns) if is_last else [""] * len(columns))
                axes.set_yticks(range(len(rows)), [""] * len(rows) if k else list(rows))
                axes.tick_params(length=0)
                axes.set(xlabel=labels[0] if is_last else "", ylabel="" if k else labels[1])
    return figure


def _draw(axes: Axes, number_map: NumberMap, scale: MapScale) -> None:
    image = axes.imshow(number_map.values, cmap=scale.colors, vmin=0, vmax=scale.greatest, aspect="auto")
    colors = mpl.colormaps[scale.colors](np.asarray(image.norm(number_map.values)))
    for (r, c), value in np.ndenumerate(number_map.values):
        if not number_map.texts[r][c]:
            continue
        red, green, blue, _ = colors[r, c]
        luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue
        is_dark = np.isfinite(value) and luminance < MIDDLE
        axes.text(c, r, number_map.texts[r][c], ha="center", va="center", color="white" if is_dark else "black")
    axes.set_title(number_map.title)
