"""Any M D'' + K D = F in sixty-digit arithmetic, the doubles of its matrices taken as exact."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from flint import arb, arb_mat
from scipy.sparse import csr_array

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.solvers.sixty_digits.block import WORKING, Equations, digits, responses


def history(
    scene: Scene, M: csr_array, K: csr_array, F: Array, rows: Mapping[str, Array], pressure: float
) -> dict[str, list[arb]]:
    """Return the observed columns of every step, the load F (of 1 Pa) times the pressure."""
    with digits(WORKING):
        exact_M, exact_K = (arb_mat(np.asarray(matrix.toarray()).tolist()) for matrix in (M, K))
        load = [arb(pressure) * value for value in F.tolist()]
        observed = {name: [arb(value) for value in row.tolist()] for name, row in rows.items()}
        return responses(Equations(exact_M, exact_K, load, observed), scene, tuple(rows))
