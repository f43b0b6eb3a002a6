"""Columns over time: every block a band between its faces, shaded by the force that it carries; gaps stay white."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.report.figures.curves import evenly
from validation.report.figures.histories import Margins, axes_grid, house_style
from validation.runs.history import Array

COLORS = "YlGnBu"  # pale where nothing presses, and told apart by everybody
MOST_INSTANTS = 240  # that are drawn
BAR = 2.5  # mm, width of the bar of colours
OPENED = 0.6  # of the lowest block's height: how wide the widest gap is drawn
MARGINS = Margins(13.0, 17.0, 6.0, 9.5, 26.0)


@dataclass(frozen=True)
class SpaceTime:
    """Blocks of a column over time.

    Raises
    ------
    ValueError
        The arrays do not belong together.
    """

    title: str
    time: Array  # (n,) [s]
    faces: Array  # heights of the faces at rest (blocks + 1,) [m]
    displacements: Array  # of each block's middle (blocks, n) [m]
    forces: Array  # that each block carries (blocks, n) [Pa]

    def __post_init__(self) -> None:
        """Check the shapes."""
        blocks = len(self.faces) - 1
        shape = (blocks, len(self.time))
        if self.displacements.shape != shape or self.forces.shape != shape:
            raise ValueError(f"displacements, forces: must be of shape {shape}, got {self.displacements.shape}")

    @property
    def magnification(self) -> float:
        """How many times displacements are enlarged: 1, 2 or 5 times a power of ten, at least 1."""
        widest = float(np.max(np.diff(self.displacements, axis=0, prepend=0.0), initial=0.0))
        if widest <= 0:
            return 1.0
        wanted = OPENED * float(np.min(np.diff(self.faces))) / widest
        power = 10.0 ** np.floor(np.log10(wanted))
        return max(1.0, float(power * max(part for part in (1, 2, 5) if part * power <= wanted)))


def space_time_figure(columns: Sequence[SpaceTime], height: float) -> Figure:
    """Draw columns side by side, so many mm high, each with a bar of its forces."""
    with house_style():
        figure, ((*row,),) = axes_grid([(height, 0.0)], len(columns), MARGINS)
        for axes, column in zip(row, columns, strict=True):
            _draw(figure, axes, column)
        row[0].set_ylabel("height [m]")
    return figure


def _draw(figure: Figure, axes: Axes, column: SpaceTime) -> None:
    kept = evenly(len(column.time), MOST_INSTANTS)
    time = 1e3 * column.time[kept]
    unit, factor = ("MPa", 1e-6) if np.max(column.forces) >= 1e5 else ("kPa", 1e-3)
    forces = factor * column.forces[:, kept]
    greatest = max(float(np.max(forces)), np.finfo(float).tiny)
    moved = column.magnification * column.displacements[:, kept]
    for foot, top, displacement, force in zip(column.faces[:-1], column.faces[1:], moved, forces, strict=True):
        edges = np.array([foot + displacement, top + displacement])
        shades = ((force[:-1] + force[1:]) / 2)[None, :]
        mesh = axes.pcolormesh(
            np.array([time, time]), edges, shades, cmap=COLORS, vmin=0.0, vmax=greatest, rasterized=True
        )
        for edge in edges:
            axes.plot(time, edge, color="black", lw=0.25)
    axes.set(xlabel="time [ms]", title=f"{column.title}, displacements × {column.magnification:g}")
    box = axes.get_position()
    width = BAR / 25.4 / figure.get_figwidth()
    bar = figure.colorbar(mesh, cax=figure.add_axes((box.x1 + 0.6 * width, box.y0, width, box.height)))
    bar.set_label(f"force [{unit}]")
