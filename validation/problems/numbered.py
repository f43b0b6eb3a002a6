"""Numbers that an answer is judged by where no single motion is the right one: exact values, and the bands around them.

The bands are what one per cent of a datum changes, for the reason of `validation.problems.bands`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

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

    def allowed(self, value: float) -> float:
        """Return the error that is allowed on the side of a value, as a share of the scale."""
        above = value > self.exact or self.low == self.exact
        return (self.high - self.exact if above else self.exact - self.low) / self.scale


def around(name: str, unit: str, exact: float, changed: Sequence[float], reason: str, **others: Any) -> JudgedNumber:
    """Return a number whose band reaches as far to both sides as changed data move it, told as a share of itself."""
    half = max(abs(value - exact) for value in changed)
    band = {"low": exact - half, "high": exact + half, "scale": abs(exact)}
    return JudgedNumber(name, unit, exact, reason=reason, **{**band, **others})
