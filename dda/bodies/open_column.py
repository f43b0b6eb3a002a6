"""A column whose contacts open or slip: its modes and rows, what is prescribed, and how it starts."""

from __future__ import annotations

import math

import numpy as np

from dda.bodies.bonded_column import Drive
from dda.bodies.column import Column, Spring
from dda.bodies.column_step import ABSENT, HALF_SPACE, ROW, SWEEPS, WELDED, Blocks, Observed, of_top
from dda.contact.band import find_in_band
from dda.contact.rows import INSIDE, LOWER, Laws, flexibility_for, rows_of
from dda.march.step import Body, Course, Length, March, State, moved_row, write_flexibility
from dda.model.arrays import Array
from dda.scheme.newmark import Scheme, late_momentum

ROUNDING = 1e-12  # of the fastest row: what a common velocity of welded blocks leaves of a difference


def base_of(column: Column) -> int:
    """Return what is below the lowest block."""
    if not column.rests_on_base:
        return ABSENT if column.impedance is None else HALF_SPACE
    return WELDED if column.contacts[0] is None else ROW


def springs_of(column: Column) -> list[Spring]:
    """Return the spring at the foot of every block, rigid and inseparable where there is no joint."""
    return [Spring(0.0, math.inf) if spring is None else spring for spring in column.contacts]


def blocks_of(column: Column, observed: Observed) -> Blocks:
    """Return what modes and rows are of a column."""
    root = np.sqrt(column.densities * column.heights)
    half = np.where(np.isinf(column.moduli), 0.0, math.sqrt(3) / root)
    gaps = np.array([spring.gap for spring in springs_of(column)])
    return Blocks(root, half, gaps, base_of(column), column.impedance or 0.0, observed)


def body_of(column: Column, blocks: Blocks) -> Body:
    """Return the column in its modes; row 0 has no weights where nothing is below."""
    n = len(blocks.root)
    width = min(4, 2 * n)
    mean = 1 / blocks.root
    mass = blocks.root * blocks.root
    k = np.zeros(2 * n)
    k[1::2] = np.where(blocks.half > 0, 12 * column.moduli / column.heights / mass, 0.0)
    weight = np.zeros((n, width))
    if blocks.base != ABSENT:
        weight[0, :2] = mean[0], -blocks.half[0]
    weight[1:] = np.column_stack([-mean[:-1], -blocks.half[:-1], mean[1:], -blocks.half[1:]])[:, :width]
    ground = np.zeros((n, 2))
    ground[0, 1] = column.rests_on_base
    loads = np.zeros((4 if blocks.base in (HALF_SPACE, WELDED) else 2, 2 * n))  # the motion below is no modal load
    loads[0, ::2] = -column.gravity * blocks.root
    loads[1, -2:] = -mean[-1], -blocks.half[-1]
    first = np.maximum(2 * np.arange(n) - 2, 0)
    return Body(k, loads, np.zeros(len(loads)), first, weight, ground, np.ones(len(k)))


def laws_of(column: Column, solve_limit: int | None, bonded: bool) -> Laws:
    """Return the laws of the rows."""
    springs = springs_of(column)
    n = len(springs)
    opens = np.zeros(n, dtype=np.int64)
    if column.law == "unilateral" and not bonded:
        opens[:] = [spring is not None for spring in column.contacts]
    strength = np.array([math.inf if bonded else spring.strength for spring in springs])
    compliance = np.array([1 / spring.stiffness for spring in springs])
    if base_of(column) == ABSENT:
        compliance[0] = 1.0  # of a row that feels nothing
    return Laws(
        contacts=n,
        rows=n,
        compliance=compliance,
        lower=np.where(opens == 1, 0.0, -strength),
        upper=strength,
        opens=opens,
        friction=0.0,
        slips=False,
        lagged=False,
        paired=False,
        banded=True,
        closing=0.0,
        retardation=0.0,
        together=SWEEPS * (n + 1),
        most=solve_limit or 0,
    )


