"""The elements on contact points of their base, which bear springs that carry no tension.

A distributed foundation becomes points at the nodes of the base with positive weights that keep the whole
length: h/2, h/2 on a linear element edge of length h, Simpson's h/6, 4h/6, h/6 on a quadratic one. Any other
foundation keeps the points of its own quadrature rule.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.sparse import csr_array, vstack

from fem_reference.contact.system import ContactSystem, point_rows, with_springs
from fem_reference.mesh import elasticity
from fem_reference.mesh.mesh import block_mesh
from fem_reference.mesh.model import assemble, column_applies, line_of
from fem_reference.problem.checks import require
from fem_reference.problem.motion import moved_base
from fem_reference.problem.problem import Array, Problem
from fem_reference.scheme.eigen import largest_frequency
from fem_reference.scheme.stage import Motion

OBSERVED = ("displacement", "horizontal_displacement", "rotation")
SAME_PLACE = 1e-9
"""Distance below which two points of the base are one, as a share of its length [-]."""


@dataclass(frozen=True)
class ContactModel:
    """M D'' + K D = F + normal' N + tangential' T, with the forces N, T of the base's points on the block."""

    problem: Problem
    M: csr_array  # consistent mass matrix [kg], shape (unknowns, unknowns)
    K: csr_array  # elastic stiffness without the springs of the base [N/m]
    F: Array  # constant load [N], shape (unknowns,)
    sides: tuple[csr_array, csr_array]
    """Rows that give the displacement of each point normal to the base, into the block, and along it [-]."""
    share: Array  # share of the base that belongs to each point [-], shape (points,); its sum is one
    motions: Array  # rigid motions without the springs of the base, shape (unknowns, 1 or 3)
    upwards: Array  # unknowns of a unit translation upwards [-], shape (unknowns,)
    observers: Array  # rows that give v, u and the rotation at the centroid, shape (3, unknowns)
    kind: str  # ``"whole"`` or ``"column"``

    def system(self, shear: str = "frictionless", friction: Friction | None = None) -> ContactSystem:
        """The block on rows that open, and on shear springs that hold them where ``shear`` is ``"glued"``."""
        problem = self.problem
        stiffness = 2 * problem.stiffness * self.share
        shear_stiffness = 2 * problem.shear_stiffness * self.share * (shear == "glued")
        tangent = None if friction is None else friction.tangent
        cohesion = 0.0 if friction is None else friction.cohesion
        rows = point_rows(stiffness, shear_stiffness, tangent, cohesion * problem.base_length * self.share)
        sides = len(rows.compliance) // len(self.share)  # normal to the base, and along it where shear springs are
        momentum = self.M @ self.upwards
        size = len(self.F)
        return ContactSystem(
            M=self.M,
            K=self.K,
            F=self.F,
            B=csr_array(vstack(self.sides[:sides])),
            rows=rows,
            watch=Motion(self.observers, (momentum / float(self.upwards @ momentum))[None], np.zeros((0, size))),
            pushes=np.zeros((size, 0)),
            ground=np.repeat([problem.normal, problem.tangent][:sides], len(self.share), axis=0),
            prescribed=partial(moved_base, problem.motion),
            start_parts=np.zeros(2),
            motions=(self.motions,),
        )


@dataclass(frozen=True)
class Friction:
    """Coulomb's friction along the base, |T| <= tan(angle) N + cohesion times a point's length of the base."""

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
    """Model of the block on points, of one column of elements where all vertical lines move alike, unless `full`.

    Raises
    ------
    ValueError
        If the block cannot be meshed, or its base is not where the block stands at t = 0.
    """
    begun = moved_base(problem.motion, np.zeros(1), np.zeros((1, 1))).ravel().tolist()
    require(not any(begun), "motion", "must be zero at t = 0 where contact opens", begun)
    return column(problem) if column_applies(problem) and not full else whole(problem)


def column(problem: Problem) -> ContactModel:
    """One column of elements, v(y) on a line, with one contact point: matrices E W (v', v') and rho W (v, v)."""
    line = line_of(problem)
    size = len(line.height)
    one = np.ones(size)
    return ContactModel(
        problem=problem,
        M=line.mass,
        K=problem.young * line.stretch,
        F=line.load(problem),
        sides=(csr_array(line.base[None]), csr_array((1, size))),
        share=np.ones(1),
        motions=one[:, None],
        upwards=one,
        observers=np.outer([1, 0, 0], line.middle),
        kind="column",
    )


def whole(problem: Problem) -> ContactModel:
    """The whole block."""
    assembled = assemble(problem)
    basis = assembled.basis
    base = block_mesh(problem).base
    if problem.foundation == "distributed":
        lumped = elasticity.LUMPED[problem.degree]
        rule = elasticity.edge_rule(basis.mesh, base, np.zeros(2), problem.tangent, [elasticity.WHOLE], lumped)
    else:
        rule = elasticity.foundation_rule(problem, basis, base)
    # The points of the base with weights, each place once, in the order along it.
    rule, along = elasticity.in_order(basis, rule, problem.tangent)
    fresh = np.append(True, np.diff(along) > SAME_PLACE * problem.base_length)
    weights = np.add.reduceat(rule.weights, np.flatnonzero(fresh))
    rule = elasticity.Rule(rule.points[:, fresh], rule.cells[fresh], weights)
    return ContactModel(
        problem=problem,
        M=assembled.M,
        K=assembled.K,
        F=assembled.F,
        sides=elasticity.across_and_along(problem, basis, rule),
        share=weights / weights.sum(),
        motions=elasticity.rigid_motions(basis),
        upwards=elasticity.components(basis),
        observers=np.array([assembled.observers[name] for name in OBSERVED]),
        kind="whole",
    )


def highest_closed_frequency(problem: Problem, full: bool) -> float:
    """The largest natural frequency while every point of the base is closed and sticks [rad/s].

    A point that opens or slides takes its springs away, which lowers every frequency: the springs of all bound every
    contact state.
    """
    system = build(problem, full).system("glued")
    return largest_frequency(with_springs(system.K, system.B, system.rows.compliance), system.M)
