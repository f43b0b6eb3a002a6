r"""One step of any body, by any scheme, on any contacts.

Every block is taken alone, without its springs, in its own natural modes: z'' + k z = load, inertia one, stiffness a
diagonal, k = 0 of its rigid motions. All that joins it to a base or to others is a row of contact, of the opening
B_r z and the force lambda_r, which pushes the modes by B_r' lambda_r. With h the length, u = gg v the velocity that a
step starts with and the end (zg, vg, ag) of the stage before, a stage (`dda.scheme.stage`) is, mode by mode,

    s (z1 - zg) = h (d_u u + d_g vg) + h^2 (e_0 a + e_g ag) + alpha h^2 f(zg) + b h^2 B' lambda,      s = 1 + b h^2 k
    R1 = F - k z1 + B' lambda,      a1 = f of R1,      v1 = u + h (g_0 a + g_g ag + delta a1)

where f balances the forces R between the ends of a step, and b = alpha (1 - af)/(1 - am). So in three lines:

    the modes without contact forces (`free_modes`), and by these the openings q without them (`free_rows`),
    the forces of the contacts (`dda.contact.rows.find`), by the flexibility W = b h^2 B s^-1 B',
    the modes under these forces (`end_modes`).

A shorter step costs nothing to set up: s is a number for each mode. The displacement of a rigid motion enters no force;
it is read from the openings where these are known. A base moves from under the rows alone.

Two rules of Newmark's scheme keep the contact force out of a, the block's own, and put one force of the step into the
displacement, with the weight 1/2 for b, and into the velocity, with 1: that of its end (Kane, Repetto, Ortiz and
Marsden 1999), or that of `dda.contact.conserving`.

The state is in units of the scheme's step dt: p = dt v, a for dt^2 a, R for dt^2 R.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from dda.contact.dense import Matrix, Vector, copy, copy_matrix
from dda.contact.rows import (
    FOUND,
    INSIDE,
    LIMIT,
    NONE,
    OVERFLOW,
    Flexibility,
    Laws,
    Rows,
    Solved,
    Work,
    flexed,
    flexibility_for,
    rows_of,
    unpair,
    unpair_ways,
    work_for,
)
from dda.march.energy import SUMS
from dda.model.arrays import Array
from dda.model.load import BaseMotion
from dda.scheme.newmark import Scheme
from dda.scheme.stage import Stage, implicit_weight, inertia_force, plain_stage, predictor, velocity_corrector

AnyState = Any  # `State`, or what has its fields
Finder = Callable[..., Solved]
POWERS = 1.0, 2.0, 1.0, 2.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0  # of a length, in `StageRoom.factors`
SHORTEST = 0.01  # shortest part of a step that a cut may leave


class Body(NamedTuple):
    """Natural modes, and the rows of contact by these."""

    k: Vector  # (n,) squares of the natural frequencies [1/s^2]; 0 of a rigid motion
    loads: Matrix  # (l, n) modal loads, each with a share that changes in time
    stored: Vector  # (l,) share of each load that counts as energy of the load, the rest of its work as given
    first: Any  # (m,) first of the modes that a row of contact feels
    weight: Matrix  # (m, w) its opening by this and those that follow
    ground: Matrix  # (m, 2) what a unit displacement of the base, along and away from itself, takes from the openings
    mobility: Vector  # (n,) acceleration by a unit modal force; one, unless a body grows


class Numbers(NamedTuple):
    """The scheme as numbers."""

    stages: int  # 1, or 2
    newmark: bool  # else the algorithm loses what all others leave of the balance of energy
    averages: bool  # whether forces of contact enter a
    impulses: bool  # whether they are impulses, which change the velocity
    gg: float
    step: float  # dt [s]
    lag: float  # by how much of a step p is older than z


class Length(NamedTuple):
    """What belongs to a stage of one length."""

    numbers: Vector  # (4,) length over dt, gg for it, length [s], weight of contact forces in z [s^2], 1 of impulses
    factors: Vector  # (14,) those of a stage for it
    inverse: Vector  # (n,) 1/s
    flexible: Flexibility


class StageRoom(NamedTuple):
    """A stage of the scheme."""

    numbers: Stage  # with gg = 1: the velocity that it takes is discounted
    # in s times an increment, of p, a of the start, of these of the stage before, and of R at the end, R, a of the
    # start; of these three in a at the end; in p there, of p, a of the start, a before, a at the end
    factors: Vector  # (14,)
    whole: Length  # of a whole step
    part: Length  # of the last part of a step


class State(NamedTuple):
    """Where a body is, in units of the step."""

    z: Vector  # (n,) modes
    p: Vector  # (n,) dt v
    a: Vector  # (n,) dt^2 a
    R: Vector  # (n,) dt^2 times all forces
    path: Vector  # (m,) where the reference of a row is: path + opening is its way [m]
    rows: Rows


class Room(NamedTuple):
    """Room for the vectors of a step."""

    start: Vector  # (2 + l,) displacement of the base [m], and the shares of the loads, at the start of a stage
    end: Vector  # the same at its end
    shares: Vector  # (l,) by which the loads are written
    x: Vector  # (n,) increments without contact forces
    load: Vector  # (n,) loads at the end of the stage
    pushed: Vector  # (n,) B' lambda
    softened: Vector  # (w,) a row of B s^-1, times the weight of forces [s^2]
    free: Vector  # (m,) what the step without forces adds to the openings
    force: Vector  # (m,) forces in the coordinates of the body


class NoMethod(NamedTuple):
    """A rule of contact without numbers of its own; compiled code takes no empty record."""

    nothing: int = 0


NO_METHOD = NoMethod()


class March(NamedTuple):
    """A body, its contacts and its scheme, with room for a step."""

    body: Body
    laws: Laws
    scheme: Numbers
    first: StageRoom  # of two
    last: StageRoom
    between: AnyState  # at the end of the first one
    room: Room
    work: Work
    lengths: Vector  # (1,) how many lengths were set up
    tally: Vector  # (1,) since a step was kept: passes of the augmented Lagrangian, contacts of a column that switched
    method: Any  # numbers of the rule of contact


class Course(NamedTuple):
    """What is prescribed, linear between instants and constant beyond them."""

    time: Vector  # (i,) [s]
    value: Matrix  # (i, 2 + l) displacement of the base along and away from itself [m], shares of the loads
    latest: Any  # (1,) number of the instant before the time that was looked up last


class Part(NamedTuple):
    """A whole step, or a part of one."""

    begun: float  # where it begins, in steps from t = 0
    ratio: float  # how long it is, in steps


class History(NamedTuple):
    """What is kept of every step; row 0 is the state at t = 0, from which the sums go on."""

    motion: Array  # (steps + 1, ...) what the body keeps of itself
    force: Array  # (steps + 1, m)
    opening: Array
    path: Array  # (steps + 1, m - n) of the ways along the base
    slip: Array  # the same, summed over the parts of a step
    state: Any
    solves: Any  # (steps + 1,) of the open-close iteration, the confirming one, repeated and cut steps included
    cuts: Any  # (steps + 1,) times that the step was cut
    sums: Array  # (steps + 1, SUMS) of `dda.march.energy`; (0, SUMS) if the energies are not asked for


# ---- what is set up --------------------------------------------------------------------------------------------------


def march_of(
    body: Body,
    laws: Laws,
    scheme: Scheme,
    opening: Array,
    method: Any = NO_METHOD,
    averages: bool = True,
    impulses: bool = False,
) -> March:
    """Return a march, with what belongs to whole steps made.

    Parameters
    ----------
    opening : (m,) array
        Openings at t = 0 [m].
    method
        A named tuple of numbers for another rule of contact.
    averages
        Whether the forces of contact enter the acceleration.
    impulses
        Whether they are impulses.
    """
    n = len(body.k)
    m = len(laws.compliance)
    rooms = [stage_room(plain_stage(stage), n, m, laws.banded) for stage in scheme.stages]
    loads = len(body.loads)
    width = max(map(len, body.weight), default=0)
    vectors = [*np.zeros((2, 2 + loads)), np.full(loads, np.inf), *np.zeros((3, n)), np.zeros(width), *np.zeros((2, m))]
    march = March(
        body=body,
        laws=laws,
        scheme=Numbers(len(rooms), scheme.table is None, averages, impulses, scheme.gg, scheme.step, float(scheme.lag)),
        first=rooms[0],
        last=rooms[-1],
        between=state_of(n, opening, np.zeros(m)),
        room=Room(*vectors),
        work=work_for(laws.contacts, m, laws.banded),
        lengths=np.zeros(1),
        tally=np.zeros(1),
        method=method,
    )
    for stage in rooms:
        set_length(march, stage, 1.0, stage.whole)
    return march


def state_of(modes: int, opening: Array, state: Any) -> State:
    """Return a state at rest, without forces."""
    z, p, a, R = np.zeros((4, modes))
    return State(z, p, a, R, np.zeros(len(opening)), rows_of(opening, state))


def stage_room(stage: Stage, modes: int, rows: int, banded: bool) -> StageRoom:
    """Return a stage, with room for what belongs to it."""
    flexible = [flexibility_for(rows, banded) for _ in range(2)]
    lengths = [Length(np.zeros(4), np.zeros(len(POWERS)), np.ones(modes), part) for part in flexible]
    ahead = predictor(stage, *np.eye(4))
    held = inertia_force(stage, *np.eye(3))
    late = velocity_corrector(stage, *np.eye(4))
    return StageRoom(stage, np.concatenate([ahead, stage.alpha * held, held, late]), *lengths)


def course_of(motion: BaseMotion | None, ramp: float) -> Course:
    """Return what is prescribed of a base along its axes, and the share of one load that rises in a time [s]."""
    instants = np.zeros(1) if motion is None else np.asarray(motion.time, float)
    if ramp:
        instants = np.union1d(instants, [0.0, ramp])
    moved = np.zeros((len(instants), 2)) if motion is None else motion.at(instants)
    share = np.clip(instants / ramp, 0.0, 1.0) if ramp else np.ones(len(instants))
    return Course(instants, np.column_stack([moved, share]), np.zeros(1, dtype=np.int64))


def history_of(steps: int, motion: int, contacts: int, rows: int, energies: bool) -> History:
    """Return room for so many steps, of bodies with so many numbers, contacts and rows of their own."""
    ways = rows - contacts
    parts: list[Any] = [np.zeros((steps + 1, size)) for size in (motion, rows, rows, ways, ways)]
    parts.append(np.zeros((steps + 1, rows), dtype=np.int8))
    parts += [np.zeros(steps + 1, dtype=np.int64) for _ in range(2)]
    parts.append(np.zeros((steps + 1 if energies else 0, SUMS)))
    return History(*parts)


def reached_history(history: History, reached: int) -> History:
    """Return the history without the steps that were not reached."""
    parts: list[Any] = [part[: reached + 1] for part in history]
    return History(*parts)


# ---- one stage -------------------------------------------------------------------------------------------------------


def set_length(march: March, stage: StageRoom, ratio: float, length: Length) -> None:
    """Write what belongs to a length: 1/s of the modes, and the flexibility of the contacts."""
    write_flexibility(march, set_modes(march, stage, ratio, length), length)
    march.lengths[0] += 1


def set_modes(march: March, stage: StageRoom, ratio: float, length: Length) -> float:
    """Write what belongs to a length but for its contacts; return the weight of their forces in the displacement [s^2].

    A shorter step keeps the share gg^ratio of the velocity, so that the parts of a step together keep gg.
    """
    body = march.body
    h = march.scheme.step * ratio
    implicit = implicit_weight(stage.numbers)
    weight = (implicit if march.scheme.averages else 0.5) * h * h
    if march.scheme.impulses:
        weight = 1.0
    if length.numbers[0] != ratio:
        length.numbers[0] = ratio
        length.numbers[1] = march.scheme.gg**ratio
        length.numbers[2] = h
        length.numbers[3] = weight
        factors = length.factors
        for k in range(len(factors)):
            factors[k] = stage.factors[k] * ratio ** POWERS[k]
        factors[0] *= length.numbers[1]
        factors[4] *= march.scheme.step * march.scheme.step
        factors[10] *= length.numbers[1]
    for i in range(len(body.k)):
        length.inverse[i] = 1 / (1 + implicit * h * h * body.k[i])
    if march.laws.retardation > 0:  # forces change y + tau y', by which these springs press
        late = stage.numbers.delta * (1 - stage.numbers.af) / (1 - stage.numbers.am)
        retarded = weight + march.laws.retardation * late * h
        length.flexible.own[0] = weight / retarded if weight > 0 else 0.0
        weight = retarded
    return weight


def write_flexibility(march: March, weight: float, length: Length) -> None:
    """Write W = weight B s^-1 B'."""
    body = march.body
    laws = march.laws
    flexible = length.flexible
    m = len(march.room.free)
    softened = march.room.softened
    inverse = length.inverse
    mobility = body.mobility
    for r in range(m):
        row = body.weight[r]
        first = body.first[r]
        for e in range(len(row)):
            softened[e] = weight * row[e] * (inverse[first + e] * mobility[first + e])
        for s in range(r, min(r + 2, m) if laws.banded else m):
            later = body.weight[s]
            ahead = body.first[s] - first
            entry = 0.0
            if ahead >= 0:  # a row that begins earlier than one before it shares no modes with it
                for e in range(len(row) - ahead):
                    entry += softened[ahead + e] * later[e]
            if laws.banded:
                flexible.W[s - r][r] = entry
            else:
                flexible.paired[r][s] = entry
                flexible.paired[s][r] = entry
    if laws.paired:
        unpair(flexible.paired, flexible.W)
    elif not laws.banded:
        copy_matrix(flexible.paired, flexible.W)


