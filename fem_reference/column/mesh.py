"""Line elements of a layered column: mass and stiffness by scikit-fem, springs where the column is jointed.

Each part between two joints is a mesh of its own; the springs join the nodes that face each other.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, coo_array, csr_array
from skfem import Basis, BilinearForm, ElementLineP1, ElementLineP2, MeshLine
from skfem.helpers import grad

from fem_reference.column.problem import NEAR, Ground
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array

ELEMENTS = {1: ElementLineP1, 2: ElementLineP2}


@BilinearForm
def inertia(u, v, w):  # type: ignore[no-untyped-def]
    """Mass: rho u v."""
    return w["density"] * u * v


@BilinearForm
def elasticity(u, v, w):  # type: ignore[no-untyped-def]
    """Stiffness: E* u' v'."""
    return w["modulus"] * grad(u)[0] * grad(v)[0]


@dataclass(frozen=True)
class Part:
    """A piece of the column without joints, meshed: its unknowns are numbered from `first` on."""

    basis: Basis
    moduli: Array  # of its elements [Pa]
    densities: Array  # of its elements [kg/m3]
    first: int

    def matrix(self, form: BilinearForm) -> csr_array:
        """Assemble a form with the material of the elements."""
        return csr_array(form.assemble(self.basis, modulus=self.moduli[:, None], density=self.densities[:, None]))

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return int(self.basis.N)

    def end(self, top: bool) -> int:
        """Number of the unknown at the lower or upper end."""
        places = self.basis.doflocs[0]
        return self.first + int(np.argmax(places) if top else np.argmin(places))

    def observe(self, height: float, stress: bool) -> tuple[Array, Array]:
        """Unknowns and values of the row that gives displacement, or minus the stress E* u', at a height."""
        nodes = self.basis.mesh.p[0]
        near = NEAR * float(nodes[-1])
        element = max(int(np.searchsorted(nodes, height - near)) - 1, 0)  # of two that meet there, the lower
        size = nodes[element + 1] - nodes[element]
        local = np.array([[(height - nodes[element]) / size]])
        unknowns = self.basis.element_dofs[:, element]
        shapes = [self.basis.elem.lbasis(local, i) for i in range(len(unknowns))]
        values = [-self.moduli[element] / size * slope[0, 0] if stress else value[0] for value, slope in shapes]
        return self.first + unknowns, np.array(values)


@dataclass(frozen=True)
class LineMesh:
    """Matrices of a meshed column; the last unknown is the base where `base_node` is not that of the lowest part."""

    parts: tuple[Part, ...]  # upwards
    M: csr_array
    K: csr_array
    base_node: int
    size: int

    def row(self, height: float, stress: bool = False) -> Array:
        """Row that observes displacement or stress at a height; at a joint the part below it."""
        tops = np.array([part.basis.mesh.p[0].max() for part in self.parts])
        part = self.parts[min(int(np.searchsorted(tops + NEAR * tops[-1], height)), len(self.parts) - 1)]
        row = np.zeros(self.size)
        unknowns, values = part.observe(min(height, float(tops[-1])), stress)
        row[unknowns] = values
        return row

    @property
    def top(self) -> int:
        """Number of the unknown at the surface."""
        return self.parts[-1].end(top=True)


def line_mesh(ground: Ground, elements: Sequence[int], degree: int, springs: bool = True) -> LineMesh:
    """Mesh a column by so many elements of each stratum, of degree 1 or 2; without `springs` joints only cut it."""
    require(degree in ELEMENTS, "degree", "must be 1 or 2", degree)
    near = NEAR * ground.height
    heights = sorted(height for height, _ in ground.joints)
    bottoms = ground.tops - [stratum.thickness for stratum in ground.strata]
    lines = [np.linspace(a, b, n + 1) for a, b, n in zip(bottoms, ground.tops, elements, strict=True)]
    nodes = np.unique(np.concatenate([*lines, heights]))
    nodes = nodes[np.append(True, np.diff(nodes) > near)]
    moduli = np.array([stratum.modulus(ground.motion) for stratum in ground.strata])
    densities = np.array([stratum.density for stratum in ground.strata])
    cuts = [height for height in heights if height > near]
    parts = []
    first = 0
    for low, high in itertools.pairwise([0.0, *cuts, ground.height]):
        own = nodes[(nodes > low - near) & (nodes < high + near)]
        stratum = np.searchsorted(ground.tops, (own[:-1] + own[1:]) / 2)
        parts.append(Part(Basis(MeshLine(own), ELEMENTS[degree]()), moduli[stratum], densities[stratum], first))
        first += parts[-1].size
    return _joined(ground, parts, springs)


def _joined(ground: Ground, parts: list[Part], springs: bool) -> LineMesh:
    size = parts[-1].first + parts[-1].size
    base = parts[0].end(top=False)
    ordered = [stiffness for _, stiffness in sorted(ground.joints)]
    inner = ordered[len(ordered) - len(parts) + 1 :]
    faces = [(below.end(top=True), above.end(top=False)) for below, above in itertools.pairwise(parts)]
    if not springs:
        inner = []
        faces = []
    elif len(ordered) > len(inner):  # a joint below the column: a node of its own below the spring
        inner = ordered
        faces = [(size, base), *faces]
        base = size
        size = size + 1
    M, K = (csr_array(block_diag([part.matrix(form) for part in parts])) for form in (inertia, elasticity))
    M.resize((size, size))
    K.resize((size, size))
    return LineMesh(tuple(parts), M, K + _springs(faces, inner, size), base, size)


def _springs(faces: Sequence[tuple[int, int]], stiffness: Sequence[float], size: int) -> csr_array:
    i, j = np.array(faces, dtype=int).reshape(-1, 2).T
    k = np.array(stiffness, float)
    places = np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i])
    return csr_array(coo_array((np.concatenate([k, k, -k, -k]), places), shape=(size, size)))
