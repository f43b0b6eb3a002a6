"""Values of metrics: numbers, or the words for what has no number; norms and ratios without overflow."""

from __future__ import annotations

import math

import numpy as np

from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.row import Value

UNDEFINED = "undefined"  # it has no meaning here
NOT_REPORTED = "not reported"  # the solver does not give it
ALIAS = "alias"  # a frequency beyond pi / dt, of which samples every dt show another
QUANTITIES = {
    "displacement": DISPLACEMENT,
    "pressure": PRESSURE,
    "horizontal": "horizontal_displacement",
    "rotation": "rotation",
}


def largest(x: Array) -> float:
    """Maximum of |x|."""
    return float(np.max(np.abs(x), initial=0.0))


def norm(x: Array) -> float:
    """Euclidean norm, scaled so that neither 1e300 overflows nor 1e-300 vanishes."""
    top = largest(x)
    return 0.0 if top == 0 else top * float(np.linalg.norm(x / top))


def quotient(error: float, size: float) -> Value:
    """Relative error; undefined for a zero or non-finite signal."""
    if size == 0 or not math.isfinite(size) or not math.isfinite(error):
        return UNDEFINED
    return error / size


def ratio(value: Value, reference: Value) -> Value:
    """Return value / reference - 1 for two metrics of single runs."""
    for part in (value, reference):
        if not isinstance(part, float | int):
            return part
    return quotient(float(value) - float(reference), float(reference))  # type: ignore[arg-type]


def finite(value: Value) -> Value:
    """Replace what is not a finite number by its name."""
    return value if not isinstance(value, float) or math.isfinite(value) else UNDEFINED


def or_nan(value: Value) -> float:
    """Return a number, NaN for what is none."""
    return value if isinstance(value, float) else math.nan


def as_number(value: Value) -> float:
    """Return a number, infinity for what is none."""
    return float(value) if isinstance(value, float) else math.inf
