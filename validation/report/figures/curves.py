"""What figures draw, before anything is drawn: the house style, thinned curves, differences, places of labels.

Every solver has one colour and one line style everywhere, which colour-blind readers can tell apart.
"""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from validation.runs.columns import OwnColumns, kind_of
from validation.runs.history import Array, ArrayPair, History
from validation.solvers.contract import LineStyle
from validation.solvers.registry import get_solver, is_solver

HAIR = 0.4  # pt, of lines, as in `house.mplstyle`
PARTS = 40  # of the time, in each of which a difference has one magnitude
GREY = "#6b6b6b"
LEAST_MOVED = 0.05  # of a place: less is not enlarged, or its ticks would need more digits than they have room for

EXACT = "exact"  # name of the line of an exact motion, whichever solution it comes from

_OTHER_COLORS = ("#009e73", "#cc79a7", "#5d3a9b", "#8c6d1f", "#44aa99", "#882255")
_OTHER_DASHES: tuple[tuple[float, ...], ...] = ((6.0, 2.0), (3.0, 1.5, 1.0, 1.5), (1.5, 1.0))


def style_of(name: str) -> LineStyle:
    """Return the style of a solver; that of an unknown one depends on its name alone."""
    if name == EXACT:
        return LineStyle("#444444", (), 0.8, 1)
    declared = get_solver(name).line if is_solver(name) else None
    if declared is not None:
        return declared
    code = zlib.crc32(name.encode())
    color = _OTHER_COLORS[code % len(_OTHER_COLORS)]
    return LineStyle(color, _OTHER_DASHES[code // len(_OTHER_COLORS) % len(_OTHER_DASHES)], 1.0, 2)


def dash_style(dash: tuple[float, ...]) -> str | tuple[float, tuple[float, ...]]:
    """Return the line style of matplotlib for dashes and gaps [pt], solid without any."""
    return (0, dash) if dash else "-"


def thin(x: Array, y: Array, points: int = 800) -> ArrayPair:
    """Return at most about `points` samples: first, last and the extremes of equal bins, so that no peak is lost."""
    if x.size <= points:
        return x, y
    edges = np.linspace(0, x.size, points // 2 + 1).astype(int)
    indices = {0, x.size - 1}
    for start, stop in itertools.pairwise(edges):
        indices |= {start + int(np.argmin(y[start:stop])), start + int(np.argmax(y[start:stop]))}
    index = np.array(sorted(indices))
    return x[index], y[index]


def evenly(count: int, most: int) -> list[int]:
    """Return at most so many of the numbers 0 to `count` - 1, evenly taken, first and last among them."""
    indices: list[int] = np.unique(np.linspace(0, count - 1, most).round().astype(int)).tolist()
    return indices


def band(x: Array, y: Array, bins: int) -> tuple[Array, Array, Array]:
    """Return the middles of equal parts of the samples, and the least and greatest value in each."""
    edges = np.unique(np.linspace(0, x.size, bins + 1).astype(int))
    low, high = (function.reduceat(y, edges[:-1]) for function in (np.minimum, np.maximum))
    return (x[edges[:-1]] + x[edges[1:] - 1]) / 2, low, high


def nudge(places: Sequence[float], gap: float, low: float, high: float) -> NDArray[np.float64]:
    """Return places at least `gap` apart, in the order of and as near as possible to the given ones.

    The least-squares answer: isotonic regression of ``places - gap * rank``, clipped to [low, high] as long as all fit.
    """
    from scipy.optimize import isotonic_regression

    targets = np.asarray(places, dtype=float)
    order = np.argsort(targets, kind="stable")
    steps = gap * np.arange(targets.size)
    level = isotonic_regression(targets[order] - steps).x
    nudged = np.empty_like(targets)
    nudged[order] = np.clip(level, low, max(low, high - gap * (targets.size - 1))) + steps
    return nudged


def engineering(largest: float, unit: str) -> tuple[float, str]:
    """Return factor and unit with the SI prefix that brings the largest value between 1 and 1000."""
    if not unit or not largest > 0 or not math.isfinite(largest):
        return 1.0, unit
    power = min(9, max(-9, 3 * math.floor(math.log10(largest) / 3)))
    return 10.0**-power, {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}[power] + unit


@dataclass(frozen=True)
class HistoryPanel:
    """One of several small multiples: the histories of all solvers for one case."""

    title: str
    histories: Mapping[str, History]
    static: Mapping[str, float]  # static values by column, in its unit
    reference: str | None  # the solver that differences are taken from
    base: History | None = None  # of the reference, where its own line is not drawn
    like_base: str | None = None  # the drawn line that the reference lies on
    finer: Mapping[str, History] = field(default_factory=dict)  # exact solutions at more instants, drawn in their place
    own: OwnColumns = field(default_factory=dict)  # columns that only its kind of scene has

    def drawn(self, column: str) -> dict[str, History]:
        """Return the histories of which a column is drawn, by solver."""
        finest = {name: self.finer.get(name, history) for name, history in self.histories.items()}
        return {name: history for name, history in finest.items() if column in history.columns}


HistoryPanels = Sequence[HistoryPanel]


def common_range(panels: HistoryPanels, column: str) -> tuple[float, float]:
    """Return the common range of a column; what blows up is cut at six static values."""
    kinds = [kind for panel in panels if (kind := kind_of(column, panel.own))]
    from_zero = all(kind.from_zero for kind in kinds)
    drawn = [history.columns[column] for panel in panels for history in panel.drawn(column).values()]
    drawn = drawn or [np.ones(1)]  # no history: a range that is not empty
    values = np.concatenate(drawn)
    values = values[np.isfinite(values)]
    if from_zero or not len(values):
        values = np.append(values, 0.0)
    rounding = max((kind.rounding for kind in kinds), default=0.0)
    if not from_zero:
        half = max(LEAST_MOVED * np.abs(values).max() / 2, (values.max() - values.min()) / 2) or 1.0
        middle = (values.max() + values.min()) / 2
        return float(middle - half), float(middle + half)
    if np.abs(values).max() < rounding:
        return -rounding, rounding  # what does not move is at rest, and not a line of rounding errors
    limit = 6 * max((abs(p.static[column]) for p in panels if p.static.get(column)), default=math.inf)
    return float(np.clip(values.min(), -limit, limit)), float(np.clip(values.max(), -limit, limit))


def differences(panel: HistoryPanel, column: str) -> dict[str, ArrayPair]:
    """Return the largest magnitude of each solver's scaled difference from the reference by parts of the time."""
    base = panel.histories.get(panel.reference or "", panel.base)
    if base is None or column not in base.columns:
        return {}
    scale = abs(panel.static.get(column, 0.0)) or float(np.abs(base.columns[column]).max()) or 1.0
    envelopes = {}
    for solver, history in panel.histories.items():
        if (
            solver not in (panel.reference, panel.like_base)
            and history.time.size == base.time.size
            and column in history.columns
        ):
            with np.errstate(all="ignore"):  # a run that blew up differs by infinity
                scaled = (history.columns[column] - base.columns[column]) / scale
            middles, _, largest = band(base.time, np.where(np.isfinite(scaled), np.abs(scaled), np.inf), PARTS)
            envelopes[solver] = middles, largest
    return envelopes
