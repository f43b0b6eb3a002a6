"""Rival of `dda`'s column: the loop that one writes with numpy, rigid blocks on springs that open, on a shaken base.

The states of all contacts are set at once until none changes, with one dense solve of the closed ones each time.
"""

import numpy as np


def history(
    steps: int,
    blocks: int = 80,
    mass: float = 2500.0,
    k: float = 1e9,
    gap: float = 1e-3,
    gravity: float = 9.81,
    amplitude: float = 1.86e-3,
    w: float = 125.66,
    dt: float = 4e-4,
    alpha: float = 0.25,
    delta: float = 0.5,
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement of the top [m] and force of the base [Pa] of every step."""
    B = np.eye(blocks) - np.eye(blocks, k=-1)  # opening of every contact by the blocks' displacements
    C = alpha * dt**2 / mass * B @ B.T
    weight = np.full(blocks, -gravity * mass)
    base = np.zeros(blocks)
    D, A, closed = np.zeros(blocks), np.zeros(blocks), np.zeros(blocks, dtype=bool)
    V = np.full(blocks, amplitude * w)
    columns = np.empty((steps, 2))
    for n in range(steps):
        base[0] = amplitude * np.sin(w * dt * (n + 1))
        ahead = D + dt * V + dt**2 * (0.5 - alpha) * A
        q = B @ (ahead + alpha * dt**2 * weight / mass) - base + gap
        while True:
            N = np.zeros(blocks)
            inside = C[np.ix_(closed, closed)] + np.eye(int(closed.sum())) / k
            N[closed] = np.linalg.solve(inside, -q[closed])
            now = np.where(closed, N > 0, q + C @ N < 0)
            if np.array_equal(now, closed):
                break
            closed = now
        A1 = (weight + B.T @ N) / mass
        D = ahead + alpha * dt**2 * A1
        V = V + dt * ((1 - delta) * A + delta * A1)
        A = A1
        columns[n] = D[-1], N[0]
    return columns[:, 0], columns[:, 1]
