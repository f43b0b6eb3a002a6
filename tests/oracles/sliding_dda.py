"""A block that slips on two corner springs, in plain numpy: the textbook recursion with a 6 x 6 solve in each pass.

Unknowns (u, v, r, ex, ey, gxy) of a rectangle's centroid, total gaps and stretches, Coulomb's law with a reference for
the shear. Nothing of the suite is imported. Two programs in one:

consistent
    All states, stick and slip included, agree with the motion that they give; if passing does not end, all are tried.
lagged
    As programs of the trade do it: a pass is repeated only where a corner opens or closes (beyond dead bands), the
    friction of a slipping corner is that of the pass before, or of the step before, and a corner that slips forgets
    its shear: it sticks again from where the step began in which it turned round.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np

OPEN, STICK = 0, 1  # slip is +2 or -2, the sign of the force


@dataclass
class Slider:
    """Data of a run; the load is a force through the centroid, or gravity on a slope."""

    width: float = 2.0
    height: float = 2.0
    rho: float = 2700.0
    E: float = 1e9
    mu: float = 0.0
    p: float = 1e9
    ps: float = 4e8
    phi: float = 30.0  # deg
    cohesion: float = 0.0  # N a corner
    gravity: float = 0.0
    slope: float = 0.0  # deg
    force: tuple[float, float] = (0.0, 0.0)  # N at the centroid
    dt: float = 1e-3
    steps: int = 100
    alpha: float = 0.5
    delta: float = 1.0
    gg: float = 1.0
    consistent_start: bool = False
    lagged: bool = False
    band: tuple[float, float] = (0.0, 0.0)  # closes below -band[0], opens above band[1]
    passes: int = 6
    base: tuple[float, float] | None = None  # a base that moves: its mass over the block's, its springs over 2 p


@dataclass
class Motion:
    time: np.ndarray
    u: np.ndarray
    v: np.ndarray
    normal: np.ndarray  # (steps, 2)
    shear: np.ndarray
    state: np.ndarray
    slide: np.ndarray
    solves: np.ndarray
    inconsistent: int = 0  # steps without a consistent state
    slip: np.ndarray = field(default_factory=lambda: np.zeros(0))  # summed movement of the references


class _Stepper:
    def __init__(self, s):
        self.s, w, h = s, s.width, s.height
        self.mass = s.rho * w * h
        x2, y2 = self.mass * w * w / 12, self.mass * h * h / 12
        self.M = np.diag([self.mass, self.mass, x2 + y2, x2, y2, (x2 + y2) / 4])
        self.M[2, 5] = self.M[5, 2] = (x2 - y2) / 2
        plane = s.E / (1 - s.mu**2) * np.array([[1, s.mu, 0], [s.mu, 1, 0], [0, 0, (1 - s.mu) / 2]])
        self.K = np.zeros((6, 6))
        self.K[3:, 3:] = w * h * plane
        y = -h / 2
        self.t = [np.array([1, 0, -y, x, 0, y / 2]) for x in (-w / 2, w / 2)]
        self.n = [np.array([0, 1, x, 0, y, x / 2]) for x in (-w / 2, w / 2)]
        b = math.radians(s.slope)
        self.F = np.zeros(6)
        self.F[:2] = np.array(s.force) + self.mass * s.gravity * np.array([math.sin(b), -math.cos(b)])
        if s.base is not None:
            self._move_base(*s.base)
        self.tan = math.tan(math.radians(s.phi))
        self.e = s.alpha * s.dt**2
        self.S0 = self.M + self.e * self.K

    def _move_base(self, mass, springs):
        """Two unknowns more: the base's displacements, which gaps and slides count from."""
        wide = [np.zeros((8, 8)), np.zeros((8, 8))]
        for matrix, own in zip(wide, (self.M, self.K), strict=True):
            matrix[:6, :6] = own
        self.M, self.K = wide
        self.M[6, 6] = self.M[7, 7] = mass * self.mass
        self.K[6, 6] = self.K[7, 7] = 2 * springs * self.s.p
        self.F = np.concatenate([self.F, [0.0, 0.0]])
        self.t = [np.concatenate([row, [-1.0, 0.0]]) for row in self.t]
        self.n = [np.concatenate([row, [0.0, -1.0]]) for row in self.n]

    def solve(self, ahead, states, r, known=None):
        """Displacements at the end of the step for given states; `known` are normal forces that friction is from."""
        s, S, R = self.s, self.S0.copy(), self.M @ ahead + self.e * self.F
        for c, state in enumerate(states):
            if state == OPEN:
                continue
            S += self.e * s.p * np.outer(self.n[c], self.n[c])
            if state == STICK:
                S += self.e * s.ps * np.outer(self.t[c], self.t[c])
                R = R + self.e * s.ps * r[c] * self.t[c]
                continue
            way = math.copysign(1, state)
            R = R + self.e * way * s.cohesion * self.t[c]
            if known is None:
                S += self.e * way * self.tan * s.p * np.outer(self.t[c], self.n[c])
            else:
                R = R + self.e * way * self.tan * known[c] * self.t[c]
        return np.linalg.solve(S, R)

    def gaps(self, D):
        return np.array([n @ D for n in self.n]), np.array([t @ D for t in self.t])


