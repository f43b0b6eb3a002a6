"""The small problem of one step: forces N, T of the nodes of the base, states that their laws ask for.

With lambda = (N, T) the gaps and slips at the end of the step are (w, s) = (w_f, s_f) + C lambda. A node is open,
N = T = 0 and w >= 0; or closed, N + k w = 0 and N >= 0, and then it sticks or slides:

    T + k_t phi (s - r) = 0  while  |T| <= tan N + c,     T = -d (tan N + c),  d (s + T / k_t - r) >= 0,

with r the slip at which its shear spring is unstrained, d the way it slides, 1 or -1, and c its share of the cohesion.
For a node that closes in the step r is the slip where its gap, taken as straight in time, is zero:
phi = w1 / (w1 - w0) with r the slip at the start; phi = 1 otherwise. Without friction nothing limits |T|.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

SETS = 256  # sets of states of which all are tried
TURNS = 4  # changes of one node after the other, over the number of nodes
SWEEPS = 200  # corrections of the crossings for given states
SLACK = 1e-12  # of the friction, by which a node that slides may miss it
NONE = "no consistent contact state"
SEVERAL = "several consistent contact states"


class Law(NamedTuple):
    """Springs and friction of the nodes."""

    k: np.ndarray  # normal stiffness [N/m]
    k_t: np.ndarray  # shear stiffness [N/m]
    tan: float  # of the angle of friction, infinite without a limit
    c: np.ndarray  # cohesion [N]


class Start(NamedTuple):
    """The nodes at the start of a step."""

    gap: np.ndarray  # [m]
    reference: np.ndarray  # slip at which the shear spring is unstrained [m]
    slip: np.ndarray  # [m]
    states: np.ndarray  # 0 open, 1 sticks, 2 and -2 slides towards +x and -x
    slid: np.ndarray  # sum of what the reference has moved while pressed [m]


class Forces(NamedTuple):
    """Forces, gaps and slips for given states of the nodes."""

    N: np.ndarray
    T: np.ndarray
    w: np.ndarray
    s: np.ndarray  # beyond the reference at the start
    states: np.ndarray
    settled: bool = True


class Small:
    """The small problem of one step."""

    def __init__(self, law: Law, C: np.ndarray, free: tuple[np.ndarray, np.ndarray], start: Start) -> None:
        self.law = law
        self.C = C
        self.start = start
        self.n = len(law.k)
        self.sheared = len(C) > self.n
        self.rubs = self.sheared and law.tan < np.inf
        self.free = np.concatenate([free[0], free[1] - start.reference])[: len(C)]
        self.stiff = np.concatenate([law.k, law.k_t])[: len(C)]

    def forces(self, states: np.ndarray) -> Forces:
        """Forces of given states, with the crossings that they bring about."""
        closing = (states == 1) & (self.start.states == 0) & self.sheared
        phi = np.where(closing, 0.5, 1.0)
        relax = 1.0
        least = np.inf
        for _ in range(SWEEPS):
            forces = self._linear(states, phi)
            miss = np.where(closing, self._passed(forces.N) - phi, 0.0)
            worst = float(np.abs(miss).max())
            if worst < 1e-13:
                return forces
            relax, least = (relax, worst) if worst < least else (relax / 2, least)
            phi = phi + relax * miss
        return forces._replace(settled=False)

    def _passed(self, N: np.ndarray) -> np.ndarray:
        """Share of the step that a closing node has been closed for."""
        depth = np.maximum(N, 0.0) / self.law.k
        distance = depth + np.maximum(self.start.gap, 0.0)
        return np.asarray(np.divide(depth, distance, out=np.ones(self.n), where=distance > 0))

    def _linear(self, states: np.ndarray, phi: np.ndarray) -> Forces:
        """Solve x + k (free + C lambda) = 0, lambda = P x + q, for the N of closed and the T of sticking nodes."""
        n = self.n
        size = len(self.C)
        P = np.eye(size)
        q = np.zeros(2 * n)
        for i in np.flatnonzero(np.abs(states) == 2):
            d = np.sign(states[i])
            P[n + i, [i, n + i]] = -d * self.law.tan, 0.0
            q[n + i] = -d * self.law.c[i]
        q = q[:size]
        rows = np.flatnonzero(np.concatenate([states != 0, states == 1])[:size])
        stiff = self.stiff.copy()
        stiff[n:] *= phi[: size - n]
        matrix = np.eye(len(rows)) + stiff[rows, None] * (self.C[rows] @ P[:, rows])
        x = np.linalg.solve(matrix, -stiff[rows] * (self.free[rows] + self.C[rows] @ q))
        found = P[:, rows] @ x + q
        moved = self.free + self.C @ found
        N, T, w, s = (np.zeros(n) for _ in range(4))
        N[:] = found[:n]
        w[:] = moved[:n]
        if self.sheared:
            T[:] = found[n:]
            s[:] = moved[n:]
        return Forces(N, T, w, s, states)

    def wanted(self, forces: Forces) -> np.ndarray:
        """States that forces, gaps and slips ask for."""
        states = forces.states
        law = self.law
        closed = np.where(states != 0, forces.N >= 0, forces.w < 0)
        if not self.rubs:
            return closed.astype(int)
        N = np.where(states != 0, forces.N, -law.k * np.minimum(forces.w, 0.0))
        phi = np.where(self.start.states == 0, self._passed(N), 1.0)
        holding = np.where(states == 1, forces.T, -law.k_t * phi * forces.s)
        most = law.tan * np.maximum(N, 0.0) + law.c
        slides = np.abs(states) == 2
        goes_on = slides & (-np.sign(states) * holding >= (1 - SLACK) * most)
        begins = ~slides & (np.abs(holding) > most)  # one that turns is held first
        sliding = np.where(goes_on, states, np.where(begins, -2 * np.sign(holding), 1))
        return np.where(closed, sliding, 0).astype(int)

    def solve(self, limit: int) -> tuple[Forces | None, int, str]:
        """Forces of consistent states, solutions used, and why there are none."""
        states = self.start.states
        for count in range(1, limit + 1):
            forces = self.forces(states)
            following = self.wanted(forces)
            if forces.settled and np.array_equal(following, states):
                return forces, count, ""
            states = following
        if not self.sheared:
            return self._by_turns(states, limit, math.inf)[0], limit + 1, ""
        choices = (0, 1, 2, -2) if self.rubs else (0, 1)
        if len(choices) ** self.n > SETS:
            return self._by_turns(states, limit, TURNS * self.n) if self.rubs else (None, limit, NONE)
        sets = self._consistent(choices)
        return (sets[0] if len(sets) == 1 else None), limit + 1, SEVERAL if sets else NONE

    def _by_turns(self, states: np.ndarray, used: int, most: float) -> tuple[Forces | None, int, str]:
        """Change the first node that is wrong, so many times at most.

        Without shear springs that ends with any such problem (Murty, 1974).
        """
        count = used
        while count < used + most:
            count += 1
            forces = self.forces(states)
            following = self.wanted(forces)
            wrong = np.flatnonzero(following != states)
            if not len(wrong):
                return (forces, count, "") if forces.settled else (None, count, NONE)
            states = states.copy()
            states[wrong[0]] = following[wrong[0]]
        return None, count, NONE

    def _consistent(self, choices: tuple[int, ...]) -> list[Forces]:
        """All sets of states that hold, those with equal forces once."""
        solutions: list[Forces] = []
        for choice in itertools.product(choices, repeat=self.n):
            forces = self.forces(np.array(choice))
            holds = forces.settled and np.array_equal(self.wanted(forces), choice)
            if holds and not any(alike(forces, other) for other in solutions):
                solutions.append(forces)
        return solutions

    def ended(self, forces: Forces, slip: np.ndarray) -> Start:
        """The nodes at the end of the step, which are at `slip`."""
        law = self.law
        start = self.start
        unstrained = slip + np.divide(forces.T, law.k_t, out=np.zeros(self.n), where=law.k_t > 0)
        was = start.states != 0
        slides = np.abs(forces.states) == 2
        stuck = np.where(was & ~slides, start.reference, unstrained)
        crossing = start.slip + (1 - self._passed(forces.N)) * (slip - start.slip)
        reference = unstrained - np.where(was, start.reference, crossing)
        return Start(
            gap=np.where(forces.states != 0, -forces.N / law.k, forces.w),
            reference=np.where(forces.states != 0, stuck, slip),
            slip=slip,
            states=forces.states,
            slid=start.slid + np.where(slides & (reference * forces.states > 0), reference, 0.0),
        )


def alike(one: Forces, other: Forces) -> bool:
    """Whether two sets of states are one contact: a node without forces has several names for its state."""
    parts = [np.concatenate([forces.N, forces.T]) for forces in (one, other)]
    return bool(np.abs(parts[0] - parts[1]).max() <= 1e-9 * np.abs(parts).max())
