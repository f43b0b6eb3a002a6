"""Coulomb friction at any number of contact points: the law of `dda.contact.friction`, point by point.

All states are updated at once, stick and slip too. Where that does not end, the first point that disagrees is set
alone, again and again, until a set of states comes back; of up to `TRIED` points all 4^n states are tried then. What
is left has no answer, and the step is to be cut.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from dda.contact.friction import ALL, ROUNDING
from dda.contact.iteration import NONE, SEVERAL
from dda.contact.points import ClosedPoints, Found, FreePoints, Points, open_close_points
from dda.contact.unilateral import OPEN, SLIP, STICK, Unilateral, slipped_share

Array = NDArray[np.float64]
States = NDArray[np.int_]
TRIED = 4  # points up to which all states are tried


def find_points(law: Unilateral, before: Points, free: FreePoints, limit: int) -> Found:
    """Find the states of all points at the end of a step, with `limit` solves before they are set one at a time."""
    if law.friction is None:
        return open_close_points(law, before, free, limit)
    state, solves = states(before), 0
    for solves in range(1, limit + 1):
        after = trial(law, before, free, state)
        agreed = agreeing(law, after)
        if np.array_equal(agreed, state):
            return Found(after, solves)
        state = agreed
    return _one_by_one(law, before, free, state, solves)


def _one_by_one(law: Unilateral, before: Points, free: FreePoints, state: States, solves: int) -> Found:
    """Set the first point that disagrees until all agree, or states come back."""
    seen: set[bytes] = set()
    while state.tobytes() not in seen:
        seen.add(state.tobytes())
        solves += 1
        after = trial(law, before, free, state)
        agreed = agreeing(law, after)
        wrong = np.flatnonzero(agreed != state)
        if not len(wrong):
            return Found(after, solves)
        state = state.copy()
        state[wrong[0]] = agreed[wrong[0]]
    return _all_states(law, before, free, solves) if len(state) <= TRIED else Found(None, solves, NONE)


def _all_states(law: Unilateral, before: Points, free: FreePoints, solves: int) -> Found:
    """Return the only state of a few points that agrees with its own forces."""
    tried = [trial(law, before, free, np.array(choice)) for choice in product(ALL, repeat=len(before.gap))]
    found = [after for after in tried if np.array_equal(agreeing(law, after), states(after))]
    solves += len(tried)
    return Found(found[0], solves) if len(found) == 1 else Found(None, solves, SEVERAL if found else NONE)


def states(points: Points) -> States:
    """Return the states of points; those that carry none stick where they are closed."""
    return np.where(points.closed, STICK, OPEN) if points.state is None else points.state


def agreeing(law: Unilateral, tried: Points) -> States:
    """Return the states that the law makes of tried points; with NaN other ones than were tried."""
    state, slipped = states(tried), np.zeros(len(tried.gap)) if tried.slipped is None else tried.slipped
    limit = (law.friction or 0.0) * np.maximum(tried.normal, 0.0) + law.cohesion
    holds = np.abs(tried.shear) <= limit * (1 + ROUNDING)
    stuck = np.where(holds, STICK, np.where(tried.shear > 0, -SLIP, SLIP))
    slips = np.where(state * slipped >= 0, state, STICK)
    shut = np.where(state == STICK, stuck, slips)
    found: States = np.where(
        state == OPEN,
        np.where(tried.gap < -law.band[0], STICK, OPEN),
        np.where(tried.normal >= -law.pull, shut, OPEN),
    )
    return found


def trial(law: Unilateral, before: Points, free: FreePoints, state: States) -> Points:
    """Return the points at the end of the step in these states; with NaN where no crossing is found."""
    n, shut = len(state), np.flatnonzero(state != OPEN)
    normal, shear, slipped = np.zeros(n), np.zeros(n), np.zeros(n)
    if len(shut):
        normal[shut], shear[shut] = _Rubbing(law, before, free, shut, state).forces()
    slips = np.flatnonzero(np.abs(state) == SLIP)
    shear[slips] = -state[slips] / SLIP * ((law.friction or 0.0) * normal[slips] + law.cohesion)
    forces = np.concatenate([normal, shear])
    stretch = 0.0 - shear / law.shear
    gap = np.where(state == OPEN, free.gap + free.C[:n] @ forces, 0.0 - normal * law.compliance)
    for i in slips.tolist():
        moved = free.slide[i] + free.C[n + i] @ forces
        past = 1.0 if before.closed[i] else slipped_share(law, float(before.gap[i]), float(normal[i]))[0]
        slipped[i] = before.stretch[i] + past * moved - stretch[i]
    return Points(state != OPEN, gap, stretch, normal, shear, state, slipped)


class _Rubbing(ClosedPoints):
    """The equations of closed points some of which slip."""

    def __init__(
        self, law: Unilateral, before: Points, free: FreePoints, shut: NDArray[np.intp], state: States
    ) -> None:
        super().__init__(law, before, free, shut)
        own = state[shut]
        self.held = (own == STICK).astype(float)
        self.closing = np.flatnonzero(~before.closed[shut] & (own == STICK))
        self.along = np.where(np.abs(own) == SLIP, -own / SLIP, 0.0)  # T of a slipping point over its size

    def drag(self, A: Array, b: Array, rows: NDArray[np.intp]) -> None:
        """Add T of the slipping points, which follows their N."""
        pulled = self.free.C[np.ix_(rows, len(self.before.gap) + self.shut)] * self.along
        A[:, : len(self.shut)] += (self.law.friction or 0.0) * pulled
        b -= self.law.cohesion * pulled.sum(axis=1)
