"""Histories, statics and modes of a system of blocks; a step is that of `dda.system.step`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from time import perf_counter

import numpy as np

from dda.contact.rows import laws_of
from dda.contact.unilateral import Unilateral
from dda.march.step import March, course_of
from dda.model.arrays import Array
from dda.model.load import BaseMotion
from dda.one_block.modes import Mode, modes_of
from dda.one_block.solution import Result, check_damping, check_request, linear_result
from dda.scheme import harmonic
from dda.scheme.harmonic import largest_frequency
from dda.scheme.newmark import Scheme
from dda.scheme.stage import plain_stage
from dda.system.step import glued_march, run_glued
from dda.system.system import BlockSystem, Equations

ROUNDING = 1e-12  # of the largest share, below which a mode has none


def solve_system(
    system: BlockSystem,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    full: bool = False,
) -> Result:
    """Step a system of blocks from rest and return the asked columns.

    Parameters
    ----------
    steps : int
        Number of steps.
    columns : sequence of str
        Any of `dda.COLUMNS`, at the system's observed point.
    full : bool
        Keep all unknowns, also those that no load can reach.

    Raises
    ------
    ValueError
        If the number of steps is not positive or a column is unknown.
    """
    import scipy.sparse.linalg  # noqa: F401  (before the clock starts)

    check_request(steps, columns)
    check_damping(scheme, system.motion is not None)
    began = perf_counter()
    equations = system.equations if full else system.reached
    return stepped(system, equations, scheme, steps, columns, equations.rows(columns), began)


def stepped(
    system: BlockSystem,
    equations: Equations,
    scheme: Scheme,
    steps: int,
    names: Sequence[str],
    rows: tuple[Array, Array],
    began: float,
) -> Result:
    """Step a system from rest and return what some rows, of z and of the joint forces, observe of it.

    Parameters
    ----------
    equations
        In the unknowns that are kept.
    began
        When the set-up began [s].
    """
    by_modes, by_force = rows
    if scheme.damped:  # of springs and dashpots together, of which the springs' own force is read from z
        by_modes = by_modes + (equations.B.T @ (equations.kappa @ by_force.T)).T
        by_force = 0 * by_force
    none = np.zeros((0, equations.shapes.shape[0]))
    laws = laws_of(Unilateral(1.0), 0, 0, 1)
    march = glued_march(equations, system.load_size, scheme, laws, none, (by_modes, by_force), False, steps)
    solvers = [march.method.solver(plain_stage(stage), 1.0) for stage in scheme.stages]
    ready = perf_counter()
    total = len(system.equations.k)
    unknowns = len(equations.k)
    return linear_result(
        scheme,
        (began, ready),
        names,
        observed_steps(march, system.motion, steps),
        system.load_size,
        unknowns=unknowns,
        nonzeros=solvers[-1].nonzeros,
        factorisations=len(solvers),
        solves=steps * sum(1 + solver.corrections for solver in solvers),
        notes=() if unknowns == total else (f"{unknowns} of {total} unknowns kept",),
    )


def observed_steps(march: March, motion: BaseMotion | None, steps: int) -> Array:
    """Return what is observed of every step from rest, (columns, steps)."""
    moved = np.zeros(2) if motion is None else motion.at([0.0])[0]
    history, _ = run_glued(march, course_of(motion, 0.0), steps, np.zeros(0), 0 * march.method.k, moved)
    return history.motion[1:].T.copy()


def static_system(system: BlockSystem) -> dict[str, float]:
    """Return the value of every column at rest under the constant loads, on the base's last position."""
    equations = system.reached
    names = (*equations.observers, "contact_pressure")
    by_modes, by_force = equations.rows(names)
    last = np.zeros(2) if system.motion is None else system.motion.at([math.inf])[0] / system.load_size
    z, force = equations.at_rest(equations.F, equations.G @ last)
    values = (by_modes @ z + by_force @ force) * system.load_size + 0.0
    return dict(zip(names, values.tolist(), strict=True))


def system_modes(system: BlockSystem, scheme: Scheme, count: int = 12, full: bool = False) -> tuple[Mode, ...]:
    """Return modes of a system, the largest static share first.

    Parameters
    ----------
    count : int
        Number of lowest modes; doubled until the mode of the largest share is among them.
    full : bool
        Count the modes that no load can reach as well.
    """
    equations = system.equations if full else system.reached
    F = _pushed(system, equations)
    z, _ = equations.at_rest(F, np.zeros(len(equations.pressure)))
    while True:
        squares, shapes, forces = lowest_modes(equations, count)
        shares = (shapes.T @ F) ** 2 / (squares * (F @ z))
        if len(squares) < count or np.max(shares) > 1 - np.sum(shares):
            break
        count *= 2
    carried = (equations.pressure @ forces) * (shapes.T @ F) / squares
    counted = np.where(shares > ROUNDING * np.max(shares), shares, 0.0)  # of no share: by their frequency
    return modes_of(scheme, np.sqrt(squares), shares, carried, np.lexsort((squares, -counted)))


def _pushed(system: BlockSystem, equations: Equations) -> Array:
    """Return the load that shares refer to: the constant one, else M R of the moving base, else a weight."""
    if np.any(equations.F):
        return equations.F
    axes = np.array([0.0, 1.0, 0.0])
    if system.motion is not None and np.any(system.motion.displacement):
        axes[:2] = np.any(np.asarray(system.motion.displacement) != 0, axis=0)
    return np.asarray(equations.rigid @ axes)


def lowest_modes(equations: Equations, count: int) -> tuple[Array, Array, Array]:
    """Return the lowest w^2, their normalised shapes and the joint forces of the shapes.

    K^-1 is applied by the saddle-point solver, so that stiff joints cost no digits.
    """
    from scipy.linalg import eigh
    from scipy.sparse.linalg import LinearOperator, eigsh

    n = len(equations.k)
    still = np.zeros(len(equations.pressure))

    def flexibility(right: Array) -> Array:
        return equations.at_rest(np.ravel(right), still)[0]

    if n <= harmonic.DENSE or count >= n - 1:
        values, shapes = eigh(np.array([flexibility(unit) for unit in np.eye(n)]))
    else:
        start = np.random.default_rng(0).standard_normal(n)
        values, shapes = eigsh(LinearOperator((n, n), matvec=flexibility, dtype=float), count, v0=start)
    order = np.argsort(-values)[:count]
    squares = 1 / values[order]
    shapes = shapes[:, order]
    forces = [equations.at_rest(w2 * phi, still)[1] for w2, phi in zip(squares, shapes.T, strict=True)]
    return squares, shapes, np.array(forces).T


def highest_frequency(system: BlockSystem) -> float:
    """Return the largest natural frequency [rad/s], which limits a conditionally stable scheme."""
    from scipy.sparse import diags_array, eye_array

    e = system.reached
    K = diags_array(e.k) + e.B.T @ e.kappa @ e.B
    return largest_frequency(K.tocsr(), eye_array(len(e.k), format="csr"))