def run(s):
    k = _Stepper(s)
    D, V, r, states = np.zeros(len(k.F)), np.zeros(len(k.F)), np.zeros(2), (STICK, STICK)
    A = np.linalg.solve(k.M, k.F) if s.consistent_start else np.zeros(len(k.F))
    rows, bad, total = [], 0, np.zeros(2)
    for _ in range(s.steps):
        ahead = D + s.gg * s.dt * V + s.dt**2 * (0.5 - s.alpha) * A
        step = _lagged if s.lagged else _consistent
        D1, used, nxt, new, passes, lost = step(k, ahead, D, r, states)
        bad += lost
        force = k.S0 @ D1 - k.M @ ahead - k.e * k.F  # e times the contact's
        A1 = np.linalg.solve(k.M, k.F - k.K @ D1 + force / k.e)
        V, A = s.gg * V + s.dt * ((1 - s.delta) * A + s.delta * A1), A1
        w, x = k.gaps(D1)
        N = np.where(np.array(used) == OPEN, 0.0, -s.p * w)
        total = total + np.abs(np.where(np.array(used) == OPEN, 0.0, new - r))
        rows.append((D1[0], D1[1], N, x, used, passes, total, force / k.e))
        D, r, states = D1, new, nxt
    u, v, N, x, used, passes, totals, F = (np.array(column) for column in zip(*rows, strict=True))
    time = s.dt * np.arange(1, s.steps + 1)
    return Motion(time, u, v, N, F[:, 0], used, x, passes, bad, totals.max(axis=1))


def _reference(k, D, D1, r):
    """The references, moved to where a corner has touched down within the step."""
    (w0, x0), (w1, x1), moved = k.gaps(D), k.gaps(D1), r.copy()
    for c in (0, 1):
        if w0[c] > 0 > w1[c]:
            moved[c] = x0[c] + w0[c] / (w0[c] - w1[c]) * (x1[c] - x0[c])
    return moved


def _consistent(k, ahead, D, r0, states):
    s, tried, order = k.s, 0, itertools.product((STICK, 2, -2, OPEN), repeat=2)
    queue, passing, r = tuple(states), True, r0
    while True:
        for _ in range(60):  # the crossing depends on the step's end
            D1 = k.solve(ahead, queue, r)
            moved = _reference(k, D, D1, r0)
            if np.max(np.abs(moved - r)) <= 1e-15:
                break
            r = moved
        found = _asked(k, D1, queue, r)
        tried += 1
        if found == queue:
            break
        if passing and tried < s.passes:
            queue = found
            continue
        passing = False
        queue = next(order, None)
        if queue is None:
            D1, queue = k.solve(ahead, found, r), found
            return D1, found, found, _at_end(k, D1, found, r), tried, 1
    return D1, queue, queue, _at_end(k, D1, queue, r), tried, 0


def _asked(k, D1, states, r):
    """The states that the end of the step asks for."""
    w, x = k.gaps(D1)
    found = []
    for c, state in enumerate(states):
        cap = k.tan * max(0.0, -k.s.p * w[c]) + k.s.cohesion
        pull = -k.s.ps * (x[c] - r[c])
        if w[c] > 0:
            found.append(OPEN)
        elif state in (OPEN, STICK):
            found.append(STICK if abs(pull) <= cap else int(math.copysign(2, pull)))
        else:
            way = math.copysign(1, state)
            found.append(state if way * (x[c] + way * cap / k.s.ps - r[c]) <= 0 else STICK)
    return tuple(found)


def _at_end(k, D1, states, r):
    w, x = k.gaps(D1)
    new = r.copy()
    for c, state in enumerate(states):
        if state == OPEN:
            new[c] = x[c]
        elif state != STICK:
            new[c] = x[c] + math.copysign(1, state) * (k.tan * -k.s.p * w[c] + k.s.cohesion) / k.s.ps
    return new


def _lagged(k, ahead, D, r0, states):
    s, (w0, x0), r, queue = k.s, k.gaps(D), r0.copy(), tuple(states)
    known = np.maximum(0.0, -s.p * w0)
    for tried in range(1, s.passes + 1):  # noqa: B007
        D1 = k.solve(ahead, queue, r, known)
        w, x = k.gaps(D1)
        found, ref = [], r.copy()
        for c, state in enumerate(queue):
            cap = k.tan * max(0.0, -s.p * w[c]) + s.cohesion
            if w[c] > s.band[1] or (state == OPEN and w[c] >= -s.band[0]):
                found.append(OPEN)
            elif state == OPEN:
                found.append(STICK)
                past = w0[c] / (w0[c] - w[c]) if w0[c] > 0 else 0.0
                ref[c] = x0[c] + past * (x[c] - x0[c])
            elif state == STICK:
                pull = -s.ps * (x[c] - r[c])
                found.append(STICK if abs(pull) <= cap else int(math.copysign(2, pull)))
            else:
                found.append(state if state * (x[c] - x0[c]) <= 0 else STICK)
        if all((a == OPEN) == (b == OPEN) for a, b in zip(found, queue, strict=True)):
            break
        queue, r, known = tuple(found), ref, np.maximum(0.0, -s.p * w)
    new = r.copy()
    for c in (0, 1):
        if abs(queue[c]) == 2 and found[c] == STICK:
            new[c] = x0[c]  # it has turned round within this step
        elif queue[c] == OPEN or found[c] != STICK:
            new[c] = x[c]
    return D1, queue, tuple(found), new, tried, 0
