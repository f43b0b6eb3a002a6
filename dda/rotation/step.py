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

Other schemes take one stage or two of this form (`dda.scheme.stage`) and forces that act as at the end of each: with
B_1, as at delta = 1/2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from dda.contact.dense import Matrix, Vector, add_rows, copy, copy_matrix, dot, invert, multiply, quadratic, zeros
from dda.contact.kernel import (
    FOUND,
    NONE,
    TO_PAIR,
    Contacts,
    Flexibility,
    Free,
    Law,
    Shear,
    States,
    Work,
    at_rest,
    change_slides,
    find_contacts,
    law_of,
    work_for,
)
from dda.contact.unilateral import OPEN, Unilateral
from dda.model.arrays import Array
from dda.rotation.body import EXACT, Body, Turn, directions, place, turn
from dda.scheme.newmark import Scheme
from dda.scheme.stage import Stage, implicit_weight, inertia_force, plain_stage, predictor, velocity_corrector
from dda.stepping.driver import BaseRecord, Part, base_at, driver, staged
from dda.stepping.energy import accounted, add_contact_losses

ROUNDS = 40  # of the turn; two to four are usual
SETTLED = 1e-12  # last change of a place over the size of the block; the next would be this times the step's turn
REACH = 0.02  # gap below which a corner may come to touch in a step, over the size of the block
PAIRS = 32  # of corners that are tried in a step
STATE = 16  # numbers that are kept of a state: q, V and Q


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

    q: Vector  # (6,) centroid [m], sum of the steps' rotations [rad], strains in axes that turn with the block
    Q: Matrix  # (2, 2) turn of the outline
    V: Vector  # (6,) velocities of q
    A: Vector  # (6,) accelerations
    R: Vector  # (6,) all forces, M A of schemes that do not average them
    contacts: Contacts  # of all corners


class StepMatrices(NamedTuple):
    """What a stage needs of an outline and of the step's length."""

    numbers: Vector  # (3,) length over the scheme's step, gg for this length, length [s]
    M: Matrix  # (6, 6) inertia
    K: Matrix  # (3, 3) elastic stiffness
    accelerating: Matrix  # (6, 6) M^-1
    flexible: Matrix  # (6, 6) alpha h^2 S^-1
    kept: Matrix  # (6, 6) S^-1 M


class RollingStage(NamedTuple):
    """One stage of the scheme."""

    numbers: Stage
    weight: float  # of h^2 K beside M
    whole: StepMatrices
    part: StepMatrices
    slide: Vector  # (corners,) displacement along the base in the stage that was made last [m]
    slipped: Vector  # (corners,) by slip [m]
    moved: Vector  # (2,) of the base [m]


class Room(NamedTuple):
    """Room for the vectors of a step."""

    V: Vector  # (6,) velocities, accelerations and forces at the start of the step
    A_0: Vector
    R: Vector
    held: Vector  # (6,) weight and elastic force at its start, with what an average takes from the start of the step
    free: Vector  # (6,) D without contact and dead loads
    guess: Vector  # (6,)
    D: Vector  # (6,)
    new: Vector  # (6,)
    push: Vector  # (6,) generalised force of loads and contact
    q: Vector  # (6,)
    across: Vector  # (6,) directions of a point in x and in y, of the chord and of the end
    up: Vector
    across_end: Vector
    up_end: Vector
    scale: Vector
    turn: Turn
    spin: Matrix  # (2, 2) dQ/dr at the end of the step
    before: Matrix  # (corners, 2) from the base at the start of the step [m]
    after: Matrix  # (corners, 2) at its end
    near: Vector  # (corners,) least height in the stage
    start: Vector  # (2,) displacement of the base at the start of the stage [m]
    base: Vector  # (2,) at its end
    A: Matrix  # (6, 6)
    at: States  # (2,) corners that may touch
    tried: States  # (PAIRS,)


class Touching(NamedTuple):
    """Some corners that may touch, one or two."""

    before: Contacts
    after: Contacts
    free: Free
    flexible: Flexibility
    work: Work
    B: Matrix  # (2n, 6) directions of the gaps, then of the slides
    P: Matrix  # (2n, 6) what their unit forces move
    force: Vector  # (2n,) N, then T