def move_rows(body: Body, x: Vector, out: Vector) -> None:
    """Write B x."""
    weight = body.weight
    first = body.first
    for r in range(len(out)):
        mode = first[r]
        total = 0.0
        for share in weight[r]:
            total += share * x[mode]
            mode += 1
        out[r] = total


def coast(stage: StageRoom, length: Length, start: AnyState, out: Vector) -> None:
    """Write the ways of the modes in a stage at the accelerations of the start."""
    way = (stage.numbers.end - stage.numbers.begin) * length.numbers[0]
    for i in range(len(out)):
        out[i] = length.numbers[1] * way * start.p[i] + way * way * start.a[i] / 2


def push_modes(march: March, force: Vector) -> None:
    """Write B' lambda."""
    pushed = march.room.pushed
    for i in range(len(pushed)):
        pushed[i] = 0.0
    add_push(march, force)


def forces_of_ways(march: March, force: Vector) -> None:
    """Write the forces as rows of the body: of two ways that are paired their sum and half their difference."""
    room = march.room
    copy(force, room.force)
    if march.laws.paired:
        room.force[2] = force[2] + force[3]
        room.force[3] = (force[3] - force[2]) / 2


def add_push(march: March, force: Vector) -> None:
    """Add B' lambda."""
    body = march.body
    weight = body.weight
    mobility = body.mobility
    pushed = march.room.pushed
    by = force
    if march.laws.paired:
        by = march.room.force
        forces_of_ways(march, force)
    for r in range(len(force)):
        push = by[r]
        if push != 0.0:
            mode = body.first[r]
            for share in weight[r]:
                pushed[mode] += mobility[mode] * share * push
                mode += 1


