r"""One time step of a block that turns.

Without contact its free modes move as those of any block, whatever the angle (`dda.bodies.turning_body`); the rest of a
stage is `dda.march.step`, but that the rows of contact follow the turn: the law of the contacts holds at the end of the
step, for the exact gaps and ways there, and the stage is solved again with the turn that it found until all is settled.

The forces act in the directions B_f = (2 delta - 1) B + (2 - 2 delta) B_1, B the chord and B_1 the derivative at the
end of the step. Their impulse then has the direction of the middle of the step for every delta: average acceleration
stays of second order, and at delta = 1 a force does the work lambda times the exact change of its gap, so that, as in
small motion, no energy is gained by contact however far the block turns. First-order rotation is linear in a step:
its chord is the derivative at both ends. Its outline grows, and with the area det Q inertia and stiffness do.

Other schemes take one stage or two of this form (`dda.scheme.stage`) and forces that act as at the end of each: with
B_1, as at delta = 1/2.

Of a convex outline two corners at most touch a plane: the rows are those of one block over two contacts.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dda.bodies.turning_body import EXACT, Turn, directions, place, turn
from dda.contact.dense import Matrix, Vector, copy, copy_matrix
from dda.contact.rows import (
    FOUND,
    INSIDE,
    LOWER,
    NONE,
    Laws,
    Rows,
    Solved,
    States,
    find,
    flexed,
    rows_of,
    unpair_ways,
    work_for,
)
from dda.march.account import add_contact_losses, add_damping, over_stages
from dda.march.step import (
    AnyState,
    Body,
    Course,
    Length,
    March,
    Part,
    StageRoom,
    add_push,
    coast,
    end_modes,
    free_modes,
    kept_discount,
    length_of,
    march_of,
    move_rows,
    prescribe,
    push_modes,
    set_length,
    state_of,
    steps_by,
    write_flexibility,
)
from dda.model.arrays import Array
from dda.scheme.newmark import Scheme

ROUNDS = 40  # of the turn; two to four are usual
STALE = 1e-6  # change of a place over the size of the block after which its flexibility is written anew
SETTLED = 1e-12  # last change of a place over the size of the block; the next would be this times the step's turn
REACH = 0.02  # gap below which a corner may come to touch in a step, over the size of the block
PAIRS = 32  # of corners that are tried in a step
STATE = 16  # numbers that are kept of a state: q, V and Q
FAR = 1e300  # m, gap of a contact that is none


class RollingState(NamedTuple):
    """Where the block is: what `dda.march.step.State` has, the rows those of all corners, and its place."""

    z: Vector
    p: Vector
    a: Vector
    R: Vector
    path: Vector
    rows: Rows
    q: Vector  # (6,) centroid [m], sum of the steps' rotations [rad], strains in axes that turn with the block
    Q: Matrix  # (2, 2) turn of the outline


class Rolling(NamedTuple):
    """What a block that turns has beside its march, and room for a stage."""

    laws: Laws  # of all corners
    ground: Matrix  # (m, 2) what the base takes from their rows
    exact: bool  # or first-order rotation
    late: float  # weight of the directions at the end of a step, beside those of its chord
    weight: float  # of forces at the end, in the work of the contacts
    size: float  # greatest distance of a corner from the centroid [m]
    shapes: Matrix  # (n, 6) unknowns q of each mode
    stiffness: Vector  # (n,) of the modes at the start [1/s^2]
    translation: States  # (n,) 1 of modes in which the centroid moves, and nothing else
    xi: Matrix  # (corners, 2)
    loads: int  # dead loads, two at most
    where: Matrix  # (2, 2) points of the outline on which they act [m]
    dead: Matrix  # (2, 2) [N]
    before: Rows  # of two corners that may touch
    after: Rows
    at: States  # (2,) which they are
    tried: States  # (PAIRS,)
    near: Vector  # (corners,) least height in the stage
    rest: Matrix  # (corners, 2) places from the base at the start of the stage [m]
    place: Matrix  # (corners, 2) at its end
    turn: Turn
    spin: Matrix  # (2, 2) dQ/dr at the end of the step
    loaded: Vector  # (n,) increments of the modes without contact forces, under the dead loads
    guess: Vector  # (n,) increments of the modes to begin with
    x: Vector  # (n,) increments of the modes in the present round
    D: Vector  # (6,) of q by these
    new: Vector  # (6,)
    q: Vector  # (6,)
    across: Vector  # (6,) directions of a point in x and in y, of the chord and of the end
    up: Vector
    across_end: Vector
    up_end: Vector


def rolling_march(
    body: Body,
    pair: Laws,
    corners: Laws,
    scheme: Scheme,
    shapes: Array,
    xi: Array,
    where: Array,
    dead: Array,
    rotation: str,
) -> March:
    """Return the march of a block that turns.

    Parameters
    ----------
    body
        Its free modes, with room for the rows of two corners.
    pair, corners
        Laws of two corners and of all of them.
    shapes : (6, n) array
        Unknowns q by the modes.
    xi : (corners, 2) array
        Outline about the centroid [m].
    where, dead : (loads, 2) arrays
        Points with dead loads [m], and these [N].
    """
    count = len(xi)
    m = len(pair.compliance)
    loads = len(where)
    points, forces = np.zeros((2, 2, 2))
    points[:loads] = where
    forces[:loads] = dead
    delta = scheme.delta if scheme.table is None else 0.5
    ground = np.zeros((len(corners.compliance), 2))
    ground[:count, 1] = 1.0
    ground[count:, 0] = 1.0
    rolling = Rolling(
        laws=corners,
        ground=ground,
        exact=rotation == EXACT,
        late=late_share(delta) if rotation == EXACT else 0.0,
        weight=delta,
        size=float(np.sqrt(np.max(np.sum(xi**2, axis=1)))),
        shapes=shapes.T.copy(),
        stiffness=np.array(body.k),
        translation=np.any(shapes[:2] != 0, axis=0).astype(np.int64),
        xi=xi,
        loads=loads,
        where=points,
        dead=forces,
        before=rows_of(np.zeros(m), np.zeros(m)),
        after=rows_of(np.zeros(m), np.zeros(m)),
        at=np.zeros(2, dtype=np.int64),
        tried=np.zeros(PAIRS, dtype=np.int64),
        near=np.zeros(count),
        rest=np.zeros((count, 2)),
        place=np.zeros((count, 2)),
        turn=Turn(*np.zeros((3, 2, 2))),
        spin=np.zeros((2, 2)),
        **{name: np.zeros(len(body.k)) for name in ("loaded", "guess", "x")},
        **{name: np.zeros(6) for name in ("D", "new", "q", "across", "up", "across_end", "up_end")},
    )
    march = march_of(body, pair, scheme, np.zeros(m), rolling)
    rows = len(ground)
    between = state_of(len(body.k), np.zeros(rows), np.zeros(rows))
    return march._replace(between=RollingState(*between, np.zeros(6), np.eye(2)), work=work_for(2, m))


def late_share(delta: float) -> float:
    """Return the weight of the directions at the end of a step, beside those of its chord."""
    return 2 - 2 * delta


def area_growth(rolling: Rolling, Q: Matrix) -> float:
    """Return the area of the unstrained outline over that of the start."""
    if rolling.exact:
        return 1.0
    return float(Q[0][0] * Q[1][1] - Q[0][1] * Q[1][0])


# ---- one stage -------------------------------------------------------------------------------------------------------


def make_stage(
    march: March,
    stage: StageRoom,
    start: RollingState,
    before: RollingState,
    after: RollingState,
    course: Course,
    part: Part,
) -> Solved:
    """Go from the end of the stage before, or the start of the step, to the end of a stage.

    Which corners may touch is guessed from the stage without contact, and it is made again with those that turn out to
    be the lowest, until no other one has crossed the plane.
    """
    rolling = march.method
    length = length_of(march, stage, part.ratio)
    if not rolling.exact:
        grow(march, area_growth(rolling, before.Q))
        set_length(march, stage, part.ratio, length)
    predict(march, stage, length, start, before, course, part)
    near = nearest(rolling, REACH * rolling.size)
    total = 0
    for attempt in range(PAIRS):
        outcome, solves = settle(march, length, start, before, after, near)
        total += solves
        if outcome != FOUND or not another_crossed(rolling, after):
            return outcome, total
        rolling.tried[attempt] = pair_number(rolling.at, near)
        for k in range(len(rolling.near)):
            rolling.near[k] = after.rows.opening[k]
        near = nearest(rolling, math.inf)
        for k in range(attempt + 1):
            if rolling.tried[k] == pair_number(rolling.at, near):
                return NONE, total
    return NONE, total


def grow(march: March, growth: float) -> None:
    """Write the modes of an outline whose area has grown: inertia of the centroid as it, all else as its square."""
    rolling = march.method
    for i in range(len(rolling.stiffness)):
        march.body.k[i] = rolling.stiffness[i] / growth
        march.body.mobility[i] = 1 / growth if rolling.translation[i] == 1 else 1 / (growth * growth)


def predict(
    march: March,
    stage: StageRoom,
    length: Length,
    start: RollingState,
    before: RollingState,
    course: Course,
    part: Part,
) -> None:
    """Write what is known of a stage before its contact: the stage without it, and where the corners come from."""
    rolling = march.method
    room = march.room
    prescribe(march, course, stage, part)
    free_modes(march, length, start, before)
    place_corners(rolling, before.q, before.Q, room.start, rolling.rest)
    by_modes(rolling, room.x, rolling.new)
    turn(before.Q, rolling.new[2], rolling.exact, rolling.turn)
    displace(rolling, before, rolling.new)
    place_corners(rolling, rolling.q, rolling.turn.end, room.end, rolling.place)
    for k in range(len(rolling.near)):
        rolling.near[k] = min(rolling.rest[k][1], rolling.place[k][1])
    coast(stage, length, start, rolling.guess)


def by_modes(rolling: Rolling, x: Vector, out: Vector) -> None:
    """Write the unknowns q of modal increments."""
    for j in range(6):
        out[j] = 0.0
    for i in range(len(x)):
        shape = rolling.shapes[i]
        for j in range(6):
            out[j] += shape[j] * x[i]


def by_mode(rolling: Rolling, row: Vector, i: int) -> float:
    """Return what a row of the unknowns is of a mode."""
    shape = rolling.shapes[i]
    if rolling.translation[i] == 1:
        return float(row[0] * shape[0] + row[1] * shape[1])
    return float(row[2] * shape[2] + row[3] * shape[3] + row[4] * shape[4] + row[5] * shape[5])


def displace(rolling: Rolling, before: RollingState, D: Vector) -> None:
    """Write q after an increment D."""
    for j in range(6):
        rolling.q[j] = before.q[j] + D[j]


def place_corners(rolling: Rolling, q: Vector, Q: Matrix, base: Vector, out: Matrix) -> None:
    """Write where the corners are, from the base."""
    for k in range(len(rolling.xi)):
        x, y = place(q, Q, rolling.xi[k][0], rolling.xi[k][1])
        out[k][0] = x - base[0]
        out[k][1] = y - base[1]


def pair_number(at: States, near: int) -> int:
    """Return a number that stands for the corners that may touch."""
    number = 0
    for k in range(near):
        number = 1024 * number + at[k] + 1
    return number


def nearest(rolling: Rolling, reach: float) -> int:
    """Write the two lowest corners below `reach` to `at`, in their order; return how many they are."""
    at = rolling.at
    heights = rolling.near
    first = 0
    for k in range(1, len(heights)):
        if heights[k] < heights[first]:
            first = k
    second = 1 if first == 0 else 0
    for k in range(len(heights)):
        if k != first and heights[k] < heights[second]:
            second = k
    if not heights[first] < reach:
        return 0
    at[0] = first
    if not heights[second] < reach:
        return 1
    at[0] = min(first, second)
    at[1] = max(first, second)
    return 2


def another_crossed(rolling: Rolling, after: RollingState) -> bool:
    """Tell whether a corner that is not closed lies below the plane."""
    for k in range(len(rolling.xi)):  # noqa: SIM110  (numba knows no generators)
        if after.rows.state[k] != INSIDE and after.rows.opening[k] < 0:
            return True
    return False


def settle(
    march: March, length: Length, start: RollingState, before: RollingState, after: RollingState, near: int
) -> Solved:
    """Make the stage with the corners `at`, and again with the turn that it found until nothing changes."""
    rolling = march.method
    room = march.room
    if near == 0 and rolling.loads == 0:  # no force turns with the block
        by_modes(rolling, room.x, rolling.D)
        accept(march, length, start, before, after, near)
        return FOUND, 0
    take_pair(rolling, before, near)
    copy(rolling.guess, rolling.x)
    by_modes(rolling, rolling.x, rolling.D)
    solves = 0
    stale = True
    for _ in range(ROUNDS):
        turn(before.Q, rolling.D[2], rolling.exact, rolling.turn)
        push_loads(march, before)
        for i in range(len(room.x)):
            rolling.loaded[i] = room.x[i] + length.numbers[3] * length.inverse[i] * room.pushed[i]
        if near > 0:
            set_rows(march, before, near)
            if stale:  # openings are linear about the present forces, of which a flexibility changes no last digit
                write_flexibility(march, length.numbers[3], length)
            displace(rolling, before, rolling.D)
            set_openings(march, length, near)
            outcome, spent = find(march.laws, rolling.before, length.flexible, rolling.after, march.work)
            solves += spent
            if outcome != FOUND:
                return outcome, solves
        add_forces(march, length)
        copy(room.pushed, rolling.x)
        by_modes(rolling, rolling.x, rolling.new)
        settled = True
        stale = False
        for j in range(6):
            change = abs(rolling.new[j] - rolling.D[j]) * (rolling.size if j > 1 else 1.0)
            settled = settled and change <= SETTLED * rolling.size
            stale = stale or change > STALE * rolling.size
        copy(rolling.new, rolling.D)
        if settled:
            accept(march, length, start, before, after, near)
            return FOUND, solves
    return NONE, solves


def take_pair(rolling: Rolling, before: RollingState, near: int) -> None:
    """Write the rows of the corners that may touch; where there is none, one that is far away."""
    for rows in (rolling.before, rolling.after):
        for r in range(len(rows.force)):
            clear_row(rows, r, r < 2)
            if r % 2 < near:
                copy_row(before.rows, row_of(rolling, r), rows, r)


def row_of(rolling: Rolling, r: int) -> int:
    """Return the row among those of all corners of a row of two."""
    return int(rolling.at[r % 2] + r // 2 * len(rolling.xi))


def clear_row(rows: Rows, r: int, across: bool) -> None:
    """Write a row without force, of an open contact."""
    rows.state[r] = LOWER if across else INSIDE
    rows.opening[r] = 0.0
    rows.force[r] = 0.0
    rows.slip[r] = 0.0


def copy_row(source: Rows, i: int, target: Rows, k: int) -> None:
    """Copy a row."""
    target.state[k] = source.state[i]
    target.opening[k] = source.opening[i]
    target.force[k] = source.force[i]
    target.slip[k] = source.slip[i]


def set_rows(march: March, before: RollingState, near: int) -> None:
    """Write B_f of the corners that may touch by the modes: gaps, then mean and difference of their ways."""
    rolling = march.method
    weight = march.body.weight
    n = len(march.room.x)
    for k in range(2):
        if k < near:
            corner = rolling.at[k]
            force_directions(rolling, before, rolling.xi[corner][0], rolling.xi[corner][1])
        for i in range(n):
            weight[k][i] = by_mode(rolling, rolling.up, i) if k < near else 0.0
            if march.laws.paired:
                way = by_mode(rolling, rolling.across, i) if k < near else 0.0
                if k == 0:
                    weight[2][i] = way / 2
                    weight[3][i] = 0.0 - way
                else:
                    weight[2][i] += way / 2
                    weight[3][i] += way


def force_directions(rolling: Rolling, before: RollingState, x: float, y: float) -> None:
    """Write B_f of a point, for the increments D and their turn."""
    for j in range(3, 6):
        rolling.q[j] = before.q[j] + rolling.D[j] / 2
    directions(rolling.turn.chord, rolling.turn.mean, rolling.q, x, y, rolling.across, rolling.up)
    late = rolling.late
    if late == 0:
        return
    for j in range(3, 6):
        rolling.q[j] = before.q[j] + rolling.D[j]
    for j in range(2):
        rolling.spin[0][j] = -rolling.turn.end[1][j]
        rolling.spin[1][j] = rolling.turn.end[0][j]
    directions(rolling.spin, rolling.turn.end, rolling.q, x, y, rolling.across_end, rolling.up_end)
    for j in range(6):
        rolling.across[j] = (1 - late) * rolling.across[j] + late * rolling.across_end[j]
        rolling.up[j] = (1 - late) * rolling.up[j] + late * rolling.up_end[j]


def push_loads(march: March, before: RollingState) -> None:
    """Write what the dead loads push the modes by, for the increments D and their turn."""
    rolling = march.method
    pushed = march.room.pushed
    for i in range(len(pushed)):
        pushed[i] = 0.0
    for k in range(rolling.loads):
        force_directions(rolling, before, rolling.where[k][0], rolling.where[k][1])
        for i in range(len(pushed)):
            along = rolling.dead[k][0] * by_mode(rolling, rolling.across, i)
            pushed[i] += march.body.mobility[i] * (along + rolling.dead[k][1] * by_mode(rolling, rolling.up, i))


def add_forces(march: March, length: Length) -> None:
    """Write the increments of the modes under the present forces of the contacts."""
    rolling = march.method
    pushed = march.room.pushed
    push_modes(march, rolling.after.force)
    for i in range(len(pushed)):
        pushed[i] = rolling.loaded[i] + length.numbers[3] * length.inverse[i] * pushed[i]


def set_openings(march: March, length: Length, near: int) -> None:
    """Write the openings without forces for the flexibility, linear about the present place and forces."""
    rolling = march.method
    work = march.work
    room = march.room
    free = room.free
    add_forces(march, length)
    for i in range(len(room.pushed)):
        room.pushed[i] -= rolling.x[i]
    move_rows(march.body, room.pushed, free)
    if march.laws.paired:
        unpair_ways(free)
    for r in range(len(free)):
        free[r] -= flexed(march.laws, length.flexible, r, rolling.after.force)
    for k in range(2):
        if k >= near:
            work.q[k] = FAR
            continue
        corner = rolling.at[k]
        x, y = place(rolling.q, rolling.turn.end, rolling.xi[corner][0], rolling.xi[corner][1])
        work.q[k] = y - room.end[1] + free[k]
        if march.laws.paired:
            way = x - room.end[0] - rolling.rest[corner][0] + free[2 + k]
            work.q[2 + k] = rolling.before.opening[2 + k] + way
    if march.laws.paired:
        work.pair[0] = (work.q[2] + work.q[3]) / 2
        work.pair[1] = work.q[3] - work.q[2]


def accept(
    march: March, length: Length, start: RollingState, before: RollingState, after: RollingState, near: int
) -> None:
    """Write the state at the end of the stage."""
    rolling = march.method
    room = march.room
    corners = len(rolling.xi)
    turn(before.Q, rolling.D[2], rolling.exact, rolling.turn)
    push_loads(march, before)
    if near > 0:
        set_rows(march, before, near)
        add_push(march, rolling.after.force)
    end_modes(march, length, start, before, after, len(march.body.k))
    displace(rolling, before, rolling.D)
    copy(rolling.q, after.q)
    copy_matrix(rolling.turn.end, after.Q)
    place_corners(rolling, rolling.q, rolling.turn.end, room.end, rolling.place)
    rows = after.rows
    for r in range(len(rows.force)):
        clear_row(rows, r, r < corners)
        if r < corners:
            rows.opening[r] = rolling.place[r][1]
    for r in range(len(rolling.after.force)):
        if r % 2 < near:
            copy_row(rolling.after, r, rows, row_of(rolling, r))
    for r in range(corners, len(rows.force)):
        k = r - corners
        after.path[r] = before.path[r] + rows.slip[r]
        if rows.state[k] != INSIDE or before.rows.state[k] != INSIDE:
            way = rolling.place[k][0] - rolling.rest[k][0]
            after.path[r] = before.path[r] + before.rows.opening[r] + way - rows.opening[r]


# ---- what is kept ----------------------------------------------------------------------------------------------------


def account(march: March, state: RollingState, after: RollingState, course: Course, part: Part, sums: Vector) -> None:
    """Add what an accepted part of a step slips, gives and loses by its contacts; the algorithm loses the rest."""
    rolling = march.method
    growth = area_growth(rolling, state.Q)
    kinetic = 0.0
    for i in range(len(state.p)):
        mass = growth if rolling.translation[i] == 1 else growth * growth
        kinetic += mass * state.p[i] * state.p[i] / 2
    add_damping(march, part, kinetic / (march.scheme.step * march.scheme.step), sums)
    account_stages(march, state, after, course, part, sums)


def account_stage(
    march: March,
    stage: StageRoom,
    before: AnyState,
    after: AnyState,
    course: Course,
    part: Part,
    sums: Vector,
) -> None:
    """Add what the contacts lose in a stage."""
    rolling = march.method
    prescribe(march, course, stage, part)
    length = march.scheme.step * part.ratio * (stage.numbers.end - stage.numbers.begin)
    add_contact_losses(march, rolling.laws, rolling.ground, before, after, rolling.weight, length, sums)


def keep(march: March, state: RollingState, rows: Array, number: int) -> bool:
    """Write q, V and Q at the end of a step; tell whether it is finite."""
    rolling = march.method
    scheme = march.scheme
    discount = kept_discount(scheme, number)
    for i in range(len(state.p)):
        march.room.pushed[i] = (discount * state.p[i] + scheme.lag * state.a[i]) / scheme.step
    by_modes(rolling, march.room.pushed, rolling.new)
    total = state.q[0] + state.q[1]
    for j in range(6):
        rows[number, j] = state.q[j]
        rows[number, 6 + j] = rolling.new[j]
        total += rolling.new[j]
    for i in range(2):
        for j in range(2):
            rows[number, 12 + 2 * i + j] = state.Q[i][j]
    return math.isfinite(total)


account_stages = over_stages(account_stage)
make_steps = steps_by(make_stage, account, keep)
