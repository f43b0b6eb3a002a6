r"""The equations of a column: M D'' + C D' + K D = F in the displacements of faces and the openings of springs.

A block of height h, density rho and modulus E has the faces' displacements for its two unknowns (its displacement is
their mean, its strain their difference over h):

    M = rho h / 6 [[2, 1], [1, 2]],     K = E / h [[1, -1], [-1, 1]].

Between two blocks the unknowns are the displacement of the lower face and the opening g to the upper one, so that the
force of a spring is its stiffness times one unknown and stiff springs cost no digits; where the faces move alike there
is no opening. A base that moves as it is told is known at every step, displacement and acceleration; a half-space
below is a dashpot of its impedance z, with the load 2 z v of an incident wave of particle velocity v.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from dda.column.column import Column
from dda.model.arrays import Array

Face = tuple[int, ...]  # the unknowns that add up to its displacement: the lower face and the opening above it
WIDTH = 2  # diagonals below the main one: a block couples two displacements and the opening between them


def inertia(mass: Array | float) -> Array:
    """Return the matrix of a block's inertia by its mass per area, (..., 2, 2) [kg/m^2]."""
    return np.asarray(np.multiply.outer(np.asarray(mass) / 6, [[2.0, 1.0], [1.0, 2.0]]))


def stiffness(spring: Array | float) -> Array:
    """Return the matrix of a block's stiffness by E / h, (..., 2, 2) [Pa/m]."""
    return np.asarray(np.multiply.outer(np.asarray(spring), [[1.0, -1.0], [-1.0, 1.0]]))


@dataclass(frozen=True, eq=False)
class Bands:
    """A symmetric matrix of some unknowns by its diagonals, (WIDTH + 1, n), main one first."""

    rows: Array

    @classmethod
    def zeros(cls, n: int) -> Bands:
        """Return the zero matrix."""
        return cls(np.zeros((WIDTH + 1, n)))

    def add(self, i: int, j: int, value: float) -> None:
        """Add to an entry on or below the diagonal."""
        if i >= j:
            self.rows[i - j, j] += value

    def first_column(self) -> Array:
        """Return the first column."""
        n = self.rows.shape[1]
        column = np.zeros(n)
        column[: WIDTH + 1] = self.rows[:n, 0]
        return column


@dataclass(frozen=True, eq=False)
class Equations:
    """M D'' + C D' + K D = F of a column; where the base is told how to move, its displacement comes first in `M`, `K`.

    `lower` and `upper` are the unknowns whose sum is the displacement of each block's two faces.
    """

    column: Column
    M: Bands
    K: Bands
    lower: Sequence[Face]
    upper: Sequence[Face]
    openings: dict[int, int] = field(default_factory=dict)  # of the spring below a block, by the block: its unknown

    @property
    def told(self) -> bool:
        """Whether the base moves as it is told."""
        return self.column.impedance is None

    @cached_property
    def size(self) -> int:
        """Number of unknowns, the base included where it is told."""
        return len(self.M.rows[0])

    @property
    def dashpot(self) -> float:
        """Impedance below the first unknown [Pa s/m], zero where the base is told."""
        return self.column.impedance or 0.0

    def row(self, block: int, low: float, high: float) -> Array:
        """Return the row that observes low times a block's lower and high times its upper face."""
        row = np.zeros(self.size)
        for faces, value in ((self.lower[block], low), (self.upper[block], high)):
            row[list(faces)] += value
        return row


def equations(column: Column) -> Equations:
    """Return the equations of a column."""
    lower, upper, openings, size = _numbers(column)
    M = Bands.zeros(size)
    K = Bands.zeros(size)
    masses = inertia(column.densities * column.heights)
    springs = stiffness(column.moduli / column.heights)
    for block in range(len(lower)):
        ends = lower[block], upper[block]
        for a in range(2):
            for b in range(2):
                _spread(M, ends[a], ends[b], masses[block, a, b])
                _spread(K, ends[a], ends[b], springs[block, a, b])
    _add_springs(column, K, openings)
    return Equations(column, M, K, lower, upper, openings)


def _spread(matrix: Bands, first: Face, second: Face, value: float) -> None:
    for i in first:
        for j in second:
            matrix.add(i, j, value)


def _numbers(column: Column) -> tuple[list[Face], list[Face], dict[int, int], int]:
    """Number the unknowns upwards: the lower face's displacement, the opening above it, the next block's upper face."""
    lower: list[Face] = []
    upper: list[Face] = []
    openings: dict[int, int] = {}
    base = 0
    size = 1
    for block, spring in enumerate(column.springs):
        face: Face = (base,)
        if spring is not None:
            openings[block] = size
            face = (size,) if block == 0 and column.impedance is None else (base, size)
            size += 1
        lower.append(face)
        base = size
        size = size + 1
        upper.append((base,))
    return lower, upper, openings, size


def _add_springs(column: Column, K: Bands, openings: dict[int, int]) -> None:
    """Add the springs; the one on a base that is told joins two displacements, every other one is an unknown's own."""
    for block, unknown in openings.items():
        value = opening_stiffness(column, block)
        K.add(unknown, unknown, value)
        if block == 0 and column.impedance is None:
            K.add(0, 0, value)
            K.add(unknown, 0, -value)


def opening_stiffness(column: Column, block: int) -> float:
    """Return the stiffness of the spring below a block [Pa/m]."""
    return column.springs[block] or 0.0