def length_of(march: March, stage: StageRoom, ratio: float) -> Length:
    """Return what belongs to a length, over dt."""
    if ratio == 1.0:
        return stage.whole
    if stage.part.numbers[0] != ratio:
        set_length(march, stage, ratio, stage.part)
    return stage.part


def prescribe(march: March, course: Course, stage: StageRoom, part: Part) -> None:
    """Write base and shares of the loads at both ends of a stage."""
    room = march.room
    step = march.scheme.step
    look_up(course, (part.begun + part.ratio * stage.numbers.begin) * step, room.start)
    look_up(course, (part.begun + part.ratio * stage.numbers.end) * step, room.end)


def look_up(course: Course, time: float, out: Vector) -> None:
    """Write what is prescribed at a time; times follow each other."""
    instants = course.time
    latest = course.latest
    last = len(instants) - 1
    low = latest[0]
    while low > 0 and instants[low] > time:
        low -= 1
    while low < last and instants[low + 1] <= time:
        low += 1
    latest[0] = low
    before = course.value[low]
    if low < last and instants[low] < time:
        after = course.value[low + 1]
        share = (time - instants[low]) / (instants[low + 1] - instants[low])
        for j in range(len(out)):
            out[j] = before[j] + share * (after[j] - before[j])
    else:
        for j in range(len(out)):
            out[j] = before[j]


