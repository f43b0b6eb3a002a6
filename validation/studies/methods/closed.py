"""Closed forms of the locked block and of dashpots, written apart from the solvers; in SI units, W = w dt."""

from __future__ import annotations

import numpy as np

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory import statics
from validation.theory.stepping import Stepping

TOLERANCE = 1e-12  # of roots that are zero


def damped_roots(stepping: Stepping, mass: Array, damping: Array, stiffness: Array) -> Array:
    """Return the damping ratios of the oscillating modes of a damped system under Newmark's scheme, by frequency.

    M a1 + C v1 + K x1 = 0 on the state (x, dt v, dt^2 a), gg in front of v as everywhere.
    """
    size = len(mass)
    dt = stepping.step
    unit = np.eye(size)
    none = np.zeros((size, size))
    alpha = stepping.alpha
    delta = stepping.delta
    position = np.hstack([unit, stepping.gg * unit, (0.5 - alpha) * unit])
    velocity = np.hstack([none, stepping.gg * unit, (1 - delta) * unit])
    S = mass / dt**2 + delta * damping / dt + alpha * stiffness
    acceleration = -np.linalg.solve(S, stiffness @ position + damping @ velocity / dt)
    step = np.vstack([position + alpha * acceleration, velocity + delta * acceleration, acceleration])
    roots = np.linalg.eigvals(step).astype(complex)
    return _ratios(np.log(roots[np.abs(roots) > TOLERANCE]))


def exact_damped_roots(mass: Array, damping: Array, stiffness: Array) -> Array:
    """Return the same, exact in time."""
    size = len(mass)
    rates = np.block(
        [[np.zeros((size, size)), np.eye(size)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]]
    )
    return _ratios(np.linalg.eigvals(rates).astype(complex))


def _ratios(logarithms: Array) -> Array:
    """Return -Re/|.| of the logarithms above the real axis, by size."""
    above = logarithms[logarithms.imag > 1e-9]
    ordered = above[np.argsort(np.abs(above))]
    return np.asarray(-ordered.real / np.abs(ordered), dtype=np.float64)


def two_unknowns(scene: Scene) -> tuple[Array, Array, Array]:
    """Return M and K of the block of one strain in (v, ey), and the row b of the gap at its base, for mu = 0."""
    width, height = statics.size(scene)
    modulus, _ = statics.moduli(scene)
    p = scene.contact.stiffness
    m = scene.block.mass
    gap = np.array([1.0, -height / 2])
    mass = np.diag([m, m * height**2 / 12])
    stiffness = np.diag([0.0, modulus * width * height]) + 2 * p * np.outer(gap, gap)
    return mass, stiffness, gap


def exact_locked(scene: Scene, time: Array) -> Array:
    """Return the centroid's displacement of the locked block under a sudden pressure, from rest [m]."""
    mass, stiffness, _ = two_unknowns(scene)
    width, height = statics.size(scene)
    load = scene.load.pressure * width * np.array([-1.0, -height / 2])
    root = np.sqrt(np.diag(mass))
    squares, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
    shapes = vectors / root[:, None]
    static = (shapes.T @ load) / squares
    swings = static * (1 - np.cos(np.multiply.outer(time, np.sqrt(squares))))
    return np.asarray(swings @ shapes.T[:, 0], dtype=np.float64)
