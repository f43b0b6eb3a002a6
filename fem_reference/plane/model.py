"""Matrices, loads and observers of a plane body, and what it answers: at rest, by modes, step by step."""

from __future__ import annotations

import time
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, csr_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem import FacetBasis, LinearForm

from fem_reference.mesh import elasticity
from fem_reference.plane.body import PlaneBody, Point, facets_between, mesh_of
from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.result import Mode, Result
from fem_reference.scheme.eigen import eigenvalues, largest_frequency
from fem_reference.scheme.newmark import Stepper, Work

SHIFT = 1e-3  # of the square of the lowest frequency of a shear wave: keeps K + shift M definite where a body is free
UNBALANCED = 1e-9  # of the sum of the loads' sizes: what rounding leaves of a balanced load


@LinearForm
def _push_x(v, w):  # type: ignore[no-untyped-def]
    return v[0]


@LinearForm
def _push_y(v, w):  # type: ignore[no-untyped-def]
    return v[1]


@LinearForm
def _traction(v, w):  # type: ignore[no-untyped-def]
    """S n . v of a constant stress."""
    s_xx, s_yy, s_xy = w.stress
    return (s_xx * w.n[0] + s_xy * w.n[1]) * v[0] + (s_xy * w.n[0] + s_yy * w.n[1]) * v[1]


