r"""Steps of a column whose contacts open or slip: its blocks in their modes, its contacts as rows.

A block of mass m per area and stiffness K = E/h has a mean displacement u and a stretch e = top - foot, in which its
inertia m, m/12 and its stiffness 0, K are diagonal; a rigid block has a stretch that nothing moves. The modes of block
i are 2i and 2i + 1,

    z = sqrt(m) u,    sqrt(m/12) e        u = z_2i / sqrt(m),    e/2 = sqrt(3/m) z_2i+1,

and row i is the contact between its foot and the top of the block below, so that every row feels four modes and its
neighbours alone (`Laws.banded`). Contacts have N >= 0, or -s <= N <= s in shear; welded faces are rigid and
without bounds. All are one problem, the least of a strictly convex function of N within bounds, which has exactly one
solution: no step is ever cut. Where touching blocks are stiff against a step a closing spreads by one contact a solve;
N + 1 solves are the most known of contacts that open, 2 N + 1 of those that slip. Where states changed
`SWEEPS` times the number of contacts, one changes at a time, which ends for every such matrix (Murty 1974).

Displacements follow from gaps, slips and stretches, from the base upwards (`place_blocks`): neither stiff springs nor
long steps, in which weight alone would move a block by g dt^2, cost digits.

Two feet are no contacts, and row 0 only holds their force N_0. That of a half-space follows the velocity of the foot,

    N_0 = zeta (2 v - v_foot),

so that N_1 changes it at once; a lowest block that is welded to a base has the base's motion for that of its foot:
displacement, velocity and acceleration, since from its displacement alone average acceleration would make accelerations
that alternate, ever more, around the right ones.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from dda.contact.band import find_in_band
from dda.contact.dense import Matrix, Vector
from dda.contact.rows import FOUND, LOWER
from dda.march.account import account, half_square, over_stages
from dda.march.energy import GIVEN, IMPULSE
from dda.march.step import (
    Course,
    History,
    Length,
    March,
    Part,
    StageRoom,
    State,
    begin_step,
    coupling,
    end_modes,
    end_paths,
    free_modes,
    free_rows,
    free_velocity,
    kept_discount,
    length_of,
    prescribe,
    push_modes,
    steps_by,
)
from dda.scheme.stage import inertia_force, predictor, velocity_corrector

SWEEPS = 4  # solves for each contact with all states updated at once
ROW, ABSENT, HALF_SPACE, WELDED = range(4)  # what is below the lowest block: a row of contact, or no contact
PRESSURE, VELOCITY, ACCELERATION = 3, 4, 5  # of what is prescribed: on the top, of the base or the wave that comes up
# of a step, after what is observed: states that changed, then the stored energies, momentum, extremes of the contacts
SWITCHES, KINETIC, STRAINED, SPRINGS, MOMENTUM, WIDEST, DEEPEST, OPEN_SHARE, FURTHEST = range(9)
RECORDED = FURTHEST + 1

MODES, RATES, FORCES, GAP, SLIDE = range(5)  # what an observer reads


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
    base: int  # among ROW, ABSENT, HALF_SPACE and WELDED
    impedance: float  # zeta [Pa s/m]
    observed: Observed


class Top(NamedTuple):
    """The top of a block that is welded to the base, on its inertia m/3, before the contact above is found."""

    inertia: float  # m/3 [kg/m^2]
    flexibility: float  # 1 / (m/3 + weight K); 0 of a rigid block
    stretch: float  # how far it moves from the base in a stage without that contact [m]
    p: float  # h times its velocity, and h^2 times its acceleration, at the start of the step
    a: float
    a_before: float  # the same at the end of the stage before
    R: float  # h^2 times the force on it at the start of the step


# ---- the stage -------------------------------------------------------------------------------------------------------


def make_column_stage(
    march: March, stage: StageRoom, start: State, before: State, after: State, course: Course, part: Part
) -> tuple[int, int]:
    """Go from the end of the stage before to the end of a stage; return the outcome and the number of solves."""
    base = march.method.base
    work = march.work
    rows = after.rows
    length = length_of(march, stage, part.ratio)
    prescribe(march, course, stage, part)
    begin_step(march, start, length)
    free_modes(march, stage, length, before)
    top = Top(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if base == WELDED:
        top = free_top(march, stage, length, before)
    free_rows(march, before)
    follows = 0.0
    if base == HALF_SPACE:
        follows = free_dashpot(march, stage, length, before)
    elif base == WELDED:
        free_row(march, length, 0.0, length.numbers[3] * top.flexibility)
    outcome, solves = find_in_band(march.laws, before.rows, length.flexible, rows, work)
    if outcome != FOUND:
        return outcome, solves
    if base == HALF_SPACE and len(rows.force) > 1:
        rows.force[0] += follows * rows.force[1]
    push_modes(march, rows.force)
    end_modes(march, stage, length, before, after)
    if base == WELDED:
        end_on_base(march, stage, length, before, after, top)
    end_paths(march, length.flexible, before, after)
    place_blocks(march, after)
    for r in range(len(rows.state)):
        if rows.state[r] != before.rows.state[r]:
            march.tally[0] += 1
    return outcome, solves


def place_blocks(march: March, state: State) -> None:
    """Write the means from gaps, slips and stretches, above the base or the lowest block."""
    blocks = march.method
    rows = state.rows
    z = state.z
    lowest = 0
    below = march.room.end[1]
    if blocks.base == ABSENT or blocks.base == HALF_SPACE:
        lowest = 1
        below = z[0] / blocks.root[0] + blocks.half[0] * z[1]
    for i in range(lowest, len(rows.state)):
        half = blocks.half[i] * z[2 * i + 1]
        mean = below + (rows.opening[i] - blocks.gap[i]) + state.path[i] + half
        z[2 * i] = blocks.root[i] * mean
        below = mean + half


# ---- feet that are no contacts ---------------------------------------------------------------------------------------


def free_row(march: March, length: Length, force: float, of_top: float) -> None:
    """Make the lowest row one that holds a known force; `of_top` is what it leaves of the flexibility there [m/Pa]."""
    W = length.flexible.W
    W[0][0] = 1.0
    march.work.q[0] = 0.0 - force
    if len(march.work.q) > 1:
        body = march.body
        W[1][0] = 0.0
        W[0][1] = of_top
        for e in range(2, 4):
            W[0][1] += length.numbers[3] * body.weight[1][e] * length.inverse[e] * body.weight[1][e]


def free_dashpot(march: March, stage: StageRoom, length: Length, before: State) -> float:
    """Write the force of the half-space where N_1 is nothing; return by how much of N_1 it changes.

    Its velocity v_foot = v* + late h (phi_00 N_0 + phi_01 N_1) has the flexibilities phi of the step.
    """
    blocks = march.method
    body = march.body
    room = march.room
    numbers = stage.numbers
    h = length.numbers[2]
    late = numbers.delta * (1 - numbers.af) / (1 - numbers.am) * h
    speed = 0.0
    for i in range(2):
        speed += body.weight[0][i] * free_velocity(march, stage, length, before, i) / h
    own = 1 + blocks.impedance * late * coupling(body, length.inverse, 0, 0)
    force = blocks.impedance * (2 * room.end[VELOCITY] - speed) / own
    if len(room.free) == 1:
        free_row(march, length, force, 0.0)
        return 0.0
    across = coupling(body, length.inverse, 0, 1)
    follows = float(0.0 - blocks.impedance * late * across / own)
    of_top = 0.0
    for e in range(2):
        of_top += body.weight[1][e] * length.inverse[e] * body.weight[1][e]
    free_row(march, length, force, length.numbers[3] * (of_top + follows * across))
    march.work.q[1] += length.numbers[3] * across * force
    return float(follows)


def of_top(blocks: Blocks, x: Vector) -> float:
    """Return what modal values make at the top of the lowest block."""
    return float(x[0] / blocks.root[0] + blocks.half[0] * x[1])


def of_foot(blocks: Blocks, x: Vector) -> float:
    """Return what modal values make at the foot of the lowest block."""
    return float(x[0] / blocks.root[0] - blocks.half[0] * x[1])


def force_on_top(blocks: Blocks, mean: float, stretching: float) -> float:
    """Return the force on the top of a block by the modal forces on its mean and its stretch."""
    return float(blocks.root[0] / 2 * (mean + stretching / math.sqrt(3)))


def free_top(march: March, stage: StageRoom, length: Length, before: State) -> Top:
    r"""Write the modes of a block whose foot is the base, without the contact above; return its top.

    With m/3 the inertia at its top and m/6 that between foot and top, y the base and d = top - y,

        (m/3 + weight K) (d1 - dg) = m/3 [ h v + ... - (y1 - yg) ] + alpha h^2 f(- m g/2 - K dg - m/6 y1'').
    """
    blocks = march.method
    room = march.room
    numbers = stage.numbers
    ratio = length.numbers[0]
    h2 = length.numbers[2] * length.numbers[2]
    mass = blocks.root[0] * blocks.root[0]
    moved = room.end[1] - room.start[1]
    p = of_top(blocks, room.p)
    a = of_top(blocks, room.a)
    a_before = ratio * ratio * of_top(blocks, before.a)
    R = force_on_top(blocks, room.R[0], room.R[1]) - mass / 6 * of_foot(blocks, room.a)
    flexibility = 0.0
    stretch = 0.0
    if blocks.half[0] > 0:
        flexibility = 1 / (mass / 3 + length.numbers[3] * march.body.k[1] * mass / 12)
        force = force_at_top(march, h2, before.z[1])
        held = inertia_force(numbers, force, R, mass / 3 * a)
        moving = predictor(numbers, p, a, ratio * of_top(blocks, before.p), a_before)
        stretch = flexibility * (mass / 3 * (moving - moved) + numbers.alpha * held)
        room.x[1] = stretch / (2 * blocks.half[0])
    room.x[0] = blocks.root[0] * (moved + stretch / 2)
    return Top(mass / 3, flexibility, stretch, p, a, a_before, R)


def force_at_top(march: March, h2: float, z: float) -> float:
    """Return h^2 times the force on the top at the end of a stage, by loads, stretch and the base's acceleration."""
    blocks = march.method
    force = force_on_top(blocks, march.room.load[0], march.room.load[1] - march.body.k[1] * z)
    return float(h2 * (force - blocks.root[0] * blocks.root[0] / 6 * march.room.end[ACCELERATION]))


