r"""Histories of the block in a small space, a few matrix products instead of a loop over the steps.

In the basis of a `KrylovSpace` the step's matrix S is 1 and the inertia T; turned to the eigenvectors
of T the reduced block falls into single modes with inertia tau, stiffness kappa = 1 - tau (times
alpha dt^2) and S = 1 again. A step is an affine map of (D, dt V, dt^2 A), made by applying the scheme's
own step to unit states, whose powers give all steps (`fem_reference.scheme.modal`).

The space is enlarged until the history no longer changes; the last change is the estimate of the error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh_tridiagonal

from fem_reference.history.krylov import KrylovSpace
from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme.modal import affine_step, applicable, power_histories, roots
from fem_reference.scheme.newmark import Stepper
from fem_reference.scheme.stage import Body

TOLERANCE = 3e-11
"""Change of the history, over its maximum, at which a space is large enough."""
HALFWAY = 1e-2
"""Change that half of the greatest space must have reached; the convergence is faster than linear from there."""
FLOOR = 2e-13
"""Rounding of a history, over its maximum: no estimate is below."""
LIGHTEST = 1e-6
"""Least inertia of a mode, as a share of S, that a consistent start may divide the load by: it holds rounding / tau."""
CANCELLED = 1e-11
"""Rounding of a column, over its maximum, beyond which it must be stepped."""
FEWEST = 8
LARGEST = 400
"""Least and greatest number of vectors."""
SLOW = 0.1
"""kappa below which 1 - tau is formed again where digits count."""
PAID = 4
"""Steps that a vector must save: it costs about a step and a half."""


@dataclass(frozen=True)
class Reduced:
    """A history from a small space."""

    history: Array  # columns of every step, shape (columns, steps)
    vectors: int  # of the space [-]
    estimate: float  # estimated error over the maximum value [-]


def reduced(stepper: Stepper, rows: Array, steps: int) -> Reduced | str:
    """History under a constant load in the smallest sufficient space, or why there is none, in words.

    The columns are observed by `rows`, shape (columns, unknowns).
    """
    if reason := applicable(stepper.scheme):
        return reason
    if any(solve is not stepper.solve for solve in stepper.solves):
        return "the stages of the scheme have different matrices"
    capacity = min(LARGEST, len(stepper.F), steps // PAID)
    if capacity < min(FEWEST, len(stepper.F)):
        return "few steps"
    space = KrylovSpace(stepper.M, stepper.S, stepper.F, stepper.solve, capacity)
    duals = np.sqrt([row @ stepper.solve(row) for row in rows])
    histories: list[Array] = []
    changes = []
    size = 0
    while size < capacity:
        size = min(capacity, size + max(FEWEST, size // 8))
        space.grow(size)
        modes = modes_of(space, stepper, rows, steps)
        if stepper.scheme.start == "consistent" and np.min(modes.inertia) < LIGHTEST:
            return "a consistent start needs digits of the inertia that a small space loses in long steps"
        histories = [*histories[-1:], history(modes, stepper.scheme, steps)]
        changes += [_change(*histories)] if len(histories) == 2 else []
        converged = len(changes) > 1 and changes[-1] <= TOLERANCE + modes.rounding
        if (space.closed or converged) and _cancelled(modes, histories[-1], duals, stepper.scheme) > CANCELLED:
            return "rounding in a small space is too large for a column that has hardly moved, or under a stiff spring"
        if space.closed or converged:
            return Reduced(histories[-1], len(space), modes.rounding + (0.0 if space.closed else changes[-1]))
        if capacity < len(stepper.F) and 2 * size >= capacity and min(changes, default=1.0) > HALFWAY:
            break
    return f"{len(space)} Krylov vectors do not represent the history"


def _change(before: Array, after: Array) -> float:
    """Greatest change of a column over its maximum; columns that stay at rest do not count."""
    largest = np.max(np.abs(after), axis=1)
    moving = largest > 0
    return float(np.max(np.max(np.abs(after - before), axis=1)[moving] / largest[moving], initial=0.0))


def _cancelled(modes: Modes, history: Array, duals: Array, scheme: Scheme) -> float:
    """Rounding of the modes' shapes in a column over its maximum.

    A shape is right to one rounding of its own size in the norm of S; a row sees that times its dual norm
    (row' S^-1 row)^1/2, and the motion is about as large as the static one.
    """
    size = np.linalg.norm(modes.load * scheme.stages[0].stiffness_weight / modes.stiffness)
    largest = np.max(np.abs(history), axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.nanmax(np.finfo(float).eps * duals * size / largest, initial=0.0))


@dataclass(frozen=True)
class Modes:
    """Modes of the reduced block, S = 1."""

    inertia: Array  # tau [-], shape (modes,)
    stiffness: Array  # kappa = 1 - tau, alpha dt^2 times the stiffness [-]
    load: Array  # dt^2 times the load
    observed: Array  # what each mode adds to each column, shape (columns, modes)
    rounding: float  # rounding of a history, over its maximum [-]


def modes_of(space: KrylovSpace, stepper: Stepper, rows: Array, steps: int) -> Modes:
    """Modes of a space; `rows` observe the columns."""
    size = len(space)
    scheme = stepper.scheme
    tau, turn = eigh_tridiagonal(space.diagonal, space.beside[: size - 1])
    tau, kappa = np.maximum(tau, np.finfo(float).tiny), 1 - tau
    vectors = space.vectors[:size]
    # The largest tau is that of the slowest mode, whose stiffness 1 - tau has lost most.
    loss = _phase_error(float(kappa[-1]), float(_stiffness(stepper, turn[:, -1:].T @ vectors)[0]), scheme, steps)
    if loss > TOLERANCE:
        slow = kappa < SLOW
        kappa[slow] = _stiffness(stepper, turn.T[slow] @ vectors)
    return Modes(tau, kappa, scheme.step**2 * space.load * turn[0], (rows @ vectors.T) @ turn, FLOOR + 10 * loss)


def _phase_error(kappa: float, exact: float, scheme: Scheme, steps: int) -> float:
    """Phase that a mode loses before it is damped because its stiffness has lost digits, as plain steps lose them."""
    if exact >= 1:  # to rounding: the slowest mode is infinitely fast for the step, and has no phase to lose
        return 0.0
    digits = max(abs(kappa - exact) / exact, np.finfo(float).eps / exact)
    omega = np.sqrt(exact / scheme.stages[0].stiffness_weight / (1 - exact))
    modulus = float(abs(roots(float(omega), scheme)[0]))
    lasting = min(steps, 1 / (1 - modulus)) if modulus < 1 else steps
    return float(digits * omega / 2 * lasting)


def _stiffness(stepper: Stepper, shapes: Array) -> Array:
    """Alpha dt^2 x' K x of shapes x, one a row, in extended precision."""
    extended = shapes.astype(np.longdouble)
    forces = (stepper.K.astype(np.longdouble) @ extended.T).T
    scale = stepper.scheme.stages[0].stiffness_weight * stepper.scheme.step**2
    return np.asarray((scale * np.sum(extended * forces, axis=1)).astype(float))


def history(modes: Modes, scheme: Scheme, steps: int) -> Array:
    """Columns of every step from rest, shape (columns, steps)."""
    tau = modes.inertia.astype(np.longdouble)
    K = modes.stiffness.astype(np.longdouble) / scheme.stages[0].stiffness_weight
    bodies = [Body(tau, None, K, 1.0)] * len(scheme.stages)
    return power_histories(*affine_step(scheme, bodies, np.ones_like(tau)), modes.observed * modes.load, steps)
