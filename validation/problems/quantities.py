"""Numbers of an answer that people understand, beside those of the exact motion; nothing is judged by them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from validation.metrics.poles import poles
from validation.metrics.values import largest
from validation.problems.problem import Number, Problem, ProblemHooks
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, History
from validation.scenes import features
from validation.scenes.scene import Scene

MOST = 3  # numbers of a problem
TRACE = 1e-3  # of the largest pressure: what is less is an open contact
ARRIVAL = 0.1  # of the largest displacement: what is more has arrived
COUNTED = frozenset({"openings"})  # of the numbers: how often something happens
ROTATION, SIDEWAYS = "rotation", "horizontal_displacement"


@dataclass(frozen=True)
class Quantity:
    """A number of an answer and of the exact motion; None where the answer or the motion has none."""

    name: str
    unit: str
    value: float | None
    exact: float | None
    band: tuple[float, float] | None = None  # edges between which it passes; None where it is not judged


def quantities(problem: Problem, history: History, exact: History) -> tuple[Quantity, ...]:
    """Return at most `MOST` numbers of an answer, over the rows of the exact motion."""
    rows, shown_numbers = len(exact.time), []
    for number in numbers(problem.scene):
        if number.column in exact.columns:
            column = history.columns.get(number.column)
            value = (
                None if column is None or not np.isfinite(column[:rows]).all() else number.of(exact.time, column[:rows])
            )
            shown_numbers.append(
                Quantity(number.name, number.unit, value, number.of(exact.time, exact.columns[number.column]))
            )
    return tuple(shown_numbers[:MOST])


def numbers(scene: Scene) -> Iterator[Number]:
    """Yield the numbers that a kind of scene is understood by, the first ones first."""
    scene_features = features.of(scene)
    own = ProblemHooks.of(scene).shown_numbers(scene)
    if own is not None:
        yield from own
    elif features.ROTATION in scene_features:
        yield Number("rotation at the last judged step", "rad", ROTATION, last)
        yield Number("instant of landing", "s", ROTATION, _landing(scene))
    elif features.FRICTION in scene_features:
        yield Number("slid in the end", "m", SIDEWAYS, last)
        yield Number("displacement in the end", "m", DISPLACEMENT, last)
    elif features.UNILATERAL in scene_features:
        yield Number("openings", "1", PRESSURE, openings)
        if scene.block.velocity or scene.contact.gap:
            yield Number("height of the first rebound", "m", DISPLACEMENT, rebound)
        yield Number("largest contact pressure", "Pa", PRESSURE, lambda t, x: float(np.max(x)))
    else:
        yield Number("frequency", "Hz", DISPLACEMENT, lambda t, x: _pole(t, x)[0])
        yield Number("damping ratio", "1", DISPLACEMENT, lambda t, x: _pole(t, x)[1])
        yield Number("displacement in the end", "m", DISPLACEMENT, last)


def last(time: Array, x: Array) -> float:
    """Return the value at the last judged step."""
    return float(x[-1])


def openings(time: Array, x: Array) -> float:
    """Return how often the contact is open at a step after a step at which it was closed."""
    closed = x > TRACE * np.max(x, initial=0.0)
    return float(np.sum(closed[:-1] & ~closed[1:]))


def rebound(time: Array, x: Array) -> float | None:
    """Return the rise from the lowest point of the first landing to the height of the bounce after it [m]."""
    rises = np.diff(x) >= 0
    turns = np.flatnonzero(rises[1:] != rises[:-1]) + 1
    turns = turns[np.sum(rises[:1]) :]  # from the first lowest point on
    return float(x[turns[1]] - x[turns[0]]) if len(turns) > 1 else None


def arrival(time: Array, x: Array) -> float | None:
    """Return when a column first moves by a tenth of its largest value [s], between steps by a straight line."""
    return _reached(time, np.abs(x), ARRIVAL * largest(x))


def _landing(scene: Scene) -> Callable[[Array, Array], float | None]:
    """Return the function that finds when the block has turned back by its tilt [s], the last steps drawn on."""
    tilt = abs(math.radians(scene.block.tilt))

    def landing(time: Array, x: Array) -> float | None:
        turned = np.abs(x)
        landed = _reached(time, turned, tilt)
        rate = turned[-1] - turned[-2]
        if landed is not None or rate <= 0:
            return landed
        ahead = (tilt - turned[-1]) / rate  # in steps: near the landing the rate is nearly constant
        return float(time[-1] + ahead * (time[-1] - time[-2])) if ahead <= MOST else None

    return landing


def _reached(time: Array, x: Array, level: float) -> float | None:
    """Return when values that are zero at t = 0 first reach a level [s], between steps by a straight line."""
    rows = np.flatnonzero(x >= level)
    if level <= 0 or not len(rows):
        return None
    around = slice(rows[0], rows[0] + 2)  # of the rows with that of t = 0: the one before and the first that reaches it
    return float(np.interp(level, np.append(0.0, x)[around], np.append(0.0, time)[around]))


def _pole(time: Array, x: Array) -> tuple[float | None, float | None]:
    """Return frequency [Hz] and damping ratio [1] of the strongest oscillation, None where there is none."""
    middle = float(np.mean(x))
    strongest = poles(x / middle - 1, float(time[0])) if middle else []
    return (strongest[0].frequency / (2 * math.pi), strongest[0].damping) if strongest else (None, None)
