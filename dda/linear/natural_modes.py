"""Natural modes to full relative accuracy, however widely their frequencies are spread."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

from dda.model.arrays import Array, ArrayPair

_SWEEPS = 40  # Jacobi's method converges quadratically: six unknowns take about five


def graded_modes(M: Array, K: Array) -> ArrayPair:
    """Return the frequencies w and mass-normalised shapes of K phi = w^2 M phi, K a positive diagonal.

    With a diagonal K the problem is that of G = K^-1/2 M K^-1/2, whose eigenvalues are 1 / w^2.
    Jacobi's rotations find each of them, and each component of the shapes, to full relative
    accuracy where they span thirty decades; a general eigenvalue solver keeps the digits of the
    largest one only.
    """
    root = np.sqrt(K)
    values, vectors = _jacobi(M / root / root[:, None])
    return 1 / np.sqrt(values), vectors / root[:, None] / np.sqrt(values)


def free_modes(M: Array, K: Array) -> ArrayPair:
    """Return w^2 and mass-normalised shapes, one a column, of a body that nothing holds: strains, then rigid motions.

    The stiffness K is a diagonal, (n,), zero of rigid motions, whose w^2 is exactly zero.
    """
    rigid = K == 0
    strained = ~rigid
    count = np.count_nonzero(strained)
    soft = M[rigid][:, rigid]
    follow = -np.linalg.solve(soft, M[rigid][:, strained])  # rigid motion that keeps strains free of momentum
    inertia = M[strained][:, strained] + M[strained][:, rigid] @ follow
    frequencies, strains = graded_modes((inertia + inertia.T) / 2, K[strained])
    shapes = np.zeros(M.shape)
    shapes[strained, :count] = strains
    shapes[rigid, :count] = follow @ strains
    shapes[rigid, count:] = np.linalg.inv(np.linalg.cholesky(soft)).T
    return np.concatenate([frequencies**2, np.zeros(len(K) - count)]), shapes


def _jacobi(matrix: Array) -> ArrayPair:
    """Return eigenvalues and eigenvectors of a positive definite matrix by cyclic rotations."""
    A = matrix.copy()
    V = np.eye(len(A))
    pairs = list(combinations(range(len(A)), 2))
    for _ in range(_SWEEPS):
        off = [(i, j) for i, j in pairs if abs(A[i, j]) > 1e-17 * math.sqrt(A[i, i] * A[j, j])]
        for i, j in off:
            _rotate(A, V, i, j)
        if not off:
            break
    return np.diag(A), V


def _rotate(A: Array, V: Array, i: int, j: int) -> None:
    """Annihilate A[i, j] by a plane rotation in place and gather it in the columns of V."""
    across = A[i, j]
    if across == 0:
        return
    theta = (A[j, j] - A[i, i]) / (2 * across)
    t = math.copysign(1.0, theta) / (abs(theta) + math.hypot(1.0, theta))
    c = 1 / math.hypot(1.0, t)
    s = t * c
    diagonal = A[i, i] - t * across, A[j, j] + t * across
    for B in (A, A.T, V):
        first = B[:, i].copy()
        B[:, i] = c * first - s * B[:, j]
        B[:, j] = s * first + c * B[:, j]
    A[i, i], A[j, j] = diagonal
    A[i, j] = A[j, i] = 0.0
