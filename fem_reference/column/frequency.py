"""The highest natural frequency of a meshed column."""

from __future__ import annotations

from collections.abc import Sequence

from fem_reference.column.mesh import line_mesh
from fem_reference.column.problem import Ground
from fem_reference.column.stepping import Model
from fem_reference.scheme.eigen import largest_frequency


def highest_frequency(ground: Ground, elements: Sequence[int], degree: int) -> float:
    """Return the highest natural frequency [rad/s], the base held; on a half-space the foot of the column is free."""
    mesh = line_mesh(ground, elements, degree)
    massless = mesh.M.diagonal()[mesh.base_node] == 0  # a joint lies on it
    M, _, K = Model(mesh, None if massless else ground.impedance).matrices()
    return largest_frequency(K, M)
