"""What the gates of the studies share: the cases that they judge, and bands about a value."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from validation.gates.gate import Gate
from validation.metrics.catalogue import pair
from validation.metrics.values import or_nan
from validation.runs.history import History
from validation.runs.numbers import significant
from validation.runs.row import Metrics
from validation.scenes.scene import Scene, load_scene

Band = tuple[float, float]
"""Lower and upper edge."""
Bands = dict[str, Band]
"""Bands by metric."""
Runs = Sequence[tuple[Scene, History]]
"""Cases of a scene, each with the history of a solver: what a row of a sweep is computed from."""
OTHER = "other code"  # the kind of a reference that an independent program computed
APART = 1e-17  # two programs never agree to the last bit: a smaller difference is a run compared with itself


def cases(*names: str) -> Iterator[Scene]:
    """Yield the single cases of built-in scenes."""
    for name in names:
        yield from _expanded(name)


@cache
def _expanded(name: str) -> tuple[Scene, ...]:
    return load_scene(name).expand()


def about(value: float, half: float) -> Band:
    """Band of a half width about a value."""
    return value - half, value + half


def near(value: float, relative: float) -> Band:
    """Band of a relative half width about a value."""
    return about(value, abs(value) * relative)


def fitted_order(sizes: ArrayLike, errors: ArrayLike) -> float:
    """Return the signed order fitted on all levels of a refinement: error = C size^order."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def short(values: ArrayLike, digits: int = 5) -> list[float]:
    """Return the numbers of a curve, to some digits."""
    return [significant(value, digits) for value in np.asarray(values)]


def convergence(
    runs: Sequence[tuple[Scene, History, History]],
    key: str = "time.step",
    quantities: tuple[str, ...] = ("displacement",),
) -> Metrics:
    """Return the order of one solver's error against another, of cases that are refined.

    A run is a case, the history that converges and that which it converges to; ``key`` is the swept value that is
    refined. The order of each quantity is fitted to its relative L2 error.
    """
    sizes = [operator.attrgetter(key)(case) for case, _, _ in runs]
    orders = {}
    for quantity in quantities:
        norms = [or_nan(pair(f"{quantity}.l2", history, exact)) for _, history, exact in runs]
        orders[quantity] = fitted_order(sizes, norms)
    return orders


def half_unit(printed: str | float) -> float:
    """Return half a unit of the last digit of a number as it was printed, a text; a number is exact."""
    if not isinstance(printed, str):
        return 0.0
    digits, _, exponent = printed.lower().partition("e")
    return 0.5 * 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


def gate(
    case: Scene | str,
    solvers: str | tuple[str, ...],
    metric: str,
    band: Band,
    reason: str,
    kind: str = "exact",
    uncertainty: float = 0.0,
    **window: Any,
) -> Gate:
    """Return a gate of a study: on a case or its name, of one solver or row, or of two that are compared.

    `window` holds further fields of the gate, such as `until`.
    """
    name = case if isinstance(case, str) else case.name
    names = (solvers,) if isinstance(solvers, str) else solvers
    return Gate(name, names, metric, *band, reason, kind, uncertainty, **window)