class PlaneModel:
    """M D'' + K D = F of a body on its mesh, clamped unknowns left out.

    Raises
    ------
    ValueError
        A clamp or a load does not lie on the outline.
    """

    def __init__(self, body: PlaneBody) -> None:
        self.body = body
        self.mesh = mesh_of(body)
        self.basis = elasticity.vector_basis(self.mesh, body.degree)
        fixed = [self.basis.get_dofs(self._facets(*clamp)).all() for clamp in body.clamps]
        self.free = np.setdiff1d(np.arange(self.basis.N), np.concatenate([*fixed, np.empty(0, int)]).astype(int))
        mass = elasticity.mass(self.basis, body.density)
        stiffness = self.elastic()
        self.M = csr_array(mass[self.free][:, self.free])
        self.K = csr_array(stiffness[self.free][:, self.free])
        self.F = self._load(mass)[self.free]

    def elastic(self) -> csr_array:
        """Return the stiffness of all unknowns [N/m]."""
        return elasticity.stiffness(self.basis, self.body)  # type: ignore[arg-type]  # which reads its moduli alone

    def _facets(self, start: Point, end: Point) -> NDArray[np.int64]:
        return facets_between(self.mesh, start, end, self.body.slack)

    def _edge(self, start: Point, end: Point) -> FacetBasis:
        return FacetBasis(self.mesh, self.basis.elem, facets=self._facets(start, end), intorder=2 * self.body.degree)

    def _load(self, mass: csr_array) -> Array:
        body = self.body
        F: Array = mass @ (elasticity.translation(self.basis) @ np.array(body.gravity))
        for (start, end), (x, y) in body.tractions:
            edge = self._edge(start, end)
            F = F + x * _push_x.assemble(edge) + y * _push_y.assemble(edge)
        if any(body.stress):
            outline = self.mesh.boundary_facets()
            clamped = [self._facets(*clamp) for clamp in body.clamps]
            loaded = np.setdiff1d(outline, np.concatenate([*clamped, np.empty(0, np.int64)]))
            F = F + _traction.assemble(FacetBasis(self.mesh, self.basis.elem, facets=loaded), stress=body.stress)
        return F

    def observer(self, start: Point, end: Point) -> Array:
        """Return the rows of the mean displacement in x and y of a part of the outline, or of a point, (2, unknowns).

        Raises
        ------
        ValueError
            Nothing lies there.
        """
        if start == end:
            u, v, _ = elasticity.point_values(self.basis, np.array(start))
            return np.array([u, v], dtype=float)[:, self.free]
        edge = self._edge(start, end)
        length = float(np.hypot(*np.subtract(end, start)))
        rows: Array = np.array([_push_x.assemble(edge), _push_y.assemble(edge)])[:, self.free] / length
        return rows

    @cached_property
    def motions(self) -> Array:
        """Rigid motions of a body that nothing holds, (unknowns, 3); none of a clamped one."""
        if self.body.clamps:
            return np.zeros((len(self.free), 0))
        x, y = self.basis.doflocs
        component = elasticity.components(self.basis)
        turn = np.where(component == 0, -y, x)
        motions: Array = np.column_stack([elasticity.translation(self.basis), turn])[self.free]
        return motions

    @cached_property
    def rest(self) -> Array:
        """Displacements at rest, orthogonal to the rigid motions of a free body, (unknowns,).

        Raises
        ------
        ValueError
            Nothing is clamped and the loads have a resultant.
        """
        momentum = self.M @ self.motions
        resultant = self.motions.T @ self.F
        size = float(np.sum(abs(self.F)))
        if np.any(abs(resultant) > UNBALANCED * size * np.max(abs(self.motions), axis=0, initial=0.0)):
            raise ValueError("load: must be in balance where nothing is clamped, got a resultant")
        if not self.motions.shape[1]:
            return Work().factor(self.K)(self.F)
        weight = self.body.young / float(abs(momentum).max())  # rows of the size of the others
        border = csr_array(weight * momentum)
        matrix = block_array([[self.K, border], [border.T, None]], format="csc")
        return np.asarray(splu(matrix).solve(np.concatenate([self.F, np.zeros(border.shape[1])]))[: len(self.F)])

    def stress_error(self) -> float:
        """Return the largest difference of a stress component at rest from the loads' own, over the largest of these.

        Raises
        ------
        ValueError
            The loads are not those of a stress.
        """
        stress = np.array(self.body.stress)
        if not np.any(stress):
            raise ValueError("stress: must be stated, got none")
        D = np.zeros(self.basis.N)
        D[self.free] = self.rest
        gradient = self.basis.interpolate(D).grad
        e_xx = gradient[0, 0]
        e_yy = gradient[1, 1]
        g_xy = gradient[0, 1] + gradient[1, 0]
        lame = self.body.lame
        shear = self.body.shear_modulus
        dilatation = lame * (e_xx + e_yy)
        found = np.array([dilatation + 2 * shear * e_xx, dilatation + 2 * shear * e_yy, shear * g_xy])
        return float(np.max(abs(found - stress[:, None, None])) / np.max(abs(stress)))

    def modes(self, scheme: Scheme, count: int) -> tuple[Mode, ...]:
        """Return the lowest modes that are no rigid motion, in rising order."""
        body = self.body
        reach = float(np.max(body.extent[1] - body.extent[0]))
        shift = SHIFT * body.shear_modulus / body.density * (np.pi / reach) ** 2
        rigid = self.motions.shape[1]
        inverse = Work().factor(csr_array(self.K + shift * self.M))
        start = np.random.default_rng(0).standard_normal(len(self.F))
        operator = LinearOperator(self.K.shape, matvec=inverse, dtype=float)
        squares, shapes = eigsh(self.K, count + rigid, self.M, sigma=-shift, OPinv=operator, v0=start)
        order = np.argsort(squares)[rigid:]
        squares = squares[order]
        shapes = shapes[:, order]
        work = float(self.F @ self.rest)
        shares = (shapes.T @ self.F) ** 2 / (squares * work) if work else np.zeros(count)
        frequencies = np.sqrt(squares)
        return tuple(
            Mode(float(w), float(share), eigenvalues(float(w), scheme))
            for w, share in zip(frequencies, shares, strict=True)
        )

    def highest_frequency(self) -> float:
        """Return the largest natural frequency, which limits a conditionally stable scheme [rad/s]."""
        return largest_frequency(self.K, self.M)

    def history(self, scheme: Scheme, steps: int, rows: Array) -> Result:
        """Return what some rows observe of the body from rest, at each step.

        Parameters
        ----------
        rows : (columns, unknowns) array
            As `observer` returns them; the columns of the result are named by their numbers.
        """
        began = time.perf_counter()
        stepper = Stepper(self.M, self.K, self.F, scheme)
        ready = time.perf_counter()
        observed = np.empty((len(rows), steps))
        with np.errstate(over="ignore", invalid="ignore"):
            for n, state in enumerate(stepper.states(steps)):
                observed[:, n] = rows @ state.D
        return Result(
            time=np.asarray(scheme.step * np.arange(1, steps + 1), dtype=np.float64),
            columns={str(i): values for i, values in enumerate(observed)},
            unknowns=len(self.F),
            **vars(stepper.work),
            notes=(),
            setup_seconds=ready - began,
            stepping_seconds=time.perf_counter() - ready,
        )
