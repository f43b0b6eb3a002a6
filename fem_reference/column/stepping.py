"""Histories of a meshed column by a scheme, on a base with prescribed motion or on a half-space.

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
from fem_reference.problem.result import Result, just_ended
from fem_reference.scheme.newmark import Stepper


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
    model.check_scheme(scheme)
    free = model.free
    M, C, K = (csr_array(matrix[free][:, free]) for matrix in (model.M, model.C, model.K))
    if scheme.start == "consistent" and np.any(M.diagonal() == 0):
        raise ValueError("start: must be 'zero' where a joint lies between half-space and column, got 'consistent'")
    stepper = Stepper(M, K, np.zeros(len(free)), scheme, C=None if ground.impedance is None else C)
    ready = perf_counter()
    with np.errstate(all="ignore"):
        columns_of_steps = histories(model, stepper, excitation, rows)
    return Result(
        **just_ended(scheme.step, columns_of_steps.shape[1], began, ready),
        columns=dict(zip(columns, columns_of_steps, strict=True)),
        unknowns=len(free),
        **vars(stepper.work),
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
    def of(cls, mesh: LineMesh, impedance: float | None, base_is_free: bool = False) -> Model:
        """Return the model of a mesh on its base, whose motion is prescribed but for a half-space or a free base."""
        n = mesh.size
        b = mesh.base_node
        C = csr_array(coo_array(([impedance or 0.0], ([b], [b])), shape=(n, n)))
        free = np.arange(n)
        if impedance is None and not base_is_free:
            free = np.delete(free, b)
        return cls(mesh.M, C, mesh.K, free, b, mesh.top, impedance)

    @property
    def holds_base(self) -> bool:
        """Whether the motion of the base is prescribed."""
        return bool(len(self.free) < self.M.shape[0])

    def check_scheme(self, scheme: Scheme) -> None:
        """Raise for a scheme that has no velocity for the dashpot of a half-space.

        Raises
        ------
        ValueError
            If its velocity is that of half a step before.
        """
        if scheme.staggered and self.impedance is not None:
            raise ValueError(
                f"scheme: must not be {scheme.name!r} above a half-space, whose dashpot needs the velocity"
            )

    def loads(self) -> Array:
        """Load of a unit of each part of the excitation on the free unknowns, shape (unknowns, 4)."""
        loads: Array = np.zeros((self.M.shape[0], 4))
        if self.holds_base:
            loads[:, 0] = -self.K[:, [self.base]].toarray()[:, 0]
            loads[:, 2] = -self.M[:, [self.base]].toarray()[:, 0]
        elif self.impedance is not None:
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
    row = mesh.row(heights[int(number) - 1], stress=kind == "stress")
    return Observation(none, row, none, parts) if kind == "velocity" else Observation(row, none, none, parts)


def observed_by(model: Model, rows: Sequence[Observation]) -> Observation:
    """Return rows on the free unknowns, one below the other, and on the excitation, which has the base's motion."""
    D, V, A, excitation = (np.array([getattr(row, part) for row in rows]) for part in ("D", "V", "A", "excitation"))
    if model.holds_base:
        excitation[:, :3] += np.column_stack([part[:, model.base] for part in (D, V, A)])
    return Observation(D[:, model.free], V[:, model.free], A[:, model.free], excitation)


def histories(model: Model, stepper: Stepper, excitation: Excitation, rows: Sequence[Observation]) -> Array:
    """Return the observed columns at every step, shape (columns, steps)."""
    parts = excitation.parts
    loads = parts @ model.loads().T
    by = observed_by(model, rows)
    stages = len(stepper.solves)
    columns = by.excitation @ parts[stages::stages].T
    for n, state in enumerate(stepper.states(columns.shape[1], loads)):
        columns[:, n] += by.D @ state.D + by.V @ state.V + by.A @ state.A
    return columns
