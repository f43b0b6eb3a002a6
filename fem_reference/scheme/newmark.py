"""The scheme on the matrices of a mesh, factorised once: the stages are those of `fem_reference.scheme.stage`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme.stage import Body, Motion, step_change


@dataclass
class Work:
    """Counters of the work done."""

    factorisations: int = 0
    solves: int = 0  # with a factorised matrix [-]
    nonzeros: int = 0  # of the last matrix factorised [-]

    def factor(self, matrix: csr_array) -> Callable[[Array], Array]:
        """Factorise a symmetric positive definite matrix; return the counted solver of right-hand sides.

        Raises a `FloatingPointError` if rounding has made it singular.
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
            return np.asarray(lu.solve(right))

        return solve


@dataclass(frozen=True)
class Operator:
    """A matrix that is known by its product with a vector, written as that of numbers."""

    product: Callable[[Array], Array]

    def __mul__(self, vector: Array) -> Array:
        return self.product(vector)

    __matmul__ = __mul__


def operator(matrix: Any) -> Operator:
    """The products with a sparse matrix."""
    return Operator(lambda vector: matrix @ vector)


def effective_matrix(
    M: csr_array, K: csr_array, scheme: Scheme, stage: int = 0, C: csr_array | None = None
) -> csr_array:
    """S = M + gamma' dt C + beta' dt^2 K of a stage, at C = 0 the paper's (9) times alpha dt^2."""
    numbers = scheme.stages[stage]
    inertia = M if C is None else M + (numbers.damping_weight * scheme.step) * C
    weight = numbers.stiffness_weight
    return inertia + (weight * scheme.step**2) * K if weight > 0 else inertia


def inverses(
    M: csr_array, K: csr_array, scheme: Scheme, C: csr_array | None, factor: Callable[[Any], Any]
) -> list[Any]:
    """Inverse of the matrix of each stage, each matrix factorised once."""
    made: list[Any] = []
    for stage, first in enumerate(scheme.stage_matrices):
        made.append(made[first] if first < stage else factor(effective_matrix(M, K, scheme, stage, C)))
    return made


def start_velocity(V: Array, A: Array, scheme: Scheme) -> Array:
    """Velocity that a history begins with, of a staggered scheme half a step before t = 0 [m/s]."""
    return V - scheme.step / 2 * A if scheme.staggered else V


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
        self.solves = inverses(self.M, self.K, scheme, self.C, self.work.factor)
        self.solve = self.solves[0]
        M = operator(self.M)
        C = None if self.C is None else operator(self.C)
        K = operator(self.K)
        self.bodies = [Body(M, C, K, Operator(solve)) for solve in self.solves]

    def start(self, F: Array | None = None) -> Motion:
        """State at t = 0: at rest, unstrained, with the initial acceleration that the scheme asks for.

        The load is the constant one where `F` is not given.
        """
        zero = np.zeros_like(self.F)
        A = zero
        if self.scheme.start == "consistent":
            is_mass = self.C is None and self.scheme.stages[0].stiffness_weight == 0
            A = (self.solve if is_mass else self.work.factor(self.M))(self.F if F is None else F)
        return Motion(zero, start_velocity(zero, A, self.scheme), A)

    def advance(self, state: Motion, loads: Sequence[Array] | None = None, gg: float | None = None) -> Motion:
        """One step, under the loads at its start and at the end of each stage, where they are not the constant one.

        Its discount is `gg`, where that is not the scheme's.
        """
        loads = [self.F] * (len(self.solves) + 1) if loads is None else loads
        gg = self.scheme.gg if gg is None else gg
        end = step_change(self.scheme, gg, self.scheme.step, self.bodies, state, loads)
        return end._replace(D=state.D + end.D)

    def states(
        self, steps: int, loads: Array | None = None, discount: Callable[[Motion], float] | None = None
    ) -> Iterator[Motion]:
        """Yield the state after each step from rest, under loads at the `stage_times`, shape (instants, unknowns).

        The scheme's own gg is that of all steps but the first half step of a staggered scheme, unless `discount` has
        it of the state that one begins with.
        """
        stages = len(self.solves)
        state = self.start(None if loads is None else loads[0])
        gg = 1.0 if self.scheme.staggered else None
        for n in range(steps):
            of_step = None if loads is None else list(loads[n * stages : (n + 1) * stages + 1])
            state = self.advance(state, of_step, gg if discount is None else discount(state))
            gg = None
            yield state
