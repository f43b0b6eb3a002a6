r"""The contact problem of a step where contacts are many: equations of the blocks, a sparse matrix of small blocks.

With the increments x of the modes by forces of contact, s the modes' stiffness in a step and rows as in
`dda.contact.rows`, the forces of closed contacts and of those that slip are functions of x,

    s x = sum F' lambda,      N = -(q_n + B_n x) / c_n,      T = -(q_t + B_t x) beta / c_t  or  +-(tan(phi) N + c),

and are put in. That costs digits of stiff springs, whose force is the small rest of a gap over a small c: once the
states are found, the equilibrium that is left over is solved for again with the same factors, and its forces are added,
so that forces keep the digits which the equilibrium gives them.

All states are updated together. Where that does not end, sweeps of exact solutions contact by contact (Gauss and
Seidel) give the states from which the next solves go on. Frictionless contacts have one answer; of many with friction
nothing is guaranteed, and what does not end is cut.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dda.contact.dense import Vector, copy
from dda.contact.rows import (
    FOUND,
    INSIDE,
    LOWER,
    NONE,
    UPPER,
    Laws,
    Rows,
    Work,
    along,
    crossing_share,
    is_smooth,
    next_state,
    shear_limit,
    write_at_bound,
)
from dda.march.step import Length
from dda.plane.bodies import Blocks
from dda.plane.elimination import (
    MISSING,
    THREE,
    BlockMatrix,
    block_matrix,
    clear_blocks,
    clear_pattern,
    factor_blocks,
    order_blocks,
    solve_blocks,
)
from dda.plane.places import Places, contact_displacement, flexibility_of, push_contacts

TOGETHER = 8  # solves in which all states are updated at once
RESTARTS = 6  # of sweeps, each longer than the last one
SWEEPS = 60
SLACK = 1e-13  # of a block's size: gaps and slips of many contacts are uncertain by rounding
CROSSINGS = 40  # of Newton's method on the share of a contact that closes, which takes about five
CROSSED = 1e-11  # change of that share in its last step
LEAST_SHARE = 1e-12
AT_LIMIT = 1e-9  # of the limit along the edge, below which a contact slips after a sweep
STIFFEST = 1e300  # 1/s^2
FILL = 120  # blocks of the factors for each row of them for which there is room


class Many(NamedTuple):
    """The equations of the blocks that move, whose modes are three of a row of the matrix each."""

    blocks: Blocks
    places: Places
    slack: float  # [m]
    matrix: BlockMatrix
    x: Vector  # (n,) increments of the modes by forces of contact
    rest: Vector  # (n,) forces of the equilibrium that is left over, then what these add to x
    kappa: Vector  # (c,) what N changes of the ways of contacts that close
    normal: Vector  # (c,) N about which that is linear [N]
    known: Any  # (1,) how many blocks the factors have


def many_of(blocks: Blocks, places: Places, size: float) -> Many:
    """Return room for the equations of these contacts; the smallest block has that size [m]."""
    x, rest = np.zeros((2, int(blocks.modes.sum())))
    kappa, normal = np.zeros((2, len(places.law)))
    rows = len(x) // THREE
    return Many(
        blocks=blocks,
        places=places,
        slack=SLACK * size,
        matrix=block_matrix(rows, min(rows * rows, FILL * rows)),
        x=x,
        rest=rest,
        kappa=kappa,
        normal=normal,
        known=np.zeros(1, dtype=np.int64),
    )


def set_pattern(many: Many) -> bool:
    """Order the bodies for the present contacts, where one is between two that have none; tell if there is room.

    Blocks of pairs that touch no more are kept until then: they cost time alone.
    """
    if mark_pairs(many) or many.known[0] <= 0:
        clear_pattern(many.matrix)
        mark_pairs(many)
        many.known[0] = order_blocks(many.matrix)
    return bool(many.known[0] > 0)


def mark_pairs(many: Many) -> bool:
    """Name the blocks of bodies that touch; tell whether any had none."""
    number = many.matrix.number
    missing = False
    for k in range(many.places.count[0]):
        sides = many.places.sides[k]
        for side in range(2):
            for row in rows_of(many, sides[side]):
                for opposite in range(2):
                    for column in rows_of(many, sides[opposite]):
                        if number[row][column] == MISSING:
                            number[row][column] = 0
                            missing = True
    return missing


def rows_of(many: Many, i: int) -> range:
    """Return which rows of the matrix are of a block."""
    first = many.blocks.first[i]
    return range(first // THREE, (first + many.blocks.modes[i]) // THREE)


def find_many(
    many: Many, laws: Laws, before: Rows, length: Length, after: Rows, work: Work, again: bool
) -> tuple[int, int]:
    """Find states, forces and openings, as `dda.contact.rows.find` does; return the outcome and the number of solves.

    Parameters
    ----------
    again
        Whether the rows after the step are those of the round before, whose states are tried first.
    """
    copy(after.state if again else before.state, work.tried)
    for k in range(laws.contacts):
        if laws.compliance[k] == 0:  # a rigid contact, whose force is no function of its way
            return NONE, 0
    for k in range(laws.contacts):
        if many.places.over[k] == 0:  # it carries nothing, and its gap is too large to be solved with
            work.tried[k] = LOWER
            work.tried[laws.contacts + k] = INSIDE
    if not set_pattern(many):
        return NONE, 0
    solves = 0
    for restart in range(RESTARTS + 1):
        if restart > 0:
            sweep(many, laws, length, after, work, restart * SWEEPS)
        for _ in range(TOGETHER if restart == 0 else 2 * TOGETHER):
            spent = solve_states(many, laws, before, length, after, work)
            solves += spent
            if spent == 0:
                return NONE, solves
            if update_all(many, laws, after, work):
                refine(many, laws, length, after, work)
                return FOUND, solves
    return NONE, solves


def update_all(many: Many, laws: Laws, after: Rows, work: Work) -> bool:
    """Set all states that disagree with forces and openings by more than the slack; tell whether none does."""
    n = laws.contacts
    slack = many.slack
    agree = True
    for k in range(n):
        r = n + k
        c = laws.compliance[k]
        state = work.tried[k]
        shear_state = work.tried[r]
        lower = laws.lower[k]
        work.tried[k] = next_state(
            state, after.force[k], work.z[k], c, lower, laws.upper[k], laws.opens[k], 0.0, slack / c
        )
        if work.tried[k] != state:
            work.tried[r] = INSIDE  # what opens or closes begins anew
        elif state == INSIDE and laws.slips and not is_smooth(laws, k):
            work.tried[r] = along(laws, after, work, k, work.z[r], slack)
        if work.tried[k] != state or work.tried[r] != shear_state:
            agree = False
    return agree


# ---- one solve -------------------------------------------------------------------------------------------------------


def closes(laws: Laws, before: Rows, work: Work, k: int) -> bool:
    """Tell whether a contact that sticks closes in the step, so that a share of its way counts."""
    r = laws.contacts + k
    shut = work.tried[k] == INSIDE and work.tried[r] == INSIDE
    return bool(shut and before.state[k] != INSIDE and before.opening[k] > 0 and not is_smooth(laws, k))


def solve_states(many: Many, laws: Laws, before: Rows, length: Length, after: Rows, work: Work) -> int:
    """Write the rows in the states `work.tried`; return the number of solves, zero where they have no solution."""
    n = laws.contacts
    closing = False
    for k in range(n):
        work.beta[k] = 1.0
        many.kappa[k] = 0.0
        closing = closing or closes(laws, before, work, k)
    solves = 0
    settled = False
    while not settled and solves < CROSSINGS:
        solves += 1
        assemble(many, laws, length, work)
        if not factor_blocks(many.matrix):
            return 0
        for i in range(len(many.x)):
            many.x[i] = 0.0
        add_forces(many, laws, work, after, many.x, 1.0)
        correct(many, length, after)
        add_forces(many, laws, work, after, many.x, 1.0)  # one difference, which rounds less than two forces do
        settled = True
        for k in range(n):
            if not closing or not closes(laws, before, work, k):
                continue
            N = after.force[k]
            share = max(crossing_share(laws, before.opening[k], k, N), LEAST_SHARE)
            if abs(share - work.beta[k]) > CROSSED * share:
                settled = False
            displacement = opening_of(many, work, n + k)
            many.kappa[k] = (after.force[n + k] * laws.compliance[n + k] + displacement) / N if N > 0 else 0.0
            many.normal[k] = N
            work.beta[k] = share
    for r in range(2 * n):
        after.state[r] = work.tried[r]
        after.slip[r] = 0.0
        after.opening[r] = 0.0 - after.force[r] * laws.compliance[r]
        if work.tried[r] != INSIDE:
            write_at_bound(laws, before, after, work, r, opening_of(many, work, r))
    return solves


def opening_of(many: Many, work: Work, r: int) -> float:
    """Return q + B x of a row [m]."""
    opening: float = work.q[r] + contact_displacement(many.x, many.blocks, many.places, r)
    return opening


def assemble(many: Many, laws: Laws, length: Length, work: Work) -> None:
    """Write the matrix for the states `work.tried`."""
    matrix = many.matrix
    n = laws.contacts
    clear_blocks(matrix, many.known[0])
    for mode in range(len(many.x)):
        row = mode // THREE
        matrix.blocks[matrix.number[row][row]][mode % THREE][mode % THREE] = stiffness_of(length, mode)
    for k in range(n):
        if work.tried[k] != INSIDE:
            continue
        r = n + k
        shear_state = work.tried[r]
        stiffness = 1 / laws.compliance[k]
        add_row(many, k, k, k, stiffness)
        if shear_state != INSIDE:
            add_row(many, k, r, k, shear_state * laws.friction[k] * stiffness)
        elif not is_smooth(laws, k):
            shear_stiffness = work.beta[k] / laws.compliance[r]
            add_row(many, k, r, r, shear_stiffness)
            if many.kappa[k] != 0.0:  # N = -(q + B x) / c moves the share behind the crossing
                add_row(many, k, r, k, -shear_stiffness * many.kappa[k] * stiffness)


def stiffness_of(length: Length, mode: int) -> float:
    """Return s of a mode in a step [1/s^2]; explicit schemes move nothing by the forces of the step."""
    flexibility = length.numbers[3] * length.inverse[mode]
    return 1 / flexibility if flexibility > 0 else STIFFEST


def add_row(many: Many, k: int, force: int, row: int, slope: float) -> None:
    """Add a force -slope B x, which pushes by the row `force` and follows the row `row` of a contact."""
    matrix = many.matrix
    places = many.places
    sides = places.sides[k]
    for side in range(2):
        F = places.F[force][side]
        rows = rows_of(many, sides[side])
        for opposite in range(2):
            B = places.B[row][opposite]
            columns = rows_of(many, sides[opposite])
            for i in rows:
                for j in columns:
                    block = matrix.blocks[matrix.number[i][j]]
                    for e in range(THREE):
                        push = slope * F[THREE * (i - rows.start) + e]
                        for f in range(THREE):
                            block[e][f] += push * B[THREE * (j - columns.start) + f]


def add_forces(many: Many, laws: Laws, work: Work, after: Rows, x: Vector, whole: float) -> None:
    """Write the forces that increments make; where `whole` is zero, add what more increments add to them."""
    n = laws.contacts
    for k in range(n):
        r = n + k
        if whole != 0:
            after.force[k] = 0.0
            after.force[r] = 0.0
        if work.tried[k] != INSIDE:
            continue
        N = -(whole * work.q[k] + contact_displacement(x, many.blocks, many.places, k)) / laws.compliance[k]
        after.force[k] += N
        if work.tried[r] != INSIDE:
            after.force[r] += work.tried[r] * (laws.friction[k] * N + whole * laws.upper[r])
        elif not is_smooth(laws, k):
            displacement = whole * work.q[r] + contact_displacement(x, many.blocks, many.places, r)
            displacement += many.kappa[k] * (N - whole * many.normal[k])
            after.force[r] -= displacement * work.beta[k] / laws.compliance[r]


def correct(many: Many, length: Length, after: Rows) -> None:
    """Add to the increments what the equilibrium that is left over adds to them, by the factors at hand."""
    rest = many.rest
    for i in range(len(rest)):
        rest[i] = -many.x[i] * stiffness_of(length, i)
    push_contacts(many.blocks, many.places, after.force, rest)
    solve_blocks(many.matrix, rest)
    for i in range(len(rest)):
        many.x[i] += rest[i]


def refine(many: Many, laws: Laws, length: Length, after: Rows, work: Work) -> None:
    """Add the forces of the equilibrium that is left over, by the factors of the last solve."""
    correct(many, length, after)
    add_forces(many, laws, work, after, many.rest, 0.0)
    for r in range(2 * laws.contacts):
        if after.force[r] != 0.0:
            after.opening[r] = 0.0 - after.force[r] * laws.compliance[r]


def sweep(many: Many, laws: Laws, length: Length, after: Rows, work: Work, sweeps: int) -> None:
    """Solve contact after contact for its own forces, from the present ones; write the states these are in."""
    n = laws.contacts
    for i in range(len(many.x)):
        many.x[i] = 0.0
    for k in range(n):
        N = after.force[k]
        T = after.force[n + k]
        after.force[k] = 0.0
        after.force[n + k] = 0.0
        set_forces(many, laws, length, after, k, N, T)
    for number in range(sweeps):
        for step in range(n):
            k = step if number % 2 == 0 else n - 1 - step
            N = force_alone(many, laws, length, after, work, k)
            set_forces(many, laws, length, after, k, N, force_alone(many, laws, length, after, work, n + k))
    for k in range(n):
        r = n + k
        work.tried[r] = INSIDE
        work.tried[k] = INSIDE
        if laws.opens[k] == 1 and after.force[k] == 0.0:
            work.tried[k] = LOWER
            continue
        slips = laws.slips and not is_smooth(laws, k)
        if slips and abs(after.force[r]) >= shear_limit(laws, k, after.force[k]) * (1 - AT_LIMIT):
            work.tried[r] = UPPER if after.force[r] > 0 else LOWER


def force_alone(many: Many, laws: Laws, length: Length, after: Rows, work: Work, r: int) -> float:
    """Return the force by which a row would be closed, those of all others as they are [N]."""
    own = flexibility_of(many.blocks, many.places, length, r, r)
    force: float = (own * after.force[r] - opening_of(many, work, r)) / (own + laws.compliance[r])
    return force


def set_forces(many: Many, laws: Laws, length: Length, after: Rows, k: int, N: float, T: float) -> None:
    """Set the forces of a contact, within their bounds, and what they move."""
    if laws.opens[k] == 1 and not laws.lower[k] <= N:
        N = 0.0
    if is_smooth(laws, k) or (laws.opens[k] == 1 and not N > 0):
        T = 0.0
    limit = shear_limit(laws, k, N)
    push(many, length, k, N, after)
    push(many, length, laws.contacts + k, min(max(T, -limit), limit), after)


def push(many: Many, length: Length, r: int, force: float, after: Rows) -> None:
    """Set the force of a row, and what it moves."""
    change = force - after.force[r]
    after.force[r] = force
    first = many.blocks.first
    n = many.places.count[0]
    for side in range(2):
        i = many.places.sides[r if r < n else r - n][side]
        for e in range(many.blocks.modes[i]):
            mode = first[i] + e
            many.x[mode] += length.numbers[3] * length.inverse[mode] * many.places.F[r][side][e] * change
