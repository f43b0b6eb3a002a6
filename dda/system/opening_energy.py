"""Energy of sub-blocks over a base that carries no tension: the entries of `dda.one_block.unilateral_energy`.

Strain counts the sub-blocks and their glue. The losses of a step are those of one block, with D' K0 D the energy of
both, D' Ke D + lambda' kappa^-1 lambda.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dda.contact.kernel import Contacts
from dda.contact.unilateral import OPEN
from dda.system.system import inverses

if TYPE_CHECKING:
    from dda.system.opening import Length, OpeningSystem, SystemState

Array = NDArray[np.float64]


class SystemLosses:
    """What sub-blocks keep at a step, and lose in a part of one [J]; `dt` is the step in whose units they are [s]."""

    def __init__(self, opening: OpeningSystem, dt: float) -> None:
        self.opening, self.dt = opening, dt
        e = opening.equations
        self.inverse, self.elastic = e.blockwise(inverses(e.mass)), e.blockwise(e.elastic)
        self.F = e.F * opening.system.load_size

    def stored(self, state: SystemState) -> tuple[float, ...]:
        """Return kinetic, strain, spring and load energy, without what the base gave."""
        strain = self._stiff(state.D, state.mu / self.dt**2) / 2
        springs = float(np.sum(self._springs(state.contacts)))
        return self._kinetic(state.P / self.dt), strain, springs, -float(self.F @ state.D)

    def of_part(self, length: Length, before: SystemState, after: SystemState, carried: Array) -> tuple[float, ...]:
        """Return the losses of a part in which the base moved by `carried`, along its normal and tangent."""
        late, gg = length.scheme.delta, length.scheme.gg
        old, new = before.contacts, after.contacts
        N = (1 - late) * np.array(old.normal) + late * np.array(new.normal)
        T = (1 - late) * np.array(old.shear) + late * np.array(new.shear)
        slid = self.opening.tangents @ (after.D - before.D) - carried[1]
        given = float(np.sum(N)) * carried[0] + float(np.sum(T)) * carried[1]
        friction = -np.array(new.shear) * np.array(new.slipped)
        work = N * np.subtract(new.gap, old.gap) + T * slid
        lost = self._springs(old) - self._springs(new) - work - friction
        same = (np.array(old.state) == OPEN) == (np.array(new.state) == OPEN)
        algorithmic = self._bulk(length, before, after) + np.sum(lost[same])
        damped = (1 - gg**2) * self._kinetic(before.P / self.dt)
        return float(algorithmic), damped, float(np.sum(lost[~same])), float(np.sum(friction)), given

    def _bulk(self, length: Length, before: SystemState, after: SystemState) -> float:
        """Return the loss of the sub-blocks, with what A0 adds where M A0 was not F - K0 D0."""
        scheme, dt2 = length.scheme, self.dt**2
        c, over = scheme.alpha - scheme.delta / 2, scheme.delta - 0.5
        moved, R0, R1 = after.D - before.D, before.f / dt2, after.f / dt2
        loss = over * self._stiff(moved, (after.mu - before.mu) / dt2)
        held = self.elastic @ before.D + self.opening.equations.B.T @ (before.mu / dt2)
        normal, shear = np.array(before.contacts.normal), np.array(before.contacts.shear)
        pressed = self.opening.normals.T @ normal + self.opening.tangents.T @ shear
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

    def _springs(self, contacts: Contacts) -> Array:
        law = self.opening.law
        shear = np.square(contacts.shear) / law.shear if law.shear else 0.0
        energy: Array = (np.square(contacts.normal) * law.compliance + shear) / 2
        return energy
