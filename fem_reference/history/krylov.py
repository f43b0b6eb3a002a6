r"""A small space that holds the response of the block: Krylov vectors of the step's own matrix.

Every displacement that the scheme makes from rest is a polynomial in S^-1 M times S^-1 F, with the
S = M + alpha dt^2 K that a step factorises anyway. Lanczos' recursion, with the inner product of S and
full reorthogonalisation, gives vectors V with

    V' S V = 1,      V' M V = T (tridiagonal),      V' F = |F| e_1,

so that alpha dt^2 V' K V = 1 - T without ever multiplying by a stiff spring. The first steps, as many
as there are vectors, are exact; the later ones as soon as the fast waves are resolved or damped.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from fem_reference.problem.problem import Array

CLOSED = 1e-14
"""Share of a new vector outside the space below which the space is closed."""


class KrylovSpace:
    """The space, grown vector by vector."""

    def __init__(self, M: csr_array, S: csr_array, F: Array, solve: Callable[[Array], Array], capacity: int) -> None:
        self._M = M
        self._S = S
        self._solve = solve
        first = solve(F)
        self.load = float(np.sqrt(first @ F))
        """V' F, all along the first vector."""
        self.vectors = np.empty((capacity + 1, len(F)))
        """Vectors, one a row."""
        self.vectors[0] = first / self.load
        self.diagonal: list[float] = []
        """Diagonal of T."""
        self.beside: list[float] = []
        """T next to its diagonal; the last entry leads out of the space."""
        self.closed = False
        """Whether the space holds the response exactly."""

    def __len__(self) -> int:
        return len(self.diagonal)

    def grow(self, size: int) -> None:
        """Add vectors until there are `size`, or the space is closed."""
        while len(self) < size and not self.closed:
            j = len(self)
            V = self.vectors[: j + 1]
            v = self.vectors[j]
            Mv = self._M @ v
            w = self._solve(Mv)
            self.diagonal.append(float(v @ Mv))
            w -= self.diagonal[-1] * v
            if j:
                w -= self.beside[-1] * V[j - 1]
            Sw = self._S @ w
            outside = V @ Sw
            remainder = float(np.sqrt(max(w @ Sw - outside @ outside, 0.0)))
            w -= outside @ V
            self.closed = remainder <= CLOSED or j + 1 == len(v)
            self.beside.append(remainder)
            if not self.closed:
                self.vectors[j + 1] = w / remainder
