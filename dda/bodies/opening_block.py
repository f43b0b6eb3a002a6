r"""One block over corners that open, as a body in its free modes and as rows of contact.

Its unknowns are those of `dda.bodies.gap_form` without the springs: mean way U and mean gap w of the base, its
rotation s, and the strains ex, e2, gxy, on which alone its own stiffness acts, K = A diag(E', lambda + 2 G, G). The
rows of contact are the gaps w -+ (a/2) s of its corners M and N and their ways U -+ (a/2) ex along the base, these as
mean and difference. So w and s, and U where the corners have springs in shear, are read from the rows, which no
rounding of a larger motion reaches; all else follows from the modes.

What neither loads nor contact forces reach is dropped. In a symmetric motion nothing reaches U and s: one row then
stands for both corners, with twice their forces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dda.bodies.gap_form import GapForm, elastic_stiffness, gap_form
from dda.contact.rows import INSIDE, LOWER
from dda.contact.springs import Contact, base_axes
from dda.linear.natural_modes import free_modes
from dda.march.step import Body, History, State, state_of
from dda.model.arrays import Array
from dda.model.load import BaseMotion, LoadedBlock
from dda.scheme.newmark import Scheme, initial_acceleration, late_momentum

U, W, S, EX, E2, GXY = range(6)  # numbers of the unknowns
SYMMETRIC = (EX, E2, W)  # of a symmetric motion


@dataclass(frozen=True, eq=False)
class OpeningBlock:
    """M x'' + K x = F + multiplicity B' lambda of a block in n unknowns, and its free modes, x = shapes z."""

    form: GapForm  # names of x, M and F; its springs are not there
    B: Array  # (m, n) rows of contact: gaps, then ways
    ramp: float  # time in which the load rises from zero [s]
    axes: Array  # (2, 2) unit tangent of the base from M to N, and its normal into the block
    contacts: int  # 1 or 2
    multiplicity: float  # corners that a contact stands for
    start: Array  # (n,) x at t = 0
    translation: Array  # (n, 2) x of a rigid translation by 1 m along the base and away from it
    body: Body
    shapes: Array  # (n, n) unknowns by the modes; zero where they are read from the rows
    read: Array  # (n, m) unknowns by the ways of the rows
    momentum: Array  # (2, n) of a translation along the base and away from it, by the modal velocities


def opening_block(model: LoadedBlock, velocity: float = 0.0, full: bool = False) -> OpeningBlock:
    """Return one block over corners that open; `velocity` only tells what moves, `full` keeps all unknowns."""
    block = model.block
    load = model.load
    a = model.base_length
    axes = base_axes(block, model.base)
    form = gap_form(block, Contact(1.0), model.base, model.top, load)  # of its springs nothing is used below
    pushed = form.F + velocity * (form.M[:, :2] @ axes[:, 1])
    if load.motion is not None:
        pushed = np.abs(pushed) + np.sum(np.abs(form.M @ form.R), axis=1)
    moving = form.reached_from(pushed != 0)
    both = full or np.any(moving[[U, S, GXY]])
    symmetric = SYMMETRIC if moving[EX] else SYMMETRIC[1:]
    kept = np.arange(6) if both else np.array(symmetric)
    form = form.restricted(kept)
    slide, gaps = form.corners.transpose(0, 2, 1)
    ways = np.array([(slide[0] + slide[1]) / 2, slide[1] - slide[0]])
    if not both:
        gaps = gaps[1:]
        ways = slide[1:]
    if not (model.contact.shear and EX in kept):  # without that strain the corners do not slide
        ways = ways[:0]
    c = len(gaps)
    B = np.vstack([gaps, ways])
    read = np.zeros((6, len(B)))
    read[W, :c] = 1 / c
    if both:
        read[S, :c] = -1 / a, 1 / a
        read[U, c:] = 0.5
    read = read[kept]
    k, shapes = free_modes(form.M, elastic_stiffness(block.material, block.section.area)[kept])
    across = np.arange(len(B)) < c
    translation = np.eye(6, 2)[kept]
    body = Body(
        k=k,
        loads=(shapes.T @ form.F)[None],
        stored=np.ones(1),
        first=np.zeros(len(B), dtype=np.int64),
        weight=B @ shapes,
        ground=np.column_stack([~across, across]).astype(float),
        mobility=np.ones(len(k)),
    )
    return OpeningBlock(
        form=form,
        B=B,
        ramp=load.ramp,
        axes=axes,
        contacts=c,
        multiplicity=2.0 / c,
        start=model.contact.gap * translation[:, 1],
        translation=translation,
        body=body,
        shapes=np.where(np.any(read != 0, axis=1)[:, None], 0.0, shapes),
        read=read,
        momentum=translation.T @ form.M @ shapes,
    )


def start_of(block: OpeningBlock, scheme: Scheme, gap: float, velocity: float, at_once: bool = False) -> State:
    """Return the state at t = 0: unstrained, without contact force, at the starting gap, with a velocity upwards [m/s].

    The block starts with the acceleration of its load `at_once`, or else as the scheme says.
    """
    dt = scheme.step
    R = (0.0 if block.ramp else dt * dt) * block.body.loads[0]
    a = R.copy() if at_once else initial_acceleration(scheme, R) + 0.0
    p = late_momentum(scheme, (dt * velocity) * (block.axes[:, 1] @ block.momentum), a)
    opening = np.zeros(len(block.B))
    opening[: block.contacts] = gap
    state = state_of(len(p), opening, np.where(opening > 0, LOWER, INSIDE))
    return state._replace(p=p, a=a, R=R)


def observed(block: OpeningBlock, row: Array, history: History, motion: BaseMotion | None, step: float) -> Array:
    """Return what a row over the unknowns observes from t = 0 on, measured from the base, (steps + 1,)."""
    c = block.contacts
    read = row @ block.read
    total = history.motion[:, : len(block.shapes)] @ (row @ block.shapes) + history.opening @ read
    total += history.path @ read[c:]
    if motion is not None and "U" in block.form.unknowns and len(block.B) == c:  # which no row of contact measures
        moved = motion.along(block.axes).at(step * np.arange(len(total)))
        total -= row[block.form.unknowns.index("U")] * moved[:, 0]
    return total