def course_of(drive: Drive, scheme: Scheme, loads: int) -> Course:
    """Return what is prescribed: the base, the weight, the pressure, and the base's velocity and acceleration."""
    none = np.zeros(len(drive.pressure))
    parts = (none, drive.displacement, none + 1, drive.pressure, drive.velocity, drive.acceleration)
    instants = scheme.instants((len(none) - 1) // len(scheme.stages))
    return Course(instants, np.column_stack(parts[: 2 + loads]), np.zeros(1, dtype=np.int64))


# ---- start -----------------------------------------------------------------------------------------------------------


def start_of(column: Column, scheme: Scheme, drive: Drive, settled: bool, march: March) -> State:
    """Return the state at t = 0: unstrained with the gaps of the contacts, or under static forces."""
    blocks = march.method
    laws = march.laws
    body = march.body
    rests = blocks.base in (ROW, WELDED)
    B = matrix_of(body)
    dt = scheme.step
    opens = laws.opens == 1
    rigid = laws.compliance == 0
    rigid[0] &= rests
    speed = np.zeros(len(body.k))
    speed[::2] = blocks.root * column.velocities
    base_speed = float(drive.velocity[0]) if rests else 0.0
    welds = rigid & ~opens & np.isinf(laws.upper)  # their blocks get a common velocity at once
    speed += B.T @ rigid_forces(march, speed, base_speed, welds, np.zeros(len(opens)))
    opening = blocks.gap.copy()
    if blocks.base == ROW:
        opening[0] -= drive.displacement[0]
    # springs have the forces of the gaps; rigid contacts, and welds, have none before the accelerations are known
    spring = laws.compliance > 0
    force = np.clip(np.where(spring, -opening / np.where(spring, laws.compliance, 1.0), 0.0), laws.lower, laws.upper)
    z = np.zeros(len(body.k))
    if settled:
        z, force = static(column, blocks, laws, float(drive.displacement[0]))
        opening = -force * laws.compliance
        rigid[:] = False
    elif blocks.base == HALF_SPACE:
        force[0] = blocks.impedance * (2 * drive.velocity[0] - body.weight[0, :2] @ speed[:2])
    own = march.room.end[2:] @ body.loads - body.k * z
    a = np.zeros(len(z))
    if scheme.start == "consistent":
        unknown = rigid & (~opens | (opening == 0))
        rate = row_rates(march, speed, base_speed)
        nothing = ROUNDING * np.max(np.abs(rate), initial=0.0)
        parts = unknown & (rate > nothing)
        returns = unknown & ~opens & (rate < -nothing)
        # a contact that slips has its strength against the slip, one whose faces part has none
        force = np.where(parts, laws.lower, np.where(returns, laws.upper, force))
        force = rigid_forces(march, own, float(drive.acceleration[0]), unknown & ~parts & ~returns, force)
        a = own + B.T @ force
    if blocks.base == WELDED:
        force[0] = move_foot(blocks, drive, own, B[1:].T @ force[1:], speed, a)
    R = own + B.T @ force
    rows = rows_of(opening, initial_states(laws, force))
    rows.force[:] = force
    p = late_momentum(scheme, dt * speed, dt * dt * a)
    return State(z, p, dt * dt * a, dt * dt * R, np.zeros(len(opening)), rows)


def matrix_of(body: Body) -> Array:
    """Return the weights of the modes in the rows, (rows, modes)."""
    matrix = np.zeros((len(body.first), len(body.k)))
    for row, first, weight in zip(matrix, body.first, body.weight, strict=True):
        row[first : first + len(weight)] = weight
    return matrix


def initial_states(laws: Laws, force: Array) -> Array:
    """Return the states at t = 0: what opens is closed where it is pressed, what slips holds below its strength."""
    return np.where((force <= laws.lower) & (laws.opens == 1), LOWER, INSIDE)


def rigid_forces(march: March, rates: Array, base: float, unknown: Array, force: Array) -> Array:
    """Return the forces with those of rigid contacts, by which these keep together.

    It is the problem of a step, in the limit of short ones, for velocities or accelerations.

    Parameters
    ----------
    rates
        (modes,) velocities or accelerations without forces.
    base
        That of the base.
    unknown
        (rows,) which forces, or impulses, are unknown.
    force
        The others.
    """
    n = len(force)
    laws = march.laws._replace(
        compliance=np.zeros(n),
        lower=np.where(unknown, march.laws.lower, force),
        upper=np.where(unknown, march.laws.upper, force),
        opens=np.where(unknown, march.laws.opens, 0),
        most=0,
    )
    length = Length(np.zeros(4), np.ones(len(rates)), flexibility_for(n, True))
    write_flexibility(march, 1.0, length)
    march.work.q[:] = row_rates(march, rates, base)
    after = rows_of(force, unknown)
    find_in_band(laws, rows_of(force, np.where(unknown, INSIDE, LOWER)), length.flexible, after, march.work)
    return np.asarray(after.force)


def row_rates(march: March, rates: Array, base: float) -> Array:
    """Return how fast each row opens or slips, (rows,), for velocities or accelerations of the modes."""
    # no product of a library, whose fused sums tear apart blocks that fall alike
    moved = [moved_row(march.body, r, rates) for r in range(len(march.body.first))]
    return np.asarray(np.array(moved) - march.body.ground[:, 1] * base)


def static(column: Column, blocks: Blocks, laws: Laws, base: float) -> tuple[Array, Array]:
    """Return modes and forces at rest: every contact carries the weight above it; a pressure acts from t = 0 on."""
    weights = column.gravity * blocks.root**2
    carried = np.append(np.cumsum(weights[::-1])[::-1], 0.0)
    stretch = -(carried[:-1] + carried[1:]) / 2 * column.heights / column.moduli
    tops = base + np.cumsum(stretch - carried[:-1] * laws.compliance - blocks.gap)
    z = np.zeros(2 * len(weights))
    z[::2] = blocks.root * (tops - stretch / 2)
    z[1::2] = blocks.root / math.sqrt(12) * stretch
    return z, carried[:-1]


def move_foot(blocks: Blocks, drive: Drive, own: Array, pushed: Array, speed: Array, a: Array) -> float:
    """Give the foot of the lowest block the motion of the base; return the force that the base needs for it."""
    root = blocks.root[0]
    for rates, foot in ((speed, drive.velocity[0]), (a, drive.acceleration[0])):
        top = of_top(blocks, rates) if blocks.half[0] > 0 else foot
        rates[:2] = root * (foot + top) / 2, root / math.sqrt(12) * (top - foot)
    if blocks.half[0] == 0:
        return float(root * (a[0] - own[0] - pushed[0]))
    missing = a[:2] - own[:2] - pushed[:2]
    return float(root / 2 * (missing[0] - missing[1] / math.sqrt(3)))
