"""The block: nodes of the mesh, weak forms in UFL, matrices, loads and observers."""

from __future__ import annotations

import inspect
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
# the top without its pressed part, and that part
BASE = 1
TOP = 2
PRESSED = 3
Request = dict[str, Any]


class Inapplicable(Exception):
    """What this program does not do, in words."""


class Outline:
    """The block's corners from the start of its base on, relative to that point [m]."""

    def __init__(self, request: Request) -> None:
        base = request["base"]
        corners = np.asarray(request["vertices"], float)
        self.origin = corners[base].copy()
        self.corners = np.roll(corners, -base, axis=0) - self.origin
        self.top = (request["top"] - base) % len(corners)
        x, y = self.corners.T
        cross = x * np.roll(y, -1) - np.roll(x, -1) * y
        self.area = cross.sum() / 2
        self.centroid = np.array([cross @ (z + np.roll(z, -1)) for z in (x, y)]) / (6 * self.area)
        self.size = float(np.ptp(self.corners))

    def side(self, index: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Start, unit direction and length of an edge."""
        start = self.corners[index]
        along = self.corners[(index + 1) % len(self.corners)] - start
        length = float(np.hypot(*along))
        return start, along / length, length


def nodes_and_cells(request: Request, outline: Outline) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] and cells; quadrilaterals in tensor order, as dolfinx numbers them."""
    if request.get("points") is not None:
        cells = np.asarray(request["cells"], np.int64)
        points = np.asarray(request["points"], float) - outline.origin
        return points, cells if cells.shape[1] == 3 else cells[:, [0, 1, 3, 2]]
    n = request["elements"]
    right, up = np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n)
    right = right.reshape(-1, 1)
    up = up.reshape(-1, 1)
    a, b, c, d = outline.corners
    points = (1 - up) * ((1 - right) * a + right * b) + up * ((1 - right) * d + right * c)
    first = (np.arange(n) + (n + 1) * np.arange(n)[:, None]).reshape(-1, 1)
    if request["cells"] == "triangles":  # each square cut from its lower left to its upper right corner
        return points, np.vstack([first + np.array([0, 1, n + 2]), first + np.array([0, n + 2, n + 1])])
    return points, first + np.array([0, 1, n + 1, n + 2])


def make_mesh(request: Request, outline: Outline) -> Any:
    """Return the distributed mesh; the first rank reads all nodes, the partitioner spreads them."""
    points, cells = nodes_and_cells(request, outline)
    kind = "triangle" if cells.shape[1] == 3 else "quadrilateral"
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


def vector_space(mesh: Any, degree: int) -> Any:
    """Continuous displacements of a degree."""
    if hasattr(dolfinx.fem, "functionspace"):
        return dolfinx.fem.functionspace(mesh, ("Lagrange", degree, (2,)))
    return dolfinx.fem.VectorFunctionSpace(mesh, ("Lagrange", degree))


def facets_on(mesh: Any, start: np.ndarray, end: np.ndarray, slack: float) -> np.ndarray:
    """Boundary facets on a straight piece of the outline."""
    length = float(np.hypot(*(end - start)))
    along = (end - start) / length

    def inside(x: np.ndarray) -> np.ndarray:
        away = x[:2] - start[:, None]
        s = along @ away
        off = along[0] * away[1] - along[1] * away[0]
        return np.asarray((np.abs(off) <= slack) & (s >= -slack) & (s <= length + slack))

    return np.asarray(dolfinx.mesh.locate_entities_boundary(mesh, 1, inside), np.int32)


def joined(parts: list[np.ndarray]) -> np.ndarray:
    """Facets of all parts, each once."""
    return np.unique(np.concatenate([*parts, np.empty(0, np.int32)])).astype(np.int32)


def spring_intervals(request: Request, length: float) -> list[tuple[float, float]]:
    """Intervals of the base that stand on distributed springs."""
    if request["foundation"] == "corner":
        return []
    w = request["patch_width"]
    return [(0.0, length)] if w is None or 2 * w >= length else [(0.0, w), (length - w, length)]


def pressed_part(request: Request, length: float) -> tuple[float, float]:
    """Interval of the top edge, as long as it can be about its shifted middle, that carries the pressure."""
    shift = request["along"] * request["eccentricity"]
    return max(0.0, 2 * shift), min(length, length + 2 * shift)


