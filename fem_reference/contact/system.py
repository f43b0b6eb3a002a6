"""Elastic bodies on their contacts: matrices, rows, what is prescribed and what is observed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import block_diag, cholesky, eigh, solve_triangular
from scipy.sparse import csr_array, diags_array

from fem_reference.problem.problem import Array, Flags, Indices
from fem_reference.scheme.newmark import Operator
from fem_reference.scheme.stage import Motion


class ContactRows(NamedTuple):
    """What rows obey: the numbers of a `fem_reference.contact.law.Law` that no scheme changes."""

    compliance: Array
    lower: Array
    upper: Array
    friction: Array
    partner: Indices
    slips: Flags


def opening_rows(compliance: Array) -> ContactRows:
    """Rows that bear pressure only."""
    count = len(compliance)
    zero = np.zeros(count)
    return ContactRows(compliance, zero, np.full(count, np.inf), zero, np.arange(count), np.zeros(count, dtype=bool))


def slipping_rows(compliance: Array, strength: Array) -> ContactRows:
    """Rows that bear up to a strength, infinite of those that are bonded."""
    rows = opening_rows(compliance)
    return rows._replace(lower=-strength, upper=strength, slips=~rows.slips)


def point_rows(
    stiffness: Array, shear_stiffness: Array, tangent: float | None, cohesion: Array, bonded: bool = False
) -> ContactRows:
    """Rows of points, which never open if `bonded`: normal ones, and where they have springs of shear those of these.

    The stiffness is that of each point [N/m]; `tangent` is that of the angle of friction, None of what never slips;
    `cohesion` is the shear force that each point bears without pressure [N].
    """
    compliance = 1 / stiffness
    unlimited = np.full(len(stiffness), np.inf)
    normal = slipping_rows(compliance, unlimited) if bonded else opening_rows(compliance)
    if not np.any(shear_stiffness):
        return normal
    strength = unlimited if tangent is None else cohesion
    shear = slipping_rows(1 / shear_stiffness, strength)
    held = shear._replace(partner=normal.partner, friction=np.full(len(strength), tangent or 0.0))
    return ContactRows(*(np.concatenate(pair) for pair in zip(normal, held, strict=True)))


def with_springs(K: csr_array, B: csr_array, compliance: Array) -> csr_array:
    """K with the springs of rows that are closed and stick, K + B' c^-1 B [N/m]."""
    return csr_array(K + B.T @ diags_array(1 / compliance) @ B)


@dataclass(frozen=True)
class ContactSystem:
    """M D'' + C D' + K D = F + pushes p(t) + B' N of bodies that no spring of K holds, and their contacts' rows."""

    M: Any  # mass [kg], shape (unknowns, unknowns); its diagonal in natural modes
    K: Any  # elastic stiffness without the springs of contacts [N/m]; its diagonal in natural modes
    F: Array  # constant load [N], shape (unknowns,)
    B: Any  # rows of the relative displacements, shape (rows, unknowns)
    rows: ContactRows
    watch: Motion  # rows that observe displacement, velocity, acceleration, each of shape (columns, unknowns)
    pushes: Array  # load of a unit of each part of what is prescribed, shape (unknowns, parts)
    ground: Array  # displacement of the ground of each row for a unit of each part, shape (rows, parts)
    prescribed: Callable[[Array, Array], Array] = field(repr=False)
    """Parts at the ends of the stages, shape (steps, stages, parts), of the steps' positions [steps] and the times."""
    start_parts: Array  # at t = 0, shape (parts,)
    motions: tuple[Array, ...]  # rigid motions of each body that nothing clamps, (unknowns of the body, 0 or more)
    C: csr_array | None = None  # viscous damping [N s/m]
    to_modes: Array | None = None  # natural modes of a displacement, shape (modes, unknowns), where they are unknowns

    @cached_property
    def elastic(self) -> Operator:
        """K of a displacement less its rigid motions, which would leave E u times the last bit in each element.

        With rigid motions R, R' M R = 1, that is K (D - R R' M D).
        """
        rigid = []
        begin = 0
        for motions in self.motions:
            body = slice(begin, begin + len(motions))
            begin += len(motions)
            if not motions.shape[1]:  # which LAPACK may refuse
                continue
            inertia = motions.T @ (self.M[body, body] @ motions)
            R = solve_triangular(cholesky(inertia, lower=True), motions.T, lower=True)
            rigid.append((body, R, np.ascontiguousarray((self.M[body, body] @ R.T).T)))

        def forces(D: Array) -> Array:
            strained = D.copy()
            for body, R, momentum in rigid:
                strained[body] -= (momentum @ D[body]) @ R
            return np.asarray(self.K @ strained)

        return Operator(forces)

    def unknowns(self, vector: Array) -> Array:
        """A displacement or velocity of the nodes in the system's unknowns."""
        return vector if self.to_modes is None else self.to_modes @ vector

    def in_modes(self) -> ContactSystem:
        """The system in the natural modes of its bodies, in which M is one and K a diagonal, without damping."""
        squares = []
        shapes = []
        begin = 0
        for motions in self.motions:
            body = slice(begin, begin + len(motions))
            of_body, turn = eigh(self.K[body, body].toarray(), self.M[body, body].toarray())
            of_body[: motions.shape[1]] = 0.0
            squares.append(of_body)
            shapes.append(turn)
            begin += len(motions)
        turn = block_diag(*shapes)
        watch = Motion(*(np.ascontiguousarray(part @ turn) for part in self.watch))
        return replace(
            self,
            M=np.ones(len(turn)),
            K=np.concatenate(squares),
            F=turn.T @ self.F,
            B=np.ascontiguousarray(self.B @ turn),
            watch=watch,
            pushes=np.ascontiguousarray(turn.T @ self.pushes),
            to_modes=(self.M @ turn).T,
        )