class RollingEquations(NamedTuple):
    """A block that turns, its law and its scheme, as numbers."""

    loads: int  # dead loads, two at most
    law: Law
    exact: bool  # or first-order rotation
    stages: int  # 1, or 2: `first` and `last`
    delta: float  # of Newmark's, 1/2 of another scheme: weight of the forces at the end of each stage
    by_balance: bool  # True: what the algorithm loses is what the others leave
    lag: float  # by how much of a step V is older than q
    gg: float
    step: float  # [s]
    size: float  # greatest distance of a corner from the centroid [m]
    M: Matrix  # (6, 6)
    K: Matrix  # (3, 3)
    xi: Matrix  # (corners, 2)
    weight: Vector  # (2,)
    where: Matrix  # (2, 2)
    dead: Matrix  # (2, 2)
    first: RollingStage  # of two
    last: RollingStage
    between: RollingState  # at the end of the first one
    made: Vector  # (1,) matrices made
    room: Room
    one: Touching
    two: Touching


def rolling_equations(setting: Setting, scheme: Scheme) -> RollingEquations:
    """Return the equations as numbers."""
    body = setting.body
    loads = len(setting.where)
    corners = len(body.xi)
    where, dead = np.zeros((2, 2, 2))
    where[:loads] = setting.where
    dead[:loads] = setting.dead
    stages = [stage_room(stage, corners) for stage in scheme.stages]
    rows: list[Any] = zeros(*[6] * 15)
    between: list[Any] = [*zeros(6, (2, 2), 6, 6, 6), at_rest(np.zeros(corners))]
    rows.append(Turn(*zeros((2, 2), (2, 2), (2, 2))))
    rows += zeros((2, 2), (corners, 2), (corners, 2), corners, 2, 2, (6, 6))
    rows += zeros(2, PAIRS, dtype=np.int64)
    equations = RollingEquations(
        loads=loads,
        law=law_of(setting.law, setting.limit),
        exact=setting.rotation == EXACT,
        stages=len(stages),
        delta=scheme.delta if scheme.table is None else 0.5,
        by_balance=True,
        lag=float(scheme.lag),
        gg=scheme.gg,
        step=scheme.step,
        size=body.size,
        M=np.array(body.M),
        K=np.array(body.K),
        xi=body.xi,
        weight=np.array(setting.weight, dtype=float),
        where=where,
        dead=dead,
        first=stages[0],
        last=stages[-1],
        between=RollingState(*between),
        made=np.zeros(1),
        room=Room(*rows),
        one=touching(1),
        two=touching(2),
    )
    for stage in stages:
        set_matrices(equations, stage, 1.0, np.eye(2), stage.whole)
    return equations


def stage_room(stage: Stage, corners: int) -> RollingStage:
    """Return a stage, with room for what belongs to it."""
    lengths = [StepMatrices(*zeros(3, (6, 6), (3, 3), (6, 6), (6, 6), (6, 6))) for _ in range(2)]
    return RollingStage(plain_stage(stage), float(implicit_weight(stage)), *lengths, *zeros(corners, corners, 2))


def touching(n: int) -> Touching:
    """Return room for so many corners that may touch."""
    m = 2 * n
    return Touching(
        before=at_rest(np.zeros(n)),
        after=at_rest(np.zeros(n)),
        free=Free(*np.zeros((3, n))),
        flexible=Flexibility(*np.zeros((2, m, m))),
        work=work_for(n),
        B=np.zeros((m, 6)),
        P=np.zeros((m, 6)),
        force=np.zeros(m),
    )


# ---- the step --------------------------------------------------------------------------------------------------------


def late_share(delta: float) -> float:
    """Return the weight of the directions at the end of a step, beside those of its chord."""
    return 2 - 2 * delta


def area_growth(body: RollingEquations, Q: Matrix) -> float:
    """Return the area of the unstrained outline over that of the start."""
    if body.exact:
        return 1.0
    return float(Q[0][0] * Q[1][1] - Q[0][1] * Q[1][0])


