"""A plane body, clamped or free, under tractions on its outline: matrices, what is observed, statics.

The mesh comes as points and cells. A body that nothing holds is pinned for statics, and its rigid motion taken off, so
that the displacements at rest are orthogonal to those of a rigid body by mass.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import dolfinx
import numpy as np
import ufl

from .model import COMM, Block, Inapplicable, Request, assembled, constant, lame, make_mesh, strain, vector_space
from .newmark import Factor


class PlaneBody(Block):
    """M D'' + K D = F of the body, and the row that observes D."""

    def __init__(self, request: Request) -> None:
        if COMM.size > 1:
            raise Inapplicable("blocks in the plane are solved on one rank")
        self.request = request
        points = np.asarray(request["points"], float)
        self.size = float(np.ptp(points))
        outline: Any = SimpleNamespace(origin=np.zeros(2), size=self.size, centroid=np.zeros(2))
        self.outline = outline
        self.mesh = make_mesh(request, outline)
        self.mesh.topology.create_connectivity(1, 2)
        self.space = vector_space(self.mesh, request["degree"])
        self._edges()
        self._assemble()
        self.pushes = [self.K.createVecRight(), self.K.createVecRight()]
        self.observers = {"displacement": self._observed()}

    def _on(self, edge: Any) -> np.ndarray:
        """Boundary facets on a straight piece of the outline."""
        start, end = np.asarray(edge, float)
        length = float(np.hypot(*(end - start)))
        along = (end - start) / length
        slack = 1e-9 * self.size

        def inside(x: np.ndarray) -> np.ndarray:
            away = x[:2] - start[:, None]
            s = along @ away
            off = along[0] * away[1] - along[1] * away[0]
            return np.asarray((np.abs(off) <= slack) & (s >= -slack) & (s <= length + slack))

        return np.asarray(dolfinx.mesh.locate_entities_boundary(self.mesh, 1, inside), np.int32)

    def _boundary(self) -> np.ndarray:
        return np.asarray(
            dolfinx.mesh.locate_entities_boundary(self.mesh, 1, lambda x: np.ones(x.shape[1], bool)), np.int32
        )

    def _edges(self) -> None:
        """Keep what acts on which facets, and the rules of integration."""
        self.rule = {"quadrature_degree": 2 * self.request["degree"] + 1}
        self.dx = ufl.Measure("dx", domain=self.mesh, metadata=self.rule)
        clamps = [self._on(edge) for edge in self.request["clamps"]]
        self.clamped = np.unique(np.concatenate([*clamps, np.empty(0, np.int32)])).astype(np.int32)

    def _over(self, facets: np.ndarray) -> Any:
        """Measure of some facets."""
        tags = dolfinx.mesh.meshtags(self.mesh, 1, np.sort(facets), np.ones(len(facets), np.int32))
        return ufl.Measure("ds", domain=self.mesh, subdomain_data=tags, metadata=self.rule)(1)

    def _assemble(self) -> None:
        """Assemble M, K and F; clamped unknowns have an equation of their own, D = 0."""
        r = self.request
        u = ufl.TrialFunction(self.space)
        v = ufl.TestFunction(self.space)
        lam, shear = (constant(self.mesh, value) for value in lame(r["young"], r["poisson"], r["hypothesis"]))
        self.M = assembled(ufl.dot(u, v) * self.dx)
        self.M.scale(r["density"])
        self.K = assembled((lam * ufl.div(u) * ufl.div(v) + 2 * shear * ufl.inner(strain(u), strain(v))) * self.dx)
        # Each part is a form of its own: a form takes the tags of one set of facets only.
        F = self._vector(ufl.dot(constant(self.mesh, r["density"] * np.array(r["gravity"])), v) * self.dx)
        for edge, traction in r["tractions"]:
            F += self._vector(ufl.dot(constant(self.mesh, np.array(traction)), v) * self._over(self._on(edge)))
        if any(r["stress"]):
            s_xx, s_yy, s_xy = r["stress"]
            stress = constant(self.mesh, np.array([[s_xx, s_xy], [s_xy, s_yy]]))
            outline = np.setdiff1d(self._boundary(), self.clamped).astype(np.int32)
            F += self._vector(ufl.dot(ufl.dot(stress, ufl.FacetNormal(self.mesh)), v) * self._over(outline))
        self.F = F
        nodes = dolfinx.fem.locate_dofs_topological(self.space, 1, self.clamped)
        self.fixed = np.concatenate([2 * nodes, 2 * nodes + 1]).astype(np.int32)
        self._hold(self.M, self.fixed)
        self._hold(self.K, self.fixed)
        self.F.array[self.fixed] = 0.0

    @staticmethod
    def _hold(matrix: Any, unknowns: np.ndarray) -> None:
        matrix.zeroRowsColumns(unknowns, diag=1.0)

    def _observed(self) -> Any:
        """Row of the observed displacement: that of a place, less the mean of others."""
        observe = self.request["observe"]
        row = self._row_at(observe["place"], observe["direction"])
        for place in observe["less"]:
            row = row - self._row_at(place, observe["direction"]) / len(observe["less"])
        return row

    def _row_at(self, place: Any, direction: tuple[float, float]) -> Any:
        """Row of the mean displacement of an edge, or of that of a point, which is an edge without length."""
        start, end = place
        if start != end:
            return self._mean_of(place, direction)
        self.outline.centroid = np.asarray(start, float)
        across, up = self._point_rows()
        return direction[0] * across + direction[1] * up

    def _mean_of(self, edge: Any, direction: tuple[float, float]) -> Any:
        v = ufl.TestFunction(self.space)
        length = float(np.hypot(*np.subtract(*edge)))
        return self._vector(ufl.dot(constant(self.mesh, np.array(direction) / length), v) * self._over(self._on(edge)))

    def rest(self) -> Any:
        """Displacements at rest."""
        if len(self.fixed):
            return Factor(self.K)(self.F)
        x = self.space.tabulate_dof_coordinates()[:, :2]
        first = int(np.argmin(x[:, 0]))
        last = int(np.argmax(x[:, 0]))
        pins = np.array([2 * first, 2 * first + 1, 2 * last + 1], np.int32)
        K = self.K.copy()
        self._hold(K, pins)
        F = self.F.copy()
        F.array[pins] = 0.0
        D = Factor(K)(F)
        motions = np.zeros((len(D.array), 3))
        motions[0::2, 0] = 1.0
        motions[1::2, 1] = 1.0
        motions[0::2, 2] = -x[:, 1]
        motions[1::2, 2] = x[:, 0]
        rows = []
        for motion in motions.T:
            vector = self.K.createVecRight()
            vector.array[:] = motion
            rows.append((self.M * vector).array.copy())
        momenta = np.array(rows)
        D.array[:] -= motions @ np.linalg.solve(momenta @ motions, momenta @ D.array)
        return D

    def stress_error(self, D: Any) -> float:
        """Largest error of a stress component in the cells, over the largest component of the loads' stress."""
        r = self.request
        u = dolfinx.fem.Function(self.space)
        u.x.array[:] = D.array
        lam, shear = lame(r["young"], r["poisson"], r["hypothesis"])
        s_xx, s_yy, s_xy = r["stress"]
        error = lam * ufl.div(u) * ufl.Identity(2) + 2 * shear * strain(u)
        error = error - ufl.as_matrix([[s_xx, s_xy], [s_xy, s_yy]])
        # The corners of the reference cell, where a linear stress is largest.
        corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        expression = dolfinx.fem.Expression(error, corners)
        cells = np.arange(self.mesh.topology.index_map(2).size_local, dtype=np.int32)
        try:
            values = expression.eval(self.mesh, cells)
        except (TypeError, AttributeError):  # dolfinx up to 0.6
            values = expression.eval(cells)
        return float(np.max(np.abs(values)) / max(map(abs, r["stress"])))


def statics(body: PlaneBody) -> dict[str, float]:
    """Return displacement and stress error at rest."""
    D = body.rest()
    values = {name: float(row.dot(D)) for name, row in body.observers.items()}
    if any(body.request["stress"]):
        values["stress_error"] = body.stress_error(D)
    return values