def write_loads(march: March) -> None:
    """Write the loads of all modes where a share has changed; the shares come after the base's displacement."""
    room = march.room
    shares = room.shares
    out = room.load
    changed = False
    for j in range(len(shares)):
        if shares[j] != room.end[2 + j]:
            shares[j] = room.end[2 + j]
            changed = True
    if not changed:
        return
    for i in range(len(out)):
        out[i] = 0.0
    for j in range(len(shares)):
        share = shares[j]
        load = march.body.loads[j]
        if share != 0.0:
            for i in range(len(out)):
                out[i] += share * load[i]


def free_modes(march: March, length: Length, start: AnyState, before: AnyState) -> None:
    """Write the loads at the end of a stage, and the increments of the modes in it without contact forces."""
    room = march.room
    k = march.body.k
    x = room.x
    load = room.load
    inverse = length.inverse
    p_0 = start.p
    a_0 = start.a
    R_0 = start.R
    z = before.z
    p = before.p
    a = before.a
    factors = length.factors
    by_p_0 = factors[0]
    by_a_0 = factors[1] + factors[6]
    by_p = factors[2]
    by_a = factors[3]
    by_force = factors[4]
    by_R_0 = factors[5]
    more = by_R_0 != 0.0 or by_p != 0.0 or by_a != 0.0  # than Newmark's scheme takes
    write_loads(march)
    for i in range(len(k)):
        moved = by_p_0 * p_0[i] + by_a_0 * a_0[i] + by_force * (load[i] - k[i] * z[i])
        if more:
            moved += by_R_0 * R_0[i] + by_p * p[i] + by_a * a[i]
        x[i] = inverse[i] * moved


