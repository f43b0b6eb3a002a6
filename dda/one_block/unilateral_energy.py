r"""Energy of one block over no-tension corners, and what takes it away.

For any Newmark scheme whose accelerations obey M A = F - K0 D + B' lambda at both ends of a step, with
c = alpha - delta/2 and V the velocity after gg,

    E1 - E0 = - (delta - 1/2) dD' K0 dD - c h^2 [ A' M A / 2 ] - (delta - 1/2) c h^2 dA' M dA
              + sum over contacts of U1 - U0 + dw [(1 - delta) N0 + delta N1] + ds [(1 - delta) T0 + delta T1],

[ ] the change over the step and U = N^2/(2 p) + T^2/(2 p_s). A contact that keeps its state is part of the
algorithmic loss, one that opens or closes is a switching loss (negative: a gain).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import SLIDES, Corners, Unilateral, slide_forces
from dda.one_block.unilateral_form import UnilateralForm
from dda.one_block.unilateral_step import State, StepLength

Array = NDArray[np.float64]

ENERGIES = ("kinetic", "strain", "springs", "load", "algorithmic", "kinetic damping", "switching")


class Ledger:
    """Keeps the energies [J] after every step, the losses summed from t = 0 on."""

    def __init__(self, form: UnilateralForm, law: Unilateral, dt: float) -> None:
        self.form, self.law, self.dt = form, law, dt
        self.inverse = np.linalg.inv(form.M)
        self.losses = np.zeros(3)
        self.slides = form.B[form.contacts :]

    def row(self, state: State) -> tuple[float, ...]:
        """Return the entries of `ENERGIES` for the present state."""
        x = np.array(state.D)
        strain = float(self.form.K @ (x * x)) / 2
        load = -float(self.form.F @ (x - self.form.start))
        return (self._kinetic(state), strain, self._springs(state.corners), load, *self.losses.tolist())

    def add(self, length: StepLength, before: State, after: State) -> None:
        """Add the losses of an accepted step."""
        kept, switched = self._contacts(length, before, after)
        damped = (1 - length.scheme.gg**2) * self._kinetic(before)
        self.losses += (self._bulk(length, before, after) + kept, damped, switched)

    def _kinetic(self, state: State) -> float:
        momentum = np.array(state.P) / self.dt
        return float(momentum @ self.inverse @ momentum) / 2

    def _spring(self, corners: Corners, i: int) -> float:
        shear = corners.shear[i] ** 2 / self.law.shear if self.law.shear else 0.0
        return self.form.multiplicity * (corners.normal[i] ** 2 * self.law.compliance + shear) / 2

    def _springs(self, corners: Corners) -> float:
        return sum(self._spring(corners, i) for i in range(self.form.contacts))

    def _bulk(self, length: StepLength, before: State, after: State) -> float:
        """Return the loss of the block itself, with what the first step's A0 adds where M A0 was not F - K0 D0."""
        form, scheme = self.form, length.scheme
        c, over = scheme.alpha - scheme.delta / 2, scheme.delta - 0.5
        x0, x1 = np.array(before.D), np.array(after.D)
        R0, R1 = np.array(before.f) / self.dt**2, np.array(after.f) / self.dt**2
        loss = over * float(form.K @ (x1 - x0) ** 2)
        missing = form.F - form.K * x0 - R0
        if not length.implicit:
            missing = missing + self._forces(before.corners)
        loss += (1 - scheme.delta) * float((x1 - x0) @ missing)
        if c:
            h2, change = scheme.step**2, R1 - R0
            stored = float(R1 @ self.inverse @ R1 - R0 @ self.inverse @ R0) / 2
            loss += c * h2 * (stored + over * float(change @ self.inverse @ change))
        return loss

    def _forces(self, corners: Corners) -> Array:
        """Return multiplicity B' lambda."""
        forces = np.array([*corners.normal, *slide_forces(corners.shear)][: len(self.form.B)])
        return self.form.multiplicity * (forces @ self.form.B)

    def _contacts(self, length: StepLength, before: State, after: State) -> tuple[float, float]:
        """Return the losses of the contacts that keep their state and of those that change it."""
        old, new = before.corners, after.corners
        slid = self._slid(before, after)
        late = 1.0 if length.implicit else length.scheme.delta
        losses = [0.0, 0.0]
        for i, was in enumerate(old.closed):
            N = (1 - late) * old.normal[i] + late * new.normal[i]
            T = (1 - late) * old.shear[i] + late * new.shear[i]
            work = N * (new.gap[i] - old.gap[i]) + T * float(slid[i])
            stored = self._spring(new, i) - self._spring(old, i)
            losses[was != new.closed[i]] -= stored + self.form.multiplicity * work
        return losses[0], losses[1]

    def _slid(self, before: State, after: State) -> Array:
        """Return the displacement of the contacts along the base [m]."""
        if not len(self.slides):
            return np.zeros(self.form.contacts)
        slid: Array = np.array(SLIDES[self.form.contacts]) @ (self.slides @ (np.array(after.D) - np.array(before.D)))
        return slid
