"""Steps of the schemes by name as the papers write them, on dense matrices, with contact by trying all states.

Nothing is rearranged: displacements count from the start of the step, accelerations are unknowns, and springs of closed
contacts stand in the stiffness.
"""

from itertools import product

import numpy as np


def generalised_alpha(name, rho):
    """Return am and af."""
    if name == "chung-hulbert":
        return (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    if name == "hht":
        return 0.0, (1 - rho) / (1 + rho)
    return (rho - 1) / (rho + 1), 0.0


class System:
    """M x'' + C x' + K x = F(t) + B' N, with N = p (-B x - y n) > 0 of each row of B; y(t) moves the base."""

    def __init__(self, M, K, F, C=None, B=None, p=0.0, gap=None):
        self.M, self.K, self.F = M, K, F
        self.C = np.zeros_like(M) if C is None else C
        self.B = np.zeros((0, len(M))) if B is None else B
        self.p = np.broadcast_to(np.asarray(p, float), len(self.B))
        self.gap = np.zeros(len(self.B)) if gap is None else gap

    def forces(self, x):
        """Return N."""
        return np.maximum(0.0, -self.p * (self.B @ x + self.gap))

    def solve(self, build):
        """Return the solution of the only contact state that agrees; `build` makes matrix and right-hand side."""
        fitting = []
        for states in product((0.0, 1.0), repeat=len(self.B)):
            k = self.p * states
            a, x = build(self.B.T @ (k[:, None] * self.B), -self.B.T @ (k * self.gap))
            if np.all((self.B @ x + self.gap < 0) == (np.array(states) > 0)):
                fitting.append((a, x))
        assert len(fitting) == 1
        return fitting[0]


def march(system, name, dt, steps, x, v, gg=1.0, rho=0.0, split=None, zero=False):
    """Return displacements, velocities at their time and contact forces, from t = 0 on."""
    s = system
    M, C, K = s.M, s.C, s.K
    a = np.zeros_like(x) if zero else np.linalg.solve(M, s.F(0.0) + s.B.T @ s.forces(x) - C @ v - K @ x)
    rows = [(x, v, s.forces(x))]
    half = v - dt / 2 * a

    def implicit(known_x, known_v, beta, gamma, F, am=0.0, af=0.0, old=0.0):
        """Return a1 and x1 of x1 = known_x + beta a1, v1 = known_v + gamma a1; `old` are the terms of the start."""

        def build(springs, push):
            stiff = K + springs
            left = (1 - am) * M + (1 - af) * (gamma * C + beta * stiff)
            right = (1 - af) * (F + push - C @ known_v - stiff @ known_x) + old
            a1 = np.linalg.solve(left, right)
            return a1, known_x + beta * a1

        return s.solve(build)

    for n in range(steps):
        t = n * dt
        u = gg * v
        if name == "leapfrog":
            half = (half if n == 0 else gg * half) + dt * a
            x = x + dt * half
            a = np.linalg.solve(M, s.F(t + dt) + s.B.T @ s.forces(x) - K @ x)
            rows.append((x, half + dt / 2 * a, s.forces(x)))
            continue
        if name == "composite":
            g = split or (0.5 if rho == 1 else (2 - np.sqrt(2 + 2 * rho)) / (1 - rho))
            q1 = (rho + 1) / (2 * g * (rho - 1) + 4)
            q0, q2 = (g - 1) * q1 + 0.5, 0.5 - g * q1
            h = g * dt
            ag, _ = implicit(x + h * u + h * h / 4 * a, u + h / 2 * a, h * h / 4, h / 2, s.F(t + h))
            vg = u + h / 2 * (a + ag)
            known_v = u + dt * (q0 * a + q1 * ag)
            known_x = x + dt * (q0 * u + q1 * vg + q2 * known_v)
            a, x = implicit(known_x, known_v, (q2 * dt) ** 2, q2 * dt, s.F(t + dt))
            v = known_v + q2 * dt * a
        else:
            am, af = generalised_alpha(name, rho)
            beta, gamma = (1 - am + af) ** 2 / 4, 0.5 - am + af
            old = af * (s.F(t) + s.B.T @ s.forces(x) - C @ v - K @ x) - am * M @ a
            known_v = u + dt * (1 - gamma) * a
            known_x = x + dt * u + dt * dt * (0.5 - beta) * a
            a, x = implicit(known_x, known_v, beta * dt * dt, gamma * dt, s.F(t + dt), am, af, old)
            v = known_v + gamma * dt * a
        rows.append((x, v, s.forces(x)))
    return tuple(np.array(part) for part in zip(*rows, strict=True))
