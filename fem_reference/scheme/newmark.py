r"""The step of a scheme, solved for the displacement, stage by stage (Newmark's: paper, equations (4) to (9)).

With the numbers of a stage (`fem_reference.problem.stages`), u = gg V, b = beta / (1 - am), k = am / (1 - am) and
S = M + beta' dt^2 K factorised once, a stage goes from (D, V, A) and the stage before (Dg, Vg, Ag) to (D1, V1, A1)::

    D* = D + dt (d_u u + d_g Vg) + dt^2 (e_0 A + e_g Ag)
    F* = (1 - af) F1 + af F0
    D1 = D + S^-1 [M (D* - D - k beta dt^2 A) + b dt^2 (F* - K D)]
    A1 = (D1 - D*) / (beta dt^2)        or from the equation of motion for beta = 0
    V1 = u + dt (g_0 A + g_g Ag + gamma A1)

Nothing is divided by beta in D1, and a stiff spring meets no difference of nearly equal numbers. Newmark's only stage
has d_u = 1, e_0 = 1/2 - alpha, beta = alpha, g_0 = 1 - delta, gamma = delta, am = af = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
    """Displacement, velocity and acceleration at the end of a step or a stage, each of shape (unknowns,)."""

    D: Array  # displacement [m]
    V: Array  # velocity [m/s], of a staggered scheme half a step before
    A: Array  # acceleration [m/s2]
    undiscounted: bool = False  # whether gg does not act on V: the first half step of a staggered scheme


def effective_matrix(M: csr_array, K: csr_array, scheme: Scheme, stage: int = 0) -> csr_array:
    """S = M + delta dt C + beta' dt^2 K of a stage, at C = 0 the paper's (9) times alpha dt^2."""
    if scheme.damped:
        a0 = scheme.mass_damping
        a1 = scheme.stiffness_damping
        dt = scheme.step
        return (1 + scheme.delta * dt * a0) * M + (scheme.alpha * dt**2 + scheme.delta * dt * a1) * K
    weight = scheme.stages[stage].stiffness_weight
    return M + (weight * scheme.step**2) * K if weight > 0 else M


def discount(state: State, scheme: Scheme) -> float:
    """Factor on the velocity of the step's start."""
    return 1.0 if state.undiscounted else scheme.gg


def predictor(state: State, scheme: Scheme, stage: int = 0, before: State | None = None) -> Array:
    """D* = D + dt (d_u u + d_g Vg) + dt^2 (e_0 A + e_g Ag) of a stage after that which ended `before` [m]."""
    dt = scheme.step
    numbers = scheme.stages[stage]
    predicted = state.D + discount(state, scheme) * dt * numbers.d_u * state.V + dt**2 * numbers.e_0 * state.A
    if before is not None:
        predicted = predicted + dt * numbers.d_g * before.V + dt**2 * numbers.e_g * before.A
    return predicted


def corrector(
    state: State, predicted: Array, M: Callable[[Array], Array], residual: Array, scheme: Scheme, stage: int = 0
) -> Array:
    """Right-hand side M (D* - D - k beta dt^2 A) + b dt^2 (F* - K D) of a stage's displacement increment."""
    numbers = scheme.stages[stage]
    inertial = predicted - state.D
    if numbers.am:
        inertial = inertial - (numbers.am * numbers.compliance * scheme.step**2) * state.A
    right: Array = M(inertial) + (numbers.compliance * scheme.step**2) * residual
    return right


def acceleration(D: Array, predicted: Array, scheme: Scheme, stage: int = 0) -> Array:
    """A1 = (D1 - D*) / (beta dt^2), the paper's (6) [m/s2]."""
    return (D - predicted) / (scheme.stages[stage].beta * scheme.step**2)


def velocity(state: State, A: Array, scheme: Scheme, stage: int = 0, before: State | None = None) -> Array:
    """V1 = u + dt (g_0 A + g_g Ag + gamma A1), the paper's (7) [m/s]."""
    numbers = scheme.stages[stage]
    impulse = numbers.g_0 * state.A + numbers.gamma * A
    if before is not None:
        impulse = impulse + numbers.g_g * before.A
    return discount(state, scheme) * state.V + scheme.step * impulse


