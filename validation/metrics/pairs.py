"""Metrics between a run and its reference, on their common steps."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from validation.metrics.values import NOT_REPORTED, QUANTITIES, as_number, finite, largest, norm, quotient
from validation.runs.history import Array, ArrayPair, History
from validation.runs.row import Metrics, Value


@dataclass(frozen=True)
class Pairing:
    """A run and what it is compared with."""

    history: History
    reference: History
    metrics: Metrics = field(default_factory=dict)  # of the run, for its static values

    def columns(self, name: str) -> ArrayPair | None:
        """Return a column of both on their common steps, None where one lacks it."""
        if name not in self.history.columns or name not in self.reference.columns:
            return None
        n = min(len(self.history.time), len(self.reference.time))
        return self.history.columns[name][:n], self.reference.columns[name][:n]


def relative_l2(value: Array, reference: Array) -> Value:
    """||value - reference|| / ||reference|| over the history."""
    return quotient(norm(value - reference), norm(reference))


def relative_max(value: Array, reference: Array) -> Value:
    """Maximum of |value - reference| over maximum of |reference|, over the history."""
    return quotient(largest(value - reference), largest(reference))


def compared(p: Pairing, quantity: str, part: str) -> Value:
    """Return the error of a column over the reference, its root mean square ("l2") or its maximum."""
    both = p.columns(QUANTITIES[quantity])
    if both is None:
        return NOT_REPORTED
    with np.errstate(all="ignore"):
        return finite((relative_l2 if part == "l2" else relative_max)(*both))


def scaled(p: Pairing, quantity: str) -> Value:
    """Maximum error over the larger of the reference's maximum and the run's static value.

    A wave that has not arrived leaves nothing to divide by.
    """
    static = p.metrics.get(f"{quantity}.static")
    both = p.columns(QUANTITIES[quantity])
    if not isinstance(static, float) or both is None:
        return NOT_REPORTED
    value, exact = both
    with np.errstate(all="ignore"):
        return finite(quotient(largest(value - exact), max(largest(exact), abs(static))))


def worst(p: Pairing) -> Value:
    """The larger of the maximum errors of displacement and pressure."""
    both = [compared(p, name, "max") for name in ("displacement", "pressure")]
    return next((value for value in both if not isinstance(value, float)), max(both, key=as_number))
