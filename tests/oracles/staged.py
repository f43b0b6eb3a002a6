"""Steps of Newmark's scheme and of those by name as the papers write them, on dense matrices.

Contact is found by trying all states. Nothing is rearranged: displacements count from the start of the step, and
accelerations and contact forces are unknowns.
"""

from itertools import product

import numpy as np
from scipy.linalg import eigh

LOWER, INSIDE, UPPER = range(3)


def generalised_alpha(name, rho):
    """Return am and af."""
    if name == "chung-hulbert":
        return (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    if name == "hht":
        return 0.0, (1 - rho) / (1 + rho)
    return (rho - 1) / (rho + 1), 0.0


def newmark(alpha, delta):
    """Return a stage: am, af, beta and gamma of its end, and what it goes ahead by: dt^2 times this share of a."""
    return 0.0, 0.0, alpha, delta, 0.5 - alpha


def of_second_order(am, af):
    """Return the stage of (1 - am) M a1 + am M a + (1 - af) r(x1) + af r(x) = F (Chung and Hulbert 1993)."""
    beta = (1 - am + af) ** 2 / 4
    return am, af, beta, 0.5 - am + af, 0.5 - beta


def theta(share):
    """Return the stage of v1 = u + dt M^-1 [share r(x1) + (1 - share) r(x)], x1 = x + dt (share v1 + (1 - share) u)."""
    return 0.0, 0.0, share**2, share, share * (1 - share)


def amplification(alpha, delta, gg, square):
    """Return the step of D, dt V and dt^2 A of a mode under Newmark's scheme, of the square of w dt."""
    end = [[1, 0, -alpha], [0, 1, -delta], [square, 0, 1]]
    start = [[1, gg, 0.5 - alpha], [0, gg, 1 - delta], [0, 0, 0]]
    return np.linalg.solve(end, start)


def two_unknowns(block, stiffness):
    """Return both axial frequencies [rad/s] of a rectangle at mu = 0, of (v, ey): springs stretch by v - h ey / 2."""
    (w, h), m, p = block.rectangle, block.mass, stiffness
    K = np.array([[2 * p, -p * h], [-p * h, block.young * w * h + p * h * h / 2]])
    return np.sqrt(eigh(K, m * np.diag([1, h * h / 12]), eigvals_only=True))


class System:
    """M x'' + C x' + K x = F(t) + B' N: the force of each row of B is N = -(B x + gap(t) - r)/c within its bounds.

    A row that opens has the bounds 0 and infinity, and r = 0. One with a strength has this and its negative, and its
    reference r moves where it slips: N = -(B x + gap - r)/c at the end of every step.
    """

    def __init__(self, M, K, F, C=None, B=None, p=1.0, gap=0.0, strength=None):
        self.M, self.K, self.F = M, K, F
        self.C = np.zeros_like(M) if C is None else C
        self.B = np.zeros((0, len(M))) if B is None else B
        rows = len(self.B)
        self.compliance = np.broadcast_to(1 / np.asarray(p, float), rows)
        self.gap = gap if callable(gap) else lambda t: np.broadcast_to(gap, rows)
        self.slips = strength is not None
        self.upper = np.broadcast_to(strength if self.slips else np.inf, rows)
        self.lower = -self.upper if self.slips else np.zeros(rows)
        self.reference = np.zeros(rows)

    def opening(self, t, x):
        """Return the opening or the way of each row."""
        return self.B @ x + self.gap(t)

    def forces(self, t, x):
        """Return N at the start of the motion, or where it follows from the displacements."""
        with np.errstate(divide="ignore", invalid="ignore"):
            N = (self.reference - self.opening(t, x)) / self.compliance
        return np.clip(np.where(self.compliance > 0, N, 0.0), self.lower, self.upper)

    def forces_of_rates(self, N, rate):
        """Return N with those of rigid rows that slip at the start: their strength, against the slip."""
        held = np.where(rate > 0, self.lower, self.upper)
        return np.where((self.compliance == 0) & (np.abs(rate) > 1e-9) & self.slips, held, N)

    def implicit(self, t, known_x, known_v, beta, gamma, am=0.0, af=0.0, old=0.0, start=None):
        """Return a1, x1 and N of x1 = known_x + beta a1, v1 = known_v + gamma a1; `old` are the terms of the start.

        With the displacements of the `start`, N is that of the gap at (1 - af) x1 + af x, and acts whole.
        """
        left = (1 - am) * self.M + (1 - af) * (gamma * self.C + beta * self.K)
        right = (1 - af) * (self.F(t) - self.C @ known_v - self.K @ known_x) + old
        kinds = (LOWER, INSIDE, UPPER) if self.slips else (LOWER, INSIDE)
        fitting = []
        for states in product(kinds, repeat=len(self.B)):
            inside = np.array(states, dtype=int) == INSIDE
            held = np.where(np.array(states) == UPPER, self.upper, self.lower)
            if not np.all(np.isfinite(held[~inside])):
                continue
            a, x, N = self._solved(t, known_x, beta, left, right, inside, held, 1 - af, start)
            place = x if start is None else (1 - af) * x + af * start
            beyond = self.opening(t, place) - self.reference + self.compliance * N
            ways = np.array([1.0, 0.0, -1.0])[list(states)] if len(self.B) else np.zeros(0)
            within = np.all((N[inside] >= self.lower[inside]) & (N[inside] <= self.upper[inside]))
            if within and np.all(beyond[~inside] * ways[~inside] >= 0):
                fitting.append((a, x, N))
        assert fitting and all(np.allclose(one[2], fitting[0][2], rtol=1e-9, atol=1e-6) for one in fitting)
        return fitting[0]

    def _solved(self, t, known_x, beta, left, right, inside, held, share, start):
        """Solve for accelerations and the forces of rows that are within their bounds."""
        n = len(left)
        B = self.B[inside]
        own = np.where(inside, 0.0, held)
        compliance = self.compliance[inside]
        short = (self.reference - self.gap(t))[inside]
        if start is not None:  # a share of the gap is known, and the force is no mean of two
            short = (short - (1 - share) * B @ start) / share
            compliance = compliance / share
            share = 1.0
        short = short - B @ known_x
        matrix = np.block([[left, -share * B.T], [B, np.diag(compliance / beta)]])
        solution = np.linalg.solve(matrix, np.concatenate([right + share * self.B.T @ own, short / beta]))
        own[inside] = solution[n:]
        return solution[:n], known_x + beta * solution[:n], own

    def end_stage(self, t, x, N):
        """Move the references of rows that slip."""
        if self.slips:
            self.reference = self.opening(t, x) + self.compliance * N


def march(system, name, dt, steps, x, v, gg=1.0, rho=0.0, split=None, zero=False, weights=None, stage=None, mean=False):
    """Return displacements, velocities at their time and contact forces, from t = 0 on.

    Newmark's scheme takes its `weights` alpha and delta, any other of one stage its row; `mean` finds contact by the
    gap between start and end that internal forces are taken at, and tells the force of the gap at the end.
    """
    s = system
    M, C, K = s.M, s.C, s.K
    s.reference = np.zeros(len(s.B))
    N = s.forces(0.0, x)
    if not zero:
        N = s.forces_of_rates(N, s.B @ v)
    a = np.zeros_like(x) if zero else np.linalg.solve(M, s.F(0.0) + s.B.T @ N - C @ v - K @ x)
    rows = [(x, v, N)]
    half = v - dt / 2 * a
    for n in range(steps):
        t = n * dt
        u = gg * v
        if name == "leapfrog":
            half = (half if n == 0 else gg * half) + dt * a
            x = x + dt * half
            N = s.forces(t + dt, x)
            a = np.linalg.solve(M, s.F(t + dt) + s.B.T @ N - K @ x)
            v = half + dt / 2 * a
        elif name == "composite":
            g = split or (0.5 if rho == 1 else (2 - np.sqrt(2 + 2 * rho)) / (1 - rho))
            q1 = (rho + 1) / (2 * g * (rho - 1) + 4)
            q0, q2 = (g - 1) * q1 + 0.5, 0.5 - g * q1
            h = g * dt
            ag, xg, N = s.implicit(t + h, x + h * u + h * h / 4 * a, u + h / 2 * a, h * h / 4, h / 2)
            s.end_stage(t + h, xg, N)
            vg = u + h / 2 * (a + ag)
            known_v = u + dt * (q0 * a + q1 * ag)
            known_x = x + dt * (q0 * u + q1 * vg + q2 * known_v)
            a, x, N = s.implicit(t + dt, known_x, known_v, (q2 * dt) ** 2, q2 * dt)
            v = known_v + q2 * dt * a
        else:
            if weights:
                stage = newmark(*weights)
            am, af, beta, gamma, ahead = stage or of_second_order(*generalised_alpha(name, rho))
            old = af * (s.F(t) + (not mean) * s.B.T @ N - C @ v - K @ x) - am * M @ a
            known_v = u + dt * (1 - gamma) * a
            known_x = x + dt * u + dt * dt * ahead * a
            start = x if mean else None
            a, x, N = s.implicit(t + dt, known_x, known_v, beta * dt * dt, gamma * dt, am, af, old, start)
            N = s.forces(t + dt, x) if mean else N
            v = known_v + gamma * dt * a
        s.end_stage(t + dt, x, N)
        rows.append((x, v, N))
    return tuple(np.array(part) for part in zip(*rows, strict=True))
