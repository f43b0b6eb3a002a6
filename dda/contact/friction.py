r"""Coulomb friction: the open-close iteration with stick and slip among its states.

A slipping contact carries T = -sigma (tan(phi) N + c), so that its T is no unknown: it follows N. The equations of
`dda.contact.iteration` hold for the normal forces of all closed contacts and for T of those that stick,

    closed   (C lambda)_w + N/p = -w_f
    stick    (C lambda)_d + T/(beta p_s) = -(s_n - r + d_f),    beta = 1 - theta where it closes in the step, else 1,

with T of the slipping ones put into lambda; the matrix is then no longer symmetric. All states are updated at once,
stick and slip too, until none changes. Where that does not end, all of them are tried, 4^2 for two corners. There may
be no consistent state, or several: unlike frictionless contact this is no linear complementarity problem.

Nothing here knows the block: C and the free step may come from any geometry.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from dda.contact.glued import ClosedContacts, Free
from dda.contact.iteration import NONE, SEVERAL, Iteration
from dda.contact.unilateral import OPEN, SLIDES, SLIP, STICK, Corners, Unilateral, slide_forces, slipped_share

Array = NDArray[np.float64]
State = tuple[int, ...]

ROUNDING = 1e-12  # of the limit, by which |T| of a sticking contact may exceed it
ALL = (OPEN, STICK, SLIP, -SLIP)


def rubbing(law: Unilateral, before: Corners, free: Free, limit: int) -> Iteration:
    """Find the states of all contacts at the end of a step, with `limit` solves before all states are tried."""
    state = states(before)
    for solve in range(1, limit + 1):
        after = trial(law, before, free, state)
        agreed = states_after(law, after)
        if agreed == state:
            return Iteration(after, solve)
        state = agreed
    tried = [trial(law, before, free, choice) for choice in product(ALL, repeat=len(before.closed))]
    found = [after for after in tried if states_after(law, after) == after.state]
    solves = limit + len(tried)
    if not found:
        return Iteration(None, solves, NONE)
    alike = all(_same(found[0], other) for other in found[1:])
    return Iteration(found[0], solves) if alike else Iteration(None, solves, SEVERAL)


def _same(one: Corners, other: Corners) -> bool:
    """Whether two answers differ by rounding only, as at the very limit of stick and slip."""
    first, second = (np.array([*c.normal, *c.shear]) for c in (one, other))
    return bool(np.max(np.abs(first - second)) <= ROUNDING * np.max(np.abs(first)))


def states(corners: Corners) -> State:
    """Return the states of contacts; those that carry none stick where they are closed."""
    return corners.state or tuple(STICK if shut else OPEN for shut in corners.closed)


def states_after(law: Unilateral, tried: Corners) -> State:
    """Return the states that the law makes of tried contacts; with NaN other ones than were tried."""
    every = zip(tried.state, tried.gap, tried.normal, tried.shear, tried.slipped, strict=True)
    return tuple(_agreeing(law, *corner) for corner in every)


def _agreeing(law: Unilateral, state: int, gap: float, N: float, T: float, slipped: float) -> int:
    if state == OPEN:
        return STICK if law.closes(gap) else OPEN
    if not law.stays_closed(N):
        return OPEN
    if state == STICK:
        if abs(T) <= law.limit(N) * (1 + ROUNDING):
            return STICK
        return -SLIP if T > 0 else SLIP
    return state if state * slipped >= 0 else STICK


def trial(law: Unilateral, before: Corners, free: Free, state: State) -> Corners:
    """Return the contacts at the end of the step in these states, whether their forces agree or not."""
    follows = law.friction or 0.0
    return pressed(law, before, free, state, follows, (law.cohesion,) * len(state))


def pressed(
    law: Unilateral, before: Corners, free: Free, state: State, follows: float, held: tuple[float, ...]
) -> Corners:
    """Return the contacts whose slipping ones carry T = -sigma (follows N + held)."""
    n = len(state)
    normal, shear = _forces(law, before, free, state, follows, held)
    both = [*normal, *slide_forces(shear)]
    soft, softness = law.compliance, 1 / law.shear
    gap, stretch = list(free.gap), tuple(0.0 - T * softness for T in shear)
    slipped = [0.0] * n
    for i, (now, N) in enumerate(zip(state, normal, strict=True)):
        if now == OPEN:
            gap[i] += sum(c * force for c, force in zip(free.C[i], both, strict=True))
        else:
            gap[i] = 0.0 - N * soft
        if abs(now) == SLIP:
            slipped[i] = _moved(law, before, free, i, both, N) - stretch[i]
    closed = tuple(now != OPEN for now in state)
    return Corners(closed, tuple(gap), stretch, before.reference, tuple(normal), tuple(shear), state, tuple(slipped))


def _moved(law: Unilateral, before: Corners, free: Free, i: int, forces: list[float], N: float) -> float:
    """Return s - r of a contact with the old reference, or that of its crossing [m]."""
    n, moved = len(before.closed), 0.0
    for part, own, row in zip(SLIDES[n][i], free.slide, free.C[n:], strict=True):
        moved += part * (own + sum(c * force for c, force in zip(row, forces, strict=True)))
    if before.closed[i]:
        return before.stretch[i] + moved
    return slipped_share(law, before.gap[i], N)[0] * moved


def _forces(
    law: Unilateral, before: Corners, free: Free, state: State, follows: float, held: tuple[float, ...]
) -> tuple[list[float], list[float]]:
    """Return N and T of all contacts, zero of the open ones."""
    n = len(state)
    shut = [i for i, now in enumerate(state) if now != OPEN]
    if not shut:
        return [0.0] * n, [0.0] * n
    closing = [k for k, i in enumerate(shut) if state[i] == STICK and not before.closed[i]]
    if not closing:
        if state not in free.gains:
            free.gains[state] = _Sliding(law, before, free, state, follows, held).gain()
        given = [*free.gap, *free.slide, *before.stretch, *held]
        found = [sum(g * v for g, v in zip(row, given, strict=True)) for row in free.gains[state]]
        return found[:n], found[n:]
    system = _Sliding(law, before, free, state, follows, held)
    beta = np.array([1.0 if state[i] == STICK else 0.0 for i in shut])
    some, holding = system.crossed(beta, closing)
    normal, shear = [0.0] * n, [0.0] * n
    for i, N, T in zip(shut, some, holding, strict=True):
        normal[i] = N
        shear[i] = T if state[i] == STICK else -state[i] / SLIP * (follows * N + held[i])
    return normal, shear


class _Sliding(ClosedContacts):
    """The equations of closed contacts some of which slip."""

    def __init__(
        self, law: Unilateral, before: Corners, free: Free, state: State, follows: float, held: tuple[float, ...]
    ) -> None:
        super().__init__(law, before, free, [i for i, now in enumerate(state) if now != OPEN])
        n, size = len(state), len(free.C)
        self.state, self.C = state, np.array(free.C)
        self.lines = np.zeros((size, n))  # T of a slipping contact in the coordinates of C, over its size
        for i, now in enumerate(state):
            if abs(now) == SLIP:
                self.lines[n:, i] = -now / SLIP * np.array(SLIDES[n][i])
        self.follows = follows
        self.loose = self.loose + self.C @ self.lines @ np.array(held)

    def drag(self, A: Array, rows: Array) -> None:
        """Add T of the slipping contacts, which follows their N."""
        m = len(self.shut)
        A[:, :m] += self.follows * (rows @ self.C @ self.lines[:, self.shut])

    def gain(self) -> list[list[float]]:
        """Return N and T of all contacts by (w_f, d_f, s_n - r, c), where none closes."""
        n, m, size = len(self.state), len(self.shut), len(self.C)
        beta = np.array([1.0 if self.state[i] == STICK else 0.0 for i in self.shut])
        active = [k for k, share in enumerate(beta) if share]
        scaled, scale, rows, W = self.matrix(beta, active)
        given = np.zeros((len(rows), size + 2 * n))
        given[:, :size], given[:, size + n :] = rows, rows @ self.C @ self.lines
        for k, line in zip(active, W, strict=True):
            given[m:, size + self.shut[k]] = line
        forces = -(np.linalg.inv(scaled) * scale * scale[:, None]) @ given
        found = np.zeros((2 * n, size + 2 * n))
        found[self.shut] = forces[:m]
        found[[n + self.shut[k] for k in active]] = W @ forces[m:]
        for i in self.shut:
            if abs(self.state[i]) == SLIP:
                found[n + i] = self.follows * found[i]
                found[n + i, size + n + i] += 1.0
                found[n + i] *= -self.state[i] / SLIP
        gain: list[list[float]] = found.tolist()
        return gain