def end_on_base(march: March, stage: StageRoom, length: Length, before: State, after: State, top: Top) -> None:
    """Write the lowest block, whose foot is the base, and the force of the base on it."""
    blocks = march.method
    room = march.room
    numbers = stage.numbers
    ratio = length.numbers[0]
    h = length.numbers[2]
    root = blocks.root[0]
    above = after.rows.force[1] if len(after.rows.force) > 1 else 0.0
    foot_p = h * room.end[VELOCITY]
    foot_a = h * h * room.end[ACCELERATION]
    p = foot_p
    a = foot_a
    if blocks.half[0] > 0:
        stretch = top.stretch - length.numbers[3] * top.flexibility * above
        after.z[1] = before.z[1] + stretch / (2 * blocks.half[0])
        R = force_at_top(march, h * h, after.z[1]) - h * h * above
        a = inertia_force(numbers, R, top.R, top.inertia * top.a) / top.inertia
        p = velocity_corrector(numbers, top.p, top.a, top.a_before, a)
        after.p[1] = (p - foot_p) / (2 * blocks.half[0]) / ratio
        after.a[1] = (a - foot_a) / (2 * blocks.half[0]) / (ratio * ratio)
    after.p[0] = root * (p + foot_p) / 2 / ratio
    after.a[0] = root * (a + foot_a) / 2 / (ratio * ratio)
    after.rows.force[0] = above + root * (root * (a + foot_a) / 2 / (h * h) - march.room.load[0])
    scale = march.scheme.step * march.scheme.step
    after.R[0] = scale * (march.room.load[0] + (after.rows.force[0] - above) / root)
    after.R[1] = scale * (march.room.load[1] - march.body.k[1] * after.z[1])
    after.R[1] -= scale * blocks.half[0] * (after.rows.force[0] + above)


