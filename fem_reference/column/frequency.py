"""The highest natural frequency of a meshed column."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array

from fem_reference.column.mesh import line_mesh
from fem_reference.column.problem import Ground
from fem_reference.scheme.eigen import largest_frequency


def highest_frequency(ground: Ground, elements: Sequence[int], degree: int) -> float:
    """Return the highest natural frequency [rad/s], the base held; on a half-space the foot of the column is free."""
    mesh = line_mesh(ground, elements, degree)
    free = np.arange(mesh.size)
    massless = mesh.M.diagonal()[mesh.base_node] == 0  # a joint lies on it
    if ground.impedance is None or massless:
        free = np.delete(free, mesh.base_node)
    M, K = (csr_array(matrix[free][:, free]) for matrix in (mesh.M, mesh.K))
    return largest_frequency(K, M)
