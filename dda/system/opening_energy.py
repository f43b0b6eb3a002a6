"""Energy of sub-blocks over a base that carries no tension: the entries of `dda.one_block.unilateral_energy`.

Strain counts the sub-blocks and their glue. The losses of a step are those of one block, with D' K0 D the energy of
both, D' Ke D + lambda' kappa^-1 lambda.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dda.contact.points import Points
from dda.system.opening import Length, OpeningSystem, SystemState
from dda.system.system import inverses

Array = NDArray[np.float64]


class SystemLedger:
    """Keeps the energies [J] after every step, the losses summed from t = 0 on."""

    def __init__(self, opening: OpeningSystem, dt: float) -> None:
        self.opening, self.dt, self.losses = opening, dt, np.zeros(4)
        self.given = 0.0  # by the base that moves, counted with the loads
        e = opening.equations
        self.inverse, self.elastic = e.blockwise(inverses(e.mass)), e.blockwise(e.elastic)
        self.F = e.F * opening.system.load_size

    def row(self, state: SystemState) -> tuple[float, ...]:
        """Return the entries of `ENERGIES` for the present state."""
        strain = self._stiff(state.D, state.mu / self.dt**2) / 2
        springs = float(np.sum(self._springs(state.points)))
        return (
            self._kinetic(state.P / self.dt),
            strain,
            springs,
            -float(self.F @ state.D) - self.given,
            *self.losses.tolist(),
        )

    def add(self, length: Length, before: SystemState, after: SystemState, carried: Sequence[float]) -> None:
        """Add the losses of an accepted step in which the base moved by `carried`, along its normal and tangent."""
        scheme = length.scheme
        old, new = before.points, after.points
        N = (1 - scheme.delta) * old.normal + scheme.delta * new.normal
        T = (1 - scheme.delta) * old.shear + scheme.delta * new.shear
        slid = self.opening.tangents @ (after.D - before.D) - carried[1]
        self.given += float(np.sum(N)) * carried[0] + float(np.sum(T)) * carried[1]
        rubbed = np.zeros_like(slid) if new.slipped is None else -new.shear * new.slipped
        lost = self._springs(old) - self._springs(new) - N * (new.gap - old.gap) - T * slid - rubbed
        same = old.closed == new.closed
        damped = (1 - scheme.gg**2) * self._kinetic(before.P / self.dt)
        self.losses += (
            self._bulk(length, before, after) + np.sum(lost[same]),
            damped,
            np.sum(lost[~same]),
            np.sum(rubbed),
        )

    def _bulk(self, length: Length, before: SystemState, after: SystemState) -> float:
        """Return the loss of the sub-blocks, with what A0 adds where M A0 was not F - K0 D0."""
        scheme, dt2 = length.scheme, self.dt**2
        c, over = scheme.alpha - scheme.delta / 2, scheme.delta - 0.5
        moved, R0, R1 = after.D - before.D, before.f / dt2, after.f / dt2
        loss = over * self._stiff(moved, (after.mu - before.mu) / dt2)
        held = self.elastic @ before.D + self.opening.equations.B.T @ (before.mu / dt2)
        pressed = self.opening.normals.T @ before.points.normal + self.opening.tangents.T @ before.points.shear
        loss += (1 - scheme.delta) * float(moved @ (self.F - held + pressed - R0))
        if c:
            stored = self._kinetic(R1) - self._kinetic(R0)
            loss += c * scheme.step**2 * (stored + 2 * over * self._kinetic(R1 - R0))
        return loss

    def _kinetic(self, momentum: Array) -> float:
        return float(momentum @ (self.inverse @ momentum)) / 2

    def _stiff(self, D: Array, force: Array) -> float:
        """Return D' Ke D + lambda' kappa^-1 lambda."""
        return float(D @ (self.elastic @ D) + force @ (self.opening.equations.C @ force))

    def _springs(self, points: Points) -> Array:
        law = self.opening.law
        shear = points.shear**2 / law.shear if law.shear else 0.0
        energy: Array = (points.normal**2 * law.compliance + shear) / 2
        return energy
