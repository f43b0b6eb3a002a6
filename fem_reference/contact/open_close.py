"""Which points of the base are closed at the end of a step, and with which forces.

The free block would have the gaps w_f; forces N of the points change them to w = w_f + C N. A point is open
with N = 0 and w >= 0, or closed with w = -N / k and N >= 0: with A = C + diag(1/k), symmetric and positive definite,

    0 <= N,    0 <= A N + w_f,    N . (A N + w_f) = 0.

The states are guessed, the forces of the closed points solved for, and all states corrected at once until none
changes. For one point that takes two solutions at most. For three and more points it may cycle (Ben Gharbia and
Gilbert, 2010); then the problem is solved as what it is, the minimum of N'A N / 2 + w_f'N over N >= 0: with
A = L L' that is |L'N + L^-1 w_f|^2 / 2 but for a constant, least squares over non-negative numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.linalg.lapack import dpotrf, dpotrs

from fem_reference.problem.problem import Array

Flags = NDArray[np.bool_]
States = NDArray[np.int8]
OPEN, STICK, SLIP = 0, 1, 2
"""States of a point: open; closed, its shear spring held; closed and sliding towards +x (-SLIP: towards -x)."""
NONE, SEVERAL = "no consistent contact state", "several consistent contact states"
KEPT = 64
"""Greatest number of sets of closed points whose factors are kept."""


@dataclass(frozen=True)
class Trial:
    """Forces and gaps of the base's points for given states."""

    normal: Array  # normal force N of each point on the block [N], zero where open, shape (points,)
    shear: Array  # tangential force T of each point on the block [N], shape (points,)
    gap: Array  # gap w_f + C N of each point [m], shape (points,)
    slip: Array  # slip of each point beyond its reference at the start of the step [m]; zero without shear
    settled: bool = True  # whether the forces are those of the states, which may themselves ask for an iteration


@dataclass(frozen=True)
class Contact:
    """Converged contact of a step, or why there is none."""

    trial: Trial | None  # forces and gaps; None where no states are consistent, or more than one set may be
    states: States  # state of each point, shape (points,)
    solves: int  # solutions for the forces of given states [-]; a fallback counts as one
    failure: str = ""  # why `trial` is None, in words: none was found, or several were


def corrected(trial: Trial, states: States) -> States:
    """STICK where the forces and gaps ask for a closed point; what is neither pressed nor lifted stays as it is."""
    return np.where(states != OPEN, trial.normal >= 0, trial.gap < 0).astype(np.int8)


def iterate(
    forces: Callable[[States], Trial],
    states: States,
    limit: int,
    asked: Callable[[Trial, States], States] = corrected,
) -> Contact:
    """Correct all states at once until none changes, with at most `limit` solutions.

    Parameters
    ----------
    forces
        The forces and gaps of given states.
    states
        States to begin with, shape (points,).
    limit
        Greatest number of solutions.
    asked
        The states that forces ask for, from those that they were found with.
    """
    for solves in range(1, limit + 1):
        trial = forces(states)
        following = asked(trial, states)
        if np.array_equal(following, states) and trial.settled:
            return Contact(trial, states, solves)
        states = following
    return Contact(None, states, limit, NONE)


class FrictionlessBase:
    """A base without friction, with the factors of its closed points kept: there always is exactly one contact.

    Parameters
    ----------
    C
        Gaps of unit forces [m/N], shape (points, points).
    compliance
        1 / k of each point [m/N], shape (points,).
    """

    def __init__(self, C: Array, compliance: Array) -> None:
        self.C, self.A = C, C + np.diag(compliance)
        self._factors: dict[bytes, tuple[NDArray[np.int64], Array]] = {}

    def contact(self, free: Array, states: States, limit: int) -> Contact:
        """Contact for gaps without forces `free` [m]; `states` and `limit` as in `iterate`."""
        found = iterate(lambda guess: self.forces(free, guess), states, limit)
        if found.trial is not None:
            return found
        states = (complementary(self.A, free) > 0).astype(np.int8)
        return Contact(self.forces(free, states), states, limit + 1)

    def forces(self, free: Array, states: States) -> Trial:
        """Forces and gaps for given states, A N = -free on the closed points."""
        N, none = np.zeros(len(free)), np.zeros(len(free))
        rows, factor = self._factor(states)
        if len(rows):
            N[rows] = dpotrs(factor, -free[rows])[0]
        return Trial(N, none, free + self.C @ N, none)

    def _factor(self, states: States) -> tuple[NDArray[np.int64], Array]:
        """Closed points and the Cholesky factor of their part of A."""
        key = states.tobytes()
        if key not in self._factors:
            if len(self._factors) >= KEPT:
                self._factors.clear()
            rows = np.flatnonzero(states)
            self._factors[key] = rows, dpotrf(self.A[np.ix_(rows, rows)])[0] if len(rows) else self.A[:0, :0]
        return self._factors[key]


def complementary(A: Array, free: Array) -> Array:
    """Forces N >= 0 with A N + free >= 0 and N . (A N + free) = 0, shape (points,).

    Parameters
    ----------
    A
        Symmetric positive definite matrix [m/N], shape (points, points).
    free
        Gaps without forces [m], shape (points,).
    """
    from scipy.optimize import nnls

    # In units in which the diagonal and the load are of size one, as the tolerance of the least squares expects.
    unit, size = 1 / np.sqrt(np.diag(A)), float(np.max(np.abs(free), initial=0.0))
    if size == 0:
        return np.zeros(len(free))
    L = np.linalg.cholesky(unit[:, None] * A * unit)
    scaled = unit * free
    scale = float(np.linalg.norm(scaled))
    solution, _ = nnls(L.T, solve_triangular(L, -scaled / scale, lower=True))
    N: Array = scale * unit * solution
    return N
