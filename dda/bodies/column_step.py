r"""Steps of a column: its blocks in their modes, what joins them as rows of contact.

A block of mass m per area and stiffness K = E/h has a mean displacement u and a stretch e = top - foot, in which its
inertia m, m/12 and its stiffness 0, K are diagonal. The modes of block i are 2i and 2i + 1,

    z = sqrt(m) u,    sqrt(m/12) e        u = z_2i / sqrt(m),    e/2 = sqrt(3/m) z_2i+1,

and row i is the contact between its foot and the top of the block below, so that every row feels four modes and its
neighbours alone (`Laws.banded`). A rigid block has a stretch that nothing moves; where no block has any, the mean is
the only mode of each. Contacts have N >= 0, or -s <= N <= s in shear; glue has no bounds, welded faces are
rigid besides. All are one problem, the least of a strictly convex function of N within bounds, which has exactly one
solution: no step is ever cut. Where touching blocks are stiff against a step a closing spreads by one contact a solve;
N + 1 solves are the most known of contacts that open, 2 N + 1 of those that slip. Where states changed
`SWEEPS` times the number of contacts, one changes at a time, which ends for every such matrix (Murty 1974).

Displacements follow from gaps, slips and stretches, from the base upwards (`place_blocks`): neither stiff springs nor
long steps, in which weight alone would move a block by g dt^2, cost digits.

A half-space follows the velocity V of its surface, N_0 = zeta (2 v - V). With a spring of stiffness p above it the
surface has a motion of its own, and by the scheme's formulas for that (* what is known before the force)

    foot + (1/p + alpha h / (delta zeta)) N_0 = surface* + alpha h / delta (2 v - V*)

is a row. Without one V = v_foot. A lowest block that is welded to a base has the motion of its top alone, of inertia
m/3, on a spring of the stiffness K, with the load -m/6 y'' of the base's acceleration y''; it takes of the base the
force

    N_0 + m (g/2 + y''/3 + a_top/6).

A rigid one moves as the base does. In an explicit stage forces move nothing before it ends: rigid rows then keep
accelerations together.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from dda.contact.band import find_in_band
from dda.contact.dense import Matrix, Vector, copy
from dda.contact.rows import FOUND, LOWER, Rows, Solved
from dda.march.account import account, half_square, over_stages
from dda.march.energy import DAMPING, GIVEN, IMPULSE
from dda.march.step import (
    AnyState,
    Course,
    History,
    Length,
    March,
    Part,
    StageRoom,
    end_modes,
    end_paths,
    free_end,
    free_modes,
    kept_discount,
    move_rows,
    prescribe,
    steps_by,
)
from dda.scheme.stage import inertia_force, predictor, velocity_corrector

SWEEPS = 4  # solves for each contact with all states updated at once
ROW, ABSENT, HALF_SPACE, SPRUNG = range(4)  # what is below the lowest block; SPRUNG: a spring and a half-space
WELDED, CARRIED = 4, 5  # a base to which an elastic block is welded, or a rigid one
PRESSURE, VELOCITY, ACCELERATION = 3, 4, 5  # of what is prescribed: on the top, of the base or the wave that comes up
# of a step, after what is observed: states that changed, then the stored energies, momentum, extremes of the contacts
SWITCHES, KINETIC, STRAINED, SPRINGS, MOMENTUM, WIDEST, DEEPEST, OPEN_SHARE, FURTHEST = range(9)
RECORDED = FURTHEST + 1

MODES, RATES, FORCES, GAP, SLIDE, FOOT = range(6)  # what an observer reads


class Observed(NamedTuple):
    """What is kept of every step, (columns,) each."""

    kind: Any
    place: Any  # block or contact
    lower: Vector  # weight of the mean of a block, or of the force at its foot
    upper: Vector  # that of its stretch, or of the force at its top


class Blocks(NamedTuple):
    """What modes and rows of a column are of it, (n,) each unless said."""

    root: Vector  # sqrt(m) [kg^1/2 / m]
    mean: Vector  # displacement by the mean's mode, 1/root; 0 of a block that a base carries
    half: Vector  # half the stretch by its mode, sqrt(3/m); 0 of a rigid block
    gap: Vector  # gaps at t = 0 [m]
    modes: int  # of each block, the stretch last
    base: int  # what is below
    mass: float  # of the lowest block [kg/m^2]
    gravity: float  # [m/s^2]
    impedance: float  # zeta [Pa s/m]
    observed: Observed


class ColumnState(NamedTuple):
    """Where a column is: what `dda.march.step.State` has, and the surface of a half-space below a spring."""

    z: Vector
    p: Vector
    a: Vector
    R: Vector
    path: Vector
    rows: Rows
    surface: Vector  # (2,) dt times its velocity, and dt^2 times its acceleration [m]


# ---- the stage -------------------------------------------------------------------------------------------------------


def make_column_stage(
    march: March,
    stage: StageRoom,
    start: AnyState,
    before: AnyState,
    after: AnyState,
    course: Course,
    part: Part,
) -> Solved:
    """Go from the end of the stage before to the end of a stage; return the outcome and the number of solves."""
    rows = after.rows
    length = stage.whole
    prescribe_instants(march, course, stage, part)
    free_modes(march, length, start, before)
    free_faces(march, before)
    hold_base(march, stage, length, start, before, after)
    outcome, solves = find_in_band(march.laws, before.rows, length.flexible, rows, march.work)
    if outcome != FOUND:
        return outcome, solves
    push_blocks(march, rows.force)
    end_modes(march, length, start, before, after, len(march.body.k))
    if march.method.base == SPRUNG:
        end_surface(march, stage, length, after)
    if march.laws.slips:
        end_paths(march, length.flexible, before, after)
    place_blocks(march, after)
    if solves > 1:
        states = rows.state
        old = before.rows.state
        for r in range(len(states)):
            if states[r] != old[r]:
                march.tally[0] += 1
    return outcome, solves


def prescribe_instants(march: March, course: Course, stage: StageRoom, part: Part) -> None:
    """Write what is prescribed at the end of a stage, and where the base was: no step of the course is ever cut."""
    instant = march.scheme.stages * int(part.begun) + 1 + (stage.numbers.begin > 0)
    march.room.start[1] = course.value[instant - 1][1]
    copy(course.value[instant], march.room.end)


def make_linear_stage(
    march: March,
    stage: StageRoom,
    start: AnyState,
    before: AnyState,
    after: AnyState,
    course: Course,
    part: Part,
) -> Solved:
    """Go to the end of a stage as `make_column_stage` does, in arrays, where no row opens or slips.

    Nothing is searched: the rows are one elimination.
    """
    from scipy.linalg.lapack import dptsv

    body = march.body
    room = march.room
    blocks = march.method
    length = stage.whole
    prescribe_instants(march, course, stage, part)
    room.load[:] = room.end[2:] @ body.loads
    numbers = stage.numbers
    dt2 = march.scheme.step**2
    p = length.numbers[1] * start.p
    ahead = predictor(numbers, p, start.a, before.p, before.a)
    held = inertia_force(numbers, dt2 * (room.load - body.k * before.z), start.R, start.a)
    room.x[:] = length.inverse * (ahead + numbers.alpha * held)
    modes = body.first[:, None] + np.arange(body.weight.shape[1])  # that each row feels
    moved = np.einsum("rm,rm->r", body.weight, room.x[modes]) - body.ground[:, 1] * (room.end[1] - room.start[1])
    march.work.q[:] = before.rows.opening + moved
    hold_base(march, stage, length, start, before, after)
    W = length.flexible.W
    force = dptsv(W[0] + march.laws.compliance, W[1, :-1], -march.work.q)[2]
    room.pushed[:] = np.bincount(modes.ravel(), (body.weight * force[:, None]).ravel(), len(room.pushed))
    after.rows.force[:] = force
    after.rows.opening[:] = -march.laws.compliance * force
    after.z[:] = before.z + room.x + length.numbers[3] * length.inverse * room.pushed
    after.R[:] = dt2 * (room.load - body.k * after.z + room.pushed)
    after.a[:] = inertia_force(numbers, after.R, start.R, start.a)
    after.p[:] = velocity_corrector(numbers, p, start.a, before.a, after.a)
    if blocks.base == SPRUNG:
        end_surface(march, stage, length, after)
    lowest, below = lowest_face(blocks, after.z, room.end[1])
    half = blocks.half[lowest:] * after.z[blocks.modes * (lowest + 1) - 1 :: blocks.modes]
    tops = below + np.cumsum((after.rows.opening - blocks.gap + after.path)[lowest:] + 2 * half)
    after.z[blocks.modes * lowest :: blocks.modes] = blocks.root[lowest:] * (tops - half)
    return FOUND, 1


def hold_base(
    march: March, stage: StageRoom, length: Length, start: AnyState, before: AnyState, after: AnyState
) -> None:
    """Make the rows of what is below the column, and welds of an explicit stage, what they are."""
    if march.method.base == HALF_SPACE:
        free_half_space(march, stage, length, start, before, after)
    elif march.method.base == SPRUNG:
        free_surface(march, stage, length, start, before, after)
    if length.numbers[3] == 0:
        hold_welds(march, length, before)


def lowest_face(blocks: Blocks, z: Vector, base: float) -> tuple[int, float]:
    """Return the first block that is placed by its row, and how far the face below it, or the base, has moved [m]."""
    if blocks.base == ROW or blocks.base == WELDED:
        return 0, base
    return 1, base if blocks.base == CARRIED else of_top(blocks, z, 0)


def free_faces(march: March, before: AnyState) -> None:
    """Write the openings at the end of a stage without contact forces.

    A foot on a half-space has its own; that of nothing below is zero from the start.
    """
    blocks = march.method
    room = march.room
    modes = blocks.modes
    mean = blocks.mean
    half = blocks.half
    opening = before.rows.opening
    x = room.x
    q = march.work.q
    lowest, below = lowest_face(blocks, x, room.end[1] - room.start[1])
    for i in range(lowest, len(q)):
        middle = mean[i] * x[modes * i]
        stretched = half[i] * x[modes * (i + 1) - 1]
        q[i] = opening[i] + (middle - below - stretched)
        below = middle + stretched


def push_blocks(march: March, force: Vector) -> None:
    """Write B' N: the mean of a block feels the difference of the forces on its faces, its stretch their sum."""
    blocks = march.method
    modes = blocks.modes
    mean = blocks.mean
    half = blocks.half
    pushed = march.room.pushed
    above = 0.0
    for i in range(len(force) - 1, -1, -1):
        below = force[i]
        pushed[modes * (i + 1) - 1] = 0.0 - half[i] * below - half[i] * above
        pushed[modes * i] = mean[i] * below - mean[i] * above  # where all are rigid, the only mode
        above = below


