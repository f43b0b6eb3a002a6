"""Weak forms of plane elasticity, and functions of the displacement along an edge or at a point.

With the Lame parameter lam of the plane problem and the shear modulus G::

    mass       rho (u, v)
    stiffness  lam (div u, div v) + 2 G (eps(u), eps(v))
    springs    sum of weight_n (n.u)(n.v) + weight_t (t.u)(t.v) over the points of a rule on the base
    load       -q (1, v_y) + tau (1, v_x) on the top, rho g (sin b (1, v_x) - cos b (1, v_y)) in the block

The foundation, distributed, over patches or at the corners, is a quadrature rule on the base; its
intervals end where a patch ends, so that it is integrated exactly on any mesh.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csr_array, diags_array
from skfem import Basis, BilinearForm, ElementQuad1, ElementQuad2, ElementTriP1, ElementTriP2, ElementVector, Mesh
from skfem.helpers import ddot, div, dot, sym_grad

from fem_reference.problem.material import Elastic
from fem_reference.problem.problem import Array, Indices, Problem

ELEMENTS = {(3, 1): ElementTriP1, (3, 2): ElementTriP2, (4, 1): ElementQuad1, (4, 2): ElementQuad2}
"""Scalar element by (corners of a cell, degree)."""
LUMPED = {
    1: (np.array([-1.0, 1.0]), np.ones(2)),
    2: (np.array([-1.0, 1.0, 0.0]), np.array([1.0, 1.0, 4.0]) / 3),
}
"""Points at the nodes of an edge of an element with their weights, by degree."""
WHOLE = (-np.inf, np.inf)
SLIVER = 1e-12
"""Piece of a facet over its length that only rounding leaves between an interval's end and the facet's."""
CONVERGED = 1e-14
"""Step of Newton's method in a cell's own coordinates, from 0 to 1, that only rounding leaves."""


@BilinearForm
def mass_form(u, v, w):  # type: ignore[no-untyped-def]
    """(u, v)."""
    return dot(u, v)


@BilinearForm
def dilatation_form(u, v, w):  # type: ignore[no-untyped-def]
    """(div u, div v)."""
    return div(u) * div(v)


@BilinearForm
def strain_form(u, v, w):  # type: ignore[no-untyped-def]
    """2 (eps(u), eps(v))."""
    return 2 * ddot(sym_grad(u), sym_grad(v))


class Rule(NamedTuple):
    """Points on facets with weights."""

    points: Array  # reference coordinates in the cell, shape (2, count)
    cells: Indices  # cell of each point, shape (count,)
    weights: Array  # weights [m], shape (count,)


def vector_basis(mesh: Mesh, degree: int) -> Basis:
    """Displacement basis of a degree on a mesh of triangles or quadrilaterals."""
    element = ElementVector(ELEMENTS[mesh.t.shape[0], degree]())
    # One order beyond 2 * degree per direction integrates the Jacobian of a bilinear cell exactly.
    return Basis(mesh, element, intorder=2 * degree + 1)


def assembled(terms: list[tuple[float, BilinearForm]], basis: Basis, congruent: bool) -> csr_array:
    """Matrix of a sum of coefficients times forms; a term whose coefficient is zero leaves no entry.

    `congruent`: all cells are translates of the first one, whose element matrix is that of all.
    """
    terms = [(coefficient, form) for coefficient, form in terms if coefficient != 0]
    if not congruent:
        parts = [coefficient * csr_array(form.assemble(basis)) for coefficient, form in terms]
        return functools.reduce(operator.add, parts)
    first = Basis(basis.mesh, basis.elem, quadrature=basis.quadrature, elements=np.array([0]))
    local = sum(coefficient * form.elemental(first).tolocal()[0] for coefficient, form in terms)
    dofs = basis.element_dofs.T.astype(np.int32)
    rows = np.repeat(dofs, dofs.shape[1], axis=1)
    columns = np.tile(dofs, dofs.shape[1])
    data = np.tile(local.ravel(), len(dofs))
    return csr_array(coo_array((data, (rows.ravel(), columns.ravel())), shape=(basis.N, basis.N)))


def mass(basis: Basis, density: float, congruent: bool = False) -> csr_array:
    """Consistent mass matrix [kg]; `congruent` as in `assembled`."""
    return assembled([(density, mass_form)], basis, congruent)


def stiffness(basis: Basis, body: Elastic, congruent: bool = False) -> csr_array:
    """Elastic stiffness matrix [N/m]; `congruent` as in `assembled`."""
    return assembled([(body.shear_modulus, strain_form), (body.lame, dilatation_form)], basis, congruent)


def values(basis: Basis, rule: Rule) -> tuple[csr_array, csr_array]:
    """Matrices that give u and v at the points of a rule, each of shape (count, unknowns)."""
    dofs = basis.element_dofs[:, rule.cells]  # of u and v in turn
    phi = np.array([basis.elem.elem.lbasis(rule.points, k)[0] for k in range(basis.Nbfun // 2)])
    rows = np.tile(np.arange(len(rule.cells)), len(phi))
    shape = (len(rule.cells), basis.N)
    u, v = (csr_array(coo_array((phi.ravel(), (rows, dofs[i::2].ravel())), shape=shape)) for i in (0, 1))
    return u, v


def across_and_along(problem: Problem, basis: Basis, rule: Rule) -> tuple[csr_array, csr_array]:
    """Rows of the displacements normal to the base, into the block, and along it at the points of a rule."""
    u, v = values(basis, rule)
    across, along = (csr_array(x * u + y * v) for x, y in (problem.normal, problem.tangent))
    return across, along


def in_order(basis: Basis, rule: Rule, tangent: Array) -> tuple[Rule, Array]:
    """A rule in the order of its points along a direction, and their places in it [m]."""
    along = tangent @ basis.mapping.F(rule.points[:, :, None], rule.cells)[:, :, 0]
    order = np.argsort(along, kind="stable")
    return Rule(rule.points[:, order], rule.cells[order], rule.weights[order]), along[order]


def edge_rule(
    mesh: Mesh,
    facets: Indices,
    origin: Array,
    tangent: Array,
    intervals: Sequence[tuple[float, float]],
    quadrature: tuple[Array, Array],
) -> Rule:
    """Rule over the part of a straight edge, given by its facets, that lies in disjoint intervals of arc length [m].

    `origin` and `tangent` are its start and unit direction; `quadrature` has places from -1 to 1 and weights on each
    piece: `gauss`, or one of `LUMPED`.
    """
    nodes, weights = quadrature
    cells = mesh.f2t[0, facets]
    ends = mesh.facets[:, facets]
    local = mesh.elem.refdom.p[:, [np.argmax(mesh.t[:, cells] == end, axis=0) for end in ends]]
    s = np.tensordot(tangent, mesh.p[:, ends] - origin[:, None, None], 1)
    pieces = []
    for low, high in intervals:
        pair = np.clip(s, low, high)
        share = (pair - s[0]) / (s[1] - s[0])
        kept = np.flatnonzero(np.ptp(share, axis=0) > SLIVER)
        fraction = share[0, kept] + (1 + nodes[:, None]) / 2 * (share[1] - share[0])[kept]
        points = local[:, :1, kept] + fraction * (local[:, 1:] - local[:, :1])[:, :, kept]
        sizes = np.outer(weights, np.ptp(pair, axis=0)[kept] / 2)
        pieces.append(Rule(points.reshape(2, -1), np.tile(cells[kept], len(nodes)), sizes.ravel()))
    return together(pieces)


def together(rules: Sequence[Rule]) -> Rule:
    """The points of all rules."""
    return Rule(*(np.concatenate(parts, axis=-1) for parts in zip(*rules, strict=True)))


def gauss(degree: int) -> tuple[Array, Array]:
    """Gauss points and weights that are exact for products of two elements of a degree."""
    return np.polynomial.legendre.leggauss(degree + 1)


def springs(basis: Basis, problem: Problem, rule: Rule) -> tuple[csr_array, Array]:
    """Spring stiffness [N/m] and the row that gives the contact pressure [Pa/m].

    The weights of `rule` sum to its length (or to the number of points); the whole foundation carries
    2 p normally and 2 p_s tangentially.
    """
    normal, tangential = across_and_along(problem, basis, rule)
    share = 2 * rule.weights / _carried(problem)
    k_n = problem.stiffness * share
    k_t = problem.shear_stiffness * share
    K = normal.T @ diags_array(k_n) @ normal + tangential.T @ diags_array(k_t) @ tangential
    return csr_array(K), -(normal.T @ k_n) / problem.base_length


def _carried(problem: Problem) -> float:
    """Sum of the weights of the whole foundation's rule."""
    if problem.foundation == "corner":
        return 2.0
    return problem.base_length if problem.patch_width is None else 2 * problem.patch_width


