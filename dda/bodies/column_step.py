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
    coupling,
    end_modes,
    end_paths,
    free_end,
    free_modes,
    free_rows,
    kept_discount,
    move_rows,
    prescribe,
    push_modes,
    steps_by,
)
from dda.scheme.stage import predictor, velocity_corrector

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
    work = march.work
    rows = after.rows
    length = stage.whole
    prescribe_instants(march, course, stage, part)
    free_modes(march, length, start, before)
    free_rows(march, before)
    hold_base(march, stage, length, start, before, after)
    outcome, solves = find_in_band(march.laws, before.rows, length.flexible, rows, work)
    if outcome != FOUND:
        return outcome, solves
    push_modes(march, rows.force)
    end_modes(march, length, start, before, after, len(march.body.k))
    if march.method.base == SPRUNG:
        end_surface(march, stage, length, after)
    end_paths(march, length.flexible, before, after)
    place_blocks(march, after)
    if solves > 1:
        for r in range(len(rows.state)):
            if rows.state[r] != before.rows.state[r]:
                march.tally[0] += 1
    return outcome, solves


def prescribe_instants(march: March, course: Course, stage: StageRoom, part: Part) -> None:
    """Write what `prescribe` does, for a course whose instants are the ends of all stages: no step is ever cut."""
    instant = march.scheme.stages * int(part.begun) + (1 if stage.numbers.begin == 0 else 2)
    copy(course.value[instant - 1], march.room.start)
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
    by = length.factors
    moving = by[0] * start.p + (by[1] + by[6]) * start.a + by[2] * before.p + by[3] * before.a + by[5] * start.R
    room.x[:] = length.inverse * (moving + by[4] * (room.load - body.k * before.z))
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
    after.R[:] = march.scheme.step**2 * (room.load - body.k * after.z + room.pushed)
    after.a[:] = by[7] * after.R + by[8] * start.R + by[9] * start.a
    after.p[:] = by[10] * start.p + by[11] * start.a + by[12] * before.a + by[13] * after.a
    if blocks.base == SPRUNG:
        end_surface(march, stage, length, after)
    lowest, below = lowest_face(march, after)
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


def lowest_face(march: March, state: AnyState) -> tuple[int, float]:
    """Return the first block that is placed by its row, and where the face below it is [m]."""
    blocks = march.method
    if blocks.base == ROW or blocks.base == WELDED:
        return 0, march.room.end[1]
    return 1, march.room.end[1] if blocks.base == CARRIED else of_top(blocks, state.z, 0)


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
    lowest, below = lowest_face(march, state)
    for i in range(lowest, len(gap)):
        stretched = half[i] * z[modes * (i + 1) - 1]
        mean = below + (opening[i] - gap[i]) + path[i] + stretched
        z[modes * i] = root[i] * mean
        below = mean + stretched


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
    march.work.q[0] -= moved + late * (2 * h * march.room.end[VELOCITY] - after.surface[0])
    own = length.numbers[3] * coupling(march.body, length.inverse, 0, 0)
    length.flexible.W[0][0] = own + late * h / march.method.impedance


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
    body = march.body
    numbers = stage.numbers
    h = length.numbers[2]
    speed = 0.0
    free_end(march, length, start, before, after, march.method.modes)
    for i in range(march.method.modes):
        speed += body.weight[0][i] * after.p[i] / march.scheme.step
    weight = weight_of_welds(length)
    own = weight / (numbers.delta * (1 - numbers.af) / (1 - numbers.am) * h)
    length.flexible.W[0][0] = weight * coupling(body, length.inverse, 0, 0) + own / march.method.impedance
    march.work.q[0] = own * (speed - 2 * march.room.end[VELOCITY])


def weight_of_welds(length: Length) -> float:
    """Return the weight of forces in what keeps faces together: ways, in an explicit stage h^2 accelerations [s^2]."""
    h = length.numbers[2]
    return float(length.numbers[3] if length.numbers[3] > 0 else h * h)


def hold_welds(march: March, length: Length, before: AnyState) -> None:
    """Make rigid rows of an explicit stage, whose forces move nothing before it ends, those of accelerations there.

    The forces of springs are known then.
    """
    body = march.body
    laws = march.laws
    room = march.room
    q = march.work.q
    W = length.flexible.W
    h2 = weight_of_welds(length)
    for i in range(len(body.k)):
        room.pushed[i] = h2 * (room.load[i] - body.k[i] * (before.z[i] + room.x[i]))
    move_rows(body, room.pushed, room.free)
    for r in range(len(q)):
        if laws.compliance[r] == 0 and not (r == 0 and march.method.base == HALF_SPACE):
            q[r] = room.free[r]
            if body.ground[r][1] != 0:
                q[r] -= h2 * room.end[ACCELERATION]
            W[0][r] = h2 * coupling(body, length.inverse, r, r)
    for r in range(len(q) - 1):
        W[1][r] = 0.0
        beside = h2 * coupling(body, length.inverse, r, r + 1)
        if laws.compliance[r] == 0 and laws.compliance[r + 1] == 0:
            W[1][r] = beside
        elif laws.compliance[r] == 0:
            q[r] += beside * known_force(march, r + 1)
        elif laws.compliance[r + 1] == 0:
            q[r + 1] += beside * known_force(march, r)


def known_force(march: March, r: int) -> float:
    """Return the force of a spring that no force of the stage moves [Pa]."""
    laws = march.laws
    return float(min(max(0.0 - march.work.q[r] / laws.compliance[r], laws.lower[r]), laws.upper[r]))


def of_top(blocks: Blocks, x: Vector, i: int) -> Any:
    """Return what modal values make at the top of a block."""
    return x[blocks.modes * i] / blocks.root[i] + blocks.half[i] * x[blocks.modes * (i + 1) - 1]


def of_foot(blocks: Blocks, x: Vector) -> float:
    """Return what modal values make at the foot of the lowest block."""
    return float(x[0] / blocks.root[0] - blocks.half[0] * x[blocks.modes - 1])


def force_of_base(march: March, state: AnyState, base: Vector) -> float:
    """Return the force on the lowest block of what is below, by what is prescribed there [Pa]."""
    blocks = march.method
    rows = state.rows
    if blocks.base == CARRIED:
        above = rows.force[1] if len(rows.force) > 1 else base[PRESSURE]
        return float(above + blocks.mass * (blocks.gravity + base[ACCELERATION]))
    force = rows.force[0]
    if blocks.base == WELDED:
        top = state.a[0] / blocks.root[0] / (march.scheme.step * march.scheme.step)
        force += blocks.mass * (blocks.gravity / 2 + base[ACCELERATION] / 3 + top / 6)
    return float(force)


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
    n = len(rows.state)
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
            value = lower * rows.force[i] + upper * (rows.force[i + 1] if i + 1 < n else room.end[PRESSURE])
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
    moving = half_square(march.room.pushed) / (step * step)
    if blocks.base >= WELDED:
        foot = march.room.end[VELOCITY]
        top = foot if blocks.base == CARRIED else march.room.pushed[0] / blocks.root[0] / step
        momentum = step * blocks.mass * (foot / 2 + top / 6)
        moving += blocks.mass / 6 * foot * (foot + top)
        if blocks.base == CARRIED:
            momentum += step * blocks.mass * foot / 3
            moving += blocks.mass / 6 * foot * foot
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
