"""Modes of a bar on a spring: wave numbers, shares in a history and the smooth end of a sum over them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import erfc

from fem_reference.problem.problem import Array


def wave_numbers(kappa: float, count: int) -> Array:
    """The lowest positive roots of b tan b = kappa, shape (count,).

    On each branch b = n pi + theta, 0 < theta < pi / 2, Newton's method on
    theta - atan(kappa / (n pi + theta)), which increases, kept inside its bracket by bisection.
    """
    turn = np.pi * np.arange(count)
    low = np.zeros(count)
    high = np.full(count, np.pi / 2)
    theta = np.minimum(np.pi / 4, np.sqrt(kappa)) * np.ones(count)
    for _ in range(60):
        b = turn + theta
        miss = theta - np.arctan2(kappa, b)
        low = np.where(miss < 0, theta, low)
        high = np.where(miss >= 0, theta, high)
        slope = 1 + kappa / (b * b + kappa * kappa) if kappa < 1 else 1 + 1 / (b * b / kappa + kappa)
        proposed = theta - miss / slope
        inside = (proposed >= low) & (proposed <= high)  # with its ends, one of which is theta: it may have settled
        following = np.where(inside, proposed, (low + high) / 2)
        settled = np.all(np.abs(following - theta) <= 2 * np.finfo(float).eps * theta)
        theta = following
        if settled:
            break
    roots: Array = turn + theta
    return roots


def shares(column: str, b: Array, kappa: float) -> Array:
    """Share of each mode in a static value; the shares of all modes sum to one.

    ``"contact_pressure"``: (-1)^n 2 kappa / (b sqrt(b^2 + kappa^2) m), ``"displacement"`` (centroid):
    2 cos(b / 2) / (b^2 m (1 / kappa + 1/2)), ``"load"`` (top edge): 2 / (b^2 m (1 / kappa + 1)), with
    m = 1 + kappa / (b^2 + kappa^2).
    """
    radius = np.hypot(b, kappa)
    m = 1 + (kappa / radius) / radius
    if column == "contact_pressure":
        sign = np.where(np.arange(len(b)) % 2 == 0, 1.0, -1.0)
        return sign * 2 / b * (kappa / radius) / m
    if column == "displacement":
        return 2 * np.cos(b / 2) / b * (kappa / b) / (m * (1 + kappa / 2))
    if column == "load":
        return 2 / b * (kappa / b) / (m * (1 + kappa))
    return np.zeros_like(b)


def cut_off(size: int, count: int) -> NDArray[np.float64]:
    """Smooth factors that end a sum over `size` modes at `count`: one to rounding, then zero."""
    position = np.arange(size) / count
    window: NDArray[np.float64] = 0.5 * erfc(12 * (position - 0.5))
    window[position >= 1] = 0.0
    return window
