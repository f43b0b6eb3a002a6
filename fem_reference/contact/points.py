"""The elements on contact points of their base, which bear springs that carry no tension.

A distributed foundation becomes points at the nodes of the base with positive weights that keep the whole
length: h/2, h/2 on a linear element edge of length h, Simpson's h/6, 4h/6, h/6 on a quadratic one. Any other
foundation keeps the points of its own quadrature rule.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack
from skfem import Basis

from fem_reference.contact.system import ContactSystem, point_rows
from fem_reference.mesh import elasticity
from fem_reference.mesh.mesh import block_mesh
from fem_reference.mesh.model import assemble, column_applies, line_of
from fem_reference.problem.checks import require
from fem_reference.problem.motion import Motion as BaseMotion
from fem_reference.problem.problem import Array, Problem
from fem_reference.scheme.stage import Motion

SAME_PLACE = 1e-9
"""Distance below which two points of the base are one, as a share of its length [-]."""


@dataclass(frozen=True)
class ContactModel:
    """M D'' + K D = F + normal' N + tangential' T, with the forces N, T of the base's points on the block."""

    M: csr_array  # consistent mass matrix [kg], shape (unknowns, unknowns)
    K: csr_array  # elastic stiffness without the springs of the base [N/m]
    F: Array  # constant load [N], shape (unknowns,)
    normal: csr_array  # rows that give the normal displacement of each point, into the block [-], (points, unknowns)
    tangential: csr_array  # rows that give the displacement of each point along the base [-], shape (points, unknowns)
    share: Array  # share of the base that belongs to each point [-], shape (points,); its sum is one
    stiffness: Array  # normal stiffness of each point, 2 p times its share [N/m]
    shear_stiffness: Array  # tangential stiffness of each point, 2 p_s times its share [N/m]
    upwards: Array  # unknowns of a unit translation upwards [-], shape (unknowns,)
    motions: Array  # rigid motions without the springs of the base, shape (unknowns, 1 or 3)
    observers: dict[str, Array]  # rows that give v, u and the rotation at the centroid, shape (unknowns,)
    kind: str  # ``"whole"`` or ``"column"``
    length: float  # length a of the base [m]
    axes: Array  # unit vectors normal to the base, into the block, and along it, shape (2, 2)
    motion: BaseMotion | None  # motion of the base

    def system(self, shear: str = "frictionless", friction: Friction | None = None) -> ContactSystem:
        """The block on rows that open, and on shear springs that hold them where ``shear`` is ``"glued"``."""
        shear_stiffness = self.shear_stiffness * (shear == "glued")
        tangent = None if friction is None else friction.tangent
        cohesion = 0.0 if friction is None else friction.cohesion
        rows = point_rows(self.stiffness, shear_stiffness, tangent, cohesion * self.length * self.share)
        sides = len(rows.compliance) // len(self.share)  # normal to the base, and along it where shear springs are
        names = ("displacement", "horizontal_displacement", "rotation")
        momentum = self.M @ self.upwards
        size = len(self.F)
        return ContactSystem(
            M=self.M,
            K=self.K,
            F=self.F,
            B=csr_array(vstack([self.normal, self.tangential][:sides])),
            rows=rows,
            watch=Motion(
                np.array([self.observers[name] for name in names]),
                (momentum / float(self.upwards @ momentum))[None],
                np.zeros((0, size)),
            ),
            pushes=np.zeros((size, 0)),
            ground=np.repeat(np.eye(2)[:sides], len(self.share), axis=0),
            prescribed=self._base,
            start_parts=np.zeros(2),
            motions=(self.motions,),
        )

    def _base(self, positions: Array, times: Array) -> Array:
        """Displacement of the base normal to it and along it, shape (steps, stages, 2) [m]."""
        if self.motion is None:
            return np.zeros((*times.shape, 2))
        return np.asarray(self.motion(times.ravel()) @ self.axes.T).reshape(*times.shape, 2)


