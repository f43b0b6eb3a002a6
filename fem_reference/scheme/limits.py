"""The stability limit of Newmark's scheme, from the trace and determinant of one step."""

from __future__ import annotations

import math


def critical_omega(alpha: float, delta: float, gg: float = 1.0) -> float:
    """Return the w dt beyond which a mode grows; infinite where none does.

    With X = Omega^2 / (1 + alpha Omega^2) the roots of one step have the trace 1 + gg - X (1/2 + gg delta) and the
    determinant gg (1 + (1/2 - delta) X). One of them reaches -1 where 1 + trace + determinant vanishes; a complex pair
    reaches the unit circle where the determinant is one, for delta < 1/2 only.
    """
    at_minus_one = _positive(2 * (1 + gg), 0.5 + gg * (2 * delta - 0.5))
    on_circle = _positive(1 - gg, gg * (0.5 - delta))
    X = min(at_minus_one, on_circle)
    return math.inf if math.isinf(X) or alpha * X >= 1 else math.sqrt(X / (1 - alpha * X))


def _positive(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator > 0 else math.inf
