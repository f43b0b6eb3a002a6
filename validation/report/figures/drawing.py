"""Scenes as they are drawn: bodies in metres, what they stand on, what drives them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike

from validation.report.figures.curves import GREY, engineering
from validation.report.figures.histories import Margins, axes_grid, house_style, size_of
from validation.runs.history import Array, History
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene

FACE = "#fbe3d3"  # DDA's colour, pale
ARROWS = 4  # along a loaded edge
LONGEST = 0.16  # arrow, of the larger side of the body
GROUND = 0.06  # hatched band of what stands still, of the same
SPRING = 0.14  # length of a spring, of the same
COILS = 4
MARGINS = Margins(4.0, 4.0, 6.0, 3.0, 8.0)  # mm
WIDTH = 60.0  # mm, of the drawing of a scene
HEIGHTS = (14.0, 46.0)  # mm, the least and the greatest


class Sketch:
    """Axes in metres that a scene is drawn on, turned by the slope of its ground.

    `size` is the larger side of the body [m], of which arrows, springs and the ground are a share.
    """

    def __init__(self, axes: Axes, bodies: Sequence[ArrayLike], slope: float = 0.0) -> None:
        self.axes = axes
        self._turn = rotation(-math.radians(slope))
        self._drawn: list[Array] = []
        corners = np.vstack([np.asarray(body, dtype=float) for body in bodies])
        self.low, self.high = corners.min(axis=0), corners.max(axis=0)
        self.middle = (self.low + self.high) / 2
        self.size = float(np.max(self.high - self.low))
        for body in bodies:
            self.polygon(body, facecolor=FACE, edgecolor="black", lw=0.35)

    def _placed(self, points: ArrayLike) -> Array:
        placed = np.asarray(points, dtype=float) @ self._turn
        self._drawn.append(placed)
        return placed

    def polygon(self, points: ArrayLike, **look: object) -> None:
        """Fill an outline."""
        self.axes.add_patch(Polygon(self._placed(points), **look))  # type: ignore[arg-type]

    def line(self, points: ArrayLike, width: float = 0.6, **look: object) -> None:
        """Draw a line."""
        self.axes.plot(*self._placed(points).T, color="black", lw=width, **look)  # type: ignore[arg-type]

    def arrow(self, tail: ArrayLike, vector: ArrayLike, words: str = "", head: str = "-|>", va: str = "bottom") -> None:
        """Draw an arrow with words at its tail: above it, or below with `va` "top"."""
        start, end = self._placed(np.array([tail, np.add(tail, vector)]))
        look = {"arrowstyle": f"{head},head_width=0.12,head_length=0.28", "lw": 0.6, "shrinkA": 0, "shrinkB": 0}
        self.axes.annotate("", end, start, arrowprops=look, zorder=4)
        if words:
            self.axes.annotate(words, start, (2.5, 1.0), textcoords="offset points", fontsize=6.5, va=va)

    def dot(self, point: Sequence[float]) -> None:
        """Draw a dot."""
        self.axes.plot(*self._placed([point]).T, color="black", marker="o", ms=1.6, lw=0)

    def spring(self, foot: Sequence[float]) -> None:
        """Draw a spring between the ground and a corner above it."""
        length = SPRING * self.size
        heights = np.linspace(0.15, 0.85, 2 * COILS + 1) * length
        shifts = 0.3 * length * np.array([0.0, *itertools.islice(itertools.cycle((1.0, -1.0)), 2 * COILS - 1), 0.0])
        zigzag = np.column_stack([foot[0] + shifts, foot[1] - length + heights])
        self.line([(foot[0], foot[1] - length), *zigzag, foot])

    def hatched(self, edge: ArrayLike) -> None:
        """Hatch the band along an edge on the side where the body is not: what is fixed."""
        start, end = np.asarray(edge, dtype=float)
        along = (end - start) / np.hypot(*(end - start))
        normal = np.array([-along[1], along[0]])
        outward = -normal if (self.middle - start) @ normal > 0 else normal
        band = GROUND * self.size * outward
        self.polygon((start, end, end + band, start + band), facecolor="none", edgecolor=GREY, hatch="////", lw=0)
        self.line([start, end], 1.2)

    def ground(self, depth: float = 0.0, base: ArrayLike | None = None, moves: bool = False) -> None:
        """Draw the ground so deep below a base, by default y = 0, with a double arrow where it moves."""
        left, right = ((self.low[0], 0.0), (self.high[0], 0.0)) if base is None else np.asarray(base)
        beyond = 0.12 * self.size * np.subtract(right, left) / math.dist(left, right)
        below = np.array([0.0, -depth])
        self.hatched([left + below - beyond, right + below + beyond])
        if moves:
            travel = np.array([LONGEST * self.size, 0.0])
            tail = (np.add(left, right) - travel) / 2 + below - (0.0, 2.2 * GROUND * self.size)
            self.arrow(tail, travel, head="<|-|>")

    def fit(self) -> None:
        """Set the limits about what is drawn."""
        points = np.vstack(self._drawn)
        margin = 0.03 * self.size
        self.axes.set_xlim(points[:, 0].min() - margin, points[:, 0].max() + margin)
        self.axes.set_ylim(points[:, 1].min() - margin, points[:, 1].max() + margin)
        self.axes.set_aspect("equal")
        self.axes.set_axis_off()


def rotation(angle: float) -> Array:
    """Return the matrix that turns points, a row each, counter-clockwise [rad]."""
    return np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])


class FigureHooks(Hooks):
    """How a kind of scene is drawn."""

    module = "figure"

    def draw(self, axes: Axes, scene: Scene) -> None:
        """Draw a scene on a `Sketch` of these axes; set their limits."""
        axes.set_axis_off()

    def frames(self, scene: Scene, history: History, steps: Sequence[int], solver: str, height: float) -> Figure | None:
        """Draw the bodies at some steps of a motion side by side, `height` mm high; None where a kind does not."""
        return None


def scene_figure(scene: Scene) -> Figure:
    """Draw a scene, as high as it needs."""
    with house_style():
        figure, ((axes,),) = axes_grid([(HEIGHTS[1], 0.0)], 1, MARGINS, WIDTH)
        FigureHooks.of(scene).draw(axes, scene)
        height = size_of(axes)[0] * np.ptp(axes.get_ylim()) / np.ptp(axes.get_xlim())
        figure.set_figheight((np.clip(height, *HEIGHTS) + MARGINS.top + MARGINS.bottom) / 25.4)
    return figure


def scenes_figure(drawn: Sequence[tuple[str, Scene]], height: float) -> Figure:
    """Draw scenes side by side, so many mm high, each with its title and a scale of its own."""
    with house_style():
        figure, ((*row,),) = axes_grid([(height, 0.0)], len(drawn), MARGINS)
        for axes, (title, scene) in zip(row, drawn, strict=True):
            FigureHooks.of(scene).draw(axes, scene)
            axes.set_title(title)
    return figure


def along(edge: ArrayLike) -> Array:
    """Return where the arrows stand along an edge."""
    shares = (np.arange(ARROWS) + 0.5)[:, None] / ARROWS
    start, end = np.array(edge)
    places: Array = (1 - shares) * start + shares * end
    return places


def quantity(value: float, unit: str) -> str:
    """Return a number with its unit and an SI prefix, ``5 MPa``."""
    factor, unit = engineering(abs(value), unit)
    return f"{factor * value:.3g} {unit}"