@dataclass(frozen=True)
class Friction:
    """Coulomb's friction along the base, |T| <= tan(angle) N + cohesion times a point's length of the base.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    angle: float  # friction angle [deg], from 0 to below 90
    cohesion: float = 0.0  # shear stress that a closed base bears without any pressure [Pa]

    def __post_init__(self) -> None:
        require(0 <= self.angle < 90, "friction", "must be at least 0 and below 90", self.angle)
        require(0 <= self.cohesion < math.inf, "cohesion", "must be finite and not negative", self.cohesion)

    @property
    def tangent(self) -> float:
        """Tangent of the angle [-]."""
        return math.tan(math.radians(self.angle))


def build(problem: Problem, full: bool = False) -> ContactModel:
    """Model of the block on points, of one column of elements where all vertical lines move alike.

    Parameters
    ----------
    problem
        The block; its foundation says where the points are.
    full
        Model the whole block in any case.

    Raises
    ------
    ValueError
        If the block cannot be meshed, or its base is not where the block stands at t = 0.
    """
    if problem.motion is not None and np.any(start := problem.motion(np.zeros(1))[0]):
        raise ValueError(f"motion: must be zero at t = 0 where contact opens, got {tuple(start.tolist())}")
    return column(problem) if column_applies(problem) and not full else whole(problem)


def column(problem: Problem) -> ContactModel:
    """One column of elements, v(y) on a line, with one contact point: matrices E W (v', v') and rho W (v, v).

    Raises
    ------
    ValueError
        If the block is not an upright rectangle.
    """
    line = line_of(problem)
    size = len(line.height)
    none = np.zeros(size)
    return ContactModel(
        M=line.mass,
        K=problem.young * line.stretch,  # with mu = 0 the modulus of a bar, lam + 2 G, is E
        F=line.load(problem),
        normal=csr_array(line.base[None]),
        tangential=csr_array((1, size)),
        share=np.ones(1),
        stiffness=np.array([2 * problem.stiffness]),
        shear_stiffness=np.array([2 * problem.shear_stiffness]),
        upwards=np.ones(size),
        motions=np.ones((size, 1)),
        observers={
            "displacement": line.middle,
            "horizontal_displacement": none,
            "rotation": none,
        },
        kind="column",
        length=line.width,
        axes=np.array([problem.normal, problem.tangent]),
        motion=problem.motion,
    )


def whole(problem: Problem) -> ContactModel:
    """The whole block.

    Raises
    ------
    ValueError
        If the block cannot be meshed.
    """
    assembled = assemble(problem)
    basis = assembled.basis
    rule = base_rule(problem, basis, block_mesh(problem).base)
    rule, weights = merged(problem, basis, rule)
    u, v = elasticity.values(basis, rule.points, rule.cells)
    n = problem.normal
    t = problem.tangent
    share = weights / weights.sum()
    return ContactModel(
        M=assembled.M,
        K=assembled.K,
        F=assembled.F,
        normal=csr_array(n[0] * u + n[1] * v),
        tangential=csr_array(t[0] * u + t[1] * v),
        share=share,
        stiffness=2 * problem.stiffness * share,
        shear_stiffness=2 * problem.shear_stiffness * share,
        upwards=elasticity.components(basis),
        motions=elasticity.rigid_motions(basis),
        observers={name: row for name, row in assembled.observers.items() if name != "contact_pressure"},
        kind="whole",
        length=problem.base_length,
        axes=np.array([n, t]),
        motion=problem.motion,
    )


def base_rule(problem: Problem, basis: Basis, facets: NDArray[np.int64]) -> elasticity.Rule:
    """Points of the base with weights; a node that two facets share comes twice."""
    if problem.foundation != "distributed":
        return elasticity.foundation_rule(problem, basis, facets)
    ends = elasticity.node_rule(basis.mesh, facets)
    if problem.degree == 1:
        return ends
    count = len(facets)
    middle = (ends.points[:, :count] + ends.points[:, count:]) / 2
    return elasticity.Rule(
        np.hstack([ends.points, middle]),
        np.concatenate([ends.cells, ends.cells[:count]]),
        np.concatenate([ends.weights / 3, 4 * ends.weights[:count] / 3]),
    )


def merged(problem: Problem, basis: Basis, rule: elasticity.Rule) -> tuple[elasticity.Rule, Array]:
    """The rule with each place once, in the order along the base, and the weights [m]."""
    x = basis.mapping.F(rule.points[:, :, None], rule.cells)[:, :, 0]
    along = problem.tangent @ x
    order = np.argsort(along, kind="stable")
    fresh = np.append(True, np.diff(along[order]) > SAME_PLACE * problem.base_length)
    weights = np.zeros(np.count_nonzero(fresh))
    np.add.at(weights, np.cumsum(fresh) - 1, rule.weights[order])
    distinct = order[fresh]
    return elasticity.Rule(rule.points[:, distinct], rule.cells[distinct], weights), weights
