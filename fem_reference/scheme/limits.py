"""The stability limit of a scheme: Newmark's from the trace and determinant of one step, others' from their roots."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from fem_reference.problem.problem import Scheme
from fem_reference.scheme.staged import FASTEST, SLACK, radii, step_matrices

SCANNED = np.geomspace(1e-2, FASTEST, 5000)
"""w dt among which the first that grows is looked for."""
BISECTIONS = 60
"""Halvings of the interval in which a complex pair reaches the unit circle."""


def stability_limit(scheme: Scheme) -> float:
    """Return the w dt beyond which a mode of a scheme of any name grows; infinite where none does."""
    if scheme.table is None:
        return critical_omega(scheme.alpha, scheme.delta, scheme.gg)
    grows = radii(SCANNED, scheme) > 1 + SLACK
    if not grows.any():
        return math.inf
    first = int(np.argmax(grows))
    low = float(SCANNED[first - 1]) if first else 0.0
    high = float(SCANNED[first])

    def at_minus_one(omega: float) -> float:
        """Characteristic polynomial at -1."""
        return float(np.linalg.det(2 * np.eye(3) + step_matrices(np.array([omega]), scheme)[0]))

    if first and at_minus_one(low) * at_minus_one(high) <= 0:
        return float(brentq(at_minus_one, low, high, xtol=1e-15, rtol=4 * np.finfo(float).eps))
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if radii(np.array([middle]), scheme)[0] > 1 + SLACK:
            high = middle
        else:
            low = middle
    return high


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
