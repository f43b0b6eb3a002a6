"""Histories of a meshed column by the Newmark scheme with damping.

One step of M A + C V + K D = F from (D, V, A), with the matrix factorised once::

    D* = D + gg dt V + dt^2 (1/2 - alpha) A,     V* = gg V + dt (1 - delta) A
    (M + delta dt C + alpha dt^2 K) (D1 - D) = (M + delta dt C) (D* - D) + alpha dt^2 (F1 - C V* - K D)
    A1 = (D1 - D*) / (alpha dt^2),               V1 = V* + delta dt A1

A prescribed base enters the others' equations by its displacement and acceleration, a half-space by a dashpot of its
impedance and the load 2 rho c v of the incident wave.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from fem_reference.column.mesh import LineMesh, line_mesh
from fem_reference.column.problem import DISPLACEMENT, PRESSURE, Excitation, Ground, check_columns
from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.result import Result
from fem_reference.scheme.newmark import State, Work, acceleration, predictor


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
        What drives it; one instant more than steps.
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


def velocity_predictor(state: State, scheme: Scheme) -> Array:
    """V* = gg V + dt (1 - delta) A, the part of (7) that is known before the step [m/s]."""
    return scheme.gg * state.V + scheme.step * (1 - scheme.delta) * state.A


class DampedStepper:
    """The scheme on a model with damping, its matrices of the free unknowns factorised once."""

    def __init__(self, model: Model, scheme: Scheme, work: Work) -> None:
        self.model = model
        self.scheme = scheme
        self.work = work
        self.M, self.C, self.K = (matrix[model.free][:, model.free] for matrix in (model.M, model.C, model.K))
        self.carried = csr_array(self.M + scheme.delta * scheme.step * self.C)
        self.solve = work.factor(csr_array(self.carried + scheme.alpha * scheme.step**2 * self.K))

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
        histories = excitation_weights @ parts[1:].T
        for n, F in enumerate(loads[1:]):
            state = self.advance(state, F)
            histories[:, n] += by_D[:, free] @ state.D + by_V[:, free] @ state.V + by_A[:, free] @ state.A
        return histories

    def start(self, F: Array) -> State:
        """State at t = 0: at rest, with the initial acceleration that the scheme asks for."""
        zero = np.zeros_like(F)
        if self.scheme.start != "consistent":
            return State(zero, zero, zero)
        if np.any(self.M.diagonal() == 0):
            raise ValueError("start: must be 'zero' where a joint lies between half-space and column, got 'consistent'")
        return State(zero, zero, self.work.factor(csr_array(self.M))(F))

    def advance(self, state: State, F: Array) -> State:
        """One step under the load `F` at its end."""
        s = self.scheme
        predicted = predictor(state, s)
        slowed = velocity_predictor(state, s)
        resisted = F - self.C @ slowed
        increment = self.carried @ (predicted - state.D) + s.alpha * s.step**2 * (resisted - self.K @ state.D)
        D = state.D + self.solve(increment)
        A = acceleration(D, predicted, s) if s.alpha > 0 else self.solve(resisted - self.K @ D)
        return State(D, slowed + s.delta * s.step * A, A)
