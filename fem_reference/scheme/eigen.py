"""Natural modes of the finite-element model and the scheme's one-step operator on each."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import LinearOperator, eigsh

from fem_reference.mesh.model import Model, build
from fem_reference.problem.problem import Array, Problem, Scheme
from fem_reference.problem.result import Mode
from fem_reference.scheme.harmonic import Complex
from fem_reference.scheme.modal import principal_first
from fem_reference.scheme.newmark import Stepper, Work
from fem_reference.scheme.stage import Motion

DENSE = 400
"""Unknowns up to which all modes are found by a dense solver."""


def modes(
    problem: Problem, scheme: Scheme, count: int = 12, full: bool = False, model: Model | None = None
) -> tuple[Mode, ...]:
    """Natural modes by falling share of the static response; the first one is the first axial mode.

    Parameters
    ----------
    count
        Number of lowest modes computed; doubled until the first axial mode is certainly among them.
    full
        Use the whole block instead of the model with exact savings.
    model
        The model of `problem` (and `full`) where it was built before.
    """
    model = build(problem, full) if model is None else model
    F = model.F if np.any(model.F) else _carried(problem, model)
    D = Work().factor(model.K)(F)
    while True:
        found = as_modes(*lowest(model.K, model.M, count), F, float(F @ D), scheme)
        shares = np.array([mode.share for mode in found])
        # The shares of all modes sum to one: no mode left out can exceed what is still missing.
        if len(found) < count or shares.max() > 1 - shares.sum():
            return tuple(found[i] for i in np.argsort(-shares, kind="stable"))
        count *= 2


def as_modes(squares: Array, shapes: Array, F: Array, work: float, scheme: Scheme) -> tuple[Mode, ...]:
    """Modes with their shares of the work that the load does at rest, none where it does none."""
    shares = (shapes.T @ F) ** 2 / (squares * work) if work else np.zeros(len(squares))
    pairs = zip(np.sqrt(squares).tolist(), shares.tolist(), strict=True)
    return tuple(Mode(frequency, share, eigenvalues(frequency, scheme)) for frequency, share in pairs)


def _carried(problem: Problem, model: Model) -> Array:
    """Inertia M R of a unit acceleration of the base, along the ways that it moves."""
    component = model.places[2]
    motion = problem.motion
    ways = [i for i, part in enumerate(((), ()) if motion is None else (motion.x, motion.y)) if any(part)] or [1]
    return np.asarray(model.M @ np.isin(component, ways).astype(float))


def lowest(K: csr_array, M: csr_array, count: int, shift: float = 0.0) -> tuple[Array, Array]:
    """Squares of the lowest frequencies [rad2/s2], rising, and their shapes with phi' M phi = 1, one a column.

    K + shift M is definite.
    """
    size = K.shape[0]
    if size <= DENSE or count >= size - 1:
        squares, shapes = eigh(K.toarray(), M.toarray())
        return squares[:count], shapes[:, :count]
    inverse = LinearOperator(K.shape, matvec=Work().factor(csr_array(K + shift * M)), dtype=float)
    squares, shapes = eigsh(K, count, M, sigma=-shift, OPinv=inverse, v0=_start_vector(size))
    order = np.argsort(squares)
    return squares[order], shapes[:, order]


def _start_vector(size: int) -> Array:
    """Fixed start of the Lanczos iteration, so that a run repeats to the last bit."""
    return np.random.default_rng(0).standard_normal(size)


def eigenvalues(frequency: float, scheme: Scheme) -> Complex:
    """Eigenvalues of the step's operator on (D, dt V, dt^2 A) of one free mode, the complex pair first.

    The operator is made by applying the scheme's own step to unit states.
    """
    dt = scheme.step
    one = csr_array(np.eye(3))  # the mode three times, from each unit state
    D, V, A = np.eye(3)
    end = Stepper(one, frequency**2 * one, np.zeros(3), scheme).advance(Motion(D, V / dt, A / dt**2))
    roots = np.linalg.eigvals(np.array([end.D, dt * end.V, dt**2 * end.A])).astype(complex)
    return principal_first(roots)


def highest_frequency(problem: Problem, full: bool = False, model: Model | None = None) -> float:
    """Largest natural frequency of the mesh [rad/s], which limits a conditionally stable scheme."""
    model = build(problem, full) if model is None else model
    return largest_frequency(model.K, model.M)


def largest_frequency(K: csr_array, M: csr_array) -> float:
    """Largest natural frequency of M D'' + K D = 0 [rad/s]; an `OverflowError` beyond double precision."""
    size = K.shape[0]
    if not (np.isfinite(K.data).all() and np.isfinite(M.data).all()):
        raise OverflowError("mass or stiffness of the elements is out of range")
    if size <= DENSE:
        return float(np.sqrt(eigh(K.toarray(), M.toarray(), eigvals_only=True)[-1]))
    largest = eigsh(csc_array(K), 1, csc_array(M), which="LA", v0=_start_vector(size), return_eigenvectors=False)
    return float(np.sqrt(largest[0]))
