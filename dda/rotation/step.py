r"""One time step of a block that turns.

With M and K of `dda.rotation.body`, weight F, dead loads f and contact forces lambda = (N, T) a step of length h is

    D    = h gg V + h^2 [(1/2 - alpha) A + alpha A1]
    M A1 = F - K (e + de) + B_f' (f, lambda)
    V1   = gg V + h [(1 - delta) A + delta A1]

with the law of the contacts at its end, for the exact gaps and slides there: the step is solved again with the turn
that it found until nothing changes, each time with the flexibility C = alpha h^2 B_f S^-1 B_f', S = M + alpha h^2 K.

The forces act in the directions B_f = (2 delta - 1) B + (2 - 2 delta) B_1, B the chord and B_1 the derivative at the
end of the step. Their impulse then has the direction of the middle of the step for every delta: average acceleration
stays of second order, and at delta = 1 a force does the work lambda times the exact change of its gap, so that, as in
small motion, no energy is gained by contact however far the block turns. First-order rotation is linear in a step:
its chord is the derivative at both ends. Its outline grows, and with the area det Q inertia and stiffness do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.kernel import (
    FOUND,
    NONE,
    Contacts,
    Flexibility,
    Free,
    Law,
    Matrix,
    States,
    Vector,
    Work,
    at_rest,
    eliminate,
    find_contacts,
    law_of,
    scale_of,
    set_paired_flexibility,
    spring_energy,
    work_for,
    zeros,
)
from dda.contact.unilateral import OPEN, Unilateral
from dda.rotation.body import EXACT, Body, Turn, directions, place, turn
from dda.scheme.newmark import Scheme
from dda.stepping.driver import BaseRecord, Counts, base_at, driver

Array = NDArray[np.float64]
ROUNDS = 40  # of the turn; two to four are usual
SETTLED = 1e-12  # last change of a place over the size of the block; the next would be this times the step's turn
REACH = 0.02  # gap below which a corner may come to touch in a step, over the size of the block
PAIRS = 32  # of corners that are tried in a step
OUTLINE = 8  # corners that there is room for, or a multiple of it


@dataclass(frozen=True, eq=False)
class Setting:
    """What stays the same from step to step."""

    body: Body
    law: Unilateral
    weight: Array  # (2,) acceleration of gravity [m/s^2]
    where: Array  # (m, 2) points of the unstrained outline with dead loads [m]
    dead: Array  # (m, 2) their forces [N]
    rotation: str
    limit: int  # solves of the open-close iteration before the states are searched


class RollingState(NamedTuple):
    """Where the block is."""

    c: Vector  # (2,) centroid [m]
    Q: Matrix  # (2, 2) turn of the outline
    r: Vector  # (1,) sum of the steps' rotations [rad]
    e: Vector  # (3,) strains in axes that turn with the block
    V: Vector  # (6,) velocities of c, r, e
    A: Vector  # (6,) accelerations
    contacts: Contacts  # of all corners


class StepMatrices(NamedTuple):
    """What a step needs of an outline and of its own length."""

    numbers: Vector  # (3,) length over the scheme's step, gg for this length, length [s]
    M: Matrix  # (6, 6) inertia
    K: Matrix  # (3, 3) elastic stiffness
    accelerating: Matrix  # (6, 6) M^-1
    flexible: Matrix  # (6, 6) alpha h^2 S^-1
    kept: Matrix  # (6, 6) S^-1 M


class Room(NamedTuple):
    """Room for the vectors of a step."""

    held: Vector  # (6,) weight and elastic force at its start
    free: Vector  # (6,) D without contact and dead loads
    guess: Vector  # (6,)
    D: Vector  # (6,)
    new: Vector  # (6,)
    push: Vector  # (6,) generalised force of loads and contact
    e: Vector  # (3,)
    c: Vector  # (2,)
    turn: Turn
    end: Matrix  # (2, 2) dQ/dr at the end of the step
    before: Matrix  # (corners, 2) from the base at the start of the step [m]
    after: Matrix  # (corners, 2) at its end
    near: Vector  # (corners,) least height in the step
    base: Vector  # (2,) displacement of the base at the end of the step [m]
    B: Matrix  # (4, 6) directions of the gaps, then of the slides, of the corners that may touch
    P: Matrix  # (6, 4) what their unit forces move
    force: Vector  # (4,)
    across: Vector  # (6,) directions of a point in x and in y, of the chord and of the end
    up: Vector
    across_end: Vector
    up_end: Vector
    at: States  # (2,) corners that may touch
    tried: States  # (PAIRS,)
    A: Matrix  # (6, 6)
    right: Matrix
    scale: Vector


class Touching(NamedTuple):
    """Some corners that may touch, one or two."""

    before: Contacts
    after: Contacts


class RollingEquations(NamedTuple):
    """A block that turns, its law and its scheme, as numbers."""

    corners: int
    loads: int  # dead loads, two at most
    law: Law
    limit: int
    exact: bool  # or first-order rotation
    alpha: float
    delta: float
    gg: float
    step: float  # [s]
    size: float  # greatest distance of a corner from the centroid [m]
    M: Matrix  # (6, 6)
    K: Matrix  # (3, 3)
    xi: Matrix  # (corners, 2)
    weight: Vector  # (2,)
    where: Matrix  # (2, 2)
    dead: Matrix  # (2, 2)
    whole: StepMatrices
    part: StepMatrices
    made: Vector  # (1,) step lengths made
    room: Room
    one: Touching
    two: Touching
    free: Free
    flexible: Flexibility
    work: Work


class RollingHistory(NamedTuple):
    """States after every step, a row each."""

    c: Array  # (steps, 2)
    Q: Array  # (steps, 4)
    r: Array  # (steps, 1)
    e: Array  # (steps, 3)
    V: Array  # (steps, 6)
    impulse: Array  # (steps, 1) of all N, as the scheme takes it [N s]
    normal: Array  # (steps, corners)
    shear: Array
    gap: Array
    slipped: Array  # size of all slip in the step [m]
    state: NDArray[np.int8]


def rolling_equations(setting: Setting, scheme: Scheme) -> RollingEquations:
    """Return the equations as numbers."""
    own, loads = setting.body, len(setting.where)
    capacity = room_for(len(own.xi))
    xi = np.zeros((capacity, 2))
    xi[: len(own.xi)] = own.xi
    where, dead = np.zeros((2, 2, 2))
    where[:loads], dead[:loads] = setting.where, setting.dead
    pairs = [Touching(at_rest(np.zeros(n), 2), at_rest(np.zeros(n), 2)) for n in (1, 2)]
    lengths = [StepMatrices(*zeros(3, (6, 6), (3, 3), (6, 6), (6, 6), (6, 6))) for _ in range(2)]
    vector, square = (6,), (6, 6)
    turning: list[Any] = [Turn(*zeros((2, 2), (2, 2), (2, 2)))]
    before = zeros(*[vector] * 6, 3, 2) + turning + zeros((2, 2), (capacity, 2), (capacity, 2), capacity, 2)
    directions_of = zeros((4, 6), (6, 4), 4, *[vector] * 4)
    room = Room(*(before + directions_of + zeros(2, PAIRS, dtype=np.int64) + zeros(square, square, 6)))
    equations = RollingEquations(
        corners=len(own.xi),
        loads=loads,
        law=law_of(setting.law),
        limit=setting.limit,
        exact=setting.rotation == EXACT,
        alpha=scheme.alpha,
        delta=scheme.delta,
        gg=scheme.gg,
        step=scheme.step,
        size=own.size,
        M=np.array(own.M),
        K=np.array(own.K),
        xi=xi,
        weight=np.array(setting.weight, dtype=float),
        where=where,
        dead=dead,
        whole=lengths[0],
        part=lengths[1],
        made=np.zeros(1),
        room=room,
        one=pairs[0],
        two=pairs[1],
        free=Free(*np.zeros((3, 2))),
        flexible=Flexibility(*np.zeros((2, 4, 4))),
        work=work_for(2),
    )
    set_matrices(equations, 1.0, np.eye(2), equations.whole)
    return equations


def room_for(corners: int) -> int:
    """Return the number of corners that there is room for: a few numbers do for all outlines."""
    capacity = OUTLINE
    while capacity < corners:
        capacity *= 2
    return capacity


def history_of(corners: int, steps: int) -> RollingHistory:
    """Return room for so many steps."""
    shapes = [(steps, width) for width in (2, 4, 1, 3, 6, 1, *[corners] * 4)]
    return RollingHistory(*(zeros(*shapes) + zeros((steps, corners), dtype=np.int8)))


# ---- the step --------------------------------------------------------------------------------------------------------


def late_share(delta: float) -> float:
    """Return the weight of the directions at the end of a step, beside those of its chord."""
    return 2 - 2 * delta


def area_growth(body: RollingEquations, Q: Matrix) -> float:
    """Return the area of the unstrained outline over that of the start."""
    if body.exact:
        return 1.0
    return float(Q[0][0] * Q[1][1] - Q[0][1] * Q[1][0])


def set_matrices(body: RollingEquations, ratio: float, Q: Matrix, made: StepMatrices) -> None:
    """Write the matrices of a step of some length, of an outline that has grown with Q."""
    own = body.room
    growth = area_growth(body, Q)
    made.numbers[0] = ratio
    made.numbers[1] = body.gg**ratio
    made.numbers[2] = body.step * ratio
    weight = body.alpha * made.numbers[2] * made.numbers[2]
    for i in range(6):
        for j in range(6):
            made.M[i][j] = body.M[i][j] * growth
            if i > 1 and j > 1:
                made.M[i][j] *= growth
            own.A[i][j] = made.M[i][j]
    for i in range(3):
        for j in range(3):
            made.K[i][j] = growth * body.K[i][j]
    invert(own, made.accelerating)
    for i in range(6):
        for j in range(6):
            own.A[i][j] = made.M[i][j]
            if i > 2 and j > 2:
                own.A[i][j] += weight * made.K[i - 3][j - 3]
    invert(own, made.flexible)
    for i in range(6):
        for j in range(6):
            total = 0.0
            for k in range(6):
                total += made.flexible[i][k] * made.M[k][j]
            made.kept[i][j] = total
    for i in range(6):
        for j in range(6):
            made.flexible[i][j] *= weight
    body.made[0] += 1


def invert(own: Room, inverse: Matrix) -> None:
    """Write the inverse of own.A, positive definite."""
    for i in range(6):
        own.scale[i] = scale_of(own.A[i][i])
        for j in range(6):
            own.right[i][j] = 1.0 if i == j else 0.0
    eliminate(own.A, own.right, own.scale, 6, 6)
    for i in range(6):
        for j in range(6):
            inverse[i][j] = own.right[i][j]


def matrices_of(body: RollingEquations, Q: Matrix, ratio: float) -> StepMatrices:
    """Return the matrices of a step; those of an outline that does not grow are kept."""
    made = body.whole if ratio == 1.0 else body.part
    if made.numbers[0] != ratio or not body.exact:
        set_matrices(body, ratio, Q, made)
    return made


def advance(
    body: RollingEquations, state: RollingState, after: RollingState, base: BaseRecord, begun: float, ratio: float
) -> tuple[int, int]:
    """Make a step, or a part of one, from `state` to `after`; return the outcome and the number of solves.

    Of a convex outline two corners at most touch a plane. Which they may be is guessed from the step without contact,
    and the step is made again with those that turn out to be the lowest, until no other one has crossed the plane.

    Parameters
    ----------
    begun, ratio
        Where it begins and how long it is, in steps.
    """
    made = matrices_of(body, state.Q, ratio)
    start_step(body, made, state, base, begun, ratio)
    own = body.room
    near = nearest(body, own.near, REACH * body.size)
    total = 0
    for tried in range(PAIRS):
        outcome, solves = settle(body, made, state, after, near)
        total += solves
        if outcome != FOUND or not another_crossed(body, after):
            return outcome, total
        own.tried[tried] = pair_number(own.at, near)
        for i in range(body.corners):
            own.near[i] = after.contacts.gap[i]
        near = nearest(body, own.near, math.inf)
        for k in range(tried + 1):
            if own.tried[k] == pair_number(own.at, near):
                return NONE, total
    return NONE, total


def pair_number(at: States, near: int) -> int:
    """Return a number that stands for the corners that may touch."""
    number = 0
    for k in range(near):
        number = 1024 * number + at[k] + 1
    return number


def start_step(
    body: RollingEquations, made: StepMatrices, state: RollingState, base: BaseRecord, begun: float, ratio: float
) -> None:
    """Write what is known of a step before its contact: the step without it, and where the corners come from."""
    own = body.room
    h = made.numbers[2]
    gg = made.numbers[1]
    for i in range(6):
        own.held[i] = 0.0
        own.guess[i] = gg * h * state.V[i] + h * h / 2 * state.A[i]
        own.new[i] = gg * h * state.V[i] + h * h * (0.5 - body.alpha) * state.A[i]
    for i in range(2):
        own.held[i] = made.M[0][0] * body.weight[i]
    for i in range(3):
        for j in range(3):
            own.held[3 + i] -= made.K[i][j] * state.e[j]
    for i in range(6):
        total = 0.0
        for j in range(6):
            total += made.flexible[i][j] * own.held[j]
            total += made.kept[i][j] * own.new[j]
        own.free[i] = total
    for axis in range(2):
        own.base[axis] = base_at(base, axis, body.step * begun)
    for i in range(body.corners):
        x, y = place(state.c, state.Q, state.e, body.xi[i][0], body.xi[i][1])
        own.before[i][0] = x - own.base[0]
        own.before[i][1] = y - own.base[1]
    for axis in range(2):
        own.base[axis] = base_at(base, axis, body.step * (begun + ratio))
    place_corners(body, state, own.free)
    for i in range(body.corners):
        own.near[i] = min(own.before[i][1], own.after[i][1])


def place_corners(body: RollingEquations, state: RollingState, D: Vector) -> None:
    """Write where an increment D brings the corners, and its turn."""
    own = body.room
    turn(state.Q, D[2], body.exact, own.turn)
    for i in range(2):
        own.c[i] = state.c[i] + D[i]
    for i in range(3):
        own.e[i] = state.e[i] + D[3 + i]
    for i in range(body.corners):
        x, y = place(own.c, own.turn.end, own.e, body.xi[i][0], body.xi[i][1])
        own.after[i][0] = x - own.base[0]
        own.after[i][1] = y - own.base[1]


def nearest(body: RollingEquations, heights: Vector, reach: float) -> int:
    """Write the two lowest corners below `reach` to own.at, in their order; return how many they are."""
    at = body.room.at
    first = 0
    for i in range(1, body.corners):
        if heights[i] < heights[first]:
            first = i
    second = 1 if first == 0 else 0
    for i in range(body.corners):
        if i != first and heights[i] < heights[second]:
            second = i
    if not heights[first] < reach:
        return 0
    at[0] = first
    if not heights[second] < reach:
        return 1
    at[0] = min(first, second)
    at[1] = max(first, second)
    return 2


def another_crossed(body: RollingEquations, after: RollingState) -> bool:
    """Tell whether a corner that is not closed lies below the plane."""
    for i in range(body.corners):  # noqa: SIM110  (numba knows no generators)
        if after.contacts.state[i] == OPEN and after.contacts.gap[i] < 0:
            return True
    return False


def settle(
    body: RollingEquations, made: StepMatrices, state: RollingState, after: RollingState, near: int
) -> tuple[int, int]:
    """Make the step with the corners own.at, and again with the turn that it found until nothing changes."""
    own = body.room
    pair = body.one if near == 1 else body.two
    for k in range(near):
        copy_contact(state.contacts, own.at[k], pair.before, k)
        copy_contact(state.contacts, own.at[k], pair.after, k)
    for i in range(6):
        own.D[i] = own.guess[i]
    if near == 0 and body.loads == 0:
        for i in range(6):
            own.D[i] = own.free[i]
        accept(body, made, state, after, near)
        return FOUND, 0
    solves = 0
    for _ in range(ROUNDS):
        turn(state.Q, own.D[2], body.exact, own.turn)
        push_of_loads(body, state)
        for i in range(6):
            total = own.free[i]
            for j in range(6):
                total += made.flexible[i][j] * own.push[j]
            own.new[i] = total
        if near > 0:
            set_directions(body, state, near)
            for row in range(2 * near):
                for i in range(6):
                    total = 0.0
                    for j in range(6):
                        total += made.flexible[i][j] * own.B[row][j]
                    own.P[i][row] = total
            take_forces(own, pair.after, near)
            set_free(body, state, near)
            outcome, spent = find_contacts(
                body.law, pair.before, body.free, body.flexible, body.limit, pair.after, body.work
            )
            solves += spent
            if outcome != FOUND:
                return outcome, solves
            take_forces(own, pair.after, near)
            for i in range(6):
                for row in range(2 * near):
                    own.new[i] += own.P[i][row] * own.force[row]
        settled = True
        for i in range(6):
            change = abs(own.new[i] - own.D[i]) * (body.size if i > 1 else 1.0)
            if not change <= SETTLED * body.size:
                settled = False
            own.D[i] = own.new[i]
        if settled:
            accept(body, made, state, after, near)
            return FOUND, solves
    return NONE, solves


def copy_contact(source: Contacts, i: int, target: Contacts, k: int) -> None:
    """Copy a contact."""
    target.state[k] = source.state[i]
    target.gap[k] = source.gap[i]
    target.stretch[k] = source.stretch[i]
    target.normal[k] = source.normal[i]
    target.shear[k] = source.shear[i]
    target.slipped[k] = source.slipped[i]


def take_forces(own: Room, contacts: Contacts, near: int) -> None:
    """Write the forces of the corners that may touch: N, then T."""
    for k in range(near):
        own.force[k] = contacts.normal[k]
        own.force[near + k] = contacts.shear[k]


def set_free(body: RollingEquations, state: RollingState, near: int) -> None:
    """Write gaps and slides for the flexibility about the place to which the present forces bring the corners."""
    own = body.room
    C = body.flexible.C
    for row in range(2 * near):
        for column in range(2 * near):
            total = 0.0
            for i in range(6):
                total += own.B[row][i] * own.P[i][column]
            C[row][column] = total
    for i in range(6):
        own.push[i] = own.new[i]
        for row in range(2 * near):
            own.push[i] += own.P[i][row] * own.force[row]
    turn(state.Q, own.push[2], body.exact, own.turn)
    for i in range(2):
        own.c[i] = state.c[i] + own.push[i]
    for i in range(3):
        own.e[i] = state.e[i] + own.push[3 + i]
    for k in range(near):
        corner = own.at[k]
        x, y = place(own.c, own.turn.end, own.e, body.xi[corner][0], body.xi[corner][1])
        body.free.gap[k] = y - own.base[1]
        body.free.slide[k] = x - own.base[0] - own.before[corner][0]
        for column in range(2 * near):
            body.free.gap[k] -= C[k][column] * own.force[column]
            body.free.slide[k] -= C[near + k][column] * own.force[column]
    if near == 2:
        set_paired_flexibility(C, body.flexible.C_paired)
        body.free.paired[0] = (body.free.slide[0] + body.free.slide[1]) / 2
        body.free.paired[1] = body.free.slide[1] - body.free.slide[0]


def set_directions(body: RollingEquations, state: RollingState, near: int) -> None:
    """Write B_f of the corners that may touch, the rows of y before those of x."""
    own = body.room
    for k in range(near):
        corner = own.at[k]
        force_directions(body, state, body.xi[corner][0], body.xi[corner][1])
        for i in range(6):
            own.B[k][i] = own.up[i]
            own.B[near + k][i] = own.across[i]


def force_directions(body: RollingEquations, state: RollingState, x: float, y: float) -> None:
    """Write B_f of a point, for own.D and its turn."""
    own = body.room
    late = late_share(body.delta) if body.exact else 0.0
    for i in range(3):
        own.e[i] = state.e[i] + own.D[3 + i] / 2
    directions(own.turn.chord, own.turn.mean, own.e, x, y, own.across, own.up)
    if late == 0:
        return
    for i in range(3):
        own.e[i] = state.e[i] + own.D[3 + i]
    for j in range(2):
        own.end[0][j] = -own.turn.end[1][j]
        own.end[1][j] = own.turn.end[0][j]
    directions(own.end, own.turn.end, own.e, x, y, own.across_end, own.up_end)
    for i in range(6):
        own.across[i] = (1 - late) * own.across[i] + late * own.across_end[i]
        own.up[i] = (1 - late) * own.up[i] + late * own.up_end[i]


def push_of_loads(body: RollingEquations, state: RollingState) -> None:
    """Write B_f' f of the dead loads, for own.D and its turn."""
    own = body.room
    for i in range(6):
        own.push[i] = 0.0
    for m in range(body.loads):
        force_directions(body, state, body.where[m][0], body.where[m][1])
        for i in range(6):
            own.push[i] += body.dead[m][0] * own.across[i] + body.dead[m][1] * own.up[i]


