"""The finite-element matrices are those of DDA's block for affine motions, on every kind of mesh."""

from itertools import product
from pathlib import Path

import meshio
import numpy as np
import pytest
from conftest import thinned
from oracles.elements import INCLINED, make
from skfem import MeshQuad, MeshTri

import dda
from fem_reference.mesh.model import assemble, build


def affine(x, y):
    """T(x, y) about the centroid: u and v of the six affine fields (paper, equation (3))."""
    one, zero = np.ones_like(x), np.zeros_like(x)
    return np.array([[one, zero, -y, x, zero, y / 2], [zero, one, x, zero, y, x / 2]])


def block_of(problem):
    """The block of one strain on the same springs under the same pressure."""
    material = dda.Material(problem.density, problem.young, problem.poisson, problem.hypothesis)
    contact = dda.Contact(problem.stiffness, problem.shear_stiffness)
    block = dda.Block(problem.vertices, material)
    return dda.TwoBlockModel(block, contact, problem.pressure, problem.base, problem.top)


def write_mesh(path, problem, mesh):
    """Write a mesh with the tags base and top in Gmsh's format."""
    corners = np.asarray(problem.vertices)
    lines, tags = [], []
    for tag, edge in ((1, problem.base), (2, problem.top)):
        start, end = corners[edge], corners[(edge + 1) % len(corners)]
        side = (end - start) / np.hypot(*(end - start))
        distance = np.abs(side[0] * (mesh.p[1] - start[1]) - side[1] * (mesh.p[0] - start[0]))
        facets = [f.tolist() for f in mesh.facets.T[mesh.boundary_facets()] if distance[f].max() < 1e-12]
        lines += facets
        tags += [tag] * len(facets)
    kind = "quad" if mesh.t.shape[0] == 4 else "triangle"
    physical = [np.array(tags), np.full(mesh.nelements, 3)]
    meshio.write(
        path,
        meshio.Mesh(
            np.pad(mesh.p.T, ((0, 0), (0, 1)), constant_values=0.3),
            [("line", np.array(lines)), (kind, mesh.t.T)],
            cell_data={"gmsh:physical": physical, "gmsh:geometrical": physical},
            field_data={"base": np.array([1, 1]), "top": np.array([2, 1]), "block": np.array([3, 2])},
        ),
        file_format="gmsh22",
        binary=False,
    )
    return str(path)


def unstructured(problem, path):
    """A triangulation of a quadrilateral block with an inner node off centre."""
    corners = np.asarray(problem.vertices)
    inner = corners.mean(axis=0) + 0.07 * (corners[1] - corners[0])
    points = np.vstack([corners, inner]).T
    mesh = MeshTri(points, np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]).T).refined(1)
    return write_mesh(path, problem, mesh)


@pytest.mark.parametrize(
    ("mesh", "hypothesis", "poisson", "degree"),
    thinned(product(["square", "inclined", "triangles"], ["plane stress", "plane strain"], [0.0, 0.3], [1, 2]), 7),
)
def test_affine_fields_give_the_block_matrices(tmp_path, mesh, hypothesis, poisson, degree):
    shape = {} if mesh == "square" else {"vertices": INCLINED, "base": 1, "top": 3}
    material = {"poisson": poisson, "hypothesis": hypothesis, "p": 3e9, "shear": 7e8}
    problem = make(**shape, **material, foundation="corner", elements=3, degree=degree)
    if mesh == "triangles":
        file = unstructured(problem, tmp_path / "block.msh")
        problem = make(**shape, **material, foundation="corner", mesh=file, degree=degree)
    assembled = assemble(problem)
    x, y = assembled.basis.doflocs - problem.centroid[:, None]
    fields = affine(x, y)
    component = np.zeros(assembled.basis.N, int)
    for dofs in (assembled.basis.nodal_dofs, assembled.basis.facet_dofs, assembled.basis.interior_dofs):
        component[dofs[1::2]] = 1
    T = np.where(component[:, None] == 0, fields[0].T, fields[1].T)
    assert assembled.M.nnz == np.count_nonzero(assembled.M.toarray())
    block = block_of(problem)
    for matrix, expected in ((assembled.M, block.mass), (assembled.K + assembled.springs, block.stiffness)):
        # The sums run over some hundred entries that cancel: rounding times their number.
        assert np.abs(T.T @ (matrix @ T) - expected).max() <= 1e-13 * np.abs(expected).max()
    assert assembled.observers["rotation"] @ T == pytest.approx([0, 0, 1, 0, 0, 0], abs=1e-12)
    assert np.abs(T.T @ assembled.F - block.force).max() <= 1e-13 * np.abs(block.force).max()


def test_centroid_outside_the_block_is_refused(tmp_path):
    shape = ((0, 0), (3, 0), (3, 2), (2.9, 2), (2.9, 0.1), (0.1, 0.1), (0.1, 2), (0, 2))
    x, y = np.array([0, 0.1, 2.9, 3.0]), np.array([0, 0.1, 2.0])
    grid = MeshQuad.init_tensor(x, y)
    middle = grid.p[:, grid.t].mean(axis=1)
    mesh = grid.remove_elements(np.flatnonzero((np.abs(middle[0] - 1.5) < 1) & (middle[1] > 0.1)))
    problem = make(shape, 0, 1, mesh=write_mesh(tmp_path / "u.msh", make(shape, 0, 1), mesh))
    with pytest.raises(ValueError, match="centroid must lie inside"):
        build(problem)


def test_mesh_file_that_is_not_the_block_is_refused(tmp_path):
    problem = make()
    grid = np.linspace(0.0, 2.0, 3)
    file = write_mesh(tmp_path / "grid.msh", problem, MeshQuad.init_tensor(grid, grid))
    tall = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.1), (0.0, 2.1))
    with pytest.raises(ValueError, match="mesh: outline"):
        build(make(tall, mesh=file))
    with pytest.raises(ValueError, match="mesh: tag 'top'"):
        build(make(top=1, mesh=file))
    fine = MeshQuad.init_tensor(*[np.linspace(0.0, 2.0, 4)] * 2)
    holed = fine.remove_elements(np.flatnonzero((abs(fine.p[:, fine.t].mean(axis=1) - 1) < 0.1).all(axis=0)))
    with pytest.raises(ValueError, match="mesh: outline"):
        build(make(mesh=write_mesh(tmp_path / "holed.msh", problem, holed)))
    short = meshio.read(file)
    short.cell_data["gmsh:physical"][0][0] = 3
    meshio.write(tmp_path / "short.msh", short, file_format="gmsh22", binary=False)
    with pytest.raises(ValueError, match="mesh: tag 'base'"):
        build(make(mesh=str(tmp_path / "short.msh")))
    with pytest.raises(ValueError, match="mesh: must be a readable"):
        build(make(mesh=str(tmp_path / "absent.msh")))


@pytest.mark.parametrize("text", ["garbage", "", None], ids=["garbage", "empty", "cut"])
def test_mesh_file_that_is_not_whole_is_refused_in_one_sentence(text, tmp_path, capfd):
    grid = np.linspace(0, 1, 4)
    file = Path(write_mesh(tmp_path / "grid.msh", make(), MeshQuad.init_tensor(grid, grid)))
    file.write_text(file.read_text()[:300] if text is None else text)
    with pytest.raises(ValueError, match=r"mesh: must be a readable mesh of triangles or quadrilaterals, .*grid\.msh"):
        build(make(mesh=str(file)))
    assert capfd.readouterr() == ("", "")