def velocity_predictor(state: State, scheme: Scheme, stage: int = 0, before: State | None = None) -> Array:
    """V* = u + dt (g_0 A + g_g Ag), the part of V1 that is known before the stage [m/s]."""
    numbers = scheme.stages[stage]
    known = discount(state, scheme) * state.V + scheme.step * numbers.g_0 * state.A
    if before is not None:
        known = known + scheme.step * numbers.g_g * before.A
    return known


def stage_load(loads: Sequence[Array], scheme: Scheme, stage: int) -> Array:
    """F* = (1 - af) F1 + af F0 of a stage, the loads being those at the start and at the end of each stage."""
    af = scheme.stages[stage].af
    return (1 - af) * loads[stage + 1] + af * loads[0] if af else loads[stage + 1]


def start_velocity(V: Array, A: Array, scheme: Scheme) -> Array:
    """Velocity that a history begins with, of a staggered scheme half a step before t = 0 [m/s]."""
    return V - scheme.step / 2 * A if scheme.staggered else V


def end_velocity(state: State, scheme: Scheme) -> Array:
    """Velocity at the end of a step, of a staggered scheme half a step after its own [m/s]."""
    return state.V + scheme.step / 2 * state.A if scheme.staggered else state.V


def initial_acceleration(F: Array, solve_mass: Callable[[Array], Array] | None) -> Array:
    """A0 = 0 without a factorised mass, else M^-1 F (the block is unstrained at t = 0) [m/s2]."""
    return np.zeros_like(F) if solve_mass is None else solve_mass(F)


Operator = Callable[[Array], Array]
"""Product with a matrix, or solution with one."""


def advance(
    state: State, loads: Sequence[Array], scheme: Scheme, M: Operator, K: Operator, solves: Sequence[Operator]
) -> State:
    """One step under the loads at its start and at the end of each stage; `solves` are the solutions with each S."""
    if scheme.damped:
        return _advance_damped(state, predictor(state, scheme), loads[-1], scheme, M, K, solves[0])
    end = _advance_stage(state, None, loads, scheme, 0, M, K, solves[0])
    for stage in range(1, len(solves)):
        end = _advance_stage(state, end, loads, scheme, stage, M, K, solves[stage])
    return end


def _advance_stage(
    state: State,
    before: State | None,
    loads: Sequence[Array],
    scheme: Scheme,
    stage: int,
    M: Operator,
    K: Operator,
    solve: Operator,
) -> State:
    numbers = scheme.stages[stage]
    predicted = predictor(state, scheme, stage, before)
    F = stage_load(loads, scheme, stage)
    if numbers.beta > 0:
        D = state.D + solve(corrector(state, predicted, M, F - K(state.D), scheme, stage))
        A = acceleration(D, predicted, scheme, stage)
    else:
        D = predicted
        strained = (1 - numbers.af) * D + numbers.af * state.D if numbers.af else D
        A = solve(F - K(strained))
        if numbers.am:
            A = (A - numbers.am * state.A) / (1 - numbers.am)
    return State(D, velocity(state, A, scheme, stage, before), A)


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
        solves: list[Operator] = [self.solve]
        for stage, first in list(enumerate(self.scheme.stage_matrices))[1:]:
            same = first < stage
            S = self.S if same else effective_matrix(self.M, self.K, self.scheme, stage)
            solves.append(solves[first] if same else self.work.factor(S))
        self.solves = tuple(solves)

    def start(self, F: Array | None = None) -> State:
        """State at t = 0: at rest, unstrained, with the initial acceleration that the scheme asks for.

        The load is the constant one where `F` is not given.
        """
        mass = None
        if self.scheme.start == "consistent":
            mass = self.solve if self.scheme.stages[0].stiffness_weight == 0 else self.work.factor(self.M)
        zero = np.zeros_like(self.F)
        A = initial_acceleration(self.F if F is None else F, mass)
        return State(zero, start_velocity(zero, A, self.scheme), A, undiscounted=self.scheme.staggered)

    def advance(self, state: State, loads: Sequence[Array] | None = None) -> State:
        """One step, under the loads at its start and at the end of each stage where they are not the constant one."""
        if loads is None:
            loads = [self.F] * (len(self.solves) + 1)
        return advance(state, loads, self.scheme, lambda x: self.M @ x, lambda x: self.K @ x, self.solves)