def foundation_rule(problem: Problem, basis: Basis, base: Indices, half: bool = False) -> Rule:
    """Rule of the foundation on the base; of its first half only if `half`."""
    a = problem.base_length
    w = problem.patch_width
    if problem.foundation == "corner":
        return together([point_rule(basis, end) for end in problem.outline[: 1 if half else 2]])
    quadrature = LUMPED[1] if problem.foundation == "nodes" else gauss(problem.degree)
    intervals = [WHOLE] if w is None or 2 * w >= a else [(-np.inf, w), (a - w, np.inf)]
    return edge_rule(basis.mesh, base, np.zeros(2), problem.tangent, intervals, quadrature)


def load(basis: Basis, problem: Problem, top: Indices, M: csr_array) -> Array:
    """Load vector of pressure, traction and gravity [N], shape (unknowns,)."""
    start, end = problem.top_ends
    tangent = (end - start) / problem.top_length
    F = M @ (rigid_motions(basis)[:, :2] @ np.array(problem.pull))
    for component, size, interval in ((1, -problem.pressure, problem.pressed), (0, problem.traction, WHOLE)):
        rule = edge_rule(basis.mesh, top, start, tangent, [interval], gauss(problem.degree))
        F = F + size * (values(basis, rule)[component].T @ rule.weights)
    return np.asarray(F)