def set_matrices(body: RollingEquations, stage: RollingStage, ratio: float, Q: Matrix, matrices: StepMatrices) -> None:
    """Write the matrices of a stage of a step of some length, of an outline that has grown with Q."""
    room = body.room
    growth = area_growth(body, Q)
    matrices.numbers[0] = ratio
    matrices.numbers[1] = body.gg**ratio
    matrices.numbers[2] = body.step * ratio
    weight = stage.weight * matrices.numbers[2] * matrices.numbers[2]
    for i in range(6):
        for j in range(6):
            matrices.M[i][j] = body.M[i][j] * growth
            if i > 1 and j > 1:
                matrices.M[i][j] *= growth
    copy_matrix(matrices.M, room.A)
    invert(room.A, 6, room.scale, matrices.accelerating)
    copy_matrix(matrices.M, room.A)
    for i in range(3):
        for j in range(3):
            matrices.K[i][j] = growth * body.K[i][j]
            room.A[3 + i][3 + j] += weight * matrices.K[i][j]
    invert(room.A, 6, room.scale, matrices.flexible)
    for i in range(6):  # M is symmetric: its rows are its columns
        for j in range(6):
            matrices.kept[i][j] = dot(matrices.flexible[i], matrices.M[j], 6)
    for i in range(6):
        for j in range(6):
            matrices.flexible[i][j] *= weight
    body.made[0] += 1


def matrices_of(body: RollingEquations, stage: RollingStage, Q: Matrix, ratio: float) -> StepMatrices:
    """Return the matrices of a stage; those of an outline that does not grow are kept."""
    matrices = stage.whole if ratio == 1.0 else stage.part
    if matrices.numbers[0] != ratio or not body.exact:
        set_matrices(body, stage, ratio, Q, matrices)
    return matrices


def make_stage(
    body: RollingEquations,
    shear_law: Shear,
    stage: RollingStage,
    state: RollingState,
    before: RollingState,
    after: RollingState,
    base: BaseRecord | None,
    part: Part,
) -> tuple[int, int]:
    """Go from the end of the stage before, or the start of the step, to the end of a stage.

    Of a convex outline two corners at most touch a plane. Which they may be is guessed from the stage without contact,
    and it is made again with those that turn out to be the lowest, until no other one has crossed the plane.
    """
    room = body.room
    copy(state.V, room.V)
    copy(state.A, room.A_0)
    copy(state.R, room.R)
    matrices = matrices_of(body, stage, before.Q, part.ratio)
    predict(body, stage, matrices, before, base, part)
    near = nearest(body, room.near, REACH * body.size)
    total = 0
    for attempt in range(PAIRS):
        outcome, solves = settle(body, shear_law, stage, matrices, before, after, near)
        total += solves
        if outcome != FOUND or not another_crossed(body, after):
            return outcome, total
        room.tried[attempt] = pair_number(room.at, near)
        copy(after.contacts.gap, room.near)
        near = nearest(body, room.near, math.inf)
        for k in range(attempt + 1):
            if room.tried[k] == pair_number(room.at, near):
                return NONE, total
    return NONE, total


advance = staged(make_stage)


def pair_number(at: States, near: int) -> int:
    """Return a number that stands for the corners that may touch."""
    number = 0
    for k in range(near):
        number = 1024 * number + at[k] + 1
    return number


