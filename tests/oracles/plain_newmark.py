"""Newmark's scheme as it is printed, on any matrices, and the bar of linear elements on a spring as such matrices."""

import numpy as np

SIDE, YOUNG, DENSITY, SPRING = 2.0, 1e9, 2700.0, 1e9  # m, Pa, kg/m3, N/m: of the paper's block


def upright(n, p=SPRING):
    """Return M and K of n linear elements on the spring 2 p; n = 1 is (v, ey) of the DDA block as well."""
    h = SIDE / n
    M, K = np.zeros((2, n + 1, n + 1))
    for i in range(n):
        M[i : i + 2, i : i + 2] += DENSITY * SIDE * h / 6 * np.array([[2, 1], [1, 2]])
        K[i : i + 2, i : i + 2] += YOUNG * SIDE / h * np.array([[1, -1], [-1, 1]])
    K[0, 0] += 2 * p
    return M, K


def stepped(M, K, forces, scheme):
    """Return D of every step (steps, n) from rest, in absolute accelerations, under forces (steps + 1, n)."""
    alpha, delta, gg, dt = scheme.alpha, scheme.delta, scheme.gg, scheme.step
    D, V, A = np.zeros((3, len(M)))
    if scheme.start == "consistent":
        A = np.linalg.solve(M, forces[0])
    found = []
    for force in forces[1:]:
        ahead = D + gg * dt * V + dt * dt * (0.5 - alpha) * A
        new = np.linalg.solve(M + alpha * dt * dt * K, force - K @ ahead)
        D = ahead + alpha * dt * dt * new
        V, A = gg * V + dt * ((1 - delta) * A + delta * new), new
        found.append(D)
    return np.array(found)
