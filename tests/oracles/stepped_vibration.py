"""Steady vibrations by stepping: plain Newmark until transients are gone, then a least-squares fit.

Matrices are stepped in their natural modes, where the rounding of a slow motion does not reach a stiff one.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

GONE, MOST = 1e-14, 20_000  # of the transients; steps


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


def steady_modes(rule, squares, w):
    """Return the amplitudes of modes under unit loads cos(wt); None where transients last too long."""
    T, push = operators(rule, squares)
    radius = float(np.max(np.abs(np.linalg.eigvals(T))))
    if radius >= 1 or np.log(GONE) / np.log(radius) > MOST:
        return None
    steps = int(np.log(GONE) / np.log(radius)) + 50
    push, state = rule.step**2 * push, np.zeros((len(squares), 3))
    fitted = int(4 * np.pi / (w * rule.step)) + 12
    seen = np.empty((fitted, len(squares)))
    for i in range(1, steps + fitted + 1):
        state = np.einsum("nij,nj->ni", T, state) + push * np.cos(w * rule.step * i)
        if i > steps:
            seen[i - steps - 1] = state[:, 0]
    return fit(seen, w, rule.step * np.arange(steps + 1.0, steps + fitted + 1))


def amplitudes(rule, M, K, F, rows, w):
    """Return the amplitudes of some rows of D under F cos(wt), by steps; None where transients last too long."""
    squares, shapes = eigh(K, M)
    steady = steady_modes(rule, squares, w)
    return None if steady is None else np.asarray((rows @ shapes) @ ((shapes.T @ F) * steady))


def fit(seen, w, times):
    """Return c of Re(c e^{iwt}) + shift by least squares, one for each column: a dashpot alone holds no place."""
    wave = np.column_stack([np.cos(w * times), -np.sin(w * times), np.ones_like(times)])
    real, imaginary, _ = np.linalg.lstsq(wave, seen, rcond=None)[0]
    return np.asarray(real + 1j * imaginary)


def two_unknowns(block, stiffness):
    """Return both axial frequencies [rad/s] of a rectangle at mu = 0, of (v, ey): springs stretch by v - h ey / 2."""
    (w, h), m, p = block.rectangle, block.mass, stiffness
    K = np.array([[2 * p, -p * h], [-p * h, block.young * w * h + p * h * h / 2]])
    return np.sqrt(eigh(K, m * np.diag([1, h * h / 12]), eigvals_only=True))
