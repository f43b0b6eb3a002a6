"""The highest natural frequency of a meshed column."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.sparse.linalg import eigsh

from fem_reference.column.mesh import line_mesh
from fem_reference.column.problem import Ground

SMALL = 40  # unknowns up to which a dense solver finds it


def highest_frequency(ground: Ground, elements: Sequence[int], degree: int) -> float:
    """Return the highest natural frequency [rad/s], the base held; on a half-space the foot of the column is free."""
    mesh = line_mesh(ground, elements, degree)
    free = np.arange(mesh.size)
    massless = mesh.M.diagonal()[mesh.base_node] == 0  # a joint lies on it
    if ground.impedance is None or massless:
        free = np.delete(free, mesh.base_node)
    M, K = (matrix[free][:, free].tocsc() for matrix in (mesh.M, mesh.K))
    if len(free) <= SMALL:
        return math.sqrt(float(np.linalg.eigvals(np.linalg.solve(M.toarray(), K.toarray())).real.max()))
    start = np.cos(np.pi * np.arange(len(free)))  # alike from run to run
    return math.sqrt(float(eigsh(K, k=1, M=M, which="LM", v0=start, return_eigenvectors=False)[0]))