def free_rows(march: March, before: AnyState) -> None:
    """Write the openings at the end of a stage without contact forces."""
    body = march.body
    room = march.room
    ground = body.ground
    free = room.free
    q = march.work.q
    opening = before.rows.opening
    paired = march.laws.paired
    along = room.end[0] - room.start[0]
    away = room.end[1] - room.start[1]
    move_rows(body, room.x, free)
    for r in range(len(free)):
        if not (paired and r == 3):  # a base that moves leaves the difference of two ways alone
            free[r] -= ground[r][0] * along + ground[r][1] * away
    if paired:
        march.work.pair[0] = free[2] + (opening[2] + opening[3]) / 2
        march.work.pair[1] = free[3] + (opening[3] - opening[2])
        unpair_ways(free)
    for r in range(len(free)):
        q[r] = opening[r] + free[r]


def free_end(march: March, length: Length, start: AnyState, before: AnyState, after: AnyState, modes: int) -> None:
    """Write the first modes at the end of a stage without contact forces."""
    for i in range(modes):
        march.room.pushed[i] = 0.0
    end_modes(march, length, start, before, after, modes)


def retard(march: March, stage: StageRoom, length: Length, start: State, before: State, after: State) -> None:
    """Add tau y' at the end of a stage without contact forces to the openings; a base moves evenly."""
    body = march.body
    room = march.room
    h = length.numbers[2]
    late = march.work.late
    free_end(march, length, start, before, after, len(body.k))
    move_rows(body, after.p, late)
    for r in range(len(room.free)):
        rate = late[r] / march.scheme.step
        for axis in range(2):
            moved = room.end[axis] - room.start[axis]
            rate -= body.ground[r][axis] * moved / (h * (stage.numbers.end - stage.numbers.begin))
        late[r] = march.laws.retardation * rate
        march.work.q[r] += late[r]


