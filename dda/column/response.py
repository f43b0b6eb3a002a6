r"""Response of a column to a steady vibration, without a step, and its highest natural frequency.

With V = S D and A = -W2 D of one frequency (`dda.scheme.harmonic`) the equations are (K + S C - W2 M) D = F, a band of
two diagonals on each side, which is eliminated for every frequency. A base that is told how to move is told its own
acceleration -w^2 y, whatever the scheme makes of the others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from dda.column.column import Column
from dda.column.equations import WIDTH, equations
from dda.column.stepping import DISPLACEMENT, PRESSURE, Stepper, observers
from dda.scheme.harmonic import Complex, acceleration_share, chosen
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
    W2, S = chosen(scheme, frequencies, exact)
    accelerations = W2 if exact or not scheme.averages else W2 * acceleration_share(scheme, w)
    system = equations(column)
    step = Stepper(system, scheme)
    rows = observers(system, columns, ())
    drive = np.zeros((len(w), 4), complex)
    drive[:, :3] = np.stack([np.ones_like(w), 1j * w, -w * w], axis=1) if at == "base" else 0.0
    drive[:, 3] = at == "top"
    driven = drive @ step.told(rows).T
    by_D, by_V, by_A = (matrix[:, step.first :] for matrix in (rows.D, rows.V, rows.A))
    for i, (w2, s, a) in enumerate(zip(W2, S, accelerations, strict=True)):
        D = _solved(step.K.rows + s * step.C.rows - w2 * step.M.rows, step.push @ drive[i])
        driven[i] += by_D @ D + s * (by_V @ D) - a * (by_A @ D)
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
    """Return the highest natural frequency [rad/s] with all springs closed, which limits an explicit scheme.

    Rigid contacts that may open or slip are left out: they only lower it. So is the dashpot of a half-space, which
    leaves the foot of a column free.

    Raises
    ------
    OverflowError
        If mass or stiffness leave the range of double precision.
    """
    from scipy.linalg import eigh

    feet, tops = _faces(column)
    rigid = np.isinf(column.moduli)
    mass = (column.densities * column.heights)[:, None] / 6
    stiffness = np.where(rigid, 0.0, column.moduli)[:, None] / column.heights[:, None]
    springs = [0.0 if spring is None or math.isinf(spring) else spring for spring in column.springs]
    stretches = tops - feet
    openings = feet.copy()
    openings[1:] -= tops[:-1]
    M = feet.T @ (mass * (2 * feet + tops)) + tops.T @ (mass * (feet + 2 * tops))
    K = stretches.T @ (stiffness * stretches) + openings.T @ (np.array(springs)[:, None] * openings)
    last = len(M) - 1
    if last < 0:  # nothing moves
        return 0.0
    if not (np.isfinite(M).all() and np.isfinite(K).all()):
        raise OverflowError("mass or stiffness of the column is out of range")
    return math.sqrt(max(float(eigh(K, M, eigvals_only=True, subset_by_index=[last, last])[0]), 0.0))


def _faces(column: Column) -> tuple[np.ndarray, np.ndarray]:
    """Return the displacements of the feet and of the tops of all blocks by those that are free, (blocks, unknowns)."""
    held = column.rests_on_base
    count = 0
    numbers: list[tuple[int, int]] = []  # of the unknowns of foot and top; -1 is held
    for block, spring in enumerate(column.springs):
        if spring is not None or (block == 0 and not held):
            foot = count
            count += 1
        else:
            foot = numbers[-1][1] if numbers else -1
        top = foot
        if math.isfinite(column.moduli[block]):
            top = count
            count += 1
        numbers.append((foot, top))
    unknowns = np.vstack([np.eye(count), np.zeros((1, count))])  # the last row is that of what is held
    feet, tops = np.array(numbers).T
    return unknowns[feet], unknowns[tops]
