r"""The equations of a column: M D'' + C D' + K D = F in the displacements of faces and the openings of springs.

A block of height h, density rho and modulus E has the faces' displacements for its two unknowns (its displacement is
their mean, its strain their difference over h):

    M = rho h / 6 [[2, 1], [1, 2]],     K = E / h [[1, -1], [-1, 1]].

The base's displacement comes first. Between two blocks the unknowns are the displacement of the lower face and the
opening g to the upper one, so that the force of a spring is its stiffness times one unknown and stiff springs cost no
digits; where the faces move alike there is no opening. A base of prescribed motion is known at
every step, displacement and acceleration; a half-space below is a dashpot of its impedance z, with the load 2 z v of an
incident wave of particle velocity v.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from dda.bodies.column import Column
from dda.linear.elimination import Elimination, largest_frequency
from dda.model.arrays import Array
from dda.scheme.harmonic import Complex, acceleration_share, chosen
from dda.scheme.newmark import Scheme

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Row = dict[int, float]  # weights of unknowns
# of the top [m], on the base [Pa]
DISPLACEMENT = "displacement"
PRESSURE = "contact_pressure"


@dataclass(frozen=True, eq=False)
class Equations:
    """M D'' + C D' + K D = F of a column; the rows of faces and openings are those of its blocks, from the base up."""

    column: Column
    feet: csr_array  # (blocks, unknowns) displacements of the lower faces
    tops: csr_array  # those of the upper ones
    openings: csr_array  # of the springs below the blocks; zero where there is none

    names = (DISPLACEMENT, PRESSURE)
    load_size = 1.0
    motion = None

    @property
    def prescribed(self) -> bool:
        """Whether the motion of the base is prescribed."""
        return self.column.rests_on_base

    @property
    def dashpot(self) -> float:
        """Impedance below the first unknown [Pa s/m], zero where there is no half-space."""
        return self.column.impedance or 0.0

    @cached_property
    def M(self) -> csr_array:
        """Inertia, (unknowns, unknowns) [kg/m^2]."""
        sixth = inertia(self.column)[:, None] / 6
        lower = self.feet.T @ (self.feet * 2 + self.tops).multiply(sixth)
        return (lower + self.tops.T @ (self.feet + self.tops * 2).multiply(sixth)).tocsr()

    @cached_property
    def K(self) -> csr_array:
        """Stiffness, (unknowns, unknowns) [Pa/m]."""
        stretches = self.tops - self.feet
        blocks = stretches.T @ stretches.multiply(stiffness(self.column)[:, None])
        springs = self.openings.T @ self.openings.multiply(spring_stiffness(self.column)[:, None])
        return (blocks + springs).tocsr()

    @property
    def reached(self) -> Equations:
        """The equations: a load reaches all unknowns."""
        return self

    equations = reached

    @property
    def F(self) -> Array:
        """A pressure of unit size on the top, (1,)."""
        return np.ones(1)

    def rows(self, columns: Sequence[str]) -> Observers:
        """Return what observes some columns."""
        return observers(self, columns, ())

    def steady(
        self, rows: Observers, F: Array, base: Array, scheme: Scheme, frequencies: ArrayLike, exact: bool
    ) -> Complex:
        """Return what rows observe of a steady vibration, (rows, frequencies).

        With V = S D and A = -W2 D of one frequency (`dda.scheme.harmonic`) the equations are (K + S C - W2 M) D = F.
        A base of prescribed motion has its own acceleration -w^2 y, whatever the scheme makes of the others; above a
        half-space the motion is that of the wave that comes up.
        """
        w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
        W2, S = chosen(scheme, frequencies, exact)
        accelerations = W2 if exact or not scheme.averages else W2 * acceleration_share(scheme, w)
        loading = Loading(self)
        motion = base[0] * np.array([np.ones_like(w), 1j * w, -w * w])
        drive = np.array([*motion, np.full(len(w), F[0], complex)])
        driven = loading.prescribed(rows) @ drive
        by_D, by_V, by_A = loading.free(rows)
        elimination = Elimination(loading.K, loading.M, loading.C)
        for i, (w2, s, a) in enumerate(zip(W2, S, accelerations, strict=True)):
            D = elimination.solve(loading.push @ drive[:, i], w2, s)
            driven[:, i] += by_D @ D + s * (by_V @ D) - a * (by_A @ D)
        return np.asarray(driven)

    def largest(self) -> float:
        """Return the highest natural frequency [rad/s] with all springs closed.

        Rigid contacts that may open or slip are left out: they only lower it. So is the dashpot of a half-space, which
        leaves the foot of a column free, or a spring below it on a base at rest.
        """
        first = int(self.prescribed or self.column.springs[0] is not None)
        return largest_frequency(self.K[first:, first:], self.M[first:, first:])

    @property
    def size(self) -> int:
        """Number of unknowns, the base included."""
        return int(self.feet.shape[1])

    def row(self, block: int, low: float, high: float) -> Array:
        """Return the row that observes low times a block's lower and high times its upper face."""
        return np.asarray((low * self.feet[[block]] + high * self.tops[[block]]).toarray()[0])


