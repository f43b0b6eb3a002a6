r"""The open-close iteration for any number of contact points, in the force form of `dda.contact.iteration`.

All points obey one law. Frictionless contact is the linear complementarity problem w = w_f + C N, N = max(0, -p w)
with C symmetric and positive definite. Setting all states at once may cycle from three points on (Ben Gharbia and
Gilbert 2010); after that the states are set one at a time, the first that disagrees (Murty 1974), which ends at the
one solution. Glued contact is no such problem: of a few points all states are tried, of more none is found and the
step is to be cut.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from dda.contact.glued import CROSSING_CHANGE, CROSSING_STEPS
from dda.contact.iteration import NONE, SEVERAL
from dda.contact.unilateral import Unilateral, slipped_share

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
TRIED = 8  # points up to which all states are tried


@dataclass(frozen=True, eq=False)
class Points:
    """State of n contact points."""

    closed: Flags  # (n,)
    gap: Array  # w [m]
    stretch: Array  # s - r of the closed ones [m], 0 where open
    normal: Array  # N on the block, away from the base [N]
    shear: Array  # T on the block, along the base [N]
    state: NDArray[np.int_] | None = None  # with friction: OPEN, STICK, or SLIP in its direction
    slipped: Array | None = None  # with friction: change of r by slip in the step [m]

    @classmethod
    def at_rest(cls, law: Unilateral, count: int) -> Points:
        """Return the points at t = 0: without force, closed where they touch."""
        nothing = np.zeros(count)
        return cls(np.full(count, law.gap == 0), np.full(count, law.gap), nothing, nothing, nothing)


@dataclass(frozen=True, eq=False)
class FreePoints:
    """What a step without contact forces does to the points, and what forces change of it."""

    gap: Array  # w_f [m]
    slide: Array  # displacement along the base in the step [m]; empty if frictionless
    C: Array  # flexibility in (w, slides), (2n, 2n), or in w [m/N]


@dataclass(frozen=True, eq=False)
class Found:
    """Points at the end of a step and the solves they took, or why there are none."""

    points: Points | None
    solves: int
    failure: str | None = None


def open_close_points(law: Unilateral, before: Points, free: FreePoints, limit: int) -> Found:
    """Find the states of all points at the end of a step, with `limit` solves before they are set one at a time."""
    closed = before.closed
    for solve in range(1, limit + 1):
        after = trial(law, before, free, closed)
        agreed = agreeing(law, after)
        if np.array_equal(agreed, closed):
            return Found(after, solve)
        closed = agreed
    return _all_states(law, before, free, limit) if len(free.slide) else _one_by_one(law, before, free, closed, limit)


def agreeing(law: Unilateral, tried: Points) -> Flags:
    """Return the states that the law makes of tried points; those of NaN are the opposite of what was tried."""
    states: Flags = np.where(tried.closed, tried.normal >= -law.pull, tried.gap < -law.band[0])
    return states


def _one_by_one(law: Unilateral, before: Points, free: FreePoints, closed: Flags, solves: int) -> Found:
    """Change the first state that disagrees until all agree; among 2^n states there is an end."""
    for _ in range(2 ** min(len(closed), 16)):
        solves += 1
        after = trial(law, before, free, closed)
        wrong = np.flatnonzero(agreeing(law, after) != closed)
        if not len(wrong):
            return Found(after, solves)
        closed = closed.copy()
        closed[wrong[0]] = not closed[wrong[0]]
    return Found(None, solves, NONE)


def _all_states(law: Unilateral, before: Points, free: FreePoints, solves: int) -> Found:
    """Return the only state of a few points that agrees with its own forces."""
    if len(before.closed) > TRIED:
        return Found(None, solves, NONE)
    found = []
    for choice in product((False, True), repeat=len(before.closed)):
        solves += 1
        after = trial(law, before, free, np.array(choice))
        if np.array_equal(agreeing(law, after), after.closed):
            found.append(after)
    if len(found) == 1:
        return Found(found[0], solves)
    return Found(None, solves, SEVERAL if found else NONE)


def trial(law: Unilateral, before: Points, free: FreePoints, closed: Flags) -> Points:
    """Return the points at the end of the step if these are closed; with NaN where no crossing is found."""
    n, shut = len(closed), np.flatnonzero(closed)
    normal, shear, stretch = np.zeros(n), np.zeros(n), np.zeros(n)
    forces = np.zeros(len(free.C))
    if len(shut):
        normal[shut], shear[shut] = ClosedPoints(law, before, free, shut).forces()
    forces[:n] = normal
    if len(free.slide):
        forces[n:] = shear
        stretch = 0.0 - shear / law.shear
    gap = np.where(closed, 0.0 - normal * law.compliance, free.gap + free.C[:n] @ forces)
    return Points(closed, gap, stretch, normal, shear)


class ClosedPoints:
    """The equations of the closed points, `shut`; a point that closes in the step has a softer spring in shear."""

    def __init__(self, law: Unilateral, before: Points, free: FreePoints, shut: NDArray[np.intp]) -> None:
        self.law, self.before, self.free, self.shut = law, before, free, shut
        self.closing = np.flatnonzero(~before.closed[shut])
        self.held = np.ones(len(shut))  # zero where a point slips

    def drag(self, A: Array, b: Array, rows: NDArray[np.intp]) -> None:
        """Add to the equations what T does that follows N; nothing where all closed points are held."""

    def forces(self) -> tuple[Array, Array]:
        """Return N and T."""
        beta = self.held.copy()
        normal, shear, slope = self._solve(beta)
        if not len(self.free.slide) or not len(self.closing):
            return normal, shear
        at = self.closing
        for _ in range(CROSSING_STEPS):
            gaps = self.before.gap[self.shut[at]].tolist()
            found = [slipped_share(self.law, w, N) for w, N in zip(gaps, normal[at].tolist(), strict=True)]
            shares, rates = np.array(found).T
            change = np.linalg.solve(np.eye(len(at)) - rates[:, None] * slope[np.ix_(at, at)], shares - beta[at])
            beta[at] = np.clip(beta[at] + change, 0.0, 1.0)
            normal, shear, slope = self._solve(beta)
            if np.all(np.abs(change) <= CROSSING_CHANGE * beta[at]):
                return normal, shear
        return np.full(len(beta), np.nan), np.full(len(beta), np.nan)

    def _solve(self, beta: Array) -> tuple[Array, Array, Array]:
        """Return N, T and, where a point closes, dN/dbeta; the matrix is scaled: a stiff direction keeps its digits."""
        m, n, law = len(self.shut), len(self.before.closed), self.law
        active = np.flatnonzero(beta > 0) if len(self.free.slide) else np.zeros(0, dtype=int)
        rows = np.concatenate([self.shut, n + self.shut[active]])
        A = self.free.C[np.ix_(rows, rows)]
        soft = np.full(len(rows), law.compliance)
        b = -np.concatenate([self.free.gap[self.shut], np.zeros(len(active))])
        if len(active):
            soft[m:] = 1 / (law.shear * beta[active])
            held = self.shut[active]
            b[m:] = -(self.before.stretch[held] + self.free.slide[held])
        A[range(len(rows)), range(len(rows))] += soft
        scale = 1 / np.sqrt(np.diag(A))
        self.drag(A, b, rows)
        scaled = A * scale * scale[:, None]
        found = np.linalg.solve(scaled, b * scale) * scale
        shear, slope = np.zeros(m), np.zeros((m, m))
        if len(active):
            shear[active] = found[m:]
        if len(active) and len(self.closing):
            push = np.zeros((len(rows), len(active)))
            push[range(m, len(rows)), range(len(active))] = found[m:] / (law.shear * beta[active] ** 2)
            slope[:, active] = (np.linalg.solve(scaled, push * scale[:, None]) * scale[:, None])[:m]
        return found[:m], shear, slope
