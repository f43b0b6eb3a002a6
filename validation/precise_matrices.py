"""Any M D'' + K D = F in sixty-digit arithmetic, the doubles of its matrices taken as exact."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from mpmath import mp, mpf
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from validation.history import Array
from validation.precise_block import WORKING, NewmarkNumbers, Number
from validation.scene import Scene

Sparse = list[dict[int, Number]]  # one dictionary column -> entry a row


def history(
    scene: Scene, M: csr_array, K: csr_array, F: Array, rows: Mapping[str, Array], pressure: float
) -> dict[str, list[Number]]:
    """Return the observed columns of every step, the load F (of 1 Pa) times the pressure.

    The step is solved for the displacement with S = M + alpha dt^2 K, factorised as L diag(d) L'.
    """
    order = reverse_cuthill_mckee(csr_array(abs(M) + abs(K)), symmetric_mode=True)
    with mp.workdps(WORKING):
        scheme, q = NewmarkNumbers.of(scene), mpf(pressure)
        exact_M, exact_K = (_exact(matrix[order][:, order]) for matrix in (M, K))
        load = [q * mpf(float(value)) for value in F[order]]
        observed = {name: _exact_row(row[order]) for name, row in rows.items()}
        columns: dict[str, list[Number]] = {name: [] for name in rows}
        for D in _displacements(exact_M, exact_K, load, scheme, scene.time.steps):
            for name, row in observed.items():
                columns[name].append(mp.fsum(value * D[i] for i, value in row.items()))
        return columns


def _exact(matrix: csr_array) -> Sparse:
    table = csr_array(matrix)
    return [_exact_row(table[[i]].toarray()[0]) for i in range(table.shape[0])]


def _exact_row(row: Array) -> dict[int, Number]:
    return {int(i): mpf(float(row[i])) for i in np.flatnonzero(row)}


def _displacements(M: Sparse, K: Sparse, F: list[Number], s: NewmarkNumbers, steps: int) -> Any:
    """Yield D of step 1 to the last, from rest."""
    dt, n = s.step, len(F)
    near = s.alpha * dt**2
    S = [{j: m.get(j, mpf(0)) + near * k.get(j, mpf(0)) for j in m | k} for m, k in zip(M, K, strict=True)]
    factor_S = _factorise(S)
    factor_M = _factorise(M) if s.consistent or s.alpha == 0 else None
    D, V = [mpf(0)] * n, [mpf(0)] * n
    A = _solve(factor_M, F) if s.consistent and factor_M else [mpf(0)] * n
    for _ in range(steps):
        ahead = [d + s.gg * dt * v + dt**2 * (mpf(1) / 2 - s.alpha) * a for d, v, a in zip(D, V, A, strict=True)]
        D = _solve(factor_S, [m + near * f for m, f in zip(_product(M, ahead), F, strict=True)])
        if s.alpha == 0 and factor_M:
            A1 = _solve(factor_M, [f - k for f, k in zip(F, _product(K, D), strict=True)])
        else:
            A1 = [(d - p) / near for d, p in zip(D, ahead, strict=True)]
        V = [s.gg * v + dt * ((1 - s.delta) * a + s.delta * b) for v, a, b in zip(V, A, A1, strict=True)]
        A = A1
        yield D


def _product(matrix: Sparse, x: list[Number]) -> list[Number]:
    return [mp.fsum(value * x[j] for j, value in row.items()) for row in matrix]


def _factorise(matrix: Sparse) -> tuple[Sparse, list[Number]]:
    """Return L without its unit diagonal, and d, of a symmetric positive definite matrix."""
    L: Sparse = []
    d: list[Number] = []
    for i, row in enumerate(matrix):
        work = {j: value for j, value in row.items() if j <= i}
        for j in range(min(work), i):
            # `work` holds L d of this row; the division by d follows.
            value = work.get(j, mpf(0)) - mp.fsum(entry * work[k] for k, entry in L[j].items() if k in work)
            if value or j in work:
                work[j] = value
        L.append({j: work[j] / d[j] for j in work if j < i})
        d.append(work[i] - mp.fsum(L[i][j] * work[j] for j in L[i]))
    return L, d


def _solve(factor: tuple[Sparse, list[Number]], right: list[Number]) -> list[Number]:
    """Return the solution of L diag(d) L' x = right."""
    L, d = factor
    x = list(right)
    for i, row in enumerate(L):
        x[i] -= mp.fsum(value * x[j] for j, value in row.items())
    x = [value / pivot for value, pivot in zip(x, d, strict=True)]
    for i in range(len(x) - 1, -1, -1):
        for j, value in L[i].items():
            x[j] -= value * x[i]
    return x
