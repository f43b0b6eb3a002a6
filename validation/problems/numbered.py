"""Numbers that an answer is judged by where no single motion is the right one: exact values, and the bands around them.

The bands are what one per cent of a datum changes, for the reason of `validation.problems.bands`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from validation.gates.gate import Status
from validation.runs.history import History

UNKNOWN = 0.01  # relative error of a datum that nobody knows better
ROUNDING = 1e-9  # relative, of an edge: what one per cent of a datum changes is inside


@dataclass(frozen=True)
class JudgedNumber:
    """A number of an answer."""

    name: str
    unit: str
    exact: float
    low: float  # edge of the band, inside, as the other one
    high: float
    scale: float  # what an error is told as a share of, in the number's unit
    reason: str  # why the band ends there
    measure: Callable[[History], float | None]  # function of the answer; None where it cannot be measured on it
    optional: bool = False  # whether an answer may do without it, since it is of a column beside the positions

    def passes(self, value: float) -> bool:
        """Whether a value is in the band."""
        margin = ROUNDING * max(abs(self.low), abs(self.high))
        return self.low - margin <= value <= self.high + margin


@dataclass(frozen=True)
class MeasuredNumber:
    """A number of an answer beside its exact value; None where it could not be measured."""

    quantity: JudgedNumber
    value: float | None
    is_reported: bool = True  # whether the columns are there that it is measured on

    @property
    def status(self) -> Status:
        """Whether it is in its band, or not reported; a number that the positions hold and do not give fails."""
        if not self.is_reported or (self.quantity.optional and self.value is None):
            return Status.NOT_REPORTED
        if self.value is None:
            return Status.FAIL
        return Status.PASS if self.quantity.passes(self.value) else Status.FAIL

    @property
    def shares(self) -> tuple[float | None, float]:
        """Error, None where it cannot be measured, and what is allowed on its side, as shares of the number's scale."""
        quantity = self.quantity
        above = self.value is None or self.value > quantity.exact or quantity.low == quantity.exact
        room = quantity.high - quantity.exact if above else quantity.exact - quantity.low
        error = None if self.value is None else abs(self.value - quantity.exact) / quantity.scale
        return error, room / quantity.scale


def measured(quantities: Sequence[JudgedNumber], history: History) -> tuple[MeasuredNumber, ...]:
    """Return the numbers of an answer."""
    values = []
    for quantity in quantities:
        try:
            value = quantity.measure(history)
        except KeyError:  # of a column that the answer withholds
            values.append(MeasuredNumber(quantity, None, is_reported=False))
            continue
        if value is not None and not math.isfinite(value):
            value = None
        values.append(MeasuredNumber(quantity, value))
    return tuple(values)


def around(name: str, unit: str, exact: float, changed: Sequence[float], reason: str, **others: Any) -> JudgedNumber:
    """Return a number whose band reaches as far to both sides as changed data move it, told as a share of itself."""
    half = max(abs(value - exact) for value in changed)
    band = {"low": exact - half, "high": exact + half, "scale": abs(exact)}
    return JudgedNumber(name, unit, exact, reason=reason, **{**band, **others})
