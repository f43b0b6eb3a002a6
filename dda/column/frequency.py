"""The highest natural frequency of a column, which a conditionally stable scheme must resolve."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from dda.column.column import Column
from dda.column.equations import Bands, equations


def highest_frequency(column: Column) -> float:
    """Return the highest natural frequency [rad/s], on a base that is held.

    A half-space below is left out: it damps, and a spring to it joins what has no inertia.
    """
    from scipy.linalg import eigh

    system = equations(replace(column, impedance=None))
    M, K = (_dense(Bands(matrix.rows[:, 1:])) for matrix in (system.M, system.K))
    last = len(M) - 1
    return math.sqrt(float(eigh(K, M, eigvals_only=True, subset_by_index=[last, last])[0]))


def _dense(matrix: Bands) -> np.ndarray:
    n = matrix.rows.shape[1]
    return np.column_stack([matrix @ unit for unit in np.eye(n)])
