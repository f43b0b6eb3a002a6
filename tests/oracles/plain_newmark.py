"""Newmark's scheme as it is printed, on any matrices, and the bar of linear elements on a spring as such matrices."""

import numpy as np
from oracles.staged import System, march

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


def stepped(M, K, forces, scheme, C=None):
    """Return D of every step (steps, n) from rest, in absolute accelerations, under forces (steps + 1, n)."""
    system = System(M, K, lambda t: forces[round(t / scheme.step)], C)
    rest = np.zeros(len(M))
    weights = scheme.alpha, scheme.delta
    zero = scheme.start == "zero"
    steps = len(forces) - 1
    return march(system, "newmark", scheme.step, steps, rest, rest, scheme.gg, zero=zero, weights=weights)[0][1:]


def glued(blocks, springs):
    """Return M and K of blocks on springs at points, (first, second or None, point, normal, shear) on level edges.

    Shear is along x and normal along y; of an upright edge the two are exchanged.
    """
    size = 6 * len(blocks)
    M, K = np.zeros((2, size, size))
    for i, block in enumerate(blocks):
        part = slice(6 * i, 6 * i + 6)
        M[part, part] = block.mass()
        K[part, part] = block.elastic()
    for first, second, point, normal, shear in springs:
        gap = np.zeros((2, size))
        gap[:, 6 * first : 6 * first + 6] = blocks[first].T(*point)
        if second is not None:
            gap[:, 6 * second : 6 * second + 6] = -blocks[second].T(*point)
        K += gap.T @ np.diag([shear, normal]) @ gap
    return M, K