def predict(
    body: RollingEquations,
    stage: RollingStage,
    matrices: StepMatrices,
    state: RollingState,
    base: BaseRecord | None,
    part: Part,
) -> None:
    """Write what is known of a stage before its contact: the stage without it, and where the corners come from."""
    room = body.room
    numbers = stage.numbers
    gg = matrices.numbers[1]
    h = matrices.numbers[2]
    if base is not None:
        base_at(base, body.step * (part.begun + part.ratio * numbers.begin), room.start)
        base_at(base, body.step * (part.begun + part.ratio * numbers.end), room.base)
        for axis in range(2):
            stage.moved[axis] = room.base[axis] - room.start[axis]
    hold(body, matrices, state.q, room.held)
    length = numbers.end - numbers.begin
    for i in range(6):
        moving = gg * h * room.V[i]
        room.guess[i] = length * moving + length * length * (h * h / 2 * room.A_0[i])
        room.new[i] = predictor(numbers, moving, h * h * room.A_0[i], h * state.V[i], h * h * state.A[i])
        known = numbers.af * room.R[i] - numbers.am * dot(matrices.M[i], room.A_0, 6)
        room.held[i] += known / (1 - numbers.af)
    for i in range(6):
        room.free[i] = dot(matrices.flexible[i], room.held, 6) + dot(matrices.kept[i], room.new, 6)
    place_corners(body, state.q, state.Q, room.start, room.before)
    move(body, state, room.free, 1.0)
    place_corners(body, room.q, room.turn.end, room.base, room.after)
    for i in range(len(body.xi)):
        room.near[i] = min(room.before[i][1], room.after[i][1])


def hold(body: RollingEquations, matrices: StepMatrices, q: Vector, force: Vector) -> None:
    """Write weight and elastic force of a block at q."""
    for i in range(2):
        force[i] = matrices.M[0][0] * body.weight[i]
    force[2] = 0.0
    for i in range(3):
        force[3 + i] = 0.0
        for j in range(3):
            force[3 + i] -= matrices.K[i][j] * q[3 + j]


def move(body: RollingEquations, state: RollingState, D: Vector, share: float) -> None:
    """Write the turn of an increment D, and q after a share of it."""
    room = body.room
    turn(state.Q, D[2], body.exact, room.turn)
    for i in range(6):
        room.q[i] = state.q[i] + share * D[i]


def place_corners(body: RollingEquations, q: Vector, Q: Matrix, base: Vector, out: Matrix) -> None:
    """Write where the corners are, from the base."""
    for i in range(len(body.xi)):
        x, y = place(q, Q, body.xi[i][0], body.xi[i][1])
        out[i][0] = x - base[0]
        out[i][1] = y - base[1]


def nearest(body: RollingEquations, heights: Vector, reach: float) -> int:
    """Write the two lowest corners below `reach` to room.at, in their order; return how many they are."""
    at = body.room.at
    first = 0
    for i in range(1, len(body.xi)):
        if heights[i] < heights[first]:
            first = i
    second = 1 if first == 0 else 0
    for i in range(len(body.xi)):
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
    for i in range(len(body.xi)):  # noqa: SIM110  (numba knows no generators)
        if after.contacts.state[i] == OPEN and after.contacts.gap[i] < 0:
            return True
    return False


def settle(
    body: RollingEquations,
    shear_law: Shear,
    stage: RollingStage,
    matrices: StepMatrices,
    state: RollingState,
    after: RollingState,
    near: int,
) -> tuple[int, int]:
    """Make the step with the corners room.at, one or two or none."""
    room = body.room
    if near == 2:
        return settle_touching(body, shear_law, body.two, stage, matrices, state, after, near)
    if near == 1 or body.loads > 0:
        return settle_touching(body, shear_law, body.one, stage, matrices, state, after, near)
    copy(room.free, room.D)
    accept(body, body.one, stage, matrices, state, after, near)
    return FOUND, 0


