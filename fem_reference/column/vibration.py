r"""Response of a meshed column to a drive that vibrates, without a step.

The equations of the scheme's stages (`fem_reference.scheme.harmonic`) say (K + S C - W2 M) D = F with V = S D and
A = -W2 D where there is one stage, the stages of an unknown standing together. A base with a prescribed motion has the
acceleration -w^2 y.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csc_array, kron
from scipy.sparse.linalg import splu

from fem_reference.column.mesh import line_mesh
from fem_reference.column.problem import DISPLACEMENT, PRESSURE, Ground
from fem_reference.column.stepping import Model, observed_by
from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme.harmonic import Complex, step_system


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
    """Complex amplitudes of columns at frequencies of the drive [Hz]; `exact`: as the mesh answers in continuous time.

    They are per pascal on the surface if `at_top`, else per metre of the base's motion, or of the wave that comes up.

    Raises
    ------
    ValueError
        For an unknown column, a mesh that is not possible, or gg = 0 where the exact motion is asked for.
    """
    ground.check_request(columns, ())
    model = Model(line_mesh(ground, elements, degree), ground.impedance)
    observed = observed_by(model, columns, ())
    w = 2 * np.pi * np.array(frequencies, float, ndmin=1)
    drive: Complex = np.zeros((4, len(w)), complex)
    drive[:] = [[0], [0], [0], [1]] if at_top else np.array([np.ones_like(w), 1j * w, -w * w, 0 * w])
    system = step_system(frequencies, scheme, exact)
    M, C, K = model.matrices()
    loads = model.loads() @ drive
    stages = system.load.shape[1]
    X: Complex = np.empty((len(loads), stages, len(w)), complex)  # free unknowns of all stages at every frequency
    for i in range(len(w)):
        matrix = kron(K, system.stiffness[i]) + kron(C, system.damping[i]) + kron(M, system.inertia[i])
        right = np.kron(loads[:, i], system.load[i])
        try:
            X[:, :, i] = splu(csc_array(matrix)).solve(right).reshape(-1, stages)
        except RuntimeError:  # a resonance that nothing damps
            X[:, :, i] = np.inf
    V = np.einsum("fs,usf->uf", system.velocity, X)
    A = np.einsum("fs,usf->uf", system.acceleration, X)
    amplitudes = observed.parts @ drive
    for rows, motion in zip(observed.motion, (X[:, -1], V, A), strict=True):
        amplitudes = amplitudes + rows @ motion
    return dict(zip(columns, amplitudes, strict=True))
