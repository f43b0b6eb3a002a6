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

from dda.column.column import Column
from dda.model.arrays import Array

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Row = dict[int, float]  # weights of unknowns


@dataclass(frozen=True, eq=False)
class Equations:
    """M D'' + C D' + K D = F of a column; the rows of faces and openings are those of its blocks, from the base up."""

    column: Column
    feet: csr_array  # (blocks, unknowns) displacements of the lower faces
    tops: csr_array  # those of the upper ones
    openings: csr_array  # of the springs below the blocks; zero where there is none

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
