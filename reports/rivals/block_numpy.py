"""Rival of `dda`: the loop that one writes with numpy, the step's matrix inverted once, two columns kept.

The square block with its six unknowns (u, v, r, ex, ey, gxy) on locked corner springs, or on frictionless corners that
open, solved for the acceleration.
"""

from itertools import product

import numpy as np


def history(
    steps: int,
    side: float = 2.0,
    rho: float = 2700.0,
    young: float = 1e9,
    p: float = 1e9,
    q: float = 5e6,
    dt: float = 1e-3,
    alpha: float = 0.5,
    delta: float = 1.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement [m] and contact pressure [Pa] of every step, plane stress, Poisson's ratio 0."""
    area, s = side**2, side**4 / 12
    M = np.diag([area, area, 2 * s, s, s, s / 2]) * rho
    K = np.zeros((6, 6))
    K[3:, 3:] = area * young * np.diag([1, 1, 0.5])
    pressure = np.zeros(6)
    for x in (-side / 2, side / 2):
        normal, shear = np.array([0, 1, x, 0, -side / 2, x / 2]), np.array([1, 0, side / 2, x, 0, -side / 4])
        K += p * (np.outer(normal, normal) + np.outer(shear, shear))
        pressure -= p / side * normal
    F = -q * side * np.array([0, 1, 0, 0, side / 2, 0])
    inverse = np.linalg.inv(M + alpha * dt**2 * K)
    rows = np.array([np.eye(6)[1], pressure])
    D, V, A = np.zeros(6), np.zeros(6), np.zeros(6)
    columns = np.empty((steps, 2))
    half, whole, old, new = dt**2 * (0.5 - alpha), alpha * dt**2, dt * (1 - delta), dt * delta
    for n in range(steps):
        ahead = D + dt * V + half * A
        A1 = inverse @ (F - K @ ahead)
        D = ahead + whole * A1
        V = V + old * A + new * A1
        A = A1
        columns[n] = rows @ D
    return columns[:, 0], columns[:, 1]


def opening(
    steps: int,
    side: float = 2.0,
    rho: float = 2700.0,
    young: float = 1e9,
    p: float = 1e9,
    q: float = 5e6,
    dt: float = 1e-3,
    alpha: float = 0.5,
    delta: float = 1.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement [m] and contact pressure [Pa] of every step, the matrices of all contact states at hand."""
    area, s = side**2, side**4 / 12
    M = np.diag([area, area, 2 * s, s, s, s / 2]) * rho
    K = np.zeros((6, 6))
    K[3:, 3:] = area * young * np.diag([1, 1, 0.5])
    gaps = np.array([[0, 1, x, 0, -side / 2, x / 2] for x in (-side / 2, side / 2)])
    F = -q * side * np.array([0, 1, 0, 0, side / 2, 0])
    states = {}
    for closed in product((False, True), repeat=2):
        Kc = K + p * gaps.T @ np.diag(closed) @ gaps
        states[closed] = Kc, np.linalg.inv(M + alpha * dt**2 * Kc)
    D, V, A, closed = np.zeros(6), np.zeros(6), np.zeros(6), (True, True)
    columns = np.empty((steps, 2))
    half, whole, old, new = dt**2 * (0.5 - alpha), alpha * dt**2, dt * (1 - delta), dt * delta
    for n in range(steps):
        ahead = D + dt * V + half * A
        for _ in range(6):
            tried = closed
            Kc, inverse = states[tried]
            A1 = inverse @ (F - Kc @ ahead)
            D = ahead + whole * A1
            closed = tuple((gaps @ D < 0).tolist())
            if closed == tried:
                break
        V = V + old * A + new * A1
        A = A1
        columns[n] = D[1], -p / side * (gaps @ D) @ tried
    return columns[:, 0], columns[:, 1]
