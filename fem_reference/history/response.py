r"""Response of the block's mesh to a load that vibrates, without a step.

(K - W2 M) D = F at the scheme's complex squared frequencies W2, summed where a step has several stages. A mesh that is
one column of elements is a narrow band and is eliminated for every frequency. For others a `KrylovSpace` of the
stiffness itself, V' K V = 1 and V' M V = T, holds all frequencies at once: D = V' y with (1 - W2 T) y = |F| e_1. The
next vector times W2 beta y_m is what remains; where it is not small, the sparse matrix is factorised for the frequency.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh_tridiagonal
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from fem_reference.history.krylov import KrylovSpace
from fem_reference.mesh.model import Model, build
from fem_reference.problem.problem import Array, Flags, Problem, Scheme
from fem_reference.problem.result import check_request
from fem_reference.scheme.harmonic import Complex, answering
from fem_reference.scheme.newmark import Work

NARROW = 1e5
"""Unknowns times the square of their band's width up to which every frequency is eliminated by itself."""
LARGEST = 400
"""Most vectors of a space."""
ADDED = 20
"""Vectors between two looks at what remains."""
SMALL = 1e-13
"""What may remain, over the static and over the actual response, in the norm of the strain energy."""
CANCELLED = 1e-9
"""Rounding of an observed sum over the sum, beyond which the frequency is solved by itself."""


def response(
    problem: Problem,
    scheme: Scheme,
    frequencies: Array,
    columns: tuple[str, ...] = ("displacement", "contact_pressure"),
    along: tuple[float, float] | None = None,
    exact: bool = False,
    model: Model | None = None,
) -> dict[str, Complex]:
    """Complex amplitudes of the columns.

    Parameters
    ----------
    frequencies
        Frequencies of the load [Hz], shape (count,).
    along
        The fixed side of the foundation moves along this vector with its length as amplitude [m], and no load acts;
        without it the loads of the problem vibrate in phase.
    exact
        As the mesh answers in continuous time.
    model
        The model of `problem` where it was built before.

    Raises
    ------
    ValueError
        If the block cannot be meshed, a column is unknown, or gg = 0 has no motion that is exact in time.
    """
    check_request(1, tuple(columns))
    model = build(problem) if model is None else model
    parts = answering(frequencies, scheme, exact)
    F = problem.load_size * model.F if along is None else model.base_force @ np.asarray(along, float)
    values = sum(observed(model, F, model.rows(columns), W2) * factor for W2, factor in parts)
    amplitudes = dict(zip(columns, np.asarray(values), strict=True))
    if along is not None and "contact_pressure" in amplitudes:
        amplitudes["contact_pressure"] = amplitudes["contact_pressure"] + model.base_pressure @ np.asarray(along, float)
    return amplitudes


def observed(model: Model, F: Array, rows: Array, W2: Complex) -> Complex:
    """Rows of D, shape (rows, frequencies)."""
    if not np.any(F):
        return np.zeros((len(rows), len(W2)), complex)
    matrices = [coo_array(part) for part in (model.K, model.M)]
    width = max(int(np.max(np.abs(part.row - part.col))) for part in matrices)
    if len(F) * width**2 <= NARROW:
        return np.stack([rows @ _eliminated(model, F, complex(w2)) for w2 in W2], axis=1)
    amplitudes, settled = _in_space(model, F, rows, W2)
    for i in np.flatnonzero(~settled):
        amplitudes[:, i] = rows @ _eliminated(model, F, complex(W2[i]))
    return amplitudes


def _eliminated(model: Model, F: Array, w2: complex) -> Complex:
    """D at one frequency by elimination, infinite at a resonance that nothing damps."""
    try:
        return np.asarray(splu(csc_array(model.K - w2 * model.M)).solve(F.astype(complex)))
    except RuntimeError:
        return np.full(len(F), np.inf, complex)


def _in_space(model: Model, F: Array, rows: Array, W2: Complex) -> tuple[Complex, Flags]:
    """Observed amplitudes from the smallest sufficient space, and which of them it has settled."""
    solve = Work().factor(model.K)
    first = solve(F)
    unit = float(first @ F) / float(first @ (model.M @ first))  # about w1^2: T is about one at most
    space = KrylovSpace(model.M * unit, model.K, F, solve, min(LARGEST, len(F)))
    while True:
        space.grow(min(len(space) + ADDED, LARGEST))
        size = len(space)
        values, shapes = eigh_tridiagonal(space.diagonal, space.beside[: size - 1])
        y = space.load * shapes[0][:, None] / (1 - values[:, None] * (W2 / unit))
        out = 0.0 if space.closed else space.beside[-1]
        response = np.minimum(space.load, np.linalg.norm(y, axis=0))
        remains = out * np.abs(W2 / unit) * np.abs(shapes[-1] @ y) / response  # over the response
        observers = rows @ space.vectors[:size].T @ shapes
        amplitudes = observers @ y
        with np.errstate(divide="ignore", invalid="ignore"):
            sums = np.max(np.abs(observers) @ np.abs(y) / np.abs(amplitudes), axis=0)
        rounding = np.nan_to_num(np.finfo(float).eps * sums)
        if space.closed or len(space) >= LARGEST or np.all(remains <= SMALL):
            return amplitudes, (remains <= SMALL) & (rounding <= CANCELLED)
