"""Maps of numbers over two data: shade and number of a cell say the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from validation.report.figures.histories import Margins, axes_grid, house_style
from validation.runs.history import Array

GAP = 6.0  # mm between two maps, and above each line for its titles
LEFT = 16.0  # mm
BOTTOM = 9.0  # mm
MIDDLE = 0.5  # luminance; on a darker cell the number is white


@dataclass(frozen=True)
class NumberMap:
    """A map by rows and columns: values to shade, NaN where there is none, and the text of each cell."""

    title: str
    values: Array
    texts: Sequence[Sequence[str]]


@dataclass(frozen=True)
class MapScale:
    """How values are shaded: the colours from 0 to the greatest, and the height of a cell [mm]."""

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
    """Draw lines of maps; rows are labelled at the left, columns below the last line, both axes by `labels`."""
    margins = Margins(LEFT, 2.0, GAP, BOTTOM, GAP)
    with house_style():
        figure, grid = axes_grid([(scale.cell * len(rows), GAP)] * len(maps), len(maps[0]), margins)
        for line, line_axes in zip(maps, grid, strict=True):
            is_last = line_axes is grid[-1]
            for axes, number_map in zip(line_axes, line, strict=True):
                is_first = axes is line_axes[0]
                image = axes.imshow(number_map.values, cmap=scale.colors, vmin=0, vmax=scale.greatest, aspect="auto")
                colors = mpl.colormaps[scale.colors](np.asarray(image.norm(number_map.values)))
                for (r, c), value in np.ndenumerate(number_map.values):
                    if not number_map.texts[r][c]:
                        continue
                    red, green, blue, _ = colors[r, c]
                    luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue
                    is_dark = np.isfinite(value) and luminance < MIDDLE
                    axes.text(
                        c, r, number_map.texts[r][c], ha="center", va="center", color="white" if is_dark else "black"
                    )
                axes.set_title(number_map.title)
                axes.set_xticks(range(len(columns)), list(columns) if is_last else [""] * len(columns))
                axes.set_yticks(range(len(rows)), list(rows) if is_first else [""] * len(rows))
                axes.tick_params(length=0)
                axes.set(xlabel=labels[0] if is_last else "", ylabel=labels[1] if is_first else "")
    return figure