def accept(body: RollingEquations, made: StepMatrices, state: RollingState, after: RollingState, near: int) -> None:
    """Write the state at the end of the step."""
    own = body.room
    D = own.D
    h = made.numbers[2]
    place_corners(body, state, D)
    push_of_loads(body, state)
    if near > 0:
        set_directions(body, state, near)
        pair = body.one if near == 1 else body.two
        take_forces(own, pair.after, near)
        for row in range(2 * near):
            for i in range(6):
                own.push[i] += own.force[row] * own.B[row][i]
    for i in range(6):
        own.push[i] += own.held[i]
    for i in range(3):
        for j in range(3):
            own.push[3 + i] -= made.K[i][j] * D[3 + j]
    for i in range(6):
        total = 0.0
        for j in range(6):
            total += made.accelerating[i][j] * own.push[j]
        after.A[i] = total
        after.V[i] = made.numbers[1] * state.V[i] + h * ((1 - body.delta) * state.A[i] + body.delta * total)
    for i in range(2):
        after.c[i] = state.c[i] + D[i]
        for j in range(2):
            after.Q[i][j] = own.turn.end[i][j]
    for i in range(3):
        after.e[i] = state.e[i] + D[3 + i]
    after.r[0] = state.r[0] + D[2]
    contacts = after.contacts
    for i in range(body.corners):
        contacts.gap[i] = own.after[i][1]
        contacts.state[i] = OPEN
        contacts.normal[i] = 0.0
        contacts.shear[i] = 0.0
        contacts.stretch[i] = 0.0
        contacts.slipped[i] = 0.0
    if near > 0:
        pair = body.one if near == 1 else body.two
        for k in range(near):
            copy_contact(pair.after, k, contacts, own.at[k])


