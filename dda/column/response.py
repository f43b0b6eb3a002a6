r"""Response of a column to a steady vibration, without a step, and its highest natural frequency.

With V = S D and A = -W2 D of one frequency (`dda.scheme.harmonic`) the equations are (K + S C - W2 M) D = F, a band of
two diagonals on each side, which is eliminated for every frequency. A base that is told how to move is told its own
acceleration -w^2 y, whatever the scheme makes of the others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from dda.column.column import Column
from dda.column.equations import WIDTH, Bands, equations
from dda.column.stepping import DISPLACEMENT, PRESSURE, Stepper, observers
from dda.scheme.harmonic import Complex, chosen, velocity_factor
from dda.scheme.newmark import Scheme

Driven = Literal["base", "top"]


def column_response(
    column: Column,
    scheme: Scheme,
    frequencies: ArrayLike,
    at: Driven,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    exact: bool = False,
) -> dict[str, Complex]:
    """Return the complex amplitudes of columns of a history.

    Parameters
    ----------
    frequencies : (n,) array_like
        Of the drive [Hz].
    at : str
        ``base``: per metre of the base's displacement, or above a half-space of that of the wave that comes up;
        ``top``: per pascal of pressure on the top.
    exact : bool
        As the system that is exact in time answers.

    Raises
    ------
    ValueError
        If gg = 0 has no limit that is exact in time.
    """
    w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    W2, S = chosen(scheme, frequencies, exact), 1j * w if exact else velocity_factor(scheme, w)
    system = equations(column)
    step, rows = Stepper(system, scheme), observers(system, columns, ())
    drive = np.zeros((len(w), 4), complex)
    drive[:, :3] = np.stack([np.ones_like(w), 1j * w, -w * w], axis=1) if at == "base" else 0.0
    drive[:, 3] = at == "top"
    driven = drive @ step.told(rows).T
    by_D, by_V, by_A = (matrix[:, step.first :] for matrix in (rows.D, rows.V, rows.A))
    for i, (w2, s) in enumerate(zip(np.atleast_1d(W2), S, strict=True)):
        D = _solved(step.K.rows + s * step.C.rows - w2 * step.M.rows, step.push @ drive[i])
        driven[i] += by_D @ D + s * (by_V @ D) - w2 * (by_A @ D)
    return dict(zip(columns, driven.T, strict=True))


def _solved(lower: Complex, right: Complex) -> Complex:
    """Solve a symmetric band that is given by its lower diagonals; infinite at a resonance that nothing damps."""
    from scipy.linalg import solve_banded

    n = len(right)
    if n == 1 and lower[0, 0] != 0:  # older SciPy divide by a diagonal beside the main one
        return np.asarray(right / lower[0, 0])
    band = np.zeros((2 * WIDTH + 1, n), complex)
    for offset, diagonal in enumerate(lower[:, :n]):
        band[WIDTH + offset, : n - offset] = diagonal[: n - offset]
        band[WIDTH - offset, offset:] = diagonal[: n - offset]
    try:
        return np.asarray(solve_banded((WIDTH, WIDTH), band, right, check_finite=False))
    except np.linalg.LinAlgError:
        return np.full(n, np.inf, complex)


def highest_frequency(column: Column) -> float:
    """Return the highest natural frequency [rad/s], on a base that is held, which limits a conditionally stable scheme.

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