def place_blocks(march: March, state: AnyState) -> None:
    """Write the means from gaps, slips and stretches, above the base or the lowest block."""
    blocks = march.method
    modes = blocks.modes
    root = blocks.root
    half = blocks.half
    gap = blocks.gap
    opening = state.rows.opening
    path = state.path
    z = state.z
    lowest, below = lowest_face(blocks, z, march.room.end[1])
    for i in range(lowest, len(gap)):
        stretched = half[i] * z[modes * (i + 1) - 1]
        middle = below + (opening[i] - gap[i]) + path[i] + stretched
        z[modes * i] = root[i] * middle
        below = middle + stretched


# ---- a spring above a half-space -------------------------------------------------------------------------------------


def free_surface(
    march: March, stage: StageRoom, length: Length, start: AnyState, before: AnyState, after: AnyState
) -> None:
    """Make the lowest row that of the spring above a half-space, whose surface then moves by nothing known.

    It leaves what is known of h times the surface's velocity in `after`.
    """
    numbers = stage.numbers
    h = length.numbers[2]
    p = length.numbers[1] * start.surface[0]
    a = start.surface[1]
    a_before = before.surface[1]
    late = numbers.alpha / numbers.delta
    after.surface[0] = velocity_corrector(numbers, p, a, a_before, 0.0)
    moved = predictor(numbers, p, a, before.surface[0], a_before)
    moved += late * (2 * h * march.room.end[VELOCITY] - after.surface[0])
    march.work.q[0] = before.rows.opening[0] + of_foot(march.method, march.room.x) - moved
    length.flexible.W[0][0] = length.flexible.paired[0][0] + late * h / march.method.impedance


