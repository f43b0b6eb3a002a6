"""Histories of a meshed column by a scheme, on a base with prescribed motion or on a half-space.

A prescribed base enters the others' equations by its displacement and acceleration, a half-space by a dashpot of its
impedance and the load 2 rho c v of the incident wave.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from fem_reference.column.mesh import LineMesh, line_mesh
from fem_reference.column.problem import DISPLACEMENT, PRESSURE, Excitation, Ground
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Indices, Scheme
from fem_reference.problem.result import Result, just_ended
from fem_reference.scheme.eigen import largest_frequency
from fem_reference.scheme.newmark import Stepper

MEAN_VELOCITY = "mean_velocity"
"""Name of the velocity of the centre of mass [m/s] where columns are observed."""


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
    columns
        Of the surface and the base, and ``displacement_1`` ..., ``stress_1`` ... of the heights.
    heights
        Where displacement [m] and stress (positive in compression) [Pa] are observed.

    Raises
    ------
    ValueError
        For an unknown column, a height outside, or a mesh that is not possible.
    """
    ground.check_request(columns, heights)
    began = perf_counter()
    mesh = line_mesh(ground, elements, degree)
    model = Model(mesh, ground.impedance)
    observed = observed_by(model, columns, heights)
    model.check_scheme(scheme)
    M, C, K = model.matrices()
    if scheme.start == "consistent" and np.any(M.diagonal() == 0):
        raise ValueError("start: must be 'zero' where a joint lies between half-space and column, got 'consistent'")
    stepper = Stepper(M, K, np.zeros(len(model.free)), scheme, C=None if ground.impedance is None else C)
    ready = perf_counter()
    with np.errstate(all="ignore"):
        columns_of_steps = histories(model, stepper, excitation, observed)
    return Result(
        **just_ended(scheme.step, columns_of_steps.shape[1], began, ready),
        columns=dict(zip(columns, columns_of_steps, strict=True)),
        unknowns=len(model.free),
        **vars(stepper.work),
    )


@dataclass(frozen=True)
class Model:
    """M A + C V + K D = F of a meshed column, on a base with prescribed motion, a half-space or a free base."""

    mesh: LineMesh
    impedance: float | None  # of the half-space [Pa s/m]
    base_is_free: bool = False

    @property
    def holds_base(self) -> bool:
        """Whether the motion of the base is prescribed."""
        return self.impedance is None and not self.base_is_free

    @cached_property
    def free(self) -> Indices:
        """Numbers of the unknowns that are solved for."""
        return np.delete(np.arange(self.mesh.size), [self.mesh.base_node] * self.holds_base)

    def matrices(self) -> list[csr_array]:
        """M, C and K of the free unknowns."""
        base = self.mesh.base_node
        C = csr_array(([self.impedance or 0.0], ([base], [base])), shape=self.mesh.K.shape)
        return [csr_array(matrix[self.free][:, self.free]) for matrix in (self.mesh.M, C, self.mesh.K)]

    def check_scheme(self, scheme: Scheme) -> None:
        """Raise a `ValueError` for a half-space and a scheme whose velocity is that of half a step before."""
        has_velocity = not scheme.staggered or self.impedance is None
        require(has_velocity, "scheme", "must have the velocity that a half-space's dashpot needs", scheme.name)

    def loads(self) -> Array:
        """Load of a unit of each part of the excitation on the free unknowns, shape (unknowns, 4)."""
        base = self.mesh.base_node
        loads = np.zeros((self.mesh.size, 4))
        loads[self.mesh.top, 3] = -1.0
        if self.holds_base:
            loads[:, 0] = -self.mesh.K[[base]].toarray()[0]
            loads[:, 2] = -self.mesh.M[[base]].toarray()[0]
        elif self.impedance is not None:
            loads[base, 1] = 2 * self.impedance
        return loads[self.free]


class Observation(NamedTuple):
    """What observes the columns of a history."""

    motion: Array  # rows on displacement, velocity and acceleration of the free unknowns, shape (3, columns, unknowns)
    parts: Array  # on the parts of the excitation, which have the base's own motion, shape (columns, 4)


def observed_by(model: Model, columns: Sequence[str], heights: Sequence[float]) -> Observation:
    """How columns of a history are observed; of those that only a contact knows nothing is."""
    mesh = model.mesh
    motion = np.zeros((3, len(columns), mesh.size))
    parts = np.zeros((len(columns), 4))
    for column, name in enumerate(columns):
        D, V, A = motion[:, column]
        kind, _, number = name.rpartition("_")
        if name == DISPLACEMENT:
            D[mesh.top] = 1.0
        elif name == PRESSURE and model.holds_base:  # the force that holds the base's own equation
            D[:] = mesh.K[[mesh.base_node]].toarray()[0]
            A[:] = mesh.M[[mesh.base_node]].toarray()[0]
        elif name == PRESSURE and model.impedance is not None:
            V[mesh.base_node] = -model.impedance
            parts[column, 1] = 2 * model.impedance
        elif name == MEAN_VELOCITY:
            mass = mesh.M @ np.ones(mesh.size)
            V[:] = mass / mass.sum()
        elif kind in ("displacement", "velocity", "stress"):
            row = V if kind == "velocity" else D
            row[:] = mesh.row(heights[int(number) - 1], stress=kind == "stress")
    if model.holds_base:
        parts[:, :3] += motion[:, :, mesh.base_node].T
    return Observation(motion[:, :, model.free], parts)


def histories(model: Model, stepper: Stepper, excitation: Excitation, observed: Observation) -> Array:
    """The observed columns at every step, shape (columns, steps)."""
    parts = excitation.parts
    loads = parts @ model.loads().T
    stages = len(stepper.solves)
    columns = observed.parts @ parts[stages::stages].T
    for n, state in enumerate(stepper.states(columns.shape[1], loads)):
        for rows, vector in zip(observed.motion, (state.D, state.V, state.A), strict=True):
            columns[:, n] += rows @ vector
    return columns


def highest_frequency(ground: Ground, elements: Sequence[int], degree: int) -> float:
    """The highest natural frequency [rad/s], the base held; on a half-space the foot of the column is free."""
    mesh = line_mesh(ground, elements, degree)
    massless = mesh.M.diagonal()[mesh.base_node] == 0  # a joint lies on it
    M, _, K = Model(mesh, None if massless else ground.impedance).matrices()
    return largest_frequency(K, M)
