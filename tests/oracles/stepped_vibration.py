"""Steps of plain Newmark as operators of natural modes, and the steady vibrations that they keep up.

In modes the rounding of a slow motion does not reach a stiff one.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh


@dataclass(frozen=True)
class Rule:
    """Newmark's parameters and Rayleigh's damping C = a0 M + a1 K."""

    alpha: float
    delta: float
    gg: float
    step: float
    a0: float = 0.0
    a1: float = 0.0
    start: str = "zero"


def operators(rule, squares):
    """Return the maps of (D, dt V, dt^2 A) of modes, (modes, 3, 3), and of dt^2 times the load, (modes, 3).

    The new acceleration is that of A + C V + w^2 D = F at the end of the step, C = a0 + a1 w^2.
    """
    k, c = squares * rule.step**2, (rule.a0 + rule.a1 * squares) * rule.step
    D = np.array([1.0, rule.gg, 0.5 - rule.alpha])  # before the new acceleration
    V = np.array([0.0, rule.gg, 1 - rule.delta])
    left = 1 + rule.delta * c + rule.alpha * k
    A = -(k[:, None] * D + c[:, None] * V) / left[:, None]
    T = np.stack([D + rule.alpha * A, V + rule.delta * A, A], axis=1)
    return T, np.array([rule.alpha, rule.delta, 1.0]) / left[:, None]


def amplitudes(rule, M, K, F, rows, w):
    """Return the amplitudes of some rows of D under F cos(wt): what steps T y + push F turn on by e^{i w dt}."""
    squares, shapes = eigh(K, M)
    T, push = operators(rule, squares)
    turn = np.exp(1j * w * rule.step)
    steady = np.linalg.solve(turn * np.eye(3) - T, turn * rule.step**2 * push[:, :, None])[:, 0, 0]
    return (rows @ shapes) @ ((shapes.T @ F) * steady)


def two_unknowns(block, stiffness):
    """Return both axial frequencies [rad/s] of a rectangle at mu = 0, of (v, ey): springs stretch by v - h ey / 2."""
    (w, h), m, p = block.rectangle, block.mass, stiffness
    K = np.array([[2 * p, -p * h], [-p * h, block.young * w * h + p * h * h / 2]])
    return np.sqrt(eigh(K, m * np.diag([1, h * h / 12]), eigvals_only=True))