def end_surface(march: March, stage: StageRoom, length: Length, after: AnyState) -> None:
    """Write the motion of the surface that its force N_0 = zeta (2 v - V) has."""
    h = length.numbers[2]
    p = h * (2 * march.room.end[VELOCITY] - after.rows.force[0] / march.method.impedance)
    after.surface[1] = (p - after.surface[0]) / stage.numbers.delta
    after.surface[0] = p


# ---- feet that are no contacts, and welds ----------------------------------------------------------------------------


def free_half_space(
    march: March, stage: StageRoom, length: Length, start: AnyState, before: AnyState, after: AnyState
) -> None:
    """Make the lowest row that of a half-space, whose force follows the velocity of the foot.

    That is v* + late h B_0 s^-1 B' N, with v* its velocity without forces; the row is over `late`, as the others are.
    """
    numbers = stage.numbers
    h = length.numbers[2]
    free_end(march, length, start, before, after, march.method.modes)
    speed = of_foot(march.method, after.p) / march.scheme.step
    weight = length.numbers[3] or h * h  # of accelerations, as that of welds
    own = weight / (numbers.delta * (1 - numbers.af) / (1 - numbers.am) * h)
    length.flexible.W[0][0] = length.flexible.paired[0][0] + own / march.method.impedance
    march.work.q[0] = own * (speed - 2 * march.room.end[VELOCITY])


