"""The Newmark scheme with kinetic damping, solved for the displacement (paper, equations (4) to (9)).

One step from (D, V, A), with S = M + alpha dt^2 K factorised once::

    D* = D + gg dt V + dt^2 (1/2 - alpha) A
    D1 = D + S^-1 [M (D* - D) + alpha dt^2 (F - K D)]
    A1 = (D1 - D*) / (alpha dt^2)        or M^-1 (F - K D1) for alpha = 0
    V1 = gg V + dt ((1 - delta) A + delta A1)

Nothing is divided by alpha in D1, and a stiff spring meets no difference of nearly equal numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from fem_reference.problem.problem import Array, Scheme


@dataclass
class Work:
    """Counters of the work done."""

    factorisations: int = 0  # number of factorisations [-]
    solves: int = 0  # number of solutions with a factorised matrix [-]
    nonzeros: int = 0  # stored entries of the last matrix factorised [-]

    def factor(self, matrix: csr_array) -> Callable[[Array], Array]:
        """Factorise a symmetric positive definite matrix; return the counted solver of right-hand sides."""
        # Positive definite: pivots on the diagonal are safe and keep the symmetric fill-in.
        lu = splu(csc_array(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        self.factorisations += 1
        self.nonzeros = int(matrix.nnz)

        def solve(right: Array) -> Array:
            self.solves += 1
            solution: Array = lu.solve(right)
            return solution

        return solve


@dataclass(frozen=True)
class State:
    """Displacement, velocity and acceleration at the end of a step, each of shape (unknowns,)."""

    D: Array  # displacement [m]
    V: Array  # velocity [m/s]
    A: Array  # acceleration [m/s2]


def effective_matrix(M: csr_array, K: csr_array, scheme: Scheme) -> csr_array:
    """S = M + delta dt C + alpha dt^2 K, at C = 0 the paper's (9) times alpha dt^2."""
    if scheme.damped:
        a0 = scheme.mass_damping
        a1 = scheme.stiffness_damping
        dt = scheme.step
        return (1 + scheme.delta * dt * a0) * M + (scheme.alpha * dt**2 + scheme.delta * dt * a1) * K
    return M + (scheme.alpha * scheme.step**2) * K if scheme.alpha > 0 else M


def predictor(state: State, scheme: Scheme) -> Array:
    """D* = D + gg dt V + dt^2 (1/2 - alpha) A [m]."""
    dt = scheme.step
    return state.D + scheme.gg * dt * state.V + dt**2 * (0.5 - scheme.alpha) * state.A


def corrector(D: Array, predicted: Array, M: Callable[[Array], Array], residual: Array, scheme: Scheme) -> Array:
    """Right-hand side M (D* - D) + alpha dt^2 (F - K D) of the step's displacement increment."""
    right: Array = M(predicted - D) + (scheme.alpha * scheme.step**2) * residual
    return right


def acceleration(D: Array, predicted: Array, scheme: Scheme) -> Array:
    """A1 = (D1 - D*) / (alpha dt^2), the paper's (6) [m/s2]."""
    return (D - predicted) / (scheme.alpha * scheme.step**2)


def velocity(state: State, A: Array, scheme: Scheme) -> Array:
    """V1 = gg V + dt ((1 - delta) A + delta A1), the paper's (7) [m/s]."""
    return scheme.gg * state.V + scheme.step * ((1 - scheme.delta) * state.A + scheme.delta * A)


def initial_acceleration(F: Array, solve_mass: Callable[[Array], Array] | None) -> Array:
    """A0 = 0 without a factorised mass, else M^-1 F (the block is unstrained at t = 0) [m/s2]."""
    return np.zeros_like(F) if solve_mass is None else solve_mass(F)


Operator = Callable[[Array], Array]
"""Product with a matrix, or solution with one."""


def advance(state: State, F: Array, scheme: Scheme, M: Operator, K: Operator, solve: Operator) -> State:
    """One step under the load `F` at its end; `solve` is the solution with S (with M for alpha = 0)."""
    predicted = predictor(state, scheme)
    if scheme.damped:
        return _advance_damped(state, predicted, F, scheme, M, K, solve)
    D = state.D + solve(corrector(state.D, predicted, M, F - K(state.D), scheme))
    A = acceleration(D, predicted, scheme) if scheme.alpha > 0 else solve(F - K(D))
    return State(D, velocity(state, A, scheme), A)


def _advance_damped(
    state: State, predicted: Array, F: Array, scheme: Scheme, M: Operator, K: Operator, solve: Operator
) -> State:
    """One step of M A + C V + K D = F, C = a0 M + a1 K.

    With V* = gg V + dt (1 - delta) A the part of the velocity that is known before::

        (M + delta dt C + alpha dt^2 K) (D1 - D) = (M + delta dt C) (D* - D) + alpha dt^2 (F - C V* - K D)
    """

    def C(x: Array) -> Array:
        return scheme.mass_damping * M(x) + scheme.stiffness_damping * K(x)

    dt = scheme.step
    displacement = predicted - state.D
    slowed = scheme.gg * state.V + dt * (1 - scheme.delta) * state.A
    resisted = F - C(slowed)
    D = state.D + solve(
        M(displacement) + scheme.delta * dt * C(displacement) + scheme.alpha * dt**2 * (resisted - K(state.D))
    )
    A = acceleration(D, predicted, scheme) if scheme.alpha > 0 else solve(resisted - K(D))
    return State(D, velocity(state, A, scheme), A)


@dataclass
class Stepper:
    """The scheme applied to M D'' + K D = F, with its factorisations made once."""

    M: csr_array
    K: csr_array
    F: Array
    scheme: Scheme
    work: Work = field(default_factory=Work)

    def __post_init__(self) -> None:
        self.S = effective_matrix(self.M, self.K, self.scheme)
        self.solve = self.work.factor(self.S)

    def start(self, F: Array | None = None) -> State:
        """State at t = 0: at rest, unstrained, with the initial acceleration that the scheme asks for.

        The load is the constant one where `F` is not given.
        """
        mass = None
        if self.scheme.start == "consistent":
            mass = self.work.factor(self.M) if self.scheme.alpha > 0 else self.solve
        zero = np.zeros_like(self.F)
        return State(zero, zero, initial_acceleration(self.F if F is None else F, mass))

    def advance(self, state: State, F: Array | None = None) -> State:
        """One step, under the load `F` at its end where that is not the constant one."""
        F = self.F if F is None else F
        return advance(state, F, self.scheme, lambda x: self.M @ x, lambda x: self.K @ x, self.solve)
