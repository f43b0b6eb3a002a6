r"""The step of a scheme, solved for the displacement, stage by stage (Newmark's: paper, equations (4) to (9)).

With the numbers of a stage (`fem_reference.problem.stages`), u = gg V, b = beta / (1 - am), k = am / (1 - am) and
S = M + gamma' dt C + beta' dt^2 K factorised once, a stage of M A + C V + K D = F goes from (D, V, A) and the stage
before (Dg, Vg, Ag) to (D1, V1, A1)::

    D* = D + dt (d_u u + d_g Vg) + dt^2 (e_0 A + e_g Ag),     V* = u + dt (g_0 A + g_g Ag)
    F* = (1 - af) F1 + af F0 - C [(1 - af) V* + af u]
    D1 = D + S^-1 [M (D* - D - k beta dt^2 A) + gamma' dt C (D* - D) + b dt^2 (F* - K D)]
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
        """Factorise a symmetric positive definite matrix; return the counted solver of right-hand sides.

        Raises
        ------
        FloatingPointError
            If rounding has made it singular.
        """
        # Positive definite: pivots on the diagonal are safe and keep the symmetric fill-in.
        options = {"SymmetricMode": True}
        try:
            lu = splu(csc_array(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
        except RuntimeError as error:
            raise FloatingPointError(f"the matrix of the step is singular in double precision: {error}") from None
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


def effective_matrix(
    M: csr_array, K: csr_array, scheme: Scheme, stage: int = 0, C: csr_array | None = None
) -> csr_array:
    """S = M + gamma' dt C + beta' dt^2 K of a stage, at C = 0 the paper's (9) times alpha dt^2."""
    numbers = scheme.stages[stage]
    inertia = M if C is None else M + (numbers.damping_weight * scheme.step) * C
    weight = numbers.stiffness_weight
    return inertia + (weight * scheme.step**2) * K if weight > 0 else inertia


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
    state: State,
    loads: Sequence[Array],
    scheme: Scheme,
    M: Operator,
    K: Operator,
    solves: Sequence[Operator],
    C: Operator | None = None,
) -> State:
    """One step under the loads at its start and at the end of each stage; `solves` are the solutions with each S."""
    end = state
    for stage, solve in enumerate(solves):
        before = end if stage else None
        end = _advance_stage(state, before, loads, scheme, stage, M, K, C, solve)
    return end


def _advance_stage(
    state: State,
    before: State | None,
    loads: Sequence[Array],
    scheme: Scheme,
    stage: int,
    M: Operator,
    K: Operator,
    C: Operator | None,
    solve: Operator,
) -> State:
    numbers = scheme.stages[stage]
    predicted = predictor(state, scheme, stage, before)
    F = stage_load(loads, scheme, stage)
    if C is not None:
        rate = velocity_predictor(state, scheme, stage, before)
        if numbers.af:
            rate = (1 - numbers.af) * rate + numbers.af * discount(state, scheme) * state.V
        F = F - C(rate)
    if numbers.beta > 0:
        right = corrector(state, predicted, M, F - K(state.D), scheme, stage)
        if C is not None:
            right = right + numbers.damping_weight * scheme.step * C(predicted - state.D)
        D = state.D + solve(right)
        A = acceleration(D, predicted, scheme, stage)
    else:
        D = predicted
        strained = (1 - numbers.af) * D + numbers.af * state.D if numbers.af else D
        right = F - K(strained)
        if numbers.am:
            right = right - numbers.am * M(state.A)
        A = solve(right) / (1 - numbers.am)
    return State(D, velocity(state, A, scheme, stage, before), A)


@dataclass
class Stepper:
    """The scheme applied to M D'' + C D' + K D = F, with its factorisations made once."""

    M: csr_array
    K: csr_array
    F: Array
    scheme: Scheme
    work: Work = field(default_factory=Work)
    C: csr_array | None = None  # without it C = a0 M + a1 K of the scheme

    def __post_init__(self) -> None:
        scheme = self.scheme
        if self.C is None and scheme.damped:
            self.C = scheme.mass_damping * self.M + scheme.stiffness_damping * self.K
        self.S = effective_matrix(self.M, self.K, scheme, 0, self.C)
        self.solve = self.work.factor(self.S)
        solves: list[Operator] = [self.solve]
        for stage, first in list(enumerate(scheme.stage_matrices))[1:]:
            same = first < stage
            S = self.S if same else effective_matrix(self.M, self.K, scheme, stage, self.C)
            solves.append(solves[first] if same else self.work.factor(S))
        self.solves = tuple(solves)

    def start(self, F: Array | None = None) -> State:
        """State at t = 0: at rest, unstrained, with the initial acceleration that the scheme asks for.

        The load is the constant one where `F` is not given.
        """
        mass = None
        if self.scheme.start == "consistent":
            is_mass = self.C is None and self.scheme.stages[0].stiffness_weight == 0
            mass = self.solve if is_mass else self.work.factor(self.M)
        zero = np.zeros_like(self.F)
        A = initial_acceleration(self.F if F is None else F, mass)
        return State(zero, start_velocity(zero, A, self.scheme), A, undiscounted=self.scheme.staggered)

    def advance(self, state: State, loads: Sequence[Array] | None = None) -> State:
        """One step, under the loads at its start and at the end of each stage where they are not the constant one."""
        if loads is None:
            loads = [self.F] * (len(self.solves) + 1)
        C = self.C
        return advance(
            state,
            loads,
            self.scheme,
            lambda x: self.M @ x,
            lambda x: self.K @ x,
            self.solves,
            None if C is None else lambda x: C @ x,
        )
