r"""One block over corners that open, as a body in its free modes and as rows of contact.

Of the unknowns of `dda.one_block.unilateral_form` the gaps, and the mean way of the base where it has springs in shear,
are read from the rows of contact, which no rounding of a larger motion reaches; all others follow from the modes. In a
symmetric motion one row stands for both corners, with twice their forces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dda.contact.rows import INSIDE, LOWER, rows_of
from dda.march.step import Body, History, State
from dda.model.arrays import Array
from dda.model.load import BaseMotion, load_share
from dda.one_block.natural_modes import free_modes
from dda.one_block.unilateral_form import UnilateralForm
from dda.scheme.newmark import Scheme, initial_acceleration, late_momentum


@dataclass(frozen=True, eq=False)
class OpeningBlock:
    """A block in its free modes, x = shapes z, and its rows of contact."""

    form: UnilateralForm
    body: Body
    shapes: Array  # (n, modes) unknowns by the modes; zero where they are read from the rows
    read: Array  # (n, rows) unknowns by the ways of the rows
    momentum: Array  # (modes,) modal momentum of a rigid translation by 1 m/s away from the base
    translation: Array  # (2, modes) momentum along and away from the base by modal velocities [kg m/s]


def opening_block(form: UnilateralForm) -> OpeningBlock:
    """Return a block in its free modes."""
    k, shapes = free_modes(form.M, form.K)
    n = len(k)
    rows = form.B @ shapes
    c = form.contacts
    m = len(rows)
    ground = np.zeros((m, 2))
    ground[:c, 1] = 1.0
    ground[c:, 0] = 1.0
    read = np.zeros((n, m))
    read[n - c :, :c] = np.eye(c)
    if m == 2 * c and c == 2:
        read[form.unknowns.index("U"), c:] = 0.5
    seen = np.any(read != 0, axis=1)
    body = Body(
        k=k,
        loads=(shapes.T @ form.F)[None],
        stored=np.ones(1),
        first=np.zeros(m, dtype=np.int64),
        weight=rows,
        ground=ground,
        mobility=np.ones(n),
    )
    moved = form.axes.T @ form.translation.T @ form.M @ shapes
    return OpeningBlock(form, body, np.where(seen[:, None], 0.0, shapes), read, shapes.T @ form.M @ form.translation, moved)


def start_of(block: OpeningBlock, scheme: Scheme, gap: float, velocity: float, at_once: bool) -> State:
    """Return the state at t = 0: unstrained, without contact force, the corners at the starting gap.

    Parameters
    ----------
    at_once
        Whether the block starts with the acceleration of its load, whatever the scheme says.
    """
    dt = scheme.step
    form = block.form
    m = len(form.B)
    R = load_share(form.ramp, 0.0) * (dt * dt * block.body.loads[0])
    a = R if at_once else initial_acceleration(scheme, R)
    p = late_momentum(scheme, (dt * velocity) * (block.momentum @ form.axes[:, 1]), a)
    opening = np.zeros(m)
    opening[: form.contacts] = gap
    rows = rows_of(opening, np.where(opening > 0, LOWER, INSIDE))
    return State(np.zeros(len(p)), p, a.copy(), R, np.zeros(m), rows)


def unknowns_of(block: OpeningBlock, history: History, motion: BaseMotion | None, step: float) -> Array:
    """Return the unknowns from t = 0 on, measured from the base, (n, steps + 1)."""
    return np.array([observed(block, row, history, motion, step) for row in np.eye(len(block.shapes))])


def observed(block: OpeningBlock, row: Array, history: History, motion: BaseMotion | None, step: float) -> Array:
    """Return what a row over the unknowns observes from t = 0 on, measured from the base, (steps + 1,)."""
    form = block.form
    c = form.contacts
    read = row @ block.read
    parts = [(history.motion, row @ block.shapes), (history.opening, read), (history.path, read[c:])]
    total = np.zeros(len(history.solves))
    for values, weights in parts:
        for j in np.flatnonzero(weights):
            total += weights[j] * values[:, j]
    if motion is not None and "U" in form.unknowns and len(form.B) == c:  # which no row of contact measures
        moved = motion.along(form.axes).at(step * np.arange(float(len(total))))
        total -= row[form.unknowns.index("U")] * moved[:, 0]
    return total