def settle_touching(
    body: RollingEquations,
    shear_law: Shear,
    pair: Touching,
    stage: RollingStage,
    matrices: StepMatrices,
    state: RollingState,
    after: RollingState,
    near: int,
) -> tuple[int, int]:
    """Make the stage with the corners room.at, and again with the turn that it found until nothing changes."""
    room = body.room
    for k in range(near):
        copy_contact(state.contacts, room.at[k], pair.before, k)
        copy_contact(state.contacts, room.at[k], pair.after, k)
    copy(room.guess, room.D)
    solves = 0
    for _ in range(ROUNDS):
        turn(state.Q, room.D[2], body.exact, room.turn)
        push_of_loads(body, state)
        for i in range(6):
            room.new[i] = room.free[i] + dot(matrices.flexible[i], room.push, 6)
        if near > 0:
            set_directions(body, pair, state)
            for row in range(len(pair.force)):
                multiply(matrices.flexible, pair.B[row], 6, 6, pair.P[row])
            take_forces(pair)
            set_free(body, pair, state)
            outcome, spent = find_contacts(
                body.law, shear_law, pair.before, pair.free, pair.flexible, pair.after, pair.work
            )
            solves += spent
            if outcome != FOUND:
                return outcome, solves
            take_forces(pair)
            add_rows(pair.P, pair.force, len(pair.force), 6, room.new)
        settled = True
        for i in range(6):
            change = abs(room.new[i] - room.D[i]) * (body.size if i > 1 else 1.0)
            if not change <= SETTLED * body.size:
                settled = False
        copy(room.new, room.D)
        if settled:
            accept(body, pair, stage, matrices, state, after, near)
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


def take_forces(pair: Touching) -> None:
    """Write the forces of the corners that may touch: N, then T."""
    near = len(pair.after.gap)
    for k in range(near):
        pair.force[k] = pair.after.normal[k]
        pair.force[near + k] = pair.after.shear[k]


def set_free(body: RollingEquations, pair: Touching, state: RollingState) -> None:
    """Write gaps and slides for the flexibility about the place to which the present forces bring the corners."""
    room = body.room
    free = pair.free
    C = pair.flexible.C
    near = len(pair.after.gap)
    rows = 2 * near
    for row in range(rows):
        for column in range(rows):
            C[row][column] = dot(pair.B[row], pair.P[column], 6)
    copy(room.new, room.push)
    add_rows(pair.P, pair.force, rows, 6, room.push)
    move(body, state, room.push, 1.0)
    for k in range(near):
        corner = room.at[k]
        x, y = place(room.q, room.turn.end, body.xi[corner][0], body.xi[corner][1])
        free.gap[k] = y - room.base[1] - dot(C[k], pair.force, rows)
        free.slide[k] = x - room.base[0] - room.before[corner][0] - dot(C[near + k], pair.force, rows)
    if near == 2:
        change_slides(C, TO_PAIR, pair.flexible.C_paired)
        free.paired[0] = (free.slide[0] + free.slide[1]) / 2
        free.paired[1] = free.slide[1] - free.slide[0]


def set_directions(body: RollingEquations, pair: Touching, state: RollingState) -> None:
    """Write B_f of the corners that may touch, the rows of y before those of x."""
    room = body.room
    near = len(pair.after.gap)
    for k in range(near):
        corner = room.at[k]
        force_directions(body, state, body.xi[corner][0], body.xi[corner][1])
        copy(room.up, pair.B[k])
        copy(room.across, pair.B[near + k])


def force_directions(body: RollingEquations, state: RollingState, x: float, y: float) -> None:
    """Write B_f of a point, for room.D and its turn."""
    room = body.room
    late = late_share(body.delta) if body.exact else 0.0
    for i in range(3, 6):
        room.q[i] = state.q[i] + room.D[i] / 2
    directions(room.turn.chord, room.turn.mean, room.q, x, y, room.across, room.up)
    if late == 0:
        return
    for i in range(3, 6):
        room.q[i] = state.q[i] + room.D[i]
    for j in range(2):
        room.spin[0][j] = -room.turn.end[1][j]
        room.spin[1][j] = room.turn.end[0][j]
    directions(room.spin, room.turn.end, room.q, x, y, room.across_end, room.up_end)
    for i in range(6):
        room.across[i] = (1 - late) * room.across[i] + late * room.across_end[i]
        room.up[i] = (1 - late) * room.up[i] + late * room.up_end[i]


def push_of_loads(body: RollingEquations, state: RollingState) -> None:
    """Write B_f' f of the dead loads, for room.D and its turn."""
    room = body.room
    for i in range(6):
        room.push[i] = 0.0
    for m in range(body.loads):
        force_directions(body, state, body.where[m][0], body.where[m][1])
        for i in range(6):
            room.push[i] += body.dead[m][0] * room.across[i] + body.dead[m][1] * room.up[i]


