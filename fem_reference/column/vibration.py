r"""Response of a meshed column to a drive that vibrates, without a step.

(K + S C - W2 M) D = F with the scheme's own V = S D and A = -W2 D. In the order of their heights the unknowns make a
narrow band, eliminated for every frequency. A base that is told how to move has the acceleration -w^2 y.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_banded
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from fem_reference.column.mesh import line_mesh
from fem_reference.column.problem import DISPLACEMENT, PRESSURE, Ground, check_columns
from fem_reference.column.stepping import Model, row_of
from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme.harmonic import Complex, rates, squares


def line_response(
    ground: Ground,
    elements: Sequence[int],
    degree: int,
    scheme: Scheme,
    frequencies: Array,
    at_top: bool,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    exact: bool = False,
) -> dict[str, Complex]:
    """Complex amplitudes of columns of a history.

    Parameters
    ----------
    elements, degree
        Number of elements of each stratum, and their degree.
    frequencies
        Of the drive [Hz].
    at_top
        Per pascal on the surface; else per metre of the base's motion, or of the wave that comes up.
    exact
        As the mesh answers in continuous time.

    Raises
    ------
    ValueError
        For an unknown column, a mesh that is not possible, or gg = 0 where the exact motion is asked for.
    """
    check_columns(columns, ())
    mesh = line_mesh(ground, elements, degree)
    model = Model.of(mesh, ground.impedance)
    rows = [row_of(mesh, model, name, ()) for name in columns]
    w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    drive: Complex = np.zeros((4, len(w)), complex)
    drive[:] = [[0], [0], [0], [1]] if at_top else np.array([np.ones_like(w), 1j * w, -w * w, 0 * w])
    W2 = squares(frequencies, scheme, exact)
    S = rates(frequencies, scheme, exact)
    D = np.zeros((mesh.size, len(w)), complex)
    D[model.free] = _solutions(model, np.asarray(model.loads() @ drive, complex), W2, S)
    V = S * D
    A = -W2 * D
    if ground.impedance is None:
        D[model.base] = drive[0]
        A[model.base] = drive[2]
    observed = [row.D @ D + row.V @ V + row.A @ A + row.excitation @ drive for row in rows]
    return dict(zip(columns, observed, strict=True))


def _solutions(model: Model, loads: Complex, W2: Complex, S: Complex) -> Complex:
    """Free unknowns at every frequency, shape (unknowns, frequencies)."""
    M, C, K = (coo_array(part[model.free][:, model.free]) for part in (model.M, model.C, model.K))
    order = reverse_cuthill_mckee((abs(M) + abs(K)).tocsr(), symmetric_mode=True)
    place = np.argsort(order)
    # at least one diagonal on each side, also of one unknown: older SciPy look for the main one in the second row
    width = max(int(np.max(np.abs(place[part.row] - place[part.col]), initial=1)) for part in (M, K))
    solutions = np.empty_like(loads)
    for i, (w2, s) in enumerate(zip(W2, S, strict=True)):
        band = np.zeros((2 * width + 1, len(order)), complex)
        for part, factor in ((K, 1.0), (C, s), (M, -w2)):
            row = place[part.row]
            col = place[part.col]
            band[width + row - col, col] += factor * part.data
        try:
            solutions[order, i] = solve_banded((width, width), band, loads[order, i], check_finite=False)
        except np.linalg.LinAlgError:  # a resonance that nothing damps
            solutions[:, i] = np.inf
    return solutions