def end_modes(march: March, length: Length, start: AnyState, before: AnyState, after: AnyState, modes: int) -> None:
    """Write the first modes at the end of a stage under the forces `room.pushed`."""
    room = march.room
    step = march.scheme.step
    averages = march.scheme.averages
    k = march.body.k
    x = room.x
    load = room.load
    pushed = room.pushed
    inverse = length.inverse
    p_0 = start.p
    a_0 = start.a
    R_0 = start.R
    z_before = before.z
    a_before = before.a
    z_end = after.z
    p_end = after.p
    a_end = after.a
    R_end = after.R
    weight = length.numbers[3]
    factors = length.factors
    of_R = factors[7]
    of_R_0 = factors[8]
    of_a_0 = factors[9]
    by_p_0 = factors[10]
    by_a_0 = factors[11]
    by_a_before = factors[12]
    by_a = factors[13]
    more = of_R_0 != 0.0 or of_a_0 != 0.0 or by_a_before != 0.0  # than Newmark's scheme takes
    dt2 = step * step
    impulse = length.numbers[0] * dt2
    for i in range(modes):
        push = pushed[i]
        z = z_before[i] + x[i] + weight * inverse[i] * push
        R = dt2 * (load[i] - k[i] * z)
        if averages:
            R += dt2 * push
        a = R
        p = by_p_0 * p_0[i] + by_a_0 * a_0[i]
        if more:
            a = of_R * R + of_R_0 * R_0[i] + of_a_0 * a_0[i]
            p += by_a_before * a_before[i]
        p += by_a * a
        if not averages:
            p += impulse * push
        z_end[i] = z
        p_end[i] = p
        a_end[i] = a
        R_end[i] = R


def end_paths(march: March, flexible: Flexibility, before: AnyState, after: AnyState) -> None:
    """Write the references: that of a row which slips moves, what is open takes it along."""
    laws = march.laws
    n = laws.contacts
    rows = after.rows
    slip = rows.slip
    path = after.path
    path_before = before.path
    for r in range(len(slip)):
        path[r] = path_before[r] + slip[r]
    for r in range(n, len(slip)):
        if rows.state[r - n] != INSIDE or before.rows.state[r - n] != INSIDE:
            way = march.room.free[r] + flexed(laws, flexible, r, rows.force)
            path[r] = path_before[r] + before.rows.opening[r] + way - rows.opening[r]


def stage_with(find: Finder) -> Finder:
    """Return what makes a stage whose contacts are found by a function: `dda.contact.rows.find`, or another rule.

    Parameters
    ----------
    find
        (march, before, flexible, after) -> outcome and number of solves; it writes the rows at the end of the stage,
        and into `march.work.mean` the forces that act over it.
    """

    def make_stage(
        march: March, stage: StageRoom, start: State, before: State, after: State, course: Course, part: Part
    ) -> Solved:
        """Go from the end of the stage before to the end of a stage; return the outcome and the number of solves."""
        length = length_of(march, stage, part.ratio)
        prescribe(march, course, stage, part)
        free_modes(march, length, start, before)
        free_rows(march, before)
        if march.laws.retardation > 0:
            retard(march, stage, length, start, before, after)
        outcome, solves = find(march, before.rows, length.flexible, after.rows)
        if outcome == FOUND:
            push_modes(march, march.work.mean)
            end_modes(march, length, start, before, after, len(march.body.k))
            end_paths(march, length.flexible, before, after)
        return outcome, solves

    return make_stage


