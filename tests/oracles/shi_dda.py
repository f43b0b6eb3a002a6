"""A small DDA program of its own, written as programs of the trade are: it makes the histories that tests judge.

Two blocks with six unknowns each in the order (u, v, r, ex, ey, gxy): the loaded one, and a wide base that point
springs hold. Stresses accumulate, vertices move with T d after each step, and everything else (area, moments, gap)
is computed anew from the vertices; a corner's normal spring is on where the corner penetrates, decided by open-close
iteration. It shares no line with the suite's own models, and mirrors what a measured-point file says of ntdda.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

HEADER = "\n% Timestep, currenttime, deltat, xpos, ypos, dcum, vx, vy, v\n\nmeaspoint1=[\n"


@dataclass
class Program:
    """Parameters of a run; the block stands on the base at y = 2, its centroid above x = 5."""

    dt: float = 0.002
    steps: int = 60
    p: float = 1e9
    q: float = 5e6
    side: float = 2.0
    rho: float = 2700.0
    E: float = 1e9
    mu: float = 0.0
    alpha: float = 0.5
    delta: float = 1.0
    gg: float = 1.0
    g: float = 0.0
    base_young: float = 50e9
    base_rho: float = 2700.0
    fixed: float = 1e12  # N/m, spring of each of the base's points
    opens: bool = True
    consistent: bool = False
    discounted: str = "both"
    updated: bool = True


@dataclass
class History:
    time: np.ndarray
    displacement: np.ndarray
    pressure: np.ndarray
    open: np.ndarray  # both corners open at the end of the step

    @property
    def opened(self) -> list[int] | None:
        steps = np.flatnonzero(self.open) + 1
        return [int(steps[0]), int(steps[-1])] if len(steps) else None


class Block:
    def __init__(self, vertices, rho, E, mu):
        self.vertices, self.rho = np.array(vertices, dtype=float), rho
        self.C = E / (1 - mu**2) * np.array([[1, mu, 0], [mu, 1, 0], [0, 0, (1 - mu) / 2]])
        self.stress, self.V, self.A = np.zeros(3), np.zeros(6), np.zeros(6)
        self.measure()

    def measure(self):
        """Area, centroid and central moments of the rectangle-like outline, by the shoelace sums."""
        x, y = self.vertices.T
        x1, y1 = np.roll(x, -1), np.roll(y, -1)
        cross = x * y1 - x1 * y
        self.S = cross.sum() / 2
        self.c = np.array([((x + x1) * cross).sum(), ((y + y1) * cross).sum()]) / (6 * self.S)
        X, Y = (self.vertices - self.c).T
        X1, Y1 = np.roll(X, -1), np.roll(Y, -1)
        cross = X * Y1 - X1 * Y
        self.sxx = ((X * X + X * X1 + X1 * X1) * cross).sum() / 12
        self.syy = ((Y * Y + Y * Y1 + Y1 * Y1) * cross).sum() / 12
        self.sxy = ((X * Y1 + 2 * X * Y + 2 * X1 * Y1 + X1 * Y) * cross).sum() / 24

    def T(self, point):
        x, y = np.asarray(point) - self.c
        return np.array([[1, 0, -y, x, 0, y / 2], [0, 1, x, 0, y, x / 2]])

    def mass(self):
        M = np.zeros((6, 6))
        M[0, 0] = M[1, 1] = self.S
        # rows of T as linear forms in (1, x, y): integrate the products
        U = np.zeros((3, 6))
        W = np.zeros((3, 6))
        U[0, 0] = W[0, 1] = 1
        U[2, 2], U[1, 3], U[2, 5] = -1, 1, 0.5
        W[1, 2], W[2, 4], W[1, 5] = 1, 1, 0.5
        G = np.diag([self.S, self.sxx, self.syy])
        G[1, 2] = G[2, 1] = self.sxy
        return self.rho * (U.T @ G @ U + W.T @ G @ W)

    def elastic(self):
        K, F = np.zeros((6, 6)), np.zeros(6)
        K[3:, 3:] = self.S * self.C
        F[3:] = -self.S * self.stress
        return K, F


def run(program: Program) -> History:
    """Step the two blocks."""
    P, half = program, program.side / 2
    block = Block([(5 - half, 2), (5 + half, 2), (5 + half, 2 + P.side), (5 - half, 2 + P.side)], P.rho, P.E, P.mu)
    base = Block([(0, 0), (10, 0), (10, 2), (0, 2)], P.base_rho, P.base_young, 0.0)
    held = [(x, 0.0) for x in np.linspace(0, 10, 11)] + [(x, y) for x in (0.0, 10.0) for y in np.linspace(0.4, 2, 5)]
    moved = [np.zeros(2) for _ in held]
    held_T = [base.T(x) for x in held]
    on, gaps, slid, total = [True, True], [0.0, 0.0], [0.0, 0.0], np.zeros(12)
    rows = []
    for n in range(P.steps):
        M, K, F = _assembled(P, block, base, held_T, moved)
        V, A = np.concatenate([block.V, base.V]), np.concatenate([block.A, base.A])
        if n == 0 and P.consistent:
            A = np.concatenate([np.linalg.solve(block.mass(), F[:6]), np.zeros(6)])
        one = P.gg if P.discounted != "velocity" else 1.0
        two = P.gg if P.discounted != "displacement" else 1.0
        star = one * P.dt * V + P.dt**2 * (0.5 - P.alpha) * A
        for _ in range(8):
            Kc, Fc, normals, shears = _contacts(P, block, base, on, gaps, slid)
            b = P.alpha * P.dt**2
            D = np.linalg.solve(M + b * (K + Kc), M @ star + b * (F + Fc))
            ends = [gap + normal @ D for gap, normal in zip(gaps, normals, strict=True)]
            new = [end < 0 if P.opens else True for end in ends]
            if new == on:
                break
            on = new
        A1 = np.linalg.solve(M, F + Fc - (K + Kc) @ D)
        V1 = two * V + P.dt * ((1 - P.delta) * A + P.delta * A1)
        force = sum(-P.p * end for end, closed in zip(ends, on, strict=True) if closed)
        slid = [s + float(shear @ D) if closed else 0.0 for s, shear, closed in zip(slid, shears, on, strict=True)]
        for T, m in zip(held_T, moved, strict=True):
            m += T @ D[6:]
        for body, d, v, a in ((block, D[:6], V1[:6], A1[:6]), (base, D[6:], V1[6:], A1[6:])):
            body.stress, body.V, body.A = body.stress + body.C @ d[3:], v, a
            if P.updated:
                body.vertices = body.vertices + np.array([body.T(x) @ d for x in body.vertices])
                body.measure()
        surface = base.vertices[2:, 1].mean()
        gaps = [float(block.vertices[j, 1] - surface) for j in range(2)] if P.updated else [float(e) for e in ends]
        total = total + D
        rows.append((total[1], force / P.side, not any(on)))
    time = P.dt * np.arange(1, P.steps + 1)
    return History(time, *(np.array(column) for column in zip(*rows, strict=True)))


def _assembled(P, block, base, held_T, moved):
    M, K, F = np.zeros((12, 12)), np.zeros((12, 12)), np.zeros(12)
    M[:6, :6], M[6:, 6:] = block.mass(), base.mass()
    K[:6, :6], F[:6] = block.elastic()
    K[6:, 6:], F[6:] = base.elastic()
    F[:6] += block.T(block.vertices[2:].mean(axis=0)).T @ [0, -P.q * P.side]
    F[1] -= block.rho * block.S * P.g
    F[7] -= base.rho * base.S * P.g
    for T, m in zip(held_T, moved, strict=True):
        K[6:, 6:] += P.fixed * T.T @ T
        F[6:] -= P.fixed * T.T @ m
    return M, K, F


def _contacts(P, block, base, on, gaps, slid):
    """Springs of the two corners, and the rows that give normal and shear motion of each."""
    K, F, normals, shears = np.zeros((12, 12)), np.zeros(12), [], []
    surface = base.vertices[2:, 1].mean()
    for corner, closed, gap, slip in zip(block.vertices[:2], on, gaps, slid, strict=True):
        T = np.hstack([block.T(corner), -base.T((corner[0], surface))])
        normals.append(T[1])
        shears.append(T[0])
        if closed:
            K += P.p * (np.outer(T[1], T[1]) + np.outer(T[0], T[0]))
            F -= P.p * (gap * T[1] + slip * T[0])
    return K, F, normals, shears


def write_measured_point(history: History, path: Path, dt: float) -> Path:
    """Write the file that ntdda writes: seven digits, an unsigned displacement, step velocities."""
    steps = np.diff(history.displacement, prepend=0.0)
    lines = [
        f"{n + 1:10d} {t:20e} {dt:20e} {5.0:20e} {3 + d:20e} {abs(d):20e} {0.0:20e} {s / dt:20e} {abs(s / dt):20e}\n"
        for n, (t, d, s) in enumerate(zip(history.time, history.displacement, steps, strict=True))
    ]
    path.write_text(HEADER + "".join(lines) + "];\n")
    return path
