"""A plane body, clamped or free, under tractions on its outline: matrices, what is observed, statics.

The mesh comes as points and cells. A body that nothing holds is pinned for statics, and its rigid motion taken off, so
that the displacements at rest are orthogonal to those of a rigid body by mass.
"""

from __future__ import annotations

from typing import Any

import dolfinx
import numpy as np
import ufl

from .factor import Factor
from .model import COMM, Elements, Inapplicable, Request, assembled, lame, strain


class PlaneBody(Elements):
    """M D'' + K D = F of the body, clamped unknowns with an equation of their own, D = 0; the row that observes D."""

    def __init__(self, request: Request) -> None:
        if COMM.size > 1:
            raise Inapplicable("blocks in the plane are solved on one rank")
        super().__init__(request, np.asarray(request["points"], float), np.asarray(request["cells"]))
        clamped = self.joined([self.on(edge) for edge in request["clamps"]])
        tractions = [(self.on(edge), traction) for edge, traction in request["tractions"]]
        s_xx, s_yy, s_xy = request["stress"]
        self.stress = np.array([[s_xx, s_xy], [s_xy, s_yy]])
        if any(request["stress"]):
            every = dolfinx.mesh.locate_entities_boundary(self.mesh, 1, lambda x: np.ones(x.shape[1], bool))
            outline = np.setdiff1d(np.asarray(every, np.int32), clamped).astype(np.int32)
            tractions.append((outline, ufl.dot(self.constant(self.stress), ufl.FacetNormal(self.mesh))))
        self.F = self.loads(request["gravity"], tractions)
        self.K = assembled(self.elastic())
        nodes = dolfinx.fem.locate_dofs_topological(self.space, 1, clamped)
        self.fixed = np.concatenate([2 * nodes, 2 * nodes + 1]).astype(np.int32)
        for matrix in (self.M, self.K):
            matrix.zeroRowsColumns(self.fixed, diag=1.0)
        self.F.array[self.fixed] = 0.0
        observe = request["observe"]
        row = self._row_at(observe["place"])
        for place in observe["less"]:
            row = row - self._row_at(place) / len(observe["less"])
        self.observers = {"displacement": row}

    def _row_at(self, place: Any) -> Any:
        """Row of the mean displacement of an edge, or of that of a point, which is an edge without length."""
        direction = np.array(self.request["observe"]["direction"])
        start, end = np.asarray(place, float)
        if np.any(start != end):
            return self.weighted(direction / float(np.hypot(*(end - start))), self.over(self.on(place)))
        across, up = self.point_rows(start)
        return direction[0] * across + direction[1] * up

    def rest(self) -> Any:
        """Displacements at rest."""
        if len(self.fixed):
            return Factor(self.K)(self.F)
        x, y = self.space.tabulate_dof_coordinates()[:, :2].T
        first = int(np.argmin(x))
        last = int(np.argmax(x))
        pins = np.array([2 * first, 2 * first + 1, 2 * last + 1], np.int32)
        K = self.K.copy()
        K.zeroRowsColumns(pins, diag=1.0)
        F = self.F.copy()
        F.array[pins] = 0.0
        D = Factor(K)(F)
        one = np.ones_like(x)
        motions = np.array([[one, 0 * one], [0 * one, one], [-y, x]]).transpose(0, 2, 1).reshape(3, -1)
        momenta = np.empty_like(motions)
        vector = self.K.createVecRight()
        for motion, momentum in zip(motions, momenta, strict=True):
            vector.array[:] = motion
            momentum[:] = (self.M * vector).array
        D.array[:] -= np.linalg.solve(momenta @ motions.T, momenta @ D.array) @ motions
        return D

    def statics(self) -> dict[str, float]:
        """Displacement and stress error at rest."""
        D = self.rest()
        values = {name: float(row.dot(D)) for name, row in self.observers.items()}
        return values | ({"stress_error": self.stress_error(D)} if np.any(self.stress) else {})

    def stress_error(self, D: Any) -> float:
        """Largest error of a stress component in the cells, over the largest component of the loads' stress."""
        u = dolfinx.fem.Function(self.space)
        u.x.array[:] = D.array
        lam, shear = lame(*self.young)
        error = lam * ufl.div(u) * ufl.Identity(2) + 2 * shear * strain(u) - ufl.as_matrix(self.stress.tolist())
        # The corners of the reference cell, where a linear stress is largest.
        corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        expression = dolfinx.fem.Expression(error, corners)
        cells = np.arange(self.mesh.topology.index_map(2).size_local, dtype=np.int32)
        try:
            values = expression.eval(self.mesh, cells)
        except (TypeError, AttributeError):  # dolfinx up to 0.6
            values = expression.eval(cells)
        return float(np.max(np.abs(values)) / np.max(np.abs(self.stress)))
