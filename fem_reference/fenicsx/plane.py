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

from .factor import Factor
from .model import COMM, Inapplicable, Meshed, Request, assembled, constant, facets_on, joined, lame, strain


class PlaneBody(Meshed):
    """M D'' + K D = F of the body, and the row that observes D."""

    def __init__(self, request: Request) -> None:
        if COMM.size > 1:
            raise Inapplicable("blocks in the plane are solved on one rank")
        self.size = float(np.ptp(np.asarray(request["points"], float)))
        super().__init__(request, SimpleNamespace(origin=np.zeros(2), size=self.size, centroid=np.zeros(2)))
        self.clamped = joined([self._on(edge) for edge in request["clamps"]])
        self._assemble()
        self.pushes = [self.K.createVecRight(), self.K.createVecRight()]
        self.observers = {"displacement": self._observed()}

    def _on(self, edge: Any) -> np.ndarray:
        """Boundary facets on a straight piece of the outline."""
        start, end = np.asarray(edge, float)
        return facets_on(self.mesh, start, end, 1e-9 * self.size)

    def _over(self, facets: np.ndarray) -> Any:
        """Measure of some facets."""
        return self.edges({1: facets})(1)

    def _assemble(self) -> None:
        """Assemble M, K and F; clamped unknowns have an equation of their own, D = 0."""
        r = self.request
        u = ufl.TrialFunction(self.space)
        v = ufl.TestFunction(self.space)
        self.K = assembled(self._elastic(u, v))
        # Each part is a form of its own: a form takes the tags of one set of facets only.
        F = self.vector(ufl.dot(constant(self.mesh, r["density"] * np.array(r["gravity"])), v) * self.dx)
        for edge, traction in r["tractions"]:
            F += self.vector(ufl.dot(constant(self.mesh, np.array(traction)), v) * self._over(self._on(edge)))
        if any(r["stress"]):
            s_xx, s_yy, s_xy = r["stress"]
            stress = constant(self.mesh, np.array([[s_xx, s_xy], [s_xy, s_yy]]))
            every = dolfinx.mesh.locate_entities_boundary(self.mesh, 1, lambda x: np.ones(x.shape[1], bool))
            outline = np.setdiff1d(np.asarray(every, np.int32), self.clamped).astype(np.int32)
            F += self.vector(ufl.dot(ufl.dot(stress, ufl.FacetNormal(self.mesh)), v) * self._over(outline))
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
        return self.vector(ufl.dot(constant(self.mesh, np.array(direction) / length), v) * self._over(self._on(edge)))

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

    def statics(self) -> dict[str, float]:
        """Displacement and stress error at rest."""
        D = self.rest()
        values = {name: float(row.dot(D)) for name, row in self.observers.items()}
        return values | ({"stress_error": self.stress_error(D)} if any(self.request["stress"]) else {})

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
