"""A DDA code of one block, for the tutorial."""

import numpy as np


def solve(scene):
    """The block as two unknowns (v, ey), for Poisson's ratio 0."""
    t, b = scene.time, scene.block
    if b.poisson != 0 or b.vertices is not None or scene.load.eccentricity != 0:
        raise NotImplementedError("rectangles of Poisson's ratio 0 under a centred load only")
    w, h = b.outline[2]
    p, q, m = scene.contact.stiffness, scene.load.pressure, b.density * w * h
    M = np.diag([m, m * h * h / 12])
    K = np.array([[2 * p, -p * h], [-p * h, b.young * w * h + p * h * h / 2]])
    F = -q * w * np.array([1, h / 2])
    D, V, A = np.zeros((3, 2))
    if t.start == "consistent":
        A = np.linalg.solve(M, F)
    S = M + t.alpha * t.step**2 * K
    rows = []
    for _ in range(t.steps):
        ahead = D + t.discount * t.step * V + t.step**2 * (0.5 - t.alpha) * A
        new = np.linalg.solve(S, F - K @ ahead)
        D = ahead + t.alpha * t.step**2 * new
        V = t.discount * V + t.step * ((1 - t.delta) * A + t.delta * new)
        A = new
        rows.append((D[0], -2 * p * (D[0] - h / 2 * D[1]) / w))
    return np.array(rows)