# ---- what is kept ----------------------------------------------------------------------------------------------------


def account(
    body: RollingEquations,
    state: RollingState,
    after: RollingState,
    base: BaseRecord,
    begun: float,
    ratio: float,
    history: RollingHistory,
    counts: Counts,
    number: int,
) -> None:
    """Add what an accepted part of a step slips, gives and loses, as `dda.rotation.energy` tells."""
    own = body.room
    late = body.delta
    gg = body.gg**ratio
    moved_x = base_at(base, 0, body.step * (begun + ratio)) - base_at(base, 0, body.step * begun)
    moved_y = base_at(base, 1, body.step * (begun + ratio)) - base_at(base, 1, body.step * begun)
    if number > 0 and begun == number:
        history.impulse[number, 0] = history.impulse[number - 1, 0]
    losses = counts.losses
    losses[number, 1] += (1 - gg * gg) * kinetic(body, state)
    before = state.contacts
    contacts = after.contacts
    for i in range(body.corners):
        N = (1 - late) * before.normal[i] + late * contacts.normal[i]
        T = (1 - late) * before.shear[i] + late * contacts.shear[i]
        history.impulse[number, 0] += body.step * ratio * N
        history.slipped[number, i] += abs(contacts.slipped[i])
        friction = abs(contacts.shear[i] * contacts.slipped[i])
        losses[number, 3] += friction
        losses[number, 4] += N * moved_y + T * moved_x
        if (before.state[i] == OPEN) != (contacts.state[i] == OPEN):
            work = N * (contacts.gap[i] - before.gap[i]) + T * (own.after[i][0] - own.before[i][0])
            losses[number, 2] += spring_energy(body.law, before, i) - spring_energy(body.law, contacts, i)
            losses[number, 2] -= work + friction


