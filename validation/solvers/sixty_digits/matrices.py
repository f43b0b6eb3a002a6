"""Any M D'' + K D = F in sixty-digit arithmetic, the doubles of its matrices taken as exact."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from mpmath import mp, mpf
from scipy.sparse import csr_array

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.solvers.sixty_digits.block import WORKING, Equations, Number, responses


def history(
    scene: Scene, M: csr_array, K: csr_array, F: Array, rows: Mapping[str, Array], pressure: float
) -> dict[str, list[Number]]:
    """Return the observed columns of every step, the load F (of 1 Pa) times the pressure, mode by mode."""
    with mp.workdps(WORKING):
        exact_M, exact_K = (mp.matrix(np.asarray(matrix.toarray()).tolist()) for matrix in (M, K))
        load = [mpf(pressure) * mpf(float(value)) for value in F]
        observed = {name: [mpf(float(value)) for value in row] for name, row in rows.items()}
        return responses(Equations(exact_M, exact_K, load, observed), scene, tuple(rows))