def inertia(column: Column) -> Array:
    """Return the mass of every block [kg/m^2]."""
    return column.densities * column.heights


def stiffness(column: Column) -> Array:
    """Return E / h of every block, none where its faces move alike [Pa/m]."""
    return np.where(np.isinf(column.moduli), 0.0, column.moduli) / column.heights


def spring_stiffness(column: Column) -> Array:
    """Return the stiffness of the spring below every block, none of a rigid one [Pa/m]."""
    springs = np.array([spring or 0.0 for spring in column.springs])
    return np.where(np.isinf(springs), 0.0, springs)


def equations(column: Column) -> Equations:
    """Return the equations of a column."""
    feet: list[Row] = []
    tops: list[Row] = []
    openings: list[Row] = []
    below: Row = {0: 1.0}
    size = 1
    for block, spring in enumerate(column.springs):
        foot = below
        opening: Row = {}
        if spring is not None:
            opening = {size: 1.0}
            foot = below | opening
            if block == 0 and column.rests_on_base:  # the foot itself: the base's acceleration is then no load
                foot = opening
                opening = {size: 1.0, 0: -1.0}
            size += 1
        feet.append(foot)
        openings.append(opening)
        if math.isfinite(column.moduli[block]):
            below = {size: 1.0}
            size += 1
        else:
            below = foot
        tops.append(below)
    return Equations(column, *(rows_of(rows, size) for rows in (feet, tops, openings)))


def rows_of(rows: Sequence[Row], size: int) -> csr_array:
    """Return the matrix of some rows."""
    from scipy.sparse import csr_array

    places = [(i, unknown) for i, row in enumerate(rows) for unknown in row]
    values = [value for row in rows for value in row.values()]
    i, k = np.array(places, dtype=int).reshape(-1, 2).T
    return csr_array((values, (i, k)), shape=(len(rows), size))


@dataclass(frozen=True, eq=False)
class Observers:
    """Rows that observe displacement, velocity, acceleration and the drive's four parts, one row a column."""

    D: Array  # (columns, unknowns)
    V: Array
    A: Array
    drive: Array  # (columns, 4)


def observers(system: Equations, columns: Sequence[str], heights: Sequence[float]) -> Observers:
    """Return the rows of the columns."""
    none = np.zeros((len(columns), system.size))
    rows = Observers(none.copy(), none.copy(), none.copy(), np.zeros((len(columns), 4)))
    for number, name in enumerate(columns):
        if name == DISPLACEMENT:
            rows.D[number] = system.row(len(system.column.heights) - 1, 0.0, 1.0)
        elif name != PRESSURE:
            rows.D[number] = _at_height(system, name, heights)
        elif system.prescribed:  # the force of the base on the column, by the base's own equation
            rows.D[number] = system.K[[0]].toarray()[0]
            rows.A[number] = system.M[[0]].toarray()[0]
        else:  # z (2 v - V) of the half-space
            rows.V[number, 0] = -system.dashpot
            rows.drive[number, 1] = 2 * system.dashpot
    return rows


def _at_height(system: Equations, name: str, heights: Sequence[float]) -> Array:
    kind, _, place = name.rpartition("_")
    block, share = system.column.block_at(heights[int(place) - 1])
    if kind == DISPLACEMENT:
        return system.row(block, 1 - share, share)
    spring = system.column.moduli[block] / system.column.heights[block]
    return system.row(block, spring, -spring)


class Loading:
    """The equations of the free unknowns; of a base of prescribed motion only its effect on the others is left."""

    def __init__(self, system: Equations) -> None:
        """Form the matrices, and the load that each part of the drive is."""
        from scipy.sparse import csr_array

        first = int(system.prescribed)
        self.first = first
        self.M = system.M[first:, first:]
        self.K = system.K[first:, first:]
        self.C = csr_array(([system.dashpot], ([0], [0])), shape=self.M.shape)
        base = np.eye(1, system.size)[0]
        top = system.row(len(system.column.heights) - 1, 0.0, -1.0)
        by_motion = -system.K[[0]].toarray()[0], -system.M[[0]].toarray()[0]
        parts = (first * by_motion[0], (1 - first) * 2 * system.dashpot * base, first * by_motion[1], top)
        self.push = np.array(parts).T[first:]  # (unknowns, 4)

    def free(self, rows: Observers) -> tuple[Array, ...]:
        """Return the rows of displacement, velocity and acceleration by the free unknowns."""
        return tuple(matrix[:, self.first :] for matrix in (rows.D, rows.V, rows.A))

    def prescribed(self, rows: Observers) -> Array:
        """Return the rows of the drive, with what a base of prescribed motion adds by its motion."""
        drive_weights = rows.drive.copy()
        if self.first:
            drive_weights[:, 0] += rows.D[:, 0]
            drive_weights[:, 2] += rows.A[:, 0]
        return drive_weights