def rigid_motions(basis: Basis) -> Array:
    """Unknowns of the unit translations and of the turn by one about the origin, shape (unknowns, 3)."""
    x, y = basis.doflocs
    v = components(basis)
    return np.column_stack([1 - v, v, np.where(v == 0, -y, x)])


def components(basis: Basis) -> Array:
    """Component (0: u, 1: v) of each unknown of a displacement basis, shape (unknowns,)."""
    component = np.zeros(basis.N)
    for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
        component[dofs[1::2]] = 1.0
    return component


def point_values(basis: Basis, point: Array) -> tuple[Array, Array, Array]:
    """Rows that give u, v and the rotation (dv/dx - du/dy) / 2 at a point of the mesh, each (unknowns,)."""
    rule = _cells_at(basis, point)
    u, v = values(basis, _first(rule))
    return u.toarray()[0], v.toarray()[0], _rotation(basis, rule)


def point_rule(basis: Basis, point: Array) -> Rule:
    """Unit weight at a point of the mesh; a `ValueError` for a point outside of it."""
    return _first(_cells_at(basis, point))


def _first(rule: Rule) -> Rule:
    """The first point of a rule, with unit weight."""
    return Rule(rule.points[:, :1], rule.cells[:1], np.ones(1))


def _cells_at(basis: Basis, point: Array) -> Rule:
    """A point in each of the cells that meet there, with equal weights, whose sum is one."""
    corners = basis.mesh.p[:, basis.mesh.t]
    x = point[:, None]
    slack = 1e-9 * np.ptp(basis.mesh.p)
    inside = (corners.min(axis=1) <= x + slack) & (corners.max(axis=1) >= x - slack)
    cells = np.flatnonzero(inside.all(axis=0))
    # By Newton's method: a bilinear map needs few steps near its cell; where it fails the point is not in that cell.
    target = np.repeat(x[:, :, None], len(cells), axis=1)
    places = np.full(target.shape, 0.5)
    with np.errstate(all="ignore"):
        for _ in range(12):
            inverse = basis.mapping.invDF(places, cells)
            step = np.einsum("ijkl,jkl->ikl", inverse, target - basis.mapping.F(places, cells))
            places = places + step
            if not np.any(np.abs(step) > CONVERGED):
                break
    local = places[:, :, 0]
    outside = np.maximum(-local, local - 1).max(axis=0, initial=-np.inf)
    if basis.mesh.t.shape[0] == 3:
        outside = np.maximum(outside, local.sum(axis=0) - 1)
    hits = np.flatnonzero(outside < 1e-9)
    if len(hits) == 0:
        raise ValueError(f"vertices: the centroid must lie inside the block, got {tuple(point)} from the base's start")
    return Rule(local[:, hits], cells[hits], np.full(len(hits), 1 / len(hits)))


def _rotation(basis: Basis, rule: Rule) -> Array:
    """Row of the mean of (dv/dx - du/dy) / 2 over the cells that meet at a point, shape (unknowns,).

    It is discontinuous between them.
    """
    row = np.zeros(basis.N)
    inverse = basis.mapping.invDF(rule.points[:, :, None], rule.cells)[..., 0]
    for k in range(basis.Nbfun // 2):
        slope = basis.elem.elem.lbasis(rule.points, k)[1]
        u, v = basis.element_dofs[2 * k : 2 * k + 2, rule.cells]
        d_dx, d_dy = np.einsum("ijk,ik->jk", inverse, slope)
        np.add.at(row, u, -rule.weights * d_dy / 2)
        np.add.at(row, v, rule.weights * d_dx / 2)
    return row