def hold_welds(march: March, length: Length, before: AnyState) -> None:
    """Make rigid rows of an explicit stage those of h^2 accelerations at its end, of springs whose forces are known."""
    body = march.body
    laws = march.laws
    room = march.room
    q = march.work.q
    h2 = length.numbers[2] * length.numbers[2]
    for i in range(len(body.k)):
        room.pushed[i] = h2 * (room.load[i] - body.k[i] * (before.z[i] + room.x[i]))
    move_rows(body, room.pushed, room.free)
    for r in range(len(q)):
        if laws.compliance[r] == 0 and not (r == 0 and march.method.base == HALF_SPACE):
            q[r] = room.free[r]
            if body.ground[r][1] != 0:
                q[r] -= h2 * room.end[ACCELERATION]
    beside = length.flexible.paired[1]
    for r in range(len(q)):
        if laws.compliance[r] > 0:
            force = min(max(0.0 - q[r] / laws.compliance[r], laws.lower[r]), laws.upper[r])
            if r > 0 and laws.compliance[r - 1] == 0:
                q[r - 1] += beside[r - 1] * force
            if r + 1 < len(q) and laws.compliance[r + 1] == 0:
                q[r + 1] += beside[r] * force


def of_top(blocks: Blocks, x: Vector, i: int) -> Any:
    """Return what modal values make at the top of a block."""
    return blocks.mean[i] * x[blocks.modes * i] + blocks.half[i] * x[blocks.modes * (i + 1) - 1]


