r"""What takes energy from a block on a base that carries no tension, step by step.

With M A = F - K D + B' lambda at both ends of a step of length h, V0 the velocity after gg, c = alpha - delta/2 and
d( ) the change over the step, the sum E of the energies of motion, strain, springs (U of each point) and loads obeys

    dE = - (delta - 1/2) dD' K dD - c h^2 [d(A' M A) / 2 + (delta - 1/2) dA' M dA]
         + sum over the points of dU + dw [(1 - delta) N0 + delta N1] + ds [(1 - delta) T0 + delta T1]

A start with A0 = 0 is out of balance by F0 = F - K D0 + B' lambda0, which adds -(1 - delta) dD' F0 to the first step.
-T1 dr of the points that slide, whose references move by dr against T1, is the loss by friction. What a point adds
beside it while it stays closed belongs to the scheme's own loss, what it adds while it opens or closes is the loss by
switching, and gg takes (1 - gg^2) of the energy of motion. With implicit contact N1 and T1 count alone.
"""

from __future__ import annotations

import numpy as np

from fem_reference.contact.points import ContactModel
from fem_reference.contact.stepper import ContactState
from fem_reference.history.opening_columns import kinetic, springs
from fem_reference.problem.problem import Array, Scheme


class Losses:
    """Energies lost from t = 0 on, in the order of `opening_columns.LOSSES` [J]."""

    def __init__(self, model: ContactModel, balanced: bool, rule: str = "newmark") -> None:
        self.model, self._balanced, self._implicit = model, balanced, rule == "implicit"
        self.values = np.zeros(4)

    def add(self, scheme: Scheme, before: ContactState, after: ContactState) -> None:
        """Add the losses of an accepted step, whose scheme holds its own length and gg."""
        friction = -after.shear * (after.slid - before.slid)
        kept, switched = self._points(scheme, before, after, friction)
        damped = (1 - scheme.gg**2) * kinetic(self.model, before)
        self.values += (self._block(scheme, before, after) + kept, damped, switched, float(friction.sum()))

    def _block(self, scheme: Scheme, before: ContactState, after: ContactState) -> float:
        """Loss of the scheme in the block itself."""
        M, K, c, over = self.model.M, self.model.K, scheme.alpha - scheme.delta / 2, scheme.delta - 0.5
        old, new = before.motion, after.motion
        D = new.D - old.D
        loss = over * float(D @ (K @ D))
        if not self._balanced:
            loss += (1 - scheme.delta) * float(D @ (self.model.F - K @ old.D - M @ old.A + self._forces(before)))
            self._balanced = True
        if c:
            A = new.A - old.A
            stored = float(new.A @ (M @ new.A) - old.A @ (M @ old.A)) / 2
            loss += c * scheme.step**2 * (stored + over * float(A @ (M @ A)))
        return loss

    def _forces(self, state: ContactState) -> Array:
        """B' lambda [N]."""
        forces: Array = self.model.normal.T @ state.normal + self.model.tangential.T @ state.shear
        return forces

    def _points(
        self, scheme: Scheme, before: ContactState, after: ContactState, friction: Array
    ) -> tuple[float, float]:
        """Losses beside friction of the points that stay open or closed and of those that change it."""
        late = 1.0 if self._implicit else scheme.delta
        early = 1 - late
        work = (after.gap - before.gap) * (early * before.normal + late * after.normal)
        work += (after.slip - before.slip) * (early * before.shear + late * after.shear)
        lost = springs(self.model, before) - springs(self.model, after) - work - friction
        switched = before.closed != after.closed
        return float(lost[~switched].sum()), float(lost[switched].sum())