# ---- what is kept ----------------------------------------------------------------------------------------------------


def account_column(march: March, state: State, after: State, course: Course, part: Part, sums: Vector) -> None:
    """Add what an accepted part of a step loses, and what loads, base and half-space give [J/m^2].

    A base that moves with a block welded to it does not move as the scheme's formulas do: its work is as accurate as
    the scheme.
    """
    account(march, state, after, course, part, sums)
    if march.method.base == HALF_SPACE:
        add_waves(march, state, after, course, part, sums)


def add_wave(
    march: March, stage: StageRoom, before: State, after: State, course: Course, part: Part, sums: Vector
) -> None:
    """Add work and impulse of a half-space in a stage."""
    late = stage.numbers.delta if march.scheme.newmark else 0.5
    force = (1 - late) * before.rows.force[0] + late * after.rows.force[0]
    sums[GIVEN] += force * (of_foot(march.method, after.z) - of_foot(march.method, before.z))
    sums[IMPULSE] += force * march.scheme.step * part.ratio * (stage.numbers.end - stage.numbers.begin)


def keep_observed(march: March, state: State, kept: Matrix, number: int) -> bool:
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
    for k in range(columns):
        kind = observed.kind[k]
        i = observed.place[k]
        lower = observed.lower[k]
        upper = observed.upper[k]
        if kind == MODES:
            value = lower * state.z[2 * i] + upper * state.z[2 * i + 1]
        elif kind == RATES:
            value = lower * (discount * state.p[2 * i] + lag * state.a[2 * i])
            value += upper * (discount * state.p[2 * i + 1] + lag * state.a[2 * i + 1])
            value /= march.scheme.step
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
        for i in range(2 * n):
            room.p[i] = discount * state.p[i] + lag * state.a[i]
        keep_record(march, state, row, columns)
    return math.isfinite(state.z[2 * n - 2])  # to which all others add