def of_foot(blocks: Blocks, x: Vector) -> Any:
    """Return what modal values make at the foot of the lowest block."""
    return blocks.mean[0] * x[0] - blocks.half[0] * x[blocks.modes - 1]


def force_of_base(march: March, state: AnyState, base: Vector) -> Any:
    """Return the force on the lowest block of what is below, by what is prescribed there [Pa]."""
    blocks = march.method
    rows = state.rows
    if blocks.base == CARRIED:
        above = rows.force[1] if len(rows.force) > 1 else base[PRESSURE]
        return above + blocks.mass * (blocks.gravity + base[ACCELERATION])
    force = rows.force[0]
    if blocks.base == WELDED:
        top = state.a[0] / blocks.root[0] / (march.scheme.step * march.scheme.step)
        force += blocks.mass * (blocks.gravity / 2 + base[ACCELERATION] / 3 + top / 6)
    return force


# ---- what is kept ----------------------------------------------------------------------------------------------------


def account_column(march: March, state: AnyState, after: AnyState, course: Course, part: Part, sums: Vector) -> None:
    """Add what an accepted part of a step loses, and what loads, base and half-space give [J/m^2].

    A base that moves with a block welded to it does not move as the scheme's formulas do: its work is as accurate as
    the scheme.
    """
    account(march, state, after, course, part, sums)
    base = march.method.base
    if base == WELDED:
        prescribe(march, course, march.first, part)
        momentum = march.method.mass / 6 * march.room.start[VELOCITY] * state.p[0] / march.method.root[0]
        sums[DAMPING] += (1 - march.scheme.gg) * momentum / march.scheme.step
    if base != ROW and base != ABSENT:
        add_feet(march, state, after, course, part, sums)


def add_foot(
    march: March, stage: StageRoom, before: AnyState, after: AnyState, course: Course, part: Part, sums: Vector
) -> None:
    """Add work and impulse of what is below in a stage, but for what its row has by the base's motion."""
    blocks = march.method
    room = march.room
    prescribe(march, course, stage, part)
    late = stage.numbers.delta if march.scheme.newmark else 0.5
    force = (1 - late) * force_of_base(march, before, room.start) + late * force_of_base(march, after, room.end)
    moved = room.end[1] - room.start[1]
    if blocks.base == HALF_SPACE or blocks.base == SPRUNG:
        shortened = after.rows.opening[0] - before.rows.opening[0]
        moved = of_foot(blocks, after.z) - of_foot(blocks, before.z) - shortened
    else:
        row = 0 if blocks.base == WELDED else 1
        carried = blocks.mass * blocks.gravity / (2 - row)  # a force on the block that is no load of its modes
        if row < len(after.rows.force):
            force -= (1 - late) * before.rows.force[row] + late * after.rows.force[row]
        else:
            carried += (1 - late) * room.start[PRESSURE] + late * room.end[PRESSURE]
        sums[GIVEN] -= carried * moved
    if blocks.base == WELDED:  # the load of the base's acceleration, which is no force on the block
        acceleration = (1 - late) * room.start[ACCELERATION] + late * room.end[ACCELERATION]
        sums[GIVEN] += blocks.mass / 6 * acceleration * (after.z[0] - before.z[0]) / blocks.root[0]
    sums[GIVEN] += force * moved
    sums[IMPULSE] += force * march.scheme.step * (stage.numbers.end - stage.numbers.begin)


