"""The elements of one body: matrices, loads, and what observes it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.linalg import null_space
from scipy.sparse import csr_array
from skfem import FacetBasis, LinearForm

from fem_reference.mesh import elasticity
from fem_reference.mesh.mesh import facets_between
from fem_reference.plane.body import PlaneBody, Point, Segment, Traction, mesh_of
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Indices


@LinearForm
def _displacement(v, w):  # type: ignore[no-untyped-def]
    """Product f . v with a vector f."""
    return w.x_part * v[0] + w.y_part * v[1]


@LinearForm
def _gradient(v, w):  # type: ignore[no-untyped-def]
    """dv_i/dx_j of one i and one j."""
    return v.grad[w.i, w.j]


@LinearForm
def _traction(v, w):  # type: ignore[no-untyped-def]
    """S n . v of a constant stress."""
    s_xx, s_yy, s_xy = w.stress
    return (s_xx * w.n[0] + s_xy * w.n[1]) * v[0] + (s_xy * w.n[0] + s_yy * w.n[1]) * v[1]


class BodyElements:
    """M D'' + K D = F of a body on its mesh, clamped unknowns left out.

    A clamp or a load off the outline is a `ValueError`.
    """

    def __init__(self, body: PlaneBody) -> None:
        self.body = body
        self.mesh = mesh_of(body)
        self.basis = elasticity.vector_basis(self.mesh, body.degree)
        self.free = np.setdiff1d(np.arange(self.basis.N), self._fixed())
        self._mass = elasticity.mass(self.basis, body.density)
        self.M = csr_array(self._mass[self.free][:, self.free])
        self.K = csr_array(self.elastic()[self.free][:, self.free])
        self.F = self._load()[self.free]

    def elastic(self) -> csr_array:
        """The stiffness of all unknowns [N/m]."""
        return elasticity.stiffness(self.basis, self.body)

    def _facets(self, part: Segment) -> Indices:
        return facets_between(self.mesh, *part, self.body.slack)

    def _fixed(self) -> Indices:
        fixed = [np.empty(0, np.int64)]
        for clamp in self.body.clamps:
            fixed.append(self.basis.get_dofs(self._facets(clamp)).all())
        component = elasticity.components(self.basis)
        for part, axis in self.body.rollers:
            require(axis in ("x", "y"), "rollers", "must be along 'x' or 'y'", axis)
            dofs = self.basis.get_dofs(self._facets(part)).all()
            fixed.append(dofs[component[dofs] == "xy".index(axis)])
        return np.concatenate(fixed).astype(np.int64)

    def _load(self) -> Array:
        body = self.body
        F: Array = self._mass @ (elasticity.rigid_motions(self.basis)[:, :2] @ np.array(body.gravity))
        for part, traction in body.tractions:
            F = F + self._pushed(part, traction)
        for place, force in body.forces:
            rows = self._means[:2] if place is None else self._at(place)
            F = F + np.array(force) @ rows
        if any(body.stress):
            clamped = np.hstack([[], *(self._facets(clamp) for clamp in body.clamps)])
            loaded = np.setdiff1d(self.mesh.boundary_facets(), clamped)
            F = F + _traction.assemble(self._edge(loaded), stress=body.stress)
        return F

    def _edge(self, facets: Indices) -> FacetBasis:
        return FacetBasis(self.mesh, self.basis.elem, facets=facets, intorder=2 * self.body.degree)

    def _pushed(self, part: Segment, traction: Traction) -> Array:
        """Load of a traction on a part of the outline."""
        edge = self._edge(self._facets(part))
        x, y = traction(np.asarray(edge.global_coordinates())) if callable(traction) else traction
        return np.asarray(_displacement.assemble(edge, x_part=x, y_part=y))

    def _at(self, place: Point) -> Array:
        """Rows of u and v of all unknowns at a point, shape (2, all)."""
        u, v, _ = elasticity.point_values(self.basis, np.array(place, float))
        return np.array([u, v])

    @cached_property
    def _means(self) -> Array:
        parts = [_displacement.assemble(self.basis, x_part=x, y_part=y) for x, y in ((1.0, 0.0), (0.0, 1.0))]
        u_x, u_y, v_x, v_y = (_gradient.assemble(self.basis, i=i, j=j) for i in (0, 1) for j in (0, 1))
        parts += [(v_x - u_y) / 2, u_x, v_y, u_y + v_x]
        return np.array(parts) / float(self.basis.dx.sum())

    @property
    def means(self) -> Array:
        """Rows of the means over the body of u, v, rotation, e_xx, e_yy and g_xy, shape (6, unknowns)."""
        return self._means[:, self.free]

    def observer(self, start: Point, end: Point) -> Array:
        """The rows of the mean displacement in x and y of a part of the outline, or of a point, (2, unknowns).

        A `ValueError` if nothing lies there.
        """
        if start == end:
            return self._at(start)[:, self.free]
        length = float(np.hypot(*np.subtract(end, start)))
        rows = np.array([self._pushed((start, end), unit) for unit in ((1.0, 0.0), (0.0, 1.0))])
        return rows[:, self.free] / length

    def stresses(self, strains: Array) -> Array:
        """Return s_xx, s_yy and s_xy [Pa] of strains e_xx, e_yy, g_xy, each along the first axis."""
        body = self.body
        e_xx, e_yy, g_xy = strains
        dilatation = body.lame * (e_xx + e_yy)
        shear = body.shear_modulus
        return np.array([dilatation + 2 * shear * e_xx, dilatation + 2 * shear * e_yy, shear * g_xy])

    def stress_error(self, D: Array) -> float:
        """The largest difference of a stress component from the loads' own, over the largest of these.

        A `ValueError` if the loads are not those of a stress.
        """
        stress = np.array(self.body.stress)
        if not np.any(stress):
            raise ValueError("stress: must be stated, got none")
        full = np.zeros(self.basis.N)
        full[self.free] = D
        gradient = self.basis.interpolate(full).grad
        strains = np.array([gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]])
        return float(np.max(abs(self.stresses(strains) - stress[:, None, None])) / np.max(abs(stress)))

    @cached_property
    def rigid(self) -> Array:
        """Unit displacements in x and y and the turn about (0, 0) of all that is free, shape (unknowns, 3)."""
        return np.asarray(elasticity.rigid_motions(self.basis)[self.free])

    @cached_property
    def motions(self) -> Array:
        """Rigid motions that no clamp and no roller holds, shape (unknowns, 0 to 3)."""
        fixed = self._fixed()
        if not len(fixed):
            return self._centred
        return np.asarray(self._centred[self.free] @ null_space(self._centred[fixed], rcond=1e-9))

    @cached_property
    def _centred(self) -> Array:
        """Rigid motions of all unknowns, the turn about the body's middle: far from (0, 0) it keeps its digits so."""
        rigid = elasticity.rigid_motions(self.basis)
        x, y = np.mean(self.body.extent, axis=0)
        rigid[:, 2] += y * rigid[:, 0] - x * rigid[:, 1]
        return rigid

    def velocity(self) -> Array:
        """Velocity of the unknowns at t = 0 [m/s]."""
        momentum = self.M @ self.rigid[:, :2]
        mass = np.diag(self.rigid[:, :2].T @ momentum)
        x, y = self.body.velocity
        spin = self.body.spin
        turned = self._centred[self.free, 2]
        drift = momentum.T @ turned / mass
        return np.asarray(self.rigid[:, :2] @ np.array([x, y] - spin * drift) + spin * turned)
