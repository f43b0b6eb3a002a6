r"""One time step of a block that turns.

With M and K of `dda.rotation.body`, weight F, dead loads f and contact forces lambda = (N, T) a step of length h is

    D    = h gg V + h^2 [(1/2 - alpha) A + alpha A1]
    M A1 = F - K (e + de) + B_f' (f, lambda)
    V1   = gg V + h [(1 - delta) A + delta A1]

with the law of the contacts at its end, for the exact gaps and slides there: the step is solved again with the turn
that it found until nothing changes, each time with the flexibility C = alpha h^2 B_f S^-1 B_f', S = M + alpha h^2 K.

The forces act in the directions B_f = (2 delta - 1) B + (2 - 2 delta) B_1, B the chord and B_1 the derivative at the
end of the step. Their impulse then has the direction of the middle of the step for every delta: average acceleration
stays of second order, and at delta = 1 a force does the work lambda times the exact change of its gap, so that, as in
small motion, no energy is gained by contact however far the block turns. First-order rotation is linear in a step:
its chord is the derivative at both ends.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.glued import Free
from dda.contact.iteration import NONE, Iteration
from dda.contact.rules import find_states
from dda.contact.unilateral import OPEN, STICK, Corners, Unilateral
from dda.rotation.body import EXACT, Body, Turn, directions, positions, quarter, turn
from dda.scheme.newmark import Scheme

Array = NDArray[np.float64]
Places = list[int]
ROUNDS = 40  # of the turn; two to four are usual
SETTLED = 1e-12  # last change of a place over the size of the block; the next would be this times the step's turn
LENGTHS = 64  # step lengths whose matrices are kept
REACH = 0.02  # gap below which a corner may come to touch in a step, over the size of the block
MEAN = np.array(
    [[0.5, 0.5], [-1.0, 1.0]]
)  # coordinates of dda.contact.unilateral.SLIDES from the slides of two corners


class Touch(NamedTuple):
    """Contact of all n corners."""

    gap: Array  # w [m]
    normal: Array  # N on the block, away from the base [N]
    shear: Array  # T on the block, along the base [N]
    stretch: Array  # s - r of the closed ones [m], 0 where open
    slipped: Array  # change of r by slip in the step [m]
    state: NDArray[np.int_]  # OPEN, STICK (closed without friction, too), SLIP, -SLIP

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Which corners are closed."""
        return np.asarray(self.state != OPEN)

    @classmethod
    def apart(cls, gap: Array) -> Touch:
        """Return corners without force, closed where they touch."""
        nothing = np.zeros(len(gap))
        return cls(gap, nothing, nothing, nothing, nothing, np.where(gap <= 0, STICK, OPEN))

    def corners(self, at: Places, rubbing: bool) -> Corners:
        """Return some corners as the laws of contact take them; without friction these have no states."""
        of = [tuple(values[at].tolist()) for values in self]
        nothing = (0.0,) * len(at)
        closed = tuple(now != OPEN for now in of[5])
        states = of[5] if rubbing else ()
        return Corners(closed, of[0], of[3], nothing, of[1], of[2], states, nothing if rubbing else ())

    def with_found(self, at: Places, found: Corners) -> Touch:
        """Return these corners with some that were found."""
        n = len(self.gap)
        normal, shear, stretch, slipped = np.zeros((4, n))
        gap, state = self.gap.copy(), np.full(n, OPEN)
        gap[at], normal[at], shear[at], stretch[at] = found.gap, found.normal, found.shear, found.stretch
        slipped[at] = found.slipped or 0.0
        state[at] = found.state or np.where(found.closed, STICK, OPEN)
        return Touch(gap, normal, shear, stretch, slipped, state)


class State(NamedTuple):
    """Where the block is after a step."""

    c: Array  # centroid [m]
    Q: Array  # turn of the outline
    r: float  # sum of the steps' rotations [rad]
    e: Array  # strains in axes that turn with the block
    V: Array  # (6,) velocities of c, r, e
    A: Array  # (6,) accelerations
    touch: Touch