# ---- the steps -------------------------------------------------------------------------------------------------------


def keep_rows(march: March, state: AnyState, history: History, number: int) -> None:
    """Write the rows at the end of a step."""
    rows = state.rows
    n = len(rows.force) - history.path.shape[1]
    for r in range(len(rows.force)):
        history.force[number, r] = rows.force[r]
        history.opening[number, r] = rows.opening[r]
        history.state[number, r] = rows.state[r]
        if r >= n:
            history.path[number, r - n] = state.path[r]


def steps_by(
    make_stage: Finder,
    account: Callable[..., None],
    keep: Callable[..., bool],
    keep_rows: Callable[..., None] = keep_rows,
) -> Finder:
    """Return the loop over the steps of a body.

    Parameters
    ----------
    make_stage
        Makes a stage from `before` to `after`, of a step that began at `start`, and leaves these as they are:
        (march, stage, start, before, after, course, part) -> outcome and number of solves.
    account
        Adds what the part of a step that was made last loses to the sums: (march, state, after, course, part, sums).
    keep
        Writes the state at the end of a step into a row, (march, state, rows, number), and tells whether it is finite.
    keep_rows
        Writes what is kept of the rows of contact, (march, state, history, number).
    """

    def make_steps(
        march: March, state: State, after: State, course: Course, history: History, steps: int, cut: float
    ) -> tuple[int, int]:
        """Make the steps that are reached; return how many, and how it ended.

        A step whose contacts have no single state is repeated, shorter, from the state in which it began; the rest of
        the interval follows, so that every interval ends at its own time.
        """
        keep(march, state, history.motion, 0)
        keep_rows(march, state, history, 0)
        scheme = march.scheme
        slips = history.slip.shape[1]
        for number in range(steps):
            row = number + 1
            remainder = 1.0
            ratio = 1.0
            if len(history.sums) > 0:
                for k in range(SUMS):
                    history.sums[row, k] = history.sums[number, k]
            while True:
                part = Part(number + (1.0 - remainder), ratio)
                outcome = NONE
                if scheme.lag == 0 or ratio == 1.0:  # a velocity of half a step before goes on in equal steps only
                    before = state
                    for place in range(scheme.stages):
                        is_last = place + 1 == scheme.stages
                        stage = march.last if is_last else march.first
                        end = after if is_last else march.between
                        outcome, solves = make_stage(march, stage, state, before, end, course, part)
                        history.solves[row] += solves
                        if outcome != FOUND:
                            break
                        before = end
                if outcome != FOUND:
                    if ratio <= SHORTEST or outcome >= LIMIT:
                        return number, outcome
                    ratio = max(cut * ratio, SHORTEST)
                    history.cuts[row] += 1
                    continue
                if len(history.sums) > 0:
                    account(march, state, after, course, part, history.sums[row])
                n = len(after.path) - slips
                for k in range(slips):
                    history.slip[row, k] += after.rows.slip[n + k]
                    if scheme.stages == 2:
                        history.slip[row, k] += march.between.rows.slip[n + k]
                state, after = after, state
                if ratio == remainder:
                    break
                remainder -= ratio
                ratio = remainder
            if not keep(march, state, history.motion, row):
                return number, OVERFLOW
            keep_rows(march, state, history, row)
        return steps, FOUND

    return make_steps


def kept_discount(scheme: Numbers, number: int) -> float:
    """Return the factor of p where a state is kept: at t = 0 that of what `late_momentum` made of it."""
    return scheme.gg if number == 0 and scheme.lag != 0 else 1.0


def keep_modes(march: March, state: State, rows: Array, number: int) -> bool:
    """Write z and p at its time; tell whether z is finite."""
    n = len(state.z)
    lag = march.scheme.lag
    discount = kept_discount(march.scheme, number)
    total = 0.0
    for i in range(n):
        rows[number, i] = state.z[i]
        rows[number, n + i] = discount * state.p[i] + lag * state.a[i]
        total += state.z[i]
    return math.isfinite(total)