def accept(
    body: RollingEquations,
    pair: Touching,
    stage: RollingStage,
    matrices: StepMatrices,
    state: RollingState,
    after: RollingState,
    near: int,
) -> None:
    """Write the state at the end of the stage."""
    room = body.room
    numbers = stage.numbers
    h = matrices.numbers[2]
    turn(state.Q, room.D[2], body.exact, room.turn)
    push_of_loads(body, state)
    contacts = after.contacts
    for i in range(len(body.xi)):
        contacts.state[i] = OPEN
        contacts.normal[i] = 0.0
        contacts.shear[i] = 0.0
        contacts.stretch[i] = 0.0
        contacts.slipped[i] = 0.0
    if near > 0:
        set_directions(body, pair, state)
        take_forces(pair)
        add_rows(pair.B, pair.force, len(pair.force), 6, room.push)
    move(body, state, room.D, 1.0)
    hold(body, matrices, room.q, room.held)
    copy(room.q, after.q)
    copy_matrix(room.turn.end, after.Q)
    for i in range(6):
        room.push[i] += room.held[i]
    for i in range(6):
        after.R[i] = room.push[i]
        end = dot(matrices.accelerating[i], room.push, 6)
        start = dot(matrices.accelerating[i], room.R, 6)
        after.A[i] = inertia_force(numbers, end, start, room.A_0[i])
        moving = matrices.numbers[1] * room.V[i]
        after.V[i] = velocity_corrector(numbers, moving, h * room.A_0[i], h * state.A[i], h * after.A[i])
    place_corners(body, room.q, room.turn.end, room.base, room.after)
    for i in range(len(body.xi)):
        contacts.gap[i] = room.after[i][1]
        stage.slide[i] = room.after[i][0] - room.before[i][0]
    for k in range(near):
        copy_contact(pair.after, k, contacts, room.at[k])
    copy(contacts.slipped, stage.slipped)


# ---- what is kept ----------------------------------------------------------------------------------------------------


def account_stage(
    body: RollingEquations,
    shear_law: Shear,
    stage: RollingStage,
    before: RollingState,
    after: RollingState,
    part: Part,
    sums: Vector,
) -> None:
    """Add what a stage slips, gives and loses by its contacts; what the algorithm loses is the rest."""
    add_contact_losses(
        body.law,
        shear_law,
        before.contacts,
        after.contacts,
        stage.slipped,
        stage.slide,
        stage.moved,
        body.delta,
        body.step * part.ratio * (stage.numbers.end - stage.numbers.begin),
        1.0,
        sums,
    )


def kinetic(body: RollingEquations, state: RollingState) -> float:
    """Return the kinetic energy [J]."""
    growth = area_growth(body, state.Q)
    moving = quadratic(body.M, state.V, 2)
    turning = 0.0
    for i in range(2, 6):
        for j in range(2, 6):
            turning += state.V[i] * body.M[i][j] * state.V[j]
    return float((growth * moving + growth * growth * turning) / 2)


def no_loss_beside(body: RollingEquations, state: RollingState, after: RollingState, part: Part, sums: Vector) -> None:
    """Add nothing: the balance of energy has it."""


def keep(body: RollingEquations, state: RollingState, rows: Array, number: int) -> bool:
    """Write q, V and Q at the end of a step; tell whether it is finite."""
    total = state.q[0] + state.q[1]
    for i in range(6):
        rows[number, i] = state.q[i]
        rows[number, 6 + i] = state.V[i]
        if body.lag != 0:
            discount = body.gg if number == 0 else 1.0  # of what `late_momentum` made of the velocity at t = 0
            rows[number, 6 + i] = discount * state.V[i] + body.lag * body.step * state.A[i]
        total += state.V[i]
    for i in range(2):
        for j in range(2):
            rows[number, 12 + 2 * i + j] = state.Q[i][j]
    return math.isfinite(total)


account = accounted(kinetic, account_stage, no_loss_beside)
make_steps = driver(advance, account, keep)