@dataclass(frozen=True, eq=False)
class Part:
    """A step, or a part of one that was cut."""

    state: State  # at its end
    scheme: Scheme  # of its length
    base: Array  # (2,) displacement of the base along and away from it, at the end [m]


@dataclass(frozen=True, eq=False)
class Matrices:
    """What a step needs of an outline and of its own length."""

    M: Array  # (6, 6) inertia
    K: Array  # (3, 3) elastic stiffness
    accelerating: Array  # M^-1
    flexible: Array  # alpha h^2 S^-1
    kept: Array  # S^-1 M

    @classmethod
    def of(cls, M: Array, K: Array, scheme: Scheme) -> Matrices:
        """Factorise S = M + alpha h^2 K."""
        weight = scheme.alpha * scheme.step * scheme.step
        S = M.copy()
        S[3:, 3:] += weight * K
        own, both = np.asarray(np.linalg.inv(M), np.float64), np.asarray(np.linalg.inv(S), np.float64)
        return cls(M, K, own, weight * both, both @ M)


@dataclass(frozen=True, eq=False)
class Setting:
    """What stays the same from step to step."""

    body: Body
    law: Unilateral
    weight: Array  # (2,) acceleration of gravity [m/s^2]
    where: Array  # (m, 2) points of the unstrained outline with dead loads [m]
    dead: Array  # (2, m) their forces [N]
    rotation: str
    limit: int  # solves of the open-close iteration before all states are tried
    known: dict[Scheme, Matrices] = field(default_factory=dict)  # of an outline that does not grow, by step length

    def matrices(self, scheme: Scheme, Q: Array) -> Matrices:
        """Return the matrices of a step."""
        if self.rotation != EXACT:
            return Matrices.of(*self.body.grown(Q), scheme)
        if scheme not in self.known:
            if len(self.known) >= LENGTHS:
                self.known.clear()
            self.known[scheme] = Matrices.of(self.body.M, self.body.K, scheme)
        return self.known[scheme]


class Made(NamedTuple):
    """A step that was made, or why there is none."""

    state: State | None
    solves: int
    failure: str | None = None


def advance(setting: Setting, scheme: Scheme, state: State, base: Array) -> Made:
    """Return the state one step later, or why there is none; `state` stays as it is.

    Of a convex outline two corners at most touch a plane. Which they may be is guessed from the step without contact,
    and the step is made again with those that turn out to be the lowest, until no other one has crossed the plane.

    Parameters
    ----------
    base : (2, 2) array
        Displacement of the base along and away from it, before and after the step [m].
    """
    step = _Step(setting, scheme, state, base)
    tried = []
    at = step.near()
    while True:
        made = step.settled(at)
        if made.state is None or not np.any(made.state.touch.gap[~made.state.touch.closed] < 0):
            return made
        tried.append(at)
        at = sorted(np.argsort(made.state.touch.gap)[:2].tolist())
        if at in tried:
            return Made(None, made.solves, NONE)


def late_share(delta: float) -> float:
    """Return the weight of the directions at the end of a step, beside those of its chord."""
    return 2 - 2 * delta