def kinetic(body: RollingEquations, state: RollingState) -> float:
    """Return the kinetic energy [J]."""
    growth = area_growth(body, state.Q)
    moving = 0.0
    turning = 0.0
    for i in range(6):
        for j in range(6):
            if i < 2 and j < 2:
                moving += state.V[i] * body.M[i][j] * state.V[j]
            elif i > 1 and j > 1:
                turning += state.V[i] * body.M[i][j] * state.V[j]
    return float((growth * moving + growth * growth * turning) / 2)


def keep(body: RollingEquations, state: RollingState, history: RollingHistory, number: int) -> bool:
    """Write the state at the end of a step; tell whether it is finite."""
    total = state.c[0] + state.c[1]
    history.r[number, 0] = state.r[0]
    for i in range(2):
        history.c[number, i] = state.c[i]
        for j in range(2):
            history.Q[number, 2 * i + j] = state.Q[i][j]
    for i in range(3):
        history.e[number, i] = state.e[i]
    for i in range(6):
        history.V[number, i] = state.V[i]
        total += state.V[i]
    for i in range(body.corners):
        history.normal[number, i] = state.contacts.normal[i]
        history.shear[number, i] = state.contacts.shear[i]
        history.gap[number, i] = state.contacts.gap[i]
        history.state[number, i] = state.contacts.state[i]
    return math.isfinite(total)


make_steps = driver(advance, account, keep)
