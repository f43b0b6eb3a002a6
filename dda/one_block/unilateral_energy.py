r"""Energy of one block over no-tension corners, and what takes it away.

For any Newmark scheme whose accelerations obey M A = F - K0 D + B' lambda at both ends of a step, with
c = alpha - delta/2 and V the velocity after gg,

    E1 - E0 = - (delta - 1/2) dD' K0 dD - c h^2 [ A' M A / 2 ] - (delta - 1/2) c h^2 dA' M dA
              + sum over contacts of U1 - U0 + dw [(1 - delta) N0 + delta N1] + ds [(1 - delta) T0 + delta T1],

[ ] the change over the step and U = N^2/(2 p) + T^2/(2 p_s). A contact that keeps its state is part of the
algorithmic loss, one that opens or closes is a switching loss (negative: a gain). Energy-conserving contact does
the work U0 - U1 itself and loses nothing. Of what a corner loses that slips, friction takes -T1 (r1 - r0), never
negative. Where the base moves by y the loads work on x = D + R y, and its own work -lambda' B R y is counted as theirs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import SLIDES, Unilateral
from dda.model.load import BaseMotion
from dda.one_block.unilateral_form import UnilateralForm
from dda.one_block.unilateral_history import History
from dda.one_block.unilateral_step import CONSERVING, NEWMARK, State, StepLength
from dda.scheme.newmark import Scheme

Array = NDArray[np.float64]

ENERGIES = ("kinetic", "strain", "springs", "load", "algorithmic", "kinetic damping", "switching", "friction")


class Instants(NamedTuple):
    """States, one a row."""

    D: Array  # (k, n) unknowns
    V: Array  # (k, n) momentum M V, its time in seconds
    R: Array  # (k, n) inertia force M A [N]
    normal: Array  # (k, c) [N]
    shear: Array  # (k, c) [N]
    gap: Array  # (k, c) [m]
    closed: NDArray[np.bool_]  # (k, c)
    slipped: Array  # (k, c) change of the shear reference in the step [m]

    def after(self, start: Instants) -> Instants:
        """Return the states with which the steps to these begin."""
        return Instants(*(np.concatenate([first, made[:-1]]) for first, made in zip(start, self, strict=True)))


CutStep = list[tuple[StepLength, State, State]]  # the parts of a step that was cut


def energies(ledger: Ledger, history: History, start: State, cut_steps: dict[int, CutStep]) -> dict[str, Array]:
    """Return the energies [J] after every step, the losses summed from t = 0 on.

    Parameters
    ----------
    cut_steps
        Parts of the steps that were cut, by the number of steps before.
    """
    dt = ledger.scheme.step
    made = _made(ledger, history)
    before = made.after(instants([start], dt))
    base = ledger.base(np.arange(history.steps + 1.0))
    losses = ledger.losses(ledger.scheme, before, made, np.diff(base, axis=0))
    for number, parts in cut_steps.items():
        pieces, begun = [], float(number)
        for at, x, y in parts:
            way = np.diff(ledger.base(np.array([begun, begun + at.ratio])), axis=0)
            pieces.append(ledger.losses(at.scheme, instants([x], dt), instants([y], dt), way))
            begun += at.ratio
        losses[number : number + 1] = np.sum(pieces, axis=0)  # nothing, if the step was not reached
    lost = np.cumsum(losses, axis=0)
    kept = np.column_stack([ledger.present(made), lost[:, :-1]])
    kept[:, ENERGIES.index("load")] -= base[1:] @ (ledger.form.translation.T @ ledger.form.F) + lost[:, -1]
    return dict(zip(ENERGIES, kept.T, strict=True))


def instants(states: list[State], dt: float) -> Instants:
    """Return states as arrays; `dt` is the scheme's step, in whose units they are [s]."""
    D, P, f = (np.array([state[part] for state in states]) for part in range(3))
    corners = [state.corners for state in states]
    N, T, w = (np.array([getattr(c, name) for c in corners]) for name in ("normal", "shear", "gap"))
    slipped = np.array([c.slipped or (0.0,) * len(c.gap) for c in corners])
    return Instants(D, P / dt, f / dt**2, N, T, w, np.array([c.closed for c in corners]), slipped)


def _made(ledger: Ledger, history: History) -> Instants:
    """Return the states of a history."""
    place = history.layout
    v = history.observe(np.eye(place.size)[: place.contact(0).start]).T
    D, V = v[:, place.D], v[:, place.P] / ledger.scheme.step
    N, T, w = (values.T for values in history.contacts(ledger.law.compliance))
    R = ledger.form.F - ledger.form.K * D
    if ledger.rule == NEWMARK:
        R = R + ledger.forces(N, T)
    closed = np.column_stack([history.closed(i) for i in range(place.contacts)])
    return Instants(D, V, R, N, T, w, closed, history.slipped().T)


