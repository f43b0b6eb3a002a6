"""Histories of a system of blocks; a step is that of `dda.bodies.glued_step`."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter

import numpy as np

from dda.bodies.block_system import BlockSystem, Equations
from dda.bodies.glued_step import glued_march, run_glued
from dda.contact.rows import laws_of
from dda.contact.unilateral import Unilateral
from dda.march.step import March, course_of
from dda.model.arrays import Array, ArrayPair
from dda.model.checks import check_damping
from dda.model.load import BaseMotion
from dda.result.result import Result, check_request, linear_result
from dda.scheme.newmark import Scheme
from dda.scheme.stage import plain_stage


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
    check_damping(scheme.damped, system.motion is not None)
    began = perf_counter()
    equations = system.equations if full else system.reached
    return stepped(system, equations, scheme, steps, columns, equations.rows(columns), began)


def stepped(
    system: BlockSystem,
    equations: Equations,
    scheme: Scheme,
    steps: int,
    names: Sequence[str],
    rows: ArrayPair,
    began: float,
) -> Result:
    """Step a system from rest, set up since an instant [s]; return what rows, of z and of the joint forces, observe."""
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
