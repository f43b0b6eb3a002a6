"""A column of blocks: its modes and rows, what is prescribed, and how it starts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dda.bodies.column import Column, Spring
from dda.bodies.column_step import (
    ABSENT,
    CARRIED,
    HALF_SPACE,
    ROW,
    SPRUNG,
    SWEEPS,
    WELDED,
    Blocks,
    ColumnState,
    Observed,
    of_foot,
    place_blocks,
)
from dda.contact.band import find_in_band
from dda.contact.rows import INSIDE, LOWER, Laws, rows_of
from dda.march.step import Body, Course, March, move_rows, write_flexibility
from dda.model.arrays import Array, ArrayPair
from dda.scheme.newmark import Scheme, late_momentum

ROUNDING = 1e-12  # of the fastest row: what a common velocity of welded blocks leaves of a difference


@dataclass(frozen=True, eq=False)
class Drive:
    """What drives a column, at t = 0 and at every step, each (steps + 1,).

    Of a scheme of several stages it holds the end of each stage, `dda.Scheme.instants`.

    The base's motion is that of the base itself or, above a half-space, the particle motion of the wave that comes up.

    Raises
    ------
    ValueError
        If the lengths differ or a number is not finite.
    """

    displacement: Array  # of the base [m]
    velocity: Array  # of the base, or of the incident wave [m/s]
    acceleration: Array  # of the base [m/s^2]
    pressure: Array  # on the top, towards the base where positive (in shear: against the displacement) [Pa]

    def __post_init__(self) -> None:
        """Check lengths and numbers."""
        parts = [np.asarray(part) for part in vars(self).values()]
        if len({part.shape for part in parts}) != 1 or parts[0].ndim != 1:
            raise ValueError(f"drive: must hold arrays of one length, got {[part.shape for part in parts]}")
        if not all(np.all(np.isfinite(part)) for part in parts):
            raise ValueError("drive: must hold finite numbers only, got NaN or infinity")


def base_of(column: Column) -> int:
    """Return what is below the lowest block."""
    welded = column.glue is None and column.contacts[0] is None
    if column.rests_on_base:
        on_base = CARRIED if math.isinf(column.moduli[0]) else WELDED
        return on_base if welded else ROW
    if column.impedance is None:
        return ABSENT
    return HALF_SPACE if welded else SPRUNG


def springs_of(column: Column) -> list[Spring]:
    """Return the spring at the foot of every block, rigid and inseparable where faces move alike."""
    glue = math.inf if column.glue is None else column.glue
    return [Spring(0.0, glue) if spring is None else spring for spring in column.contacts]


def inertia(column: Column) -> Array:
    """Return the mass of every block [kg/m^2]."""
    return column.densities * column.heights


def stiffness(column: Column) -> Array:
    """Return 12 E / h of every block, over its mass the w^2 of its strain; none where its faces move alike [Pa/m]."""
    return np.where(np.isinf(column.moduli), 0.0, 12 * column.moduli / column.heights)


def compliances(column: Column) -> Array:
    """Return that of the row below every block, none where faces move alike [m/Pa]."""
    compliance = np.array([1 / spring.stiffness for spring in springs_of(column)])
    base = base_of(column)
    if base == WELDED:
        compliance[0] = 12 / stiffness(column)[0]
    elif base in (ABSENT, CARRIED):
        compliance[0] = 1.0  # of a row that feels nothing
    return compliance


def impedance(column: Column) -> float:
    """Return that of the half-space below [Pa s/m], zero where there is none."""
    return column.impedance or 0.0


def blocks_of(column: Column, observed: Observed) -> Blocks:
    """Return what modes and rows are of a column."""
    masses = inertia(column)
    base = base_of(column)
    root = np.sqrt(masses)
    half = np.where(np.isinf(column.moduli), 0.0, math.sqrt(3) / root)
    if base == WELDED:  # the motion of its top alone
        root[0] /= math.sqrt(3)
        half[0] = 0.0
    mean = 1 / root
    if base == CARRIED:
        mean[0] = 0.0
    gaps = np.array([spring.gap for spring in springs_of(column)])
    modes = 2 if half.any() else 1
    return Blocks(root, mean, half, gaps, modes, base, float(masses[0]), column.gravity, impedance(column), observed)


def body_of(column: Column, blocks: Blocks) -> Body:
    """Return the column in its modes; row 0 has no weights where nothing is below."""
    n = len(blocks.root)
    modes = blocks.modes
    mean = blocks.mean
    k = np.zeros(modes * n)
    k[modes - 1 :: modes] = (blocks.half > 0) * stiffness(column) / blocks.root**2
    weight = np.zeros((n, 4))
    weight[0, :2] = mean[0], -blocks.half[0]
    weight[1:] = np.column_stack([-mean[:-1], -blocks.half[:-1], mean[1:], -blocks.half[1:]])
    weight = weight[:, : 2 * n : 3 - modes].copy()
    ground = np.zeros((n, 2))
    ground[0, 1] = column.rests_on_base
    if blocks.base == ABSENT:
        weight[0] = 0.0
    loads = np.zeros((2 if blocks.base in (ROW, ABSENT) else 4, modes * n))  # the motion below is no modal load
    loads[0, ::modes] = -column.gravity * blocks.root
    loads[1, -modes:] = (-mean[-1], -blocks.half[-1])[:modes]
    if blocks.base == CARRIED:  # its mode stands still
        loads[0, 0] = 0.0
        ground[:2, 1] = np.arange(min(n, 2))
    if blocks.base == WELDED:
        loads[0, 0] /= 2 * blocks.root[0] * blocks.root[0] / blocks.mass
        loads[3, 0] = -blocks.mass / 6 * mean[0]
    first = np.maximum(modes * (np.arange(n) - 1), 0)
    return Body(k, loads, np.zeros(len(loads)), first, weight, ground, np.ones(len(k)))


def laws_of(column: Column, solve_limit: int | None, bonded: bool) -> Laws:
    """Return the laws of the rows."""
    springs = springs_of(column)
    n = len(springs)
    may_open = column.law == "unilateral" and not bonded
    opens = np.array([may_open and spring is not None for spring in column.contacts], dtype=np.int64)
    strength = np.array([math.inf if bonded else spring.strength for spring in springs])
    return Laws(
        contacts=n,
        rows=n,
        compliance=compliances(column),
        lower=np.where(opens == 1, 0.0, -strength),
        upper=strength,
        opens=opens,
        friction=0.0,
        slips=bool(np.any((opens == 0) & np.isfinite(strength))),
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


def write_rows(march: March) -> None:
    """Write what forces move: in an explicit stage nothing before its end, where h^2 accelerations hold rigid rows.

    What they move of the row beside is left in `Flexibility.paired`, and what the foot on a half-space has of its own.
    """
    rigid = march.laws.compliance == 0
    both = np.array([rigid, rigid & np.append(rigid[1:], False)])
    for stage in (march.first, march.last):
        length = stage.whole
        flexible = length.flexible
        write_flexibility(march, length.numbers[3] or length.numbers[2] ** 2, length)
        flexible.paired[:] = flexible.W
        flexible.W[:] *= both | (length.numbers[3] > 0)
        flexible.paired[0] = flexible.W[0]


# ---- start -----------------------------------------------------------------------------------------------------------


def start_of(column: Column, scheme: Scheme, drive: Drive, settled: bool, march: March) -> ColumnState:
    """Return the state at t = 0: unstrained with the gaps of the contacts, or under static forces."""
    blocks = march.method
    laws = march.laws
    body = march.body
    B = matrix_of(body)
    dt = scheme.step
    opens = laws.opens == 1
    rigid = laws.compliance == 0
    rigid[0] &= column.rests_on_base
    speed = np.zeros(len(body.k))
    speed[:: blocks.modes] = blocks.root * column.velocities
    if blocks.base == CARRIED:
        speed[0] = 0.0
    base_speed = drive.velocity[0] * column.rests_on_base
    welds = rigid & ~opens & np.isinf(laws.upper)  # their blocks get a common velocity at once
    speed += B.T @ rigid_forces(march, speed, base_speed, welds, np.zeros(len(opens)))
    opening = blocks.gap - body.ground[:, 1] * drive.displacement[0]
    # springs have the forces of the gaps; rigid contacts, and welds, have none before the accelerations are known
    stiff = laws.compliance == 0
    force = np.clip(-opening * ~stiff / (laws.compliance + stiff), laws.lower, laws.upper)
    z = np.zeros(len(body.k))
    if settled:
        z, force = static(column, blocks)
        opening = -force * laws.compliance
        rigid[:] = False
    elif blocks.base == HALF_SPACE:
        force[0] = blocks.impedance * (2 * drive.velocity[0] - of_foot(blocks, speed))
    own = march.room.end[2:] @ body.loads - body.k * z
    if scheme.start == "consistent":
        unknown = rigid & (~opens | (opening == 0))
        rate = row_rates(march, speed, base_speed)
        nothing = ROUNDING * np.max(np.abs(rate), initial=0.0)
        forwards = unknown & (rate > nothing) & np.isfinite(laws.lower)
        backwards = unknown & ~opens & (rate < -nothing) & np.isfinite(laws.upper)
        # a contact that slips has its strength against the slip, one whose faces part has none
        force = np.where(forwards, laws.lower, np.where(backwards, laws.upper, force))
        force = rigid_forces(march, own, drive.acceleration[0], unknown & ~forwards & ~backwards, force)
    R = dt * dt * (own + B.T @ force)
    a = R * (scheme.start == "consistent")
    # what opens is closed where it is pressed, what slips holds below its strength
    rows = rows_of(opening, np.where((force <= laws.lower) & opens, LOWER, INSIDE))
    rows.force[:] = force
    p = late_momentum(scheme, dt * speed, a)
    state = ColumnState(z, p, a, R, np.zeros(len(opening)), rows, np.zeros(2))
    if settled:
        place_blocks(march, state)
    return state


def matrix_of(body: Body) -> Array:
    """Return the weights of the modes in the rows, (rows, modes)."""
    matrix = np.zeros((len(body.first), len(body.k)))
    for row, first, weight in zip(matrix, body.first, body.weight, strict=True):
        row[first : first + len(weight)] = weight
    return matrix


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
    length = march.last.part  # of which no stage of a column is made: its s is one
    write_flexibility(march, 1.0, length)
    march.work.q[:] = row_rates(march, rates, base)
    after = rows_of(force, unknown)
    find_in_band(laws, rows_of(force, np.where(unknown, INSIDE, LOWER)), length.flexible, after, march.work)
    return np.asarray(after.force)


def row_rates(march: March, rates: Array, base: float) -> Array:
    """Return how fast each row opens or slips, (rows,), for velocities or accelerations of the modes."""
    # no product of a library, whose fused sums tear apart blocks that fall alike
    moved = np.zeros(len(march.body.first))
    move_rows(march.body, rates, moved)
    moved -= march.body.ground[:, 1] * base
    return moved


def static(column: Column, blocks: Blocks) -> ArrayPair:
    """Return stretches and forces at rest: every contact carries the weight above it; a pressure acts from t = 0 on."""
    weights = column.gravity * inertia(column)
    carried = np.append(np.cumsum(weights[::-1])[::-1], 0.0)
    stretch = -(carried[:-1] + carried[1:]) / 2 * column.heights / column.moduli
    if blocks.base in (WELDED, CARRIED):
        carried[0] = (carried[0] + carried[1]) / 2 if blocks.base == WELDED else 0.0
        stretch[0] = 0.0
    z = np.zeros(blocks.modes * len(weights))
    z[blocks.modes - 1 :: blocks.modes] = blocks.root / math.sqrt(12) * stretch
    return z, carried[:-1]