def keep_observed(march: March, state: AnyState, kept: Matrix, number: int) -> bool:
    """Write what is observed, and what the energies are made of where these are kept; tell whether it is finite."""
    blocks = march.method
    observed = blocks.observed
    room = march.room
    rows = state.rows
    row = kept[number]
    lag = march.scheme.lag
    discount = kept_discount(march.scheme, number)
    columns = len(observed.kind)
    modes = blocks.modes
    for k in range(columns):
        kind = observed.kind[k]
        i = observed.place[k]
        lower = observed.lower[k]
        upper = observed.upper[k]
        mean = modes * i
        stretch = mean + modes - 1
        on_base = i == 0 and blocks.base >= WELDED
        if kind == MODES:
            value = lower * state.z[mean] + upper * (room.end[1] if on_base else state.z[stretch])
        elif kind == RATES:
            value = lower * (discount * state.p[mean] + lag * state.a[mean]) / march.scheme.step
            rate = (discount * state.p[stretch] + lag * state.a[stretch]) / march.scheme.step
            value += upper * (room.end[VELOCITY] if on_base else rate)
        elif kind == FOOT:
            value = force_of_base(march, state, room.end)
        elif kind == FORCES:
            above = rows.force[i + 1] if i + 1 < len(rows.force) else room.end[PRESSURE]
            value = lower * rows.force[i] + upper * above
        elif kind == GAP:
            value = max(rows.opening[i], 0.0) if march.laws.opens[i] == 1 else 0.0
        else:
            value = state.path[i]
        row[k] = value
    row[columns + SWITCHES] = march.tally[0]
    march.tally[0] = 0.0
    if len(row) > columns + 1:
        for i in range(len(room.pushed)):
            room.pushed[i] = discount * state.p[i] + lag * state.a[i]
        keep_record(march, state, row, columns)
    return math.isfinite(state.z[len(state.z) - blocks.modes])  # to which all others add


def keep_record(march: March, state: AnyState, row: Vector, columns: int) -> None:
    """Write stored energies [J/m^2], momentum [Pa s] and the extremes of the contacts after what is observed."""
    blocks = march.method
    laws = march.laws
    rows = state.rows
    step = march.scheme.step
    strained = 0.0
    springs = 0.0
    momentum = 0.0
    widest = 0.0
    deepest = 0.0
    furthest = 0.0
    contacts = 0
    opened = 0
    foot = march.room.end[VELOCITY] if blocks.base >= WELDED else 0.0
    if blocks.base == CARRIED:  # as the base does
        march.room.pushed[0] = step * blocks.root[0] * foot
    moving = half_square(march.room.pushed) / (step * step)
    if blocks.base == WELDED:
        top = march.room.pushed[0] / blocks.root[0] / step
        momentum = step * blocks.mass * (foot / 2 + top / 6)
        moving += blocks.mass / 6 * foot * (foot + top)
    for i in range(len(rows.state)):
        mean = blocks.modes * i
        last = mean + blocks.modes - 1
        strained += march.body.k[last] * state.z[last] * state.z[last]
        momentum += blocks.root[i] * march.room.pushed[mean]
        energy = laws.compliance[i] * rows.force[i] * rows.force[i]
        if i == 0 and blocks.base == WELDED:
            strained += energy
        else:
            springs += energy
        if laws.opens[i] == 1:
            contacts += 1
            widest = max(widest, rows.opening[i])
            deepest = max(deepest, 0.0 - rows.opening[i])
            if rows.state[i] == LOWER:
                opened += 1
        else:
            furthest = max(furthest, abs(state.path[i]))
    row[columns + KINETIC] = moving
    row[columns + STRAINED] = strained / 2
    row[columns + SPRINGS] = springs / 2
    row[columns + MOMENTUM] = momentum / step
    row[columns + WIDEST] = widest
    row[columns + DEEPEST] = deepest
    row[columns + OPEN_SHARE] = opened / max(contacts, 1)
    row[columns + FURTHEST] = furthest


def keep_states(march: March, state: AnyState, history: History, number: int) -> None:
    """Write the states of the contacts where they are asked for."""
    if len(history.state) > 0:
        for r in range(len(state.rows.state)):
            history.state[number, r] = state.rows.state[r]


add_feet = over_stages(add_foot)
make_column_steps = steps_by(make_column_stage, account_column, keep_observed, keep_states)
make_linear_steps = steps_by(make_linear_stage, account_column, keep_observed, keep_states)
