"""Histories of a meshed column by a scheme with damping.

One stage of M A + C V + K D = F from (D, V, A) and the stage before, with its matrix factorised once and the numbers
of `fem_reference.problem.stages`, gamma' = gamma (1 - af) / (1 - am)::

    D* = D + dt (d_u u + d_g Vg) + dt^2 (e_0 A + e_g Ag),     V* = u + dt (g_0 A + g_g Ag),    u = gg V
    (M + gamma' dt C + beta' dt^2 K) (D1 - D) = (M + gamma' dt C) (D* - D)
                                                + b dt^2 (F* - am M A - (1 - af) C V* - af C u - K D)
    A1 = (D1 - D*) / (beta dt^2),               V1 = V* + gamma dt A1

A prescribed base enters the others' equations by its displacement and acceleration, a half-space by a dashpot of its
impedance and the load 2 rho c v of the incident wave.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from fem_reference.column.mesh import LineMesh, line_mesh
from fem_reference.column.problem import DISPLACEMENT, PRESSURE, Excitation, Ground, check_columns
from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.result import Result
from fem_reference.scheme.newmark import (
    State,
    Work,
    acceleration,
    discount,
    predictor,
    stage_load,
    start_velocity,
    velocity_predictor,
)


def solve_line(
    ground: Ground,
    elements: Sequence[int],
    degree: int,
    scheme: Scheme,
    excitation: Excitation,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
) -> Result:
    """Step a column from rest and return the asked columns.

    Parameters
    ----------
    elements, degree
        Number of elements of each stratum, and their degree.
    excitation
        What drives it at the scheme's `stage_times`: t = 0 and the ends of all stages.
    columns
        Of `asked_columns`.
    heights
        Where displacement [m] and stress (positive in compression) [Pa] are observed.

    Raises
    ------
    ValueError
        For an unknown column, a height outside, or a mesh that is not possible.
    """
    check_columns(columns, heights)
    ground.check_heights(heights)
    began = perf_counter()
    mesh = line_mesh(ground, elements, degree)
    model = Model.of(mesh, ground.impedance)
    rows = [row_of(mesh, model, name, heights) for name in columns]
    work = Work()
    stepper = DampedStepper(model, scheme, work)
    ready = perf_counter()
    with np.errstate(all="ignore"):
        histories = stepper.run(excitation, rows)
    ended = perf_counter()
    steps = histories.shape[1]
    return Result(
        time=scheme.step * np.arange(1.0, steps + 1),
        columns=dict(zip(columns, histories, strict=True)),
        unknowns=len(model.free),
        nonzeros=work.nonzeros,
        factorisations=work.factorisations,
        solves=work.solves,
        notes=(),
        setup_seconds=ready - began,
        stepping_seconds=ended - ready,
    )


@dataclass(frozen=True)
class Model:
    """M A + C V + K D = F of all unknowns, and which of them are free."""

    M: csr_array
    C: csr_array
    K: csr_array
    free: NDArray[np.intp]  # numbers of the unknowns that are solved for
    base: int
    top: int
    impedance: float | None

    @classmethod
    def of(cls, mesh: LineMesh, impedance: float | None) -> Model:
        """Return the model of a mesh on its base."""
        n = mesh.size
        b = mesh.base_node
        C = csr_array(coo_array(([impedance or 0.0], ([b], [b])), shape=(n, n)))
        free = np.flatnonzero(np.arange(n) != (b if impedance is None else n))
        return cls(mesh.M, C, mesh.K, free, b, mesh.top, impedance)

    def loads(self) -> Array:
        """Load of a unit of each part of the excitation on the free unknowns, shape (unknowns, 4)."""
        loads: Array = np.zeros((self.M.shape[0], 4))
        if self.impedance is None:
            loads[:, 0] = -self.K[:, [self.base]].toarray()[:, 0]
            loads[:, 2] = -self.M[:, [self.base]].toarray()[:, 0]
        else:
            loads[self.base, 1] = 2 * self.impedance
        loads[self.top, 3] = -1.0
        return np.asarray(loads[self.free])


@dataclass(frozen=True)
class Observation:
    """A column of the history: rows on displacement, velocity, acceleration (all unknowns) and excitation."""

    D: Array
    V: Array
    A: Array
    excitation: Array


def row_of(mesh: LineMesh, model: Model, name: str, heights: Sequence[float]) -> Observation:
    """Return how a column of the history is observed."""
    none = np.zeros(mesh.size)
    parts = np.zeros(4)
    if name == PRESSURE and model.impedance is None:  # the force that holds the base's own equation
        D, A = (matrix[[model.base]].toarray()[0] for matrix in (model.K, model.M))
        return Observation(D, none, A, parts)
    if name == PRESSURE:
        unit = np.eye(1, mesh.size, model.base)[0]
        return Observation(
            none, -(model.impedance or 0.0) * unit, none, np.array([0, 2 * (model.impedance or 0), 0, 0])
        )
    if name == DISPLACEMENT:
        return Observation(np.eye(1, mesh.size, mesh.top)[0], none, none, parts)
    kind, _, number = name.rpartition("_")
    return Observation(mesh.row(heights[int(number) - 1], stress=kind != DISPLACEMENT), none, none, parts)


class DampedStepper:
    """The scheme on a model with damping, its matrices of the free unknowns factorised once."""

    def __init__(self, model: Model, scheme: Scheme, work: Work) -> None:
        self.model = model
        self.scheme = scheme
        self.work = work
        self.M, self.C, self.K = (matrix[model.free][:, model.free] for matrix in (model.M, model.C, model.K))
        if scheme.staggered and model.impedance is not None:
            raise ValueError(
                f"scheme: must not be {scheme.name!r} above a half-space, whose dashpot needs the velocity"
            )
        self.carried: list[csr_array] = []
        self.solves: list[Callable[[Array], Array]] = []
        for stage, first in enumerate(scheme.stage_matrices):
            if first < stage:
                self.carried.append(self.carried[first])
                self.solves.append(self.solves[first])
                continue
            numbers = scheme.stages[stage]
            carried = csr_array(self.M + numbers.damping_weight * scheme.step * self.C)
            self.carried.append(carried)
            self.solves.append(work.factor(csr_array(carried + numbers.stiffness_weight * scheme.step**2 * self.K)))

    def run(self, excitation: Excitation, rows: Sequence[Observation]) -> Array:
        """Return the observed columns at every step, shape (columns, steps)."""
        e = excitation
        free = self.model.free
        base = self.model.base
        parts = np.column_stack([e.displacement, e.velocity, e.acceleration, e.pressure])
        loads = parts @ self.model.loads().T
        by_D, by_V, by_A = (np.array([getattr(row, part) for row in rows]) for part in "DVA")
        excitation_weights = np.array([row.excitation for row in rows])
        if self.model.impedance is None:
            excitation_weights[:, 0] += by_D[:, base]
            excitation_weights[:, 2] += by_A[:, base]
        state = self.start(loads[0])
        stages = len(self.scheme.stages)
        histories = excitation_weights @ parts[stages::stages].T
        for n in range(histories.shape[1]):
            state = self.advance(state, list(loads[n * stages : (n + 1) * stages + 1]))
            histories[:, n] += by_D[:, free] @ state.D + by_V[:, free] @ state.V + by_A[:, free] @ state.A
        return histories

    def start(self, F: Array) -> State:
        """State at t = 0: at rest, with the initial acceleration that the scheme asks for."""
        zero = np.zeros_like(F)
        if self.scheme.start != "consistent":
            return State(zero, zero, zero)
        if np.any(self.M.diagonal() == 0):
            raise ValueError("start: must be 'zero' where a joint lies between half-space and column, got 'consistent'")
        A = self.work.factor(csr_array(self.M))(F)
        return State(zero, start_velocity(zero, A, self.scheme), A, undiscounted=self.scheme.staggered)

    def advance(self, state: State, loads: Sequence[Array]) -> State:
        """One step under the loads at its start and at the end of each stage."""
        end = self._advance_stage(state, None, loads, 0)
        for stage in range(1, len(self.solves)):
            end = self._advance_stage(state, end, loads, stage)
        return end

    def _advance_stage(self, state: State, before: State | None, loads: Sequence[Array], stage: int) -> State:
        s = self.scheme
        numbers = s.stages[stage]
        predicted = predictor(state, s, stage, before)
        slowed = velocity_predictor(state, s, stage, before)
        resisted = stage_load(loads, s, stage) - self.C @ self._mean_velocity(state, slowed, stage)
        if numbers.am:
            resisted = resisted - numbers.am * (self.M @ state.A)
        if numbers.beta > 0:
            weight = numbers.compliance * s.step**2
            increment = self.carried[stage] @ (predicted - state.D) + weight * (resisted - self.K @ state.D)
            D = state.D + self.solves[stage](increment)
            A = acceleration(D, predicted, s, stage)
        else:
            D = predicted
            strained = (1 - numbers.af) * D + numbers.af * state.D if numbers.af else D
            A = self.solves[stage](resisted - self.K @ strained) / (1 - numbers.am)
        return State(D, slowed + numbers.gamma * s.step * A, A)

    def _mean_velocity(self, state: State, slowed: Array, stage: int) -> Array:
        """(1 - af) V* + af u, which a dashpot feels before the new acceleration acts [m/s]."""
        af = self.scheme.stages[stage].af
        return (1 - af) * slowed + af * discount(state, self.scheme) * state.V if af else slowed