class Meshed:
    """M D'' + K D = F + pushes y of elements, y the displacement of the base, and the rows that observe D."""

    M: Any
    K: Any
    F: Any
    pushes: list[Any]
    observers: dict[str, Any]

    def __init__(self, request: Request, outline: Any) -> None:
        self.request = request
        self.outline = outline
        self.mesh = make_mesh(request, outline)
        self.mesh.topology.create_connectivity(1, 2)
        self.space = vector_space(self.mesh, request["degree"])
        # one order above 2 degree integrates the Jacobian of a bilinear cell exactly
        self.rule = {"quadrature_degree": 2 * request["degree"] + 1}
        self.dx = ufl.Measure("dx", domain=self.mesh, metadata=self.rule)

    def edges(self, facets_by_tag: dict[int, np.ndarray]) -> Any:
        """Measure of the outline whose facets have tags."""
        facets = np.concatenate([*facets_by_tag.values()])
        tags = np.repeat(np.array([*facets_by_tag], np.int32), [len(part) for part in facets_by_tag.values()])
        order = np.argsort(facets)
        data = dolfinx.mesh.meshtags(self.mesh, 1, facets[order], tags[order])
        return ufl.Measure("ds", domain=self.mesh, subdomain_data=data, metadata=self.rule)

    def _elastic(self, u: Any, v: Any) -> Any:
        """Assemble M from rho (u, v); return the form lam (div u, div v) + 2 G (eps(u), eps(v))."""
        r = self.request
        self.M = assembled(ufl.dot(u, v) * self.dx)
        self.M.scale(r["density"])
        lam, shear = (constant(self.mesh, value) for value in lame(r["young"], r["poisson"], r["hypothesis"]))
        return (lam * ufl.div(u) * ufl.div(v) + 2 * shear * ufl.inner(strain(u), strain(v))) * self.dx

    def vector(self, form: Any) -> Any:
        """Assemble a linear form into a vector of the matrices' layout."""
        ghosted = dolfinx.fem.petsc.assemble_vector(dolfinx.fem.form(form))
        ghosted.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        vector = self.K.createVecRight()
        vector.array[:] = ghosted.array
        return vector

    def load(self, moved: Any) -> Any:
        """The load where the base is displaced by (x, y)."""
        x, y = moved
        return self.F + x * self.pushes[0] + y * self.pushes[1] if x or y else self.F

    def rest(self) -> Any:
        """Displacements at rest, where the base comes to rest."""
        return Factor(self.K)(self.load(self.request["last"]))

    def statics(self) -> dict[str, float]:
        """What is observed at rest."""
        D = self.rest()
        return {name: float(row.dot(D)) for name, row in self.observers.items()}

    def _global(self, local: np.ndarray) -> np.ndarray:
        return np.asarray(self.space.dofmap.index_map.local_to_global(np.asarray(local, np.int32)), np.int64)

    def _point_rows(self) -> tuple[Any, Any]:
        """Rows that give u and v at the centroid: the basis functions of its cell, each evaluated there."""
        point = np.append(self.outline.centroid, 0.0)
        cell = self._cell()
        owner = COMM.allreduce(COMM.size if cell is None else COMM.rank, MPI.MIN)
        if owner == COMM.size:
            raise ValueError("vertices: the centroid must lie inside the block")
        rows = self.K.createVecRight(), self.K.createVecRight()
        probe = dolfinx.fem.Function(self.space)  # on every rank: it compiles
        if owner == COMM.rank:
            dofs = self.space.dofmap.cell_dofs(cell)
            for local, number in zip(dofs, self._global(dofs), strict=True):
                probe.x.array[:] = 0.0
                probe.x.array[2 * local] = 1.0
                weight = float(np.ravel(probe.eval(point, [cell]))[0])
                for component, row in enumerate(rows):
                    row.setValue(2 * int(number) + component, weight)
        for row in rows:
            row.assemble()
        return rows

    def _cell(self) -> int | None:
        """A cell of this rank that holds the centroid; on an edge, nudged off it, any neighbour will do."""
        g = dolfinx.geometry
        tree = g.bb_tree(self.mesh, 2) if hasattr(g, "bb_tree") else g.BoundingBoxTree(self.mesh, 2)
        collide = getattr(g, "compute_collisions_points", None) or g.compute_collisions
        for nudge in 1e-10 * self.outline.size * np.array([[0, 0], [1, 2], [-2, 1], [-1, -2], [2, -1]]):
            point = np.append(self.outline.centroid + nudge, 0.0).reshape(1, 3)
            cells = g.compute_colliding_cells(self.mesh, collide(tree, point), point).links(0)
            if len(cells):
                return int(cells[0])
        return None