class Ledger:
    """What a step of one block keeps and loses."""

    def __init__(
        self, form: UnilateralForm, law: Unilateral, scheme: Scheme, rule: str, motion: BaseMotion | None
    ) -> None:
        self.form, self.law, self.scheme, self.rule, self.motion = form, law, scheme, rule, motion
        self.inverse = np.linalg.inv(form.M)
        self.slides = form.B[form.contacts :]

    def base(self, steps: Array) -> Array:
        """Return the displacement of the base after so many steps, (len(steps), 2) [m]."""
        return np.zeros((len(steps), 2)) if self.motion is None else self.motion.at(steps * self.scheme.step)

    def present(self, at: Instants) -> Array:
        """Return kinetic, strain, spring and load energy, (k, 4)."""
        strain = (at.D * at.D) @ self.form.K / 2
        load = -(at.D - self.form.start) @ self.form.F
        return np.column_stack([self._kinetic(at.V), strain, self._springs(at).sum(axis=1), load])

    def losses(self, scheme: Scheme, before: Instants, after: Instants, way: Array) -> Array:
        """Return what steps of one length lose by the algorithm, gg, switching, friction and give the base, (k, 5)."""
        rubbed = -self.form.multiplicity * np.sum(after.shear * after.slipped, axis=1)
        kept, switched = self._contacts(scheme, before, after)
        damped = (1 - scheme.gg**2) * self._kinetic(before.V)
        carried = way @ self.form.translation.T
        bulk = self._bulk(scheme, before, after, carried)
        # what the springs take from the block on the way of the base comes from the base
        late = scheme.delta if self.rule == NEWMARK else 1.0
        held = [self.forces(at.normal, at.shear) for at in (before, after)]
        given = np.sum(((1 - late) * held[0] + late * held[1]) * carried, axis=1)
        return np.column_stack([bulk + kept, damped, switched, rubbed, given])

    def _kinetic(self, momentum: Array) -> Array:
        kinetic: Array = np.einsum("ki,ij,kj->k", momentum, self.inverse, momentum) / 2
        return kinetic

    def _springs(self, at: Instants) -> Array:
        """Return the energy of the springs of every contact, (k, c)."""
        shear = at.shear**2 / self.law.shear if self.law.shear else 0.0
        energy: Array = self.form.multiplicity * (at.normal**2 * self.law.compliance + shear) / 2
        return energy

    def _bulk(self, scheme: Scheme, before: Instants, after: Instants, carried: Array) -> Array:
        """Return the loss of the block itself, with what the first step's A0 adds where M A0 was not F - K0 D0."""
        form, moved = self.form, after.D - before.D
        c, over = scheme.alpha - scheme.delta / 2, scheme.delta - 0.5
        loss = over * (moved**2 @ form.K)
        missing = form.F - form.K * before.D - before.R
        if self.rule == NEWMARK:
            missing = missing + self.forces(before.normal, before.shear)
        loss += (1 - scheme.delta) * np.sum((moved + carried) * missing, axis=1)
        if c:
            h2 = scheme.step**2
            stored = self._kinetic(after.R) - self._kinetic(before.R)
            loss += c * h2 * (stored + 2 * over * self._kinetic(after.R - before.R))
        return loss

    def forces(self, normal: Array, shear: Array) -> Array:
        """Return multiplicity B' lambda, (k, n)."""
        B, c = self.form.B, self.form.contacts
        held = normal @ B[:c]
        if len(self.slides):
            both = shear if c == 1 else np.column_stack([shear.sum(axis=1), (shear[:, 1] - shear[:, 0]) / 2])
            held = held + both @ self.slides
        loaded: Array = self.form.multiplicity * held
        return loaded

    def _contacts(self, scheme: Scheme, before: Instants, after: Instants) -> tuple[Array, Array]:
        """Return the losses of the contacts that keep their state and of those that change it."""
        if self.rule == CONSERVING:
            return np.zeros(len(after.D)), np.zeros(len(after.D))
        late = scheme.delta if self.rule == NEWMARK else 1.0
        N = (1 - late) * before.normal + late * after.normal
        T = (1 - late) * before.shear + late * after.shear
        work = N * (after.gap - before.gap) + T * self._slid(after.D - before.D)
        work = work - after.shear * after.slipped
        lost = self._springs(before) - self._springs(after) - self.form.multiplicity * work
        same = before.closed == after.closed
        return np.sum(lost * same, axis=1), np.sum(lost * ~same, axis=1)

    def _slid(self, moved: Array) -> Array:
        """Return the displacement of the contacts along the base, (k, c) [m]."""
        if not len(self.slides):
            return np.zeros((len(moved), self.form.contacts))
        slid: Array = moved @ self.slides.T @ np.array(SLIDES[self.form.contacts]).T
        return slid
