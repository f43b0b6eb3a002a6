"""The drawing of the two-block model: block, springs, load and unknowns."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Rectangle

from validation.report.figures.curves import GREY, style_of
from validation.report.figures.histories import house_style

# Lengths of the drawing, in mm.
WIDTH = 72.0
HEIGHT = 62.0
SIDE = 34.0  # of the block
LEFT = 17.0  # edge of the block
BASE = 17.0  # lower edge of the block
GAP = 6.0  # length of the springs
FIXED = "#e8e8e8"
BLOCK = "#fdf3e7"


def model_figure(side: str, pressure: str) -> Figure:
    """Draw the model with the words of its side and of its load, such as "a = 2 m" and "q = 5 MPa"."""
    with house_style():
        figure = Figure(figsize=(WIDTH / 25.4, HEIGHT / 25.4))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(0.0, WIDTH), ylim=(0.0, HEIGHT))
        axes.set_axis_off()
        _bodies(axes)
        _corner(axes, LEFT, "M", outwards=-1.0)
        _corner(axes, LEFT + SIDE, "N", outwards=1.0)
        _load(axes, pressure)
        _unknowns(axes)
        _dimension(axes, side)
    return figure


def _bodies(axes: Axes) -> None:
    axes.add_patch(Rectangle((LEFT, BASE), SIDE, SIDE, fc=BLOCK, ec="black", lw=1.0, zorder=2))
    axes.add_patch(Rectangle((4.0, BASE - GAP - 8.0), WIDTH - 8.0, 8.0, fc=FIXED, ec="#b0b0b0", hatch="////", lw=0.0))
    axes.plot([4.0, WIDTH - 4.0], [BASE - GAP] * 2, color="black", lw=1.0)
    axes.text(LEFT + 2.0, BASE + SIDE - 4.5, "A", fontsize=9, fontweight="bold")
    boxed = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
    axes.text(LEFT + SIDE / 2, BASE - GAP - 4.2, "B, fixed", ha="center", va="center", bbox=boxed)


def _corner(axes: Axes, x: float, name: str, outwards: float) -> None:
    """Draw a corner's normal spring below it and its shear spring beside it, both on block B."""
    color = style_of("dda").color
    zigzag = np.array([0, 0, 1, -1, 1, -1, 1, 0, 0.0])
    along = np.concatenate([[0.0], np.linspace(0.15, 0.85, 7), [1.0]])
    axes.plot(x + 1.2 * zigzag, BASE - GAP * along, color=color, lw=0.9, zorder=3)
    reach = 7.0
    axes.plot(x + outwards * reach * along, BASE + 0.9 * zigzag, color=color, lw=0.9, zorder=3)
    axes.plot([x + outwards * reach] * 2, [BASE, BASE - GAP], color="black", lw=0.7)
    axes.plot(x, BASE, "o", ms=3.0, color="black", zorder=4)
    side = "right" if outwards < 0 else "left"
    axes.text(x + outwards * 1.6, BASE + 1.6, name, ha=side, va="bottom", fontweight="bold")
    axes.text(x + outwards * 8.2, BASE - 0.4, "p", ha=side, va="center", color=color, fontstyle="italic")
    inside = "left" if outwards < 0 else "right"
    axes.text(x - outwards * 2.2, BASE - 3.2, "p", ha=inside, va="center", color=color, fontstyle="italic")


def _load(axes: Axes, pressure: str) -> None:
    top = BASE + SIDE
    for x in np.linspace(LEFT + 1.5, LEFT + SIDE - 1.5, 7):
        _arrow(axes, (x, top + 5.5), (x, top + 0.4), "black")
    axes.plot([LEFT + 1.5, LEFT + SIDE - 1.5], [top + 5.5] * 2, color="black", lw=0.7)
    axes.text(LEFT + SIDE / 2, top + 6.6, f"{pressure}, from t = 0 on", ha="center", va="bottom")


def _unknowns(axes: Axes) -> None:
    x = LEFT + SIDE / 2
    y = BASE + SIDE / 2 + 1.0
    color = style_of("dda").color
    axes.plot(x, y, "o", ms=3.0, color=color, zorder=4)
    _arrow(axes, (x, y), (x + 9.0, y), color)
    _arrow(axes, (x, y), (x, y + 9.0), color)
    axes.text(x + 9.6, y, "u", va="center", color=color, fontstyle="italic")
    axes.text(x, y + 9.6, "v", ha="center", color=color, fontstyle="italic")
    axes.add_patch(Arc((x, y), 8.0, 8.0, theta1=110, theta2=250, color=color, lw=0.9, zorder=4))
    _arrow(axes, (x - 1.7, y - 3.62), (x - 1.0, y - 3.88), color)
    axes.text(x - 4.8, y, "r", ha="right", va="center", color=color, fontstyle="italic")
    axes.text(x, y - 8.5, r"$\varepsilon_x,\ \varepsilon_y,\ \gamma_{xy}$", ha="center", va="center", color=color)


def _dimension(axes: Axes, side: str) -> None:
    x = LEFT + SIDE + 12.5
    axes.plot([x, x], [BASE, BASE + SIDE], color=GREY, lw=0.5)
    for y in (BASE, BASE + SIDE):
        axes.plot([x - 0.9, x + 0.9], [y, y], color=GREY, lw=0.5)
    axes.text(x + 1.2, BASE + SIDE / 2, side, rotation=90, va="center", color=GREY)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], color: str) -> None:
    look = {"arrowstyle": "-|>,head_width=0.12,head_length=0.28", "color": color, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=look, zorder=4)
