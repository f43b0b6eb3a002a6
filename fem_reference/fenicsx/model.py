"""Elements of a body: weak forms in UFL, matrices, loads, and the rows that observe them."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from typing import Any

import dolfinx
import dolfinx.fem.petsc
import dolfinx.geometry
import dolfinx.mesh
import numpy as np
import ufl
from mpi4py import MPI
from petsc4py import PETSc

from .factor import Factor

COMM = MPI.COMM_WORLD
SLACK = 1e-9  # of the body's extent, within which two places are one
Request = dict[str, Any]


class Inapplicable(Exception):
    """What this program does not do, in words."""


def make_mesh(points: np.ndarray, cells: np.ndarray) -> Any:
    """The distributed mesh; the first rank reads all nodes, the partitioner spreads them."""
    cells = np.asarray(cells, np.int64)
    kind = "triangle"
    if cells.shape[1] == 4:
        kind = "quadrilateral"
        cells = cells[:, [0, 1, 3, 2]]  # in tensor order, as dolfinx numbers them
    if COMM.rank > 0:
        points = points[:0]
        cells = cells[:0]
    try:
        import basix.ufl

        element = basix.ufl.element("Lagrange", kind, 1, shape=(2,))
    except ImportError:  # dolfinx up to 0.6
        # The variant that dolfinx itself puts in later: given at once, compiled forms are found again.
        element = ufl.VectorElement("Lagrange", kind, 1, variant="equispaced")
    # The last two arguments changed places in 0.10, and one of them its name before.
    name = "e" if "e" in inspect.signature(dolfinx.mesh.create_mesh).parameters else "domain"
    return dolfinx.mesh.create_mesh(COMM, cells=cells, x=points, **{name: ufl.Mesh(element)})


class Elements:
    """M D'' + K D = F + pushes y of elements, y the displacement of the base, and the rows that observe D.

    Nodes have the shape (nodes, 2) [m], cells their corners counter-clockwise.
    """

    K: Any
    F: Any
    pushes: Sequence[Any] = ()
    base_pressure = np.zeros(2)  # contact pressure of a unit displacement of the base, the body held [Pa/m]
    observers: dict[str, Any]

    def __init__(self, request: Request, points: np.ndarray, cells: np.ndarray) -> None:
        self.request = request
        self.slack = SLACK * float(np.ptp(points))
        self.mesh = make_mesh(points, cells)
        self.mesh.topology.create_connectivity(1, 2)
        degree = request["degree"]
        if hasattr(dolfinx.fem, "functionspace"):
            self.space = dolfinx.fem.functionspace(self.mesh, ("Lagrange", degree, (2,)))
        else:
            self.space = dolfinx.fem.VectorFunctionSpace(self.mesh, ("Lagrange", degree))
        self.u = ufl.TrialFunction(self.space)
        self.v = ufl.TestFunction(self.space)
        # one order above 2 degree integrates the Jacobian of a bilinear cell exactly
        self.rule = {"quadrature_degree": 2 * request["degree"] + 1}
        self.dx = ufl.Measure("dx", domain=self.mesh, metadata=self.rule)
        self.M = assembled(ufl.dot(self.u, self.v) * self.dx)
        self.M.scale(request["density"])
        self.young = request["young"], request["poisson"], request["hypothesis"]

    def elastic(self) -> Any:
        """The form lam (div u, div v) + 2 G (eps(u), eps(v))."""
        lam, shear = (self.constant(value) for value in lame(*self.young))
        strains = ufl.inner(strain(self.u), strain(self.v))
        return (lam * ufl.div(self.u) * ufl.div(self.v) + 2 * shear * strains) * self.dx

    def constant(self, value: Any) -> Any:
        """A constant of a form, so that one compiled form serves all values."""
        return dolfinx.fem.Constant(self.mesh, np.asarray(value, PETSc.ScalarType))

    def on(self, edge: Any) -> np.ndarray:
        """Boundary facets on a straight piece of the outline."""
        start, end = np.asarray(edge, float)
        length = float(np.hypot(*(end - start)))
        along = (end - start) / length

        def inside(x: np.ndarray) -> np.ndarray:
            away = x[:2] - start[:, None]
            s = along @ away
            off = along[0] * away[1] - along[1] * away[0]
            return np.asarray((np.abs(off) <= self.slack) & (s >= -self.slack) & (s <= length + self.slack))

        return np.asarray(dolfinx.mesh.locate_entities_boundary(self.mesh, 1, inside), np.int32)

    @staticmethod
    def joined(parts: list[np.ndarray]) -> np.ndarray:
        """Facets of all parts, each once."""
        return np.unique(np.hstack([[], *parts])).astype(np.int32)

    def over(self, facets: np.ndarray) -> Any:
        """Measure of some facets."""
        tags = dolfinx.mesh.meshtags(self.mesh, 1, np.sort(facets), np.ones(len(facets), np.int32))
        return ufl.Measure("ds", domain=self.mesh, subdomain_data=tags, metadata=self.rule)(1)

    def weighted(self, value: Any, measure: Any) -> Any:
        """Vector of (value, v) over a measure, in the layout of the matrices."""
        value = value if isinstance(value, ufl.core.expr.Expr) else self.constant(value)
        ghosted = dolfinx.fem.petsc.assemble_vector(dolfinx.fem.form(ufl.dot(value, self.v) * measure))
        ghosted.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        vector = self.M.createVecRight()
        vector.array[:] = ghosted.array
        return vector

    def loads(self, gravity: Any, tractions: Sequence[tuple[np.ndarray, Any]]) -> Any:
        """Load of the weight, and of tractions on facets."""
        load = self.weighted(self.request["density"] * np.asarray(gravity), self.dx)
        # Each part is a form of its own: a form takes the tags of one set of facets only.
        for facets, traction in tractions:
            load += self.weighted(traction, self.over(facets))
        return load

    def load(self, moved: Any) -> Any:
        """The load where the base is displaced by (x, y)."""
        x, y = moved
        return self.F + x * self.pushes[0] + y * self.pushes[1] if x or y else self.F

    def unknowns_of(self, local: np.ndarray) -> np.ndarray:
        """Global numbers of the two unknowns of each of this rank's nodes, shape (nodes, 2)."""
        nodes = np.asarray(self.space.dofmap.index_map.local_to_global(np.asarray(local, np.int32)))
        return np.asarray(2 * nodes[:, None] + np.array([0, 1]), np.int32)

    def point_rows(self, place: np.ndarray) -> tuple[Any, Any]:
        """Rows that give u and v at a place: the basis functions of its cell, each evaluated there."""
        cell = self._cell(place)
        owner = COMM.allreduce(COMM.size if cell is None else COMM.rank, MPI.MIN)
        if owner == COMM.size:
            raise ValueError("vertices: the centroid must lie inside the block")
        rows = self.M.createVecRight(), self.M.createVecRight()
        probe = dolfinx.fem.Function(self.space)  # on every rank: it compiles
        if owner == COMM.rank:
            nodes = self.space.dofmap.cell_dofs(cell)
            for local, pair in zip(nodes, self.unknowns_of(nodes), strict=True):
                probe.x.array[:] = 0.0
                probe.x.array[2 * local] = 1.0
                weight = float(np.ravel(probe.eval(np.append(place, 0.0), [cell]))[0])
                for unknown, row in zip(pair, rows, strict=True):
                    row.setValue(int(unknown), weight)
        for row in rows:
            row.assemble()
        return rows

    def _cell(self, place: np.ndarray) -> int | None:
        """A cell of this rank that holds a place; on an edge, nudged off it, any neighbour will do."""
        g = dolfinx.geometry
        tree = g.bb_tree(self.mesh, 2) if hasattr(g, "bb_tree") else g.BoundingBoxTree(self.mesh, 2)
        collide = getattr(g, "compute_collisions_points", None) or g.compute_collisions
        for nudge in self.slack / 10 * np.array([[0, 0], [1, 2], [-2, 1], [-1, -2], [2, -1]]):
            point = np.append(place + nudge, 0.0).reshape(1, 3)
            cells = g.compute_colliding_cells(self.mesh, collide(tree, point), point).links(0)
            if len(cells):
                return int(cells[0])
        return None

    def rest(self) -> Any:
        """Displacements at rest, where the base comes to rest."""
        return Factor(self.K)(self.load(self.request["last"]))

    def statics(self) -> dict[str, float]:
        """What is observed at rest."""
        D = self.rest()
        values = {name: float(row.dot(D)) for name, row in self.observers.items()}
        if "contact_pressure" in values:
            values["contact_pressure"] += float(self.base_pressure @ self.request["last"])
        return values


def strain(u: Any) -> Any:
    """Symmetric gradient."""
    return ufl.sym(ufl.grad(u))


def lame(young: float, poisson: float, hypothesis: str) -> tuple[float, float]:
    """Lame parameter of the plane problem and shear modulus [Pa]."""
    last = 1 - 2 * poisson if hypothesis == "plane strain" else 1 - poisson
    return young * poisson / ((1 + poisson) * last), young / (2 * (1 + poisson))


def assembled(form: Any) -> Any:
    """Assemble a matrix."""
    matrix = dolfinx.fem.petsc.assemble_matrix(dolfinx.fem.form(form))
    matrix.assemble()
    return matrix
