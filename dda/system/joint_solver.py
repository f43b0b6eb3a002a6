"""Sparse solvers of systems of blocks and joints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Array = NDArray[np.float64]


@dataclass
class Factor:
    """A factorised sparse symmetric matrix and its size."""

    solve: Callable[[Array], Array]
    nonzeros: int


def factor(matrix: csr_array, definite: bool = True) -> Factor:
    """Factorise a matrix; a definite one keeps its diagonal pivots and its symmetric fill-in."""
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    options: dict[str, Any] = {
        "permc_spec": "MMD_AT_PLUS_A",
        "diag_pivot_thresh": 0.0,
        "options": {"SymmetricMode": True},
    }
    lu = splu(csc_array(matrix), **(options if definite else {}))
    return Factor(lu.solve, int(matrix.nnz))


def saddle(Ke: csr_array, B: csr_array, C: csr_array, modulus: float) -> Callable[[Array, Array], tuple[Array, Array]]:
    """Return the solver of Ke D + B' lambda = F, B D - C lambda = g, in moduli near one.

    Parameters
    ----------
    modulus : float
        Size of the entries of Ke, by which forces are scaled.
    """
    from scipy.sparse import block_array

    lu = factor(block_array([[Ke / modulus, B.T], [B, -modulus * C]], format="csr"), definite=False)
    n = Ke.shape[0]

    def solve(F: Array, g: Array) -> tuple[Array, Array]:
        solution = lu.solve(np.concatenate([F / modulus, g]))
        return solution[:n], modulus * solution[n:]

    return solve
