"""One frequency at a time: an elimination for its amplitudes, and the highest natural frequency."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from dda.model.arrays import Array
from dda.scheme.harmonic import Complex

if TYPE_CHECKING:
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import LinearOperator

DENSE = 300  # unknowns up to which frequencies are found by a dense solver
BAND = 2e5  # unknowns times the square of their band's width up to which every frequency is solved by itself


class Elimination:
    """(K + S C - W2 M) D = F at one frequency, solved by an elimination of its own, in moduli near one.

    A chain of blocks is a narrow band: its elimination costs little, and keeps the digits of a wave that has decayed.
    """

    def __init__(self, K: csr_array, M: csr_array, C: csr_array) -> None:
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        pattern = abs(K) + abs(M) + abs(C)
        self.order = reverse_cuthill_mckee((pattern + pattern.T).tocsr(), symmetric_mode=True)
        self.K = K[self.order][:, self.order]
        self.M = M[self.order][:, self.order]
        self.C = C[self.order][:, self.order]
        places = pattern[self.order][:, self.order].tocoo()
        self.width = int(np.max(np.abs(places.row - places.col), initial=0))

    @property
    def narrow(self) -> bool:
        """Whether eliminating the band costs less than a small space does."""
        return len(self.order) * self.width**2 <= BAND

    def solve(self, right: Array | Complex, W2: complex, S: complex = 0.0) -> Complex:
        """Return D, infinite at a resonance that nothing damps."""
        from scipy.linalg import solve_banded
        from scipy.sparse.linalg import splu

        matrix: Any = self.K + S * self.C - W2 * self.M
        ordered = right[self.order].astype(complex)
        values: Complex = np.empty_like(ordered)
        try:
            if not self.narrow:
                values[self.order] = splu(matrix.tocsc()).solve(ordered)
                return values
            entries = matrix.tocoo()
            band = np.zeros((2 * self.width + 1, len(values)), complex)
            band[self.width + entries.row - entries.col, entries.col] = entries.data
            values[self.order] = solve_banded((self.width, self.width), band, ordered, check_finite=False)
        except (np.linalg.LinAlgError, RuntimeError):
            values[:] = np.inf
        return values


def largest_frequency(stiffness: csr_array | LinearOperator) -> float:
    """Return the largest w of K phi = w^2 phi [rad/s], 0 where nothing moves; OverflowError beyond double precision."""
    from scipy.linalg import eigvalsh
    from scipy.sparse.linalg import eigsh

    n = stiffness.shape[0]
    if n == 0:
        return 0.0
    start = np.random.default_rng(0).standard_normal(n)
    if not np.isfinite(stiffness @ start).all():
        raise OverflowError("stiffness is out of range")
    if n <= DENSE:
        squares = eigvalsh(stiffness @ np.eye(n), subset_by_index=[n - 1, n - 1])
    else:
        squares = eigsh(stiffness, 1, which="LA", v0=start, return_eigenvectors=False)
    return math.sqrt(max(float(squares[0]), 0.0))