class _Step:
    """One step, before its contact is known."""

    def __init__(self, setting: Setting, scheme: Scheme, state: State, base: Array) -> None:
        self.setting, self.scheme, self.state, self.base = setting, scheme, state, base
        body, h = setting.body, scheme.step
        self.made = made = setting.matrices(scheme, state.Q)
        self.held = np.zeros(6)
        self.held[:2], self.held[3:] = made.M[0, 0] * setting.weight, -(made.K @ state.e)
        ahead = scheme.gg * h * state.V + h * h * (0.5 - scheme.alpha) * state.A
        self.free = made.flexible @ self.held + made.kept @ ahead
        self.guess = scheme.gg * h * state.V + h * h / 2 * state.A
        self.before = positions(state.c, state.Q, state.e, body.xi) - base[0]

    def near(self) -> Places:
        """Return the corners that may touch in the step, two at most."""
        ahead = self._placed(self._turn(self.free), self.free, self.setting.body.xi)
        lowest = np.minimum(self.before[:, 1], ahead[:, 1])
        two = np.argsort(lowest)[:2]
        return sorted(two[lowest[two] < REACH * self.setting.body.size].tolist())

    def settled(self, at: Places) -> Made:
        """Make the step with these corners, and again with the turn that it found until nothing changes."""
        touch, size = self.state.touch, self.setting.body.size
        found = touch.corners(at, self.setting.law.friction is not None)
        if not at and not len(self.setting.where):
            return Made(self._accepted(self.free, at, found), 0)
        D, force, solves = self.guess, np.array([*found.normal, *found.shear]), 0
        held, flexible = found, self.made.flexible
        for _ in range(ROUNDS):
            turning = self._turn(D)
            new = self.free + flexible @ self._loads(turning, D)
            if at:
                B = self._directions(turning, D, self.setting.body.xi[at])
                P = flexible @ B.T
                iteration = self._contact(held, at, new + P @ force, B @ P, force)
                solves += iteration.solves
                if iteration.corners is None:
                    return Made(None, solves, iteration.failure)
                found = iteration.corners
                force = np.array([*found.normal, *found.shear])
                new = new + P @ force
            change, D = np.abs(new - D), new
            if max(change[0], change[1], size * float(np.max(change[2:]))) <= SETTLED * size:
                return Made(self._accepted(D, at, found), solves)
        return Made(None, solves, NONE)

    def _contact(self, held: Corners, at: Places, D: Array, C: Array, force: Array) -> Iteration:
        """Return the contacts for the flexibility C about the place to which D brings them under `force`."""
        n, law = len(at), self.setting.law
        placed = self._placed(self._turn(D), D, self.setting.body.xi[at])
        back = C @ force
        gaps, slides = placed[:, 1] - back[:n], placed[:, 0] - self.before[at, 0] - back[n:]
        if not law.shear:
            return find_states(law, held, Free(gaps.tolist(), (), C[:n, :n].tolist(), {}), self.setting.limit)
        if n == 2:
            slides, C = MEAN @ slides, C.copy()
            C[2:] = MEAN @ C[2:]
            C[:, 2:] = C[:, 2:] @ MEAN.T
        return find_states(law, held, Free(gaps.tolist(), slides.tolist(), C.tolist(), {}), self.setting.limit)

    def _turn(self, D: Array) -> Turn:
        return turn(self.state.Q, float(D[2]), self.setting.rotation)

    def _placed(self, turning: Turn, D: Array, xi: Array) -> Array:
        """Return points after the step, from the base [m]."""
        after = positions(self.state.c + D[:2], turning.end, self.state.e + D[3:], xi)
        return np.asarray(after - self.base[1])

    def _directions(self, turning: Turn, D: Array, xi: Array) -> Array:
        """Return B_f of points, the rows of y before those of x."""
        e, late = self.state.e, late_share(self.scheme.delta) if self.setting.rotation == EXACT else 0.0
        B = directions(turning.chord, turning.mean, e + D[3:] / 2, xi)
        if late:
            B = (1 - late) * B + late * directions(quarter(turning.end), turning.end, e + D[3:], xi)
        return B

    def _loads(self, turning: Turn, D: Array) -> Array:
        """Return B_f' f."""
        if not len(self.setting.where):
            return np.zeros(6)
        B = self._directions(turning, D, self.setting.where)
        return np.asarray(self.setting.dead.ravel() @ B, dtype=np.float64)

    def _accepted(self, D: Array, at: Places, found: Corners) -> State:
        state, scheme, turning = self.state, self.scheme, self._turn(D)
        push = self.held + self._loads(turning, D)
        push[3:] -= self.made.K @ D[3:]
        if at:
            push += np.array([*found.normal, *found.shear]) @ self._directions(turning, D, self.setting.body.xi[at])
        A = self.made.accelerating @ push
        V: Array = scheme.gg * state.V + scheme.step * ((1 - scheme.delta) * state.A + scheme.delta * A)
        touch = Touch.apart(self._placed(turning, D, self.setting.body.xi)[:, 1]).with_found(at, found)
        return State(state.c + D[:2], turning.end, state.r + float(D[2]), state.e + D[3:], V, A, touch)
