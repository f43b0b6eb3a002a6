r"""Response of a column to a base or a pressure that vibrates, without a step.

With A = -W2 D and V = S D of the steps (`dda.scheme.harmonic`), (K + S C - W2 M) D = F at every frequency: three
diagonals on and below the main one, eliminated for all frequencies at once and corrected once. A base that is told,
or a wave that comes up, is the sampled motion e^{iwt} itself: its acceleration is -w^2 and its velocity iw.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from dda.column.column import Column
from dda.column.equations import WIDTH, equations
from dda.column.stepping import DISPLACEMENT, PRESSURE, observers
from dda.scheme.harmonic import Complex, chosen
from dda.scheme.newmark import Scheme


def velocity_factor(scheme: Scheme, omega: ArrayLike) -> Complex:
    """Return S = V / D of the stepped system [1/s]; it tends to iw as dt does to zero at gg = 1.

    The corrector (7) and the predictor (6) give V / D = (z - 1)(1 + delta (z - 1)) / (dt b), with
    b = gg (1 + delta (z - 1)) + (1/2 + alpha (z - 1)) (z - gg).
    """
    half = np.asarray(omega, float) * (scheme.step / 2)
    forward = 2j * np.sin(half) * np.exp(1j * half)
    below = scheme.gg * (1 + scheme.delta * forward) + (0.5 + scheme.alpha * forward) * (forward + (1 - scheme.gg))
    return np.asarray(forward * (1 + scheme.delta * forward) / (scheme.step * below))


def column_response(
    column: Column,
    scheme: Scheme,
    frequencies: ArrayLike,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
    base: bool = True,
    exact: bool = False,
) -> dict[str, Complex]:
    """Return the complex amplitudes of columns of a history.

    Parameters
    ----------
    frequencies : (n,) array_like
        In Hz, above zero.
    base : bool
        For 1 m of motion of the base, or of the wave that comes up; else for 1 Pa of pressure on the top.
    exact : bool
        As the blocks answer in continuous time.

    Raises
    ------
    ValueError
        If a height lies outside, or gg = 0 has no limit that is exact in time.
    """
    omega = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    squared = chosen(scheme, np.atleast_1d(np.asarray(frequencies, float)), exact)
    rate = np.asarray(1j * omega if exact else velocity_factor(scheme, omega))
    system = equations(column)
    rows = observers(system, columns, heights)
    first = int(system.told)
    drive = np.array([np.ones_like(rate), 1j * omega, -(omega**2), np.zeros_like(rate)]) * base
    drive[3] = 1.0 - base
    matrix = system.K.rows[:, first:, None] - squared * system.M.rows[:, first:, None]
    matrix[0, 0] += rate * system.dashpot
    unit = np.eye(1, system.size)[0]
    loads = np.zeros((system.size, len(omega)), complex)
    if system.told:
        loads -= np.outer(system.K @ unit, drive[0]) + np.outer(system.M @ unit, drive[2])
    else:
        loads[0] = 2 * system.dashpot * drive[1]
    loads[-1] -= drive[3]
    D = solve_bands(matrix, loads[first:])
    by_D, by_V, by_A = (part[:, first:] for part in (rows.D, rows.V, rows.A))
    found = by_D @ D + by_V @ (rate * D) - by_A @ (squared * D) + rows.drive @ drive
    if system.told:
        found += np.outer(rows.D[:, 0], drive[0]) + np.outer(rows.A[:, 0], drive[2])
    return dict(zip(columns, found, strict=True))


def solve_bands(matrix: Complex, right: Complex) -> Complex:
    """Return the solutions of symmetric systems by their diagonals, (3, n, m), for right-hand sides (n, m).

    Eliminated without pivots, since nearly every frequency is harmless, and corrected by one residual.
    """
    eliminated = _eliminated(matrix)
    found = _substituted(eliminated, right)
    return np.asarray(found + _substituted(eliminated, right - _product(matrix, found)))


def _product(matrix: Complex, x: Complex) -> Complex:
    """Return the products of symmetric matrices by their diagonals with vectors."""
    y = np.asarray(matrix[0] * x)
    for offset in range(1, WIDTH + 1):
        part = matrix[offset, : len(x) - offset]
        y[offset:] += part * x[: len(x) - offset]
        y[: len(x) - offset] += part * x[offset:]
    return y


def _eliminated(matrix: Complex) -> Complex:
    """Return L and D of L D L', in the place of the diagonals."""
    d = np.concatenate([matrix, np.zeros((3, 2, matrix.shape[2]))], axis=1)
    for j in range(matrix.shape[1]):
        one, two = d[1, j] / d[0, j], d[2, j] / d[0, j]
        d[0, j + 1] -= one * d[1, j]
        d[1, j + 1] -= two * d[1, j]
        d[0, j + 2] -= two * d[2, j]
        d[1, j], d[2, j] = one, two
    return d


def _substituted(d: Complex, right: Complex) -> Complex:
    """Return the solutions from L and D."""
    n = len(right)
    x = np.concatenate([right, np.zeros((2, right.shape[1]))])
    for j in range(n):
        x[j + 1] -= d[1, j] * x[j]
        x[j + 2] -= d[2, j] * x[j]
    x[:n] /= d[0, :n]
    x[n:] = 0.0
    for j in reversed(range(n)):
        x[j] -= d[1, j] * x[j + 1] + d[2, j] * x[j + 2]
    return x[:n]
