"""Displacement and stress of the whole block as files for ParaView, written through meshio."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree
from skfem import Basis
from skfem.helpers import sym_grad

from fem_reference.mesh import elasticity, files
from fem_reference.mesh.mesh import block_mesh
from fem_reference.mesh.model import Model
from fem_reference.problem.problem import Array, Problem

FRAMES = 200
"""Greatest number of steps written."""
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


class FieldWriter:
    """Collects displacement (points) and stress (cells) of a run and writes them.

    ``.xdmf`` holds a time series of at most `FRAMES` steps with its data inline, ``.vtu`` the last step.

    Raises
    ------
    ValueError
        If the file's ending is neither, or meshio is not installed.
    """

    def __init__(self, problem: Problem, model: Model, path: Path, step: float, steps: int) -> None:
        if path.suffix not in SUFFIXES:
            raise ValueError(f"fields: must end in one of {SUFFIXES}, got {str(path)!r}")
        self._meshio = files.library()
        self._problem = problem
        self._path = path
        self._step = step
        mesh = block_mesh(problem).mesh
        self._basis = elasticity.vector_basis(mesh, problem.degree)
        centre = np.full((2, 1), 0.5 if mesh.t.shape[0] == 4 else 1 / 3)
        self._centres = Basis(mesh, self._basis.elem, quadrature=(centre, np.ones(1)))
        self._prolong = prolongation(problem, model, self._basis)
        stride = 1 if path.suffix == ".xdmf" else steps
        self._stride = max(stride, -(-steps // FRAMES))
        self._steps = steps
        self._frames: list[tuple[float, Array]] = []

    def record(self, number: int, D: Array) -> None:
        """Keep step `number` if it is one of the frames; the last step always is."""
        if number % self._stride == 0 or number == self._steps:
            self._frames.append((number * self._step, self._problem.load_size * (self._prolong @ D)))

    def close(self) -> None:
        """Write the file."""
        mesh = self._basis.mesh
        corner = np.asarray(self._problem.vertices[self._problem.base], float)
        points = np.pad(mesh.p.T + corner, ((0, 0), (0, 1)))
        cells = [("quad" if mesh.t.shape[0] == 4 else "triangle", mesh.t.T)]
        if self._path.suffix == ".vtu":
            point_data, cell_data = self._data(self._frames[-1][1])
            self._meshio.write(self._path, self._meshio.Mesh(points, cells, point_data=point_data, cell_data=cell_data))
            return
        with self._meshio.xdmf.TimeSeriesWriter(str(self._path), data_format="XML") as writer:
            writer.write_points_cells(points, cells)
            for instant, D in self._frames:
                point_data, cell_data = self._data(D)
                writer.write_data(instant, point_data=point_data, cell_data=cell_data)

    def _data(self, D: Array) -> tuple[dict[str, Array], dict[str, list[Array]]]:
        displacement = np.pad(D[self._basis.nodal_dofs].T, ((0, 0), (0, 1)))
        return {"displacement": displacement}, {"stress": [self.stress(D)]}

    def stress(self, D: Array) -> Array:
        """Stress (sxx, syy, sxy) at the cell centres [Pa], shape (cells, 3)."""
        strain = np.asarray(sym_grad(self._centres.interpolate(D)))[:, :, :, 0]
        pressure = self._problem.lame * (strain[0, 0] + strain[1, 1])
        stress = 2 * self._problem.shear_modulus * strain
        return np.array([stress[0, 0] + pressure, stress[1, 1] + pressure, stress[0, 1]]).T