def keep_record(march: March, state: State, row: Vector, columns: int) -> None:
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
    for i in range(len(rows.state)):
        stretch = state.z[2 * i + 1]
        strained += march.body.k[2 * i + 1] * stretch * stretch
        momentum += blocks.root[i] * march.room.p[2 * i]
        springs += laws.compliance[i] * rows.force[i] * rows.force[i]
        if laws.opens[i] == 1:
            contacts += 1
            widest = max(widest, rows.opening[i])
            deepest = max(deepest, 0.0 - rows.opening[i])
            if rows.state[i] == LOWER:
                opened += 1
        else:
            furthest = max(furthest, abs(state.path[i]))
    row[columns + KINETIC] = half_square(march.room.p) / (step * step)
    row[columns + STRAINED] = strained / 2
    row[columns + SPRINGS] = springs / 2
    row[columns + MOMENTUM] = momentum / step
    row[columns + WIDEST] = widest
    row[columns + DEEPEST] = deepest
    row[columns + OPEN_SHARE] = opened / max(contacts, 1)
    row[columns + FURTHEST] = furthest


def keep_states(march: March, state: State, history: History, number: int) -> None:
    """Write the states of the contacts where they are asked for."""
    if len(history.state) > 0:
        for r in range(len(state.rows.state)):
            history.state[number, r] = state.rows.state[r]


add_waves = over_stages(add_wave)
make_column_steps = steps_by(make_column_stage, account_column, keep_observed, keep_states)
