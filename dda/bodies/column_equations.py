r"""A bonded column under a steady vibration, and its highest frequency, by the modes and rows of its steps.

With the modes z of the blocks, and forces lambda of the springs between them (`dda.bodies.column_march`),

    (k - W2) z = F + B' lambda,      B z + c lambda = y of the base,

W2 and S = V / D of the scheme (`dda.scheme.harmonic`). On a half-space of impedance zeta, whose surface is the foot or
a spring below it, and where a wave of velocity v comes up, the lowest row is S (B z + c lambda) + lambda / zeta = 2 v.
A base of prescribed motion has its own acceleration -w^2 y, whatever the scheme makes of the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from dda.bodies.column import Column
from dda.bodies.column_history import DISPLACEMENT, PRESSURE, observed_columns
from dda.bodies.column_march import blocks_of, body_of, compliances, inertia, matrix_of, stiffness
from dda.bodies.column_step import WELDED, Blocks, of_top
from dda.linear.elimination import Elimination, largest_frequency
from dda.march.step import Body
from dda.model.arrays import Array
from dda.scheme.harmonic import Complex, acceleration_share, chosen
from dda.scheme.newmark import Scheme

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class Equations:
    """A column as a linear body (`dda.linear.answers.LinearBody`)."""

    column: Column

    names = (DISPLACEMENT, PRESSURE)
    load_size = 1.0
    motion = None
    moving = np.ones(2)

    @property
    def reached(self) -> Equations:
        """The equations: a load reaches all unknowns."""
        return self

    equations = reached

    @property
    def F(self) -> Array:
        """A pressure of unit size on the top, (1,)."""
        return np.ones(1)

    def rows(self, columns: tuple[str, ...]) -> tuple[str, ...]:
        """Return the columns."""
        return columns

    @cached_property
    def blocks(self) -> Blocks:
        """Masses and stretches of the blocks."""
        return blocks_of(self.column, observed_columns(self.column, (), ()))

    @cached_property
    def body(self) -> Body:
        """Modes and rows."""
        return body_of(self.column, self.blocks)

    @cached_property
    def B(self) -> csr_array:
        """Openings of the springs by the modes, (blocks, modes)."""
        from scipy.sparse import csr_array

        return csr_array(matrix_of(self.body))

    def steady(
        self, columns: tuple[str, ...], F: Array, base: Array, scheme: Scheme, frequencies: ArrayLike, exact: bool
    ) -> Complex:
        """Return some columns of a steady vibration, (columns, frequencies).

        Parameters
        ----------
        F, base
            Amplitudes of the pressure on the top, (1,), and of the base, or of the wave, first of all [m].
        """
        w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
        W2, S = chosen(scheme, frequencies, exact)
        accelerations = W2 if exact else W2 * acceleration_share(scheme, w)
        elimination, scale = self.elimination()
        k = self.body.k
        loads = self.body.loads
        first = np.eye(1, len(self.blocks.root))[0]
        values: dict[str, list[complex]] = {DISPLACEMENT: [], PRESSURE: []}
        for w_i, w2, s, a in zip(w.tolist(), W2.tolist(), S.tolist(), accelerations.tolist(), strict=True):
            acceleration = -w_i * w_i * base[0]
            push = F[0] * loads[1]
            if self.blocks.base == WELDED:
                push = push + acceleration * loads[3]
            moved = base[0] if self.column.rests_on_base else 2j * w_i * base[0]
            solution = elimination.solve(np.concatenate([push / scale, moved * first]), w2, s)
            z = solution[: len(k)]
            values[DISPLACEMENT].append(of_top(self.blocks, z, len(first) - 1))
            force = scale * solution[len(k)]
            if self.blocks.base == WELDED:
                force += self.blocks.mass * (acceleration / 3 - a * of_top(self.blocks, z, 0) / 6)
            values[PRESSURE].append(force)
        return np.array([values[name] for name in columns])

    def elimination(self) -> tuple[Elimination, float]:
        """Return the equations in moduli near one, and the factor of the forces in them."""
        from scipy.sparse import block_array, diags_array

        scale = float(np.max(stiffness(self.column) / inertia(self.column)))
        n = len(self.blocks.root)
        k = self.body.k / scale
        if self.blocks.modes == 2:  # of a block without stretch any stiffness, which nothing reaches
            k[1::2] = np.where(self.blocks.half > 0, k[1::2], 1.0)
        on_half_space = np.eye(1, n)[0] * (not self.column.rests_on_base)
        dashpots = diags_array(scale * on_half_space / (self.blocks.impedance or 1.0))
        openings = self.B, diags_array(scale * compliances(self.column))
        still, moving = (
            [diags_array(share) @ part for part in openings] for share in (1 - on_half_space, on_half_space)
        )
        K = block_array([[diags_array(k), -self.B.T], [still[0], still[1] + dashpots]], format="csr")
        C = block_array([[diags_array(0 * k), None], [moving[0], moving[1]]], format="csr")
        M = diags_array(np.repeat([1 / scale, 0.0], [len(k), n]), format="csr")
        return Elimination(K, M, C), scale

    def largest(self) -> float:
        """Return the highest natural frequency [rad/s] with all springs closed.

        Rigid contacts that may open or slip are left out: they only lower it. So is the dashpot of a half-space, which
        leaves the foot of a column free, or a spring below it on a base at rest.
        """
        from scipy.sparse import diags_array
        from scipy.sparse.linalg import LinearOperator, splu

        compliance = compliances(self.column)
        closed = compliance > 0
        alike = np.array([self.column.glue is None and contact is None for contact in self.column.contacts])
        alike[0] = False  # a foot on a half-space is free, one on a base has a spring for its block
        springs = diags_array(1 / np.sqrt(compliance[closed])) @ self.B[closed]
        K = diags_array(self.body.k) + springs.T @ springs
        if not alike.any():
            return largest_frequency(K.tocsr())
        welds = self.B[alike]
        forces = splu((welds @ welds.T).tocsc())

        def free(z: Array) -> Array:
            """Return the part of a motion that keeps the faces together."""
            return np.asarray(z - welds.T @ forces.solve(welds @ z))

        return largest_frequency(LinearOperator(K.shape, dtype=float, matvec=lambda z: free(K @ free(z))))


def equations(column: Column) -> Equations:
    """Return the equations of a column."""
    return Equations(column)
