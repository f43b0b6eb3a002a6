"""Displacement and stress of the whole block as files for ParaView, written through meshio."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree
from skfem import Basis
from skfem.helpers import sym_grad

from fem_reference.mesh import elasticity, files
from fem_reference.mesh.mesh import block_mesh
from fem_reference.mesh.model import Model
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Problem

FRAMES = 200
"""Most steps written."""
SUFFIXES = (".xdmf", ".vtu")


def prolongation(problem: Problem, model: Model, basis: Basis) -> csr_array:
    """Matrix from the model's unknowns to those of the whole block's basis.

    Each unknown of the whole block is the model's unknown at the mirrored or shifted place, with the
    sign of the mirror; an unknown that the model dropped is at rest.
    """
    component = elasticity.components(basis)
    x, y = basis.doflocs
    width = problem.base_length
    sign = np.ones(basis.N)
    if model.kind == "column":
        x = np.zeros_like(x)
    elif model.kind == "half":
        sign[(component == 0) & (x > width / 2)] = -1.0
        x = np.minimum(x, width - x)
    # Components are set apart by more than the block, so that the nearest place has the right one.
    span = 10 * float(np.ptp(basis.mesh.p))
    tree = cKDTree(np.vstack([model.places[:2], span * model.places[2:]]).T)
    distance, nearest = tree.query(np.vstack([x, y, span * component]).T)
    coincident = distance > 1e-9 * span
    data = np.where(coincident, 0.0, sign)
    return csr_array((data, (np.arange(basis.N), nearest)), shape=(basis.N, len(model.F)))


def frames_of(path: Path, steps: int) -> list[int]:
    """Numbers of the steps that a file has: ``.xdmf`` a series of at most `FRAMES`, ``.vtu`` the last one.

    Another ending, or no meshio, is a `ValueError`.
    """
    require(path.suffix in SUFFIXES, "fields", f"must end in one of {SUFFIXES}", str(path))
    files.library()
    stride = steps if path.suffix == ".vtu" else -(-steps // FRAMES)
    return [*range(stride, steps, stride), steps]


def write_fields(problem: Problem, model: Model, path: Path, frames: Mapping[float, Array]) -> None:
    """Write displacement (points) and stress (cells), data inline, by displacements under the unit load at instants."""
    meshio = files.library()
    mesh = block_mesh(problem).mesh
    basis = elasticity.vector_basis(mesh, problem.degree)
    kind, middle = ("quad", 0.5) if mesh.t.shape[0] == 4 else ("triangle", 1 / 3)
    centres = Basis(mesh, basis.elem, quadrature=(np.full((2, 1), middle), np.ones(1)))
    prolong = problem.load_size * prolongation(problem, model, basis)

    def data(D: Array) -> dict[str, dict[str, Any]]:
        whole = prolong @ D
        displacement = np.pad(whole[basis.nodal_dofs].T, ((0, 0), (0, 1)))
        strain = (sym_grad(centres.interpolate(whole)))[:, :, :, 0]
        stress = 2 * problem.shear_modulus * strain
        stress[[0, 1], [0, 1]] += problem.lame * (strain[0, 0] + strain[1, 1])
        # of each cell sxx, syy, sxy [Pa]
        of_cells = np.array([stress[0, 0], stress[1, 1], stress[0, 1]]).T
        return {"point_data": {"displacement": displacement}, "cell_data": {"stress": [of_cells]}}

    corner = np.asarray(problem.vertices[problem.base], float)
    points = np.pad(mesh.p.T + corner, ((0, 0), (0, 1)))
    cells = [(kind, mesh.t.T)]
    if path.suffix == ".vtu":
        (D,) = frames.values()
        meshio.write(path, meshio.Mesh(points, cells, **data(D)))
        return
    with meshio.xdmf.TimeSeriesWriter(str(path), data_format="XML") as writer:
        writer.write_points_cells(points, cells)
        for instant, D in frames.items():
            writer.write_data(instant, **data(D))
