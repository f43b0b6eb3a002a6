"""Response of a meshed column to a vibration, without a step: (K + S C - W2 M) D = F at the scheme's own W2 and S."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_banded
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from fem_reference.column.mesh import line_mesh
from fem_reference.column.problem import DISPLACEMENT, PRESSURE, Ground, check_columns
from fem_reference.column.stepping import Model, observation
from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme.harmonic import Complex, squares


def rates(scheme: Scheme, omega: Array) -> Complex:
    """V over D of the stepped system [1/s], from (6) and (7) with V = S D, A = -W2 D: (z - gg) S = -dt (..) W2."""
    forward = np.expm1(1j * omega * scheme.step)
    ahead = forward + (1 - scheme.gg)
    moved = scheme.gg * (1 + scheme.delta * forward) + (0.5 + scheme.alpha * forward) * ahead
    return np.asarray(forward * (1 + scheme.delta * forward) / moved / scheme.step)


def line_response(
    ground: Ground,
    elements: Sequence[int],
    degree: int,
    scheme: Scheme,
    frequencies: Array,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
    base: bool = True,
    exact: bool = False,
) -> dict[str, Complex]:
    """Complex amplitudes of columns, for 1 m of motion of the base or of the wave that comes up, or 1 Pa on the top.

    Parameters
    ----------
    frequencies
        Above zero [Hz], shape (count,).
    base
        The base moves; else the pressure acts.
    exact
        As the mesh answers in continuous time.

    Raises
    ------
    ValueError
        For an unknown column or a height outside.
    """
    check_columns(columns, heights)
    ground.check_heights(heights)
    mesh = line_mesh(ground, elements, degree)
    model = Model.of(mesh, ground.impedance)
    omega = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    squared, rate = squares(omega / (2 * np.pi), scheme, exact), rates(scheme, omega)
    if exact:
        rate[:] = 1j * omega
    parts = np.zeros((4, len(omega)), complex)
    if base:
        parts[:3] = np.ones_like(omega), 1j * omega, -(omega**2)
    else:
        parts[3] = 1.0
    D = np.zeros((mesh.size, len(omega)), complex)
    D[model.free] = _solved(model, squared, rate, np.asarray(model.loads() @ parts, complex))
    V, A = rate * D, -squared * D
    if ground.impedance is None:
        D[model.base], A[model.base] = parts[0], parts[2]
    rows = [observation(mesh, model, name, heights) for name in columns]
    found = [row.D @ D + row.V @ V + row.A @ A + row.excitation @ parts for row in rows]
    return dict(zip(columns, found, strict=True))


def _solved(model: Model, squared: Complex, rate: Complex, loads: Complex) -> Complex:
    """Solutions of the free unknowns, numbered so that the band is narrow, shape (unknowns, count)."""
    M, C, K = (csr_array(matrix[model.free][:, model.free]) for matrix in (model.M, model.C, model.K))
    order = reverse_cuthill_mckee(abs(K) + abs(M) + abs(C), symmetric_mode=True)
    M, C, K = (matrix[order][:, order].tocoo() for matrix in (M, C, K))
    width = max(int(np.max(np.abs(matrix.row - matrix.col), initial=0)) for matrix in (M, C, K))
    bands = []
    for matrix in (M, C, K):
        band = np.zeros((2 * width + 1, len(order)))
        np.add.at(band, (width + matrix.row - matrix.col, matrix.col), matrix.data)
        bands.append(band)
    found = np.empty(loads.shape, complex)
    for n in range(loads.shape[1]):
        whole = bands[2] + rate[n] * bands[1] - squared[n] * bands[0]
        found[order, n] = solve_banded((width, width), whole, loads[order, n], overwrite_ab=True, check_finite=False)
    return found
