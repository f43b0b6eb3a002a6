"""Contact of a base whose closed points are glued along it by shear springs.

A closed point bears T = -k_t (s - r) with its slip s and reference r. While it is open its reference follows its
slip; where it closes within a step, from a gap w0 >= 0 to w1 < 0, the reference is the slip at the crossing,
r = s0 + (s1 - s0) w0 / (w0 - w1), which stores no energy while open and loses no slip of the step. Hence

    T = -k_t phi (s1 - r0),    phi = w1 / (w1 - w0) for a point that closes, 1 for one that was closed.

For any phi from 0 to 1 the spring gains no more energy than a step of delta = 1 puts into it.
This is no linear complementarity problem: some steps have no consistent states, some have several.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from fem_reference.contact.open_close import KEPT, Contact, Flags, Trial, corrected, iterate
from fem_reference.problem.problem import Array

ENUMERATED = 8
"""Greatest number of points of which all sets of states are tried."""
PASSES = 60
"""Greatest number of corrections of the crossings for given states."""
SETTLED = 1e-13
"""Change of phi at which the crossings are settled [-]."""


class Factor(NamedTuple):
    """Factorised equations of the closed points."""

    rows: NDArray[np.int64]  # which of the forces (N, T) are unknown
    weight: Array  # factors of their free gaps and slips on the right-hand side
    lu: Array
    pivots: NDArray[np.int64]


@dataclass(frozen=True)
class GluedBase:
    """What a base is in every step of one length, with the factors of its closed points kept."""

    C: Array  # gaps, then slips, of unit normal, then tangential, forces [m/N], shape (2 points, 2 points)
    compliance: Array  # 1 / k of each point [m/N], shape (points,)
    shear_stiffness: Array  # k_t of each point [N/m], shape (points,)
    _factors: dict[bytes, Factor] = field(default_factory=dict)

    def factor(self, states: Flags, phi: Array | None) -> Factor:
        """The equations of the closed points, N / k + w = 0 and T + k_t phi s = 0, factorised; phi = 1 if None."""
        if phi is not None:
            return self._factorised(states, phi)
        key = states.tobytes()
        if key not in self._factors:
            if len(self._factors) >= KEPT:
                self._factors.clear()
            self._factors[key] = self._factorised(states, np.ones(len(states)))
        return self._factors[key]

    def _factorised(self, states: Flags, phi: Array) -> Factor:
        points = len(states)
        kappa = self.shear_stiffness * phi
        # Divided by its size each row is as good as any other for the pivots; phi may be zero.
        flexibility = np.diag(self.C)
        size = np.concatenate([self.compliance + flexibility[:points], 1 + kappa * flexibility[points:]])
        weight = np.concatenate([np.ones(points), kappa]) / size
        diagonal = np.concatenate([self.compliance, np.ones(points)]) / size
        rows = np.flatnonzero(np.concatenate([states, states]))
        matrix = weight[rows, None] * self.C[np.ix_(rows, rows)] + np.diag(diagonal[rows])
        return Factor(rows, -weight[rows], *(dgetrf(matrix)[:2] if len(rows) else (matrix, rows)))


@dataclass(frozen=True)
class GluedStep:
    """The base in one step: gaps and slips are (w, s) = (free_gap, free_slip) + C (N, T)."""

    base: GluedBase
    free_gap: Array  # gaps without forces at the end of the step [m], shape (points,)
    free_slip: Array  # slips without forces beyond the references at the start of the step, s - r0 [m], shape (points,)
    gap: Array  # gaps at the start of the step [m], shape (points,)
    closed: Flags  # points that were closed at the start of the step, shape (points,)

    def forces(self, states: Flags) -> Trial:
        """Forces and gaps for given states, with the crossings that belong to them: phi for phi(forces(phi))."""
        closing = states & ~self.closed
        if not closing.any():
            return self._linear(states, None)
        phi = np.where(closing, 0.5, 1.0)
        weight, last = 1.0, np.inf
        for _ in range(PASSES):
            trial = self._linear(states, phi)
            change = np.where(closing, self._crossed(trial) - phi, 0.0)
            size = float(np.max(np.abs(change), initial=0.0))
            if size <= SETTLED:
                return trial
            # A crossing that is passed to and fro is approached by smaller corrections.
            weight, last = weight / 2 if size >= last else weight, size
            phi = phi + weight * change
        return replace(trial, settled=False)

    def _crossed(self, trial: Trial) -> Array:
        """Share phi of the step for which each point has been closed."""
        depth = np.maximum(trial.normal, 0.0) * self.base.compliance
        way = depth + np.maximum(self.gap, 0.0)
        return np.divide(depth, way, out=np.ones_like(way), where=way > 0)

    def _linear(self, states: Flags, phi: Array | None) -> Trial:
        """Forces for given states and crossings."""
        points, factor = len(states), self.base.factor(states, phi)
        found = np.zeros(2 * points)
        if len(factor.rows):
            free = np.concatenate([self.free_gap, self.free_slip])
            found[factor.rows] = dgetrs(factor.lu, factor.pivots, factor.weight * free[factor.rows])[0]
        return Trial(found[:points], found[points:], self.free_gap + self.base.C[:points] @ found)


def glued(base: GluedStep, limit: int) -> Contact:
    """Contact of a glued base, from the states at the start of the step.

    Where the iteration does not converge and there are few points all sets of states are tried.
    """
    found = iterate(base.forces, base.closed, limit)
    if found.trial is not None or len(base.closed) > ENUMERATED:
        return found
    consistent = list(_consistent(base))
    if len(consistent) == 1:
        trial, closed = consistent[0]
        return Contact(trial, closed, limit + 1)
    failure = "several consistent contact states" if consistent else "no consistent contact state"
    return Contact(None, base.closed, limit + 1, failure)


def _consistent(base: GluedStep) -> Iterator[tuple[Trial, Flags]]:
    """All sets of states that their own forces and gaps ask for."""
    for choice in product((False, True), repeat=len(base.closed)):
        states = np.array(choice)
        trial = base.forces(states)
        if trial.settled and np.array_equal(corrected(trial, states), states):
            yield trial, states