class Block(Meshed):
    """The block on its springs."""

    def __init__(self, request: Request) -> None:
        super().__init__(request, Outline(request))
        self._measures()
        self._check()
        self._matrices()
        self._rows()

    def _facets(self, index: int, low: float, high: float) -> np.ndarray:
        """Facets of an edge between two arc lengths."""
        start, along, _ = self.outline.side(index)
        return facets_on(self.mesh, start + low * along, start + high * along, 1e-9 * self.outline.size)

    def _measures(self) -> None:
        """Mark what carries springs and what is loaded."""
        _, _, length = self.outline.side(0)
        springs = joined([self._facets(0, *span) for span in spring_intervals(self.request, length)])
        _, along, full = self.outline.side(self.outline.top)
        self.request["along"] = 1.0 if along[0] > 0 or (along[0] == 0 and along[1] > 0) else -1.0
        top = self._facets(self.outline.top, 0.0, full)
        pressed = self._facets(self.outline.top, *pressed_part(self.request, full))
        self.ds = self.edges({BASE: springs, TOP: np.setdiff1d(top, pressed).astype(np.int32), PRESSED: pressed})

    def _integral(self, measure: Any) -> float:
        form = dolfinx.fem.form(constant(self.mesh, 1.0) * measure)
        return float(COMM.allreduce(dolfinx.fem.assemble_scalar(form), MPI.SUM))

    def _check(self) -> None:
        """Refuse a mesh that is not the block's: area, perimeter, loaded and carried length."""
        o = self.outline
        request = self.request
        perimeter = sum(o.side(i)[2] for i in range(len(o.corners)))
        top = self.ds((TOP, PRESSED))
        measures = {"area": (self.dx, o.area), "perimeter": (self.ds, perimeter), "top": (top, o.side(o.top)[2])}
        for name, (measure, expected) in measures.items():
            if abs(self._integral(measure) - expected) > 1e-9 * expected:
                raise ValueError(f"mesh: outline must be the block's, but its {name} differs")
        low, high = pressed_part(request, o.side(o.top)[2])
        if abs(self._integral(self.ds(PRESSED)) - (high - low)) > 1e-9 * o.side(o.top)[2]:
            raise Inapplicable(
                "the pressed part of the top ends inside an element's edge, and fenicsx integrates whole edges only"
            )
        spans = spring_intervals(request, o.side(0)[2])
        carried = sum(high - low for low, high in spans)
        if spans and abs(self._integral(self.ds(BASE)) - carried) > 1e-9 * carried:
            if request["foundation"] == "patch":
                raise Inapplicable("the patches end inside an element's edge, and fenicsx integrates whole edges only")
            raise ValueError("mesh: the base must be covered by edges of elements exactly")
        self.carried = carried if spans else 1.0

    def _matrices(self) -> None:
        """Assemble M, K with the springs, the load and what a moving base adds."""
        r = self.request
        mesh = self.mesh
        ds = self.ds
        u = ufl.TrialFunction(self.space)
        v = ufl.TestFunction(self.space)
        t = self.outline.side(0)[1]
        self.tangent = t
        self.normal = np.array([-t[1], t[0]])
        spread = 2 / self.carried  # over edges of the base; where springs stand at its corners no edge is marked
        kn, kt = (constant(mesh, spread * r[name]) for name in ("stiffness", "shear_stiffness"))
        n = constant(mesh, self.normal)
        t = constant(mesh, self.tangent)
        springs = (kn * ufl.dot(n, u) * ufl.dot(n, v) + kt * ufl.dot(t, u) * ufl.dot(t, v)) * ds(BASE)
        self.K = assembled(self._elastic(u, v) + springs, self._corner_springs if r["foundation"] == "corner" else None)
        down, right = (constant(mesh, r[name]) for name in ("pressure", "traction"))
        angle = np.radians(r["slope"])
        weight = constant(mesh, r["density"] * r["gravity"] * np.array([np.sin(angle), -np.cos(angle)]))
        load = right * v[0] * ds((TOP, PRESSED)) - down * v[1] * ds(PRESSED) + ufl.dot(weight, v) * self.dx
        self.F = self.vector(load)
        self.pushes = [self._push(kn, kt, n, t, v, np.eye(2)[i]) for i in (0, 1)]
        self.pressure = self.vector(-(kn / constant(mesh, self.outline.side(0)[2])) * ufl.dot(n, v) * ds(BASE))

    def _push(self, kn: Any, kt: Any, n: Any, t: Any, v: Any, direction: np.ndarray) -> Any:
        """Load of a unit displacement of the base in one direction."""
        across, along = (constant(self.mesh, float(axis @ direction)) for axis in (self.normal, self.tangent))
        vector = self.vector((kn * across * ufl.dot(n, v) + kt * along * ufl.dot(t, v)) * self.ds(BASE))
        if self.request["foundation"] == "corner":
            for pair in self.corners():
                vector.setValues(pair, self._spring() @ direction, addv=PETSc.InsertMode.ADD_VALUES)
            vector.assemble()
        return vector

    def _spring(self) -> np.ndarray:
        """Matrix of one corner spring."""
        p = self.request["stiffness"]
        ps = self.request["shear_stiffness"]
        return np.asarray(p * np.outer(self.normal, self.normal) + ps * np.outer(self.tangent, self.tangent))

    def corners(self) -> list[np.ndarray]:
        """Global numbers of the two unknowns of each end of the base that this rank owns."""
        owned = []
        for point in self.outline.corners[:2]:

            def here(x: np.ndarray, point: np.ndarray = point) -> np.ndarray:
                return np.asarray(np.hypot(x[0] - point[0], x[1] - point[1]) <= 1e-9 * self.outline.size)

            local = dolfinx.fem.locate_dofs_geometrical(self.space, here)
            local = local[local < self.space.dofmap.index_map.size_local]
            owned += [(2 * i + np.array([0, 1])).astype(np.int32) for i in self._global(local)]
        return owned

    def _corner_springs(self, K: Any) -> None:
        """Add the two point springs to the stiffness."""
        for pair in self.corners():
            K.setValues(pair, pair, self._spring(), addv=PETSc.InsertMode.ADD_VALUES)

    def _rows(self) -> None:
        """Set the observers of the columns."""
        if self.request["foundation"] == "corner":
            share = -self.request["stiffness"] / self.outline.side(0)[2]
            for pair in self.corners():
                self.pressure.setValues(pair, share * self.normal, addv=PETSc.InsertMode.ADD_VALUES)
            self.pressure.assemble()
        across, down = self._point_rows()
        self.observers = {
            "displacement": down,
            "contact_pressure": self.pressure,
            "horizontal_displacement": across,
        }

    def statics(self) -> dict[str, float]:
        """What is observed at rest."""
        static = super().statics()
        static["contact_pressure"] += float(self.carried_pressure(self.request["last"]))
        return static

    def carried_pressure(self, moved: Any) -> np.ndarray:
        """Contact pressure of a displaced base where the block is held, for each (x, y)."""
        pressure: np.ndarray = (
            np.asarray(moved) @ self.normal * (2 * self.request["stiffness"] / self.outline.side(0)[2])
        )
        return pressure


def constant(mesh: Any, value: Any) -> Any:
    """A constant of a form, so that one compiled form serves all values."""
    return dolfinx.fem.Constant(mesh, np.asarray(value, PETSc.ScalarType))


def strain(u: Any) -> Any:
    """Symmetric gradient."""
    return ufl.sym(ufl.grad(u))


def lame(young: float, poisson: float, hypothesis: str) -> tuple[float, float]:
    """Lame parameter of the plane problem and shear modulus [Pa]."""
    last = 1 - 2 * poisson if hypothesis == "plane strain" else 1 - poisson
    return young * poisson / ((1 + poisson) * last), young / (2 * (1 + poisson))


def assembled(form: Any, add: Any = None) -> Any:
    """Assemble a matrix; `add` puts further entries into it."""
    matrix = dolfinx.fem.petsc.assemble_matrix(dolfinx.fem.form(form))
    matrix.assemble()
    if add is not None:
        add(matrix)
        matrix.assemble()
    return matrix
