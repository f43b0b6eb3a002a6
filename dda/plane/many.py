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

from dda.contact.dense import Matrix, Vector, copy
from dda.contact.rows import (
    FOUND,
    INSIDE,
    LOWER,
    NONE,
    ROUNDING,
    UPPER,
    Laws,
    Rows,
    Work,
    crossing_share,
    is_smooth,
    shear_limit,
)
from dda.march.step import Length
from dda.plane.bodies import Blocks
from dda.plane.elimination import (
    MISSING,
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
FILL = 60  # blocks of the factors for each body for which there is room


class Many(NamedTuple):
    """The equations of the blocks that move."""

    matrix: BlockMatrix
    body: Any  # (b,) number among those that move; MISSING of a fixed one
    right: Matrix  # (moving, m) right-hand side and solution
    x: Vector  # (n,) increments of the modes by forces of contact
    residual: Vector  # (n,)
    kappa: Vector  # (c,) what N changes of the ways of contacts that close
    normal: Vector  # (c,) N about which that is linear [N]
    known: Any  # (1,) how many blocks the factors have


def many_of(blocks: Blocks, contacts: int) -> Many:
    """Return room for the equations of so many contacts."""
    modes = np.diff(blocks.first)
    moving = np.flatnonzero(modes)
    body = np.full(len(modes), MISSING)
    body[moving] = np.arange(len(moving))
    n = len(moving)
    m = int(modes.max())
    total = int(blocks.first[-1])
    return Many(
        matrix=block_matrix(n, m, min(n * n, FILL * n)),
        body=body,
        right=np.zeros((n, m)),
        x=np.zeros(total),
        residual=np.zeros(total),
        kappa=np.zeros(contacts),
        normal=np.zeros(contacts),
        known=np.zeros(1, dtype=np.int64),
    )


def set_pattern(many: Many, places: Places) -> bool:
    """Order the bodies for the present contacts, where one is between two that have none; tell if there is room.

    Blocks of pairs that touch no more are kept until then: they cost time alone.
    """
    number = many.matrix.number
    known = many.known[0] > 0
    for k in range(places.count[0]):
        i = many.body[places.sides[k][0]]
        j = many.body[places.sides[k][1]]
        if i >= 0 and j >= 0 and number[i][j] == MISSING:
            known = False
    if known:
        return True
    clear_pattern(many.matrix)
    for k in range(places.count[0]):
        i = many.body[places.sides[k][0]]
        j = many.body[places.sides[k][1]]
        if i >= 0 and j >= 0:
            number[i][j] = 0
            number[j][i] = 0
    many.known[0] = order_blocks(many.matrix)
    return bool(many.known[0] > 0)


def find_many(
    many: Many,
    blocks: Blocks,
    places: Places,
    laws: Laws,
    before: Rows,
    length: Length,
    after: Rows,
    work: Work,
    size: float,
    again: bool,
) -> tuple[int, int]:
    """Find states, forces and openings, as `dda.contact.rows.find` does; return the outcome and the number of solves.

    Parameters
    ----------
    size
        Of the smallest block [m].
    again
        Whether the rows after the step are those of the round before, whose states are tried first.
    """
    slack = SLACK * size
    if again:
        copy(after.state, work.tried)
    else:
        copy(before.state, work.tried)
    for k in range(laws.contacts):
        if places.over[k] == 0:  # it carries nothing, and its gap is too large to be solved with
            work.tried[k] = LOWER
            work.tried[laws.contacts + k] = INSIDE
    if not set_pattern(many, places):
        return NONE, 0
    solves = 0
    for restart in range(RESTARTS + 1):
        if restart > 0:
            sweep(many, blocks, places, laws, before, length, after, work, restart * SWEEPS)
        for _ in range(TOGETHER if restart == 0 else 2 * TOGETHER):
            spent = solve_states(many, blocks, places, laws, before, length, after, work)
            solves += spent
            if spent == 0:
                return NONE, solves
            if update_all(laws, after, work, slack) == 0:
                refine(many, blocks, places, laws, length, after, work)
                return FOUND, solves
    return NONE, solves


def update_all(laws: Laws, after: Rows, work: Work, slack: float) -> int:
    """Set all states that disagree with forces and openings by more than a slack [m]; return how many do."""
    n = laws.contacts
    wrong = 0
    for k in range(n):
        r = n + k
        state = work.tried[k]
        shear_state = work.tried[r]
        if state != INSIDE:
            if work.z[k] < -slack:
                state = INSIDE
                shear_state = INSIDE
        elif laws.opens[k] == 1 and not (after.force[k] - laws.lower[k]) * laws.compliance[k] >= -slack:
            state = LOWER
            shear_state = INSIDE
        elif laws.slips and not is_smooth(laws, k):
            if shear_state != INSIDE:
                if shear_state * work.z[r] > slack:
                    shear_state = INSIDE
            else:
                limit = shear_limit(laws, k, after.force[k])
                more = abs(after.force[r]) - limit * (1 + ROUNDING)
                if more * laws.compliance[r] > slack:
                    shear_state = UPPER if after.force[r] > 0 else LOWER
        if state != work.tried[k] or shear_state != work.tried[r]:
            wrong += 1
            work.tried[k] = state
            work.tried[r] = shear_state
    return wrong


# ---- one solve -------------------------------------------------------------------------------------------------------


def closes(laws: Laws, before: Rows, work: Work, k: int) -> bool:
    """Tell whether a contact that sticks closes in the step, so that a share of its way counts."""
    r = laws.contacts + k
    shut = work.tried[k] == INSIDE and work.tried[r] == INSIDE
    return bool(shut and before.state[k] != INSIDE and before.opening[k] > 0 and not is_smooth(laws, k))


def solve_states(
    many: Many,
    blocks: Blocks,
    places: Places,
    laws: Laws,
    before: Rows,
    length: Length,
    after: Rows,
    work: Work,
) -> int:
    """Write the rows in the states `work.tried`; return the number of solves, zero where they have no solution."""
    n = laws.contacts
    closing = False
    for k in range(n):
        work.beta[k] = 1.0
        many.kappa[k] = 0.0
        closing = closing or closes(laws, before, work, k)
    for newton in range(CROSSINGS):
        assemble(many, blocks, places, laws, length, work)
        if not factor_blocks(many.matrix):
            return 0
        solve_blocks(many.matrix, many.right)
        take_solution(many, blocks)
        add_forces(many, blocks, places, laws, work, after, 1.0)
        settled = True
        for k in range(n):
            if not closing or not closes(laws, before, work, k):
                continue
            N = after.force[k]
            share = max(crossing_share(laws, before.opening[k], k, N), LEAST_SHARE)
            if abs(share - work.beta[k]) > CROSSED * share:
                settled = False
            displacement = work.q[n + k] + contact_displacement(many.x, blocks, places, n + k)
            many.kappa[k] = (after.force[n + k] * laws.compliance[n + k] + displacement) / N if N > 0 else 0.0
            many.normal[k] = N
            work.beta[k] = share
        if settled:
            write_openings(many, blocks, places, laws, before, work, after)
            return newton + 1
    write_openings(many, blocks, places, laws, before, work, after)
    return CROSSINGS


def assemble(many: Many, blocks: Blocks, places: Places, laws: Laws, length: Length, work: Work) -> None:
    """Write matrix and right-hand side for the states `work.tried`."""
    matrix = many.matrix
    m = len(matrix.part)
    n = laws.contacts
    clear_blocks(matrix, many.known[0])
    for i in range(len(many.body)):
        body = many.body[i]
        if body < 0:
            continue
        block = matrix.blocks[matrix.number[body][body]]
        first = blocks.first[i]
        for e in range(m):
            many.right[body][e] = 0.0
            block[e][e] = 1.0
        for e in range(blocks.first[i + 1] - first):
            block[e][e] = stiffness_of(length, first + e)
    for k in range(n):
        if work.tried[k] != INSIDE:
            continue
        r = n + k
        shear_state = work.tried[r]
        stiffness = 1 / laws.compliance[k]
        add_row(many, blocks, places, k, k, k, stiffness, -stiffness * work.q[k])
        if shear_state != INSIDE:
            slope = shear_state * laws.friction[k] * stiffness
            add_row(many, blocks, places, k, r, k, slope, shear_state * laws.upper[r] - slope * work.q[k])
        elif not is_smooth(laws, k):
            along = work.beta[k] / laws.compliance[r]
            add_row(many, blocks, places, k, r, r, along, -along * work.q[r])
            kappa = many.kappa[k]
            if kappa != 0.0:  # N = -(q + B x) / c moves the share behind the crossing
                slope = -along * kappa * stiffness
                constant = along * kappa * (many.normal[k] + stiffness * work.q[k])
                add_row(many, blocks, places, k, r, k, slope, constant)


def stiffness_of(length: Length, mode: int) -> float:
    """Return s of a mode in a step [1/s^2]; explicit schemes move nothing by the forces of the step."""
    flexibility = length.numbers[3] * length.inverse[mode]
    return 1 / flexibility if flexibility > 0 else STIFFEST


def add_row(
    many: Many, blocks: Blocks, places: Places, k: int, force: int, row: int, slope: float, constant: float
) -> None:
    """Add a force constant - slope B x, which pushes by the row `force` and follows the row `row` of a contact."""
    matrix = many.matrix
    for side in range(2):
        i = places.sides[k][side]
        body = many.body[i]
        if body < 0:
            continue
        F = places.F[force][side]
        right = many.right[body]
        modes = blocks.first[i + 1] - blocks.first[i]
        for e in range(modes):
            right[e] += F[e] * constant
        for opposite in range(2):
            j = places.sides[k][opposite]
            other = many.body[j]
            if other < 0:
                continue
            B = places.B[row][opposite]
            block = matrix.blocks[matrix.number[body][other]]
            for e in range(modes):
                push = slope * F[e]
                if push != 0.0:
                    for f in range(blocks.first[j + 1] - blocks.first[j]):
                        block[e][f] += push * B[f]


def take_solution(many: Many, blocks: Blocks) -> None:
    """Write the solution as increments of the modes."""
    for i in range(len(many.body)):
        body = many.body[i]
        if body >= 0:
            first = blocks.first[i]
            for e in range(blocks.first[i + 1] - first):
                many.x[first + e] = many.right[body][e]


def add_forces(many: Many, blocks: Blocks, places: Places, laws: Laws, work: Work, after: Rows, whole: float) -> None:
    """Write the forces that the increments make; where `whole` is zero, add what more increments add to them."""
    n = laws.contacts
    for k in range(n):
        r = n + k
        if whole != 0:
            after.force[k] = 0.0
            after.force[r] = 0.0
        if work.tried[k] != INSIDE:
            continue
        N = -(whole * work.q[k] + contact_displacement(many.x, blocks, places, k)) / laws.compliance[k]
        after.force[k] += N
        if work.tried[r] != INSIDE:
            after.force[r] += work.tried[r] * (laws.friction[k] * N + whole * laws.upper[r])
        elif not is_smooth(laws, k):
            displacement = whole * work.q[r] + contact_displacement(many.x, blocks, places, r)
            if many.kappa[k] != 0.0:
                displacement += many.kappa[k] * (N - whole * many.normal[k])
            after.force[r] -= displacement * work.beta[k] / laws.compliance[r]


def write_openings(
    many: Many, blocks: Blocks, places: Places, laws: Laws, before: Rows, work: Work, after: Rows
) -> None:
    """Write states, openings and slips of rows whose forces are there."""
    n = laws.contacts
    for k in range(n):
        r = n + k
        after.state[k] = work.tried[k]
        after.state[r] = work.tried[r]
        after.slip[k] = 0.0
        after.slip[r] = 0.0
        after.opening[k] = 0.0 - after.force[k] * laws.compliance[k]
        after.opening[r] = 0.0 - after.force[r] * laws.compliance[r]
        if work.tried[k] != INSIDE:
            work.z[k] = work.q[k] + contact_displacement(many.x, blocks, places, k)
            after.opening[k] = work.z[k]
        elif work.tried[r] != INSIDE:
            z = work.q[r] + contact_displacement(many.x, blocks, places, r)
            if before.state[k] != INSIDE:
                z *= crossing_share(laws, before.opening[k], k, after.force[k])
            work.z[r] = z + laws.compliance[r] * after.force[r]
            after.slip[r] = work.z[r]


def refine(many: Many, blocks: Blocks, places: Places, laws: Laws, length: Length, after: Rows, work: Work) -> None:
    """Add the forces of the equilibrium that is left over, by the factors of the last solve."""
    n = laws.contacts
    for i in range(len(many.x)):
        many.residual[i] = -many.x[i] * stiffness_of(length, i)
    push_contacts(blocks, places, after.force, many.residual)
    for i in range(len(many.body)):
        body = many.body[i]
        if body >= 0:
            first = blocks.first[i]
            for e in range(len(many.right[body])):
                many.right[body][e] = 0.0
            for e in range(blocks.first[i + 1] - first):
                many.right[body][e] = many.residual[first + e]
    solve_blocks(many.matrix, many.right)
    take_solution(many, blocks)
    add_forces(many, blocks, places, laws, work, after, 0.0)
    for r in range(2 * n):
        if after.force[r] != 0.0:
            after.opening[r] = 0.0 - after.force[r] * laws.compliance[r]


def sweep(
    many: Many,
    blocks: Blocks,
    places: Places,
    laws: Laws,
    before: Rows,
    length: Length,
    after: Rows,
    work: Work,
    sweeps: int,
) -> None:
    """Solve contact after contact for its own forces, from the present ones; write the states these are in."""
    n = laws.contacts
    for i in range(len(many.x)):
        many.x[i] = 0.0
    for k in range(n):
        r = n + k
        N = after.force[k]
        if laws.opens[k] == 1 and not laws.lower[k] <= N:
            N = 0.0
        limit = shear_limit(laws, k, N)
        T = min(max(after.force[r], -limit), limit) if N != 0.0 or laws.opens[k] == 0 else 0.0
        after.force[k] = 0.0
        after.force[r] = 0.0
        push(many, blocks, places, length, k, N, after)
        push(many, blocks, places, length, r, T, after)
    for number in range(sweeps):
        for step in range(n):
            k = step if number % 2 == 0 else n - 1 - step
            r = n + k
            gap = work.q[k] + contact_displacement(many.x, blocks, places, k)
            flexibility = flexibility_of(blocks, places, length, k, k)
            N = (flexibility * after.force[k] - gap) / (flexibility + laws.compliance[k])
            if laws.opens[k] == 1 and laws.lower[k] > N:
                N = 0.0
            T = 0.0
            if not is_smooth(laws, k) and (N > 0 or laws.opens[k] == 0):
                displacement = work.q[r] + contact_displacement(many.x, blocks, places, r)
                flexibility = flexibility_of(blocks, places, length, r, r)
                limit = shear_limit(laws, k, N)
                sticking = (flexibility * after.force[r] - displacement) / (flexibility + laws.compliance[r])
                T = min(max(sticking, -limit), limit)
            push(many, blocks, places, length, k, N, after)
            push(many, blocks, places, length, r, T, after)
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


def push(many: Many, blocks: Blocks, places: Places, length: Length, r: int, force: float, after: Rows) -> None:
    """Set the force of a row, and what it moves."""
    change = force - after.force[r]
    after.force[r] = force
    if change == 0.0:
        return
    n = places.count[0]
    k = r if r < n else r - n
    for side in range(2):
        i = places.sides[k][side]
        first = blocks.first[i]
        for e in range(blocks.first[i + 1] - first):
            mode = first + e
            many.x[mode] += length.numbers[3] * length.inverse[mode] * places.F[r][side][e] * change
