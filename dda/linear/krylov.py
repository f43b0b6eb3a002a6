r"""Response of a system of blocks to a steady vibration, without a step.

With the static response z0 to the load, (K - W2) z = F is (1 - W2 H) z = z0, H = K^-1. Lanczos' recursion on H
from z0 makes orthonormal vectors with V' H V = T, tridiagonal, and

    z = V y,      (1 - W2 T) y = |z0| e_1,      remainder  -W2 beta y_m times the next vector,

for every frequency at once. K^-1 is applied to blocks and joint forces together, so that stiff joints cost no digits,
and every vector carries what is observed of it, forces included. A few blocks, a chain of them, and frequencies that a
space of `LARGEST` vectors does not resolve or whose wave has decayed to the rounding of its sum, are solved one by one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dda.linear.elimination import Elimination
from dda.model.arrays import Array, ArrayPair
from dda.scheme.harmonic import Complex

LARGEST = 600  # vectors
AT_A_TIME = 16  # vectors between two looks at the remainder
RESOLVED = 1e-13  # remainder over the static and over the actual response
ROUNDING = 1e-8  # of a sum over the vectors, over the sum
CLOSED = 1e-15  # share of a new vector outside the space, over the largest, below which it is rounding


class _Space:
    """The vectors of the recursion, each with what is observed of it behind its modes."""

    def __init__(self, equations: Any, rows: ArrayPair, static: ArrayPair) -> None:
        """Begin with the static response (modes, joint forces)."""
        self.equations = equations
        self.rows = rows
        self.modes = len(equations.k)
        self.still = 0 * static[1]
        first = self.observed(*static)
        self.size = np.linalg.norm(static[0])
        self.vectors = np.empty((min(LARGEST, self.modes) + 1, len(first)))
        self.vectors[0] = first / self.size if self.size > 0 else 0.0
        self.diagonal: list[float] = []
        self.beside: list[float] = []
        self.closed = self.size == 0

    def observed(self, z: Array, force: Array) -> Array:
        """Return modes, and what is observed of them and of the joint forces."""
        return np.concatenate([z, self.rows[0] @ z + self.rows[1] @ force])

    def grow(self) -> None:
        """Add a vector."""
        n = self.modes
        j = len(self.diagonal)
        earlier = self.vectors[: j + 1]
        vector = self.observed(*self.equations.at_rest(earlier[j, :n], self.still))
        inside = 0.0
        for _ in range(2):  # twice is enough
            part = earlier[:, :n] @ vector[:n]
            vector = vector - part @ earlier
            inside += part[j]
        size = float(np.linalg.norm(vector[:n]))
        self.diagonal.append(inside)
        self.beside.append(size)
        self.closed = size <= CLOSED * max(self.diagonal) or j + 1 == n
        if not self.closed:
            self.vectors[j + 1] = vector / size

    def grown(self, W2: Complex) -> tuple[Complex, NDArray[np.bool_]]:
        """Grow until every frequency is resolved, or the space is closed or as large as allowed; answer."""
        while True:
            for _ in range(AT_A_TIME):
                if not self.closed and len(self.diagonal) < LARGEST:
                    self.grow()
            amplitudes, resolved, lost = self.answer(W2)
            if self.closed or np.all(resolved) or len(self.diagonal) >= LARGEST:
                return amplitudes, resolved & ~lost

    def answer(self, W2: Complex) -> tuple[Complex, NDArray[np.bool_], NDArray[np.bool_]]:
        """Return the observed amplitudes, (rows, frequencies), which are resolved, and which are rounding."""
        from scipy.linalg import eigh_tridiagonal

        m = len(self.diagonal)
        values, turned = eigh_tridiagonal(self.diagonal, self.beside[: m - 1])
        y = self.size * turned[0][:, None] / (1 - values[:, None] * W2)  # in the eigenvectors of T
        last = np.abs(turned[-1] @ y)
        residual = 0.0 if self.closed else np.abs(W2) * self.beside[-1] * last
        small = RESOLVED * np.minimum(self.size, np.sqrt(np.sum(np.abs(y) ** 2, axis=0)))
        rows = self.vectors[:m, self.modes :].T @ turned
        amplitudes = rows @ y
        terms = np.abs(rows) @ np.abs(y)
        lost = np.any(np.finfo(float).eps * terms > ROUNDING * np.abs(amplitudes), axis=0)
        return amplitudes, residual <= small, lost


def amplitudes(equations: Any, rows: ArrayPair, F: Array, g: Array, W2: Complex) -> Complex:
    """Return what rows of z and of lambda observe where (K - W2) z = F, (rows, frequencies).

    The equations are the `Equations` of `dda.bodies.block_system`, with B z - C lambda = g.
    """
    from scipy.sparse import diags_array

    observed = np.zeros((len(rows[0]), len(W2)), complex)
    resolved = np.zeros(len(W2), bool)
    inertia = diags_array(np.repeat([1 / equations.scale, 0.0], [len(F), len(g)]), format="csr")
    elimination = Elimination(equations.saddle, inertia, 0 * inertia)
    if not elimination.narrow:
        observed, resolved = _Space(equations, rows, equations.at_rest(F, g)).grown(W2)
    right = np.concatenate([F / equations.scale, g])
    by_both = np.hstack([rows[0], equations.scale * rows[1]])
    for i in np.flatnonzero(~resolved):
        solution = elimination.solve(right, complex(W2[i]))
        observed[:, i] = by_both @ solution if np.isfinite(solution).all() else np.inf
    return observed
