"""Histories of a column whose contacts open or slip: what comes in is put into numbers, what comes out is named."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dda.column.column import NEAR, Column, Spring
from dda.column.contact_step import (
    FORCES,
    GAP,
    KINETIC,
    LIMIT,
    MOTION,
    RECORDED,
    SLIDE,
    SPEED,
    SPRINGS,
    STRAIN,
    STRAINED,
    BlockColumn,
    ColumnStage,
    ColumnState,
    ColumnWork,
    DriveSteps,
    JointLaws,
    Observed,
    StepNumbers,
    StepStart,
    find_forces,
    make_column_steps,
)
from dda.column.stepping import DISPLACEMENT, PRESSURE, Drive, column_names
from dda.contact.dense import zeros
from dda.contact.kernel import FOUND
from dda.contact.unilateral import OPEN, SLIP, STICK
from dda.model.arrays import Array
from dda.model.checks import check_count
from dda.one_block.solution import Result, times_of
from dda.scheme.newmark import Scheme, late_momentum
from dda.scheme.stage import implicit_weight, plain_stage
from dda.stepping.compiled import run_loop
from dda.stepping.driver import OUTCOMES
from dda.stepping.energy import SUMS, energies_of

AT_HEIGHTS = (DISPLACEMENT, "stress", "velocity", "force", "gap", "slip")  # the last three where a contact is
COLUMN_OUTCOMES = OUTCOMES | {LIMIT: "solve limit exceeded"}
PLAIN_STEP = 5e-6  # seconds of plain Python for each step
PLAIN_BLOCK = 1.5e-6  # and for each block in it
PLAIN_ENERGIES = 2.3  # times as long with the energies


@dataclass(frozen=True)
class ColumnOptions:
    """How contacts are found and what is kept.

    Raises
    ------
    ValueError
        If the limit of solves, or how often steps are repeated, is no positive integer.
    """

    solve_limit: int | None = None  # solves of the open-close iteration that end the run; None: as many as it takes
    settled: bool = False  # start at rest under the weight alone, not unstrained with all gaps
    states: bool = False  # keep the states of all contacts at every step
    energies: bool = False  # keep energies, momentum and extremes of the contacts at every step
    bonded: bool = False  # contacts carry tension and never slip, whatever the column's law: a faulty program's
    repeats: int = 1  # runs of as many steps that will be made: compiling pays the earlier

    def __post_init__(self) -> None:
        """Check the numbers."""
        check_count(repeats=self.repeats)
        if self.solve_limit is not None:
            check_count(solve_limit=self.solve_limit)


@dataclass(frozen=True, eq=False)
class ColumnContactResult(Result):
    """Histories of the steps that were reached; element 0 is step 1. Forces act on the block above a contact."""

    outcome: str  # "completed", or why the history ends early, in words
    step_solves: NDArray[np.int64]  # solves of the open-close iteration, the confirming one included, (steps,)
    step_switches: NDArray[np.int64]  # contacts whose state changed in a step, (steps,)
    states: NDArray[np.int8] | None  # 0 open, 1 stuck, 2 and -2 slipping, (blocks, steps), by the block above
    record: Array | None  # (RECORDED, steps + 1) from t = 0 on: energies, momentum, extremes of contacts
    newmark: bool  # whether the scheme is Newmark's, whose algorithmic loss is a sum of the steps

    def state_of(self, contact: int) -> NDArray[np.int8]:
        """Return the states at the foot of a block, (steps,).

        Raises
        ------
        ValueError
            If the states were not asked for.
        """
        if self.states is None:
            raise ValueError("states: must be asked for before the steps are made, got none")
        return np.asarray(self.states[contact])

    @cached_property
    def energies(self) -> dict[str, Array] | None:
        """By `ENERGIES` [J/m^2], losses summed from t = 0 on; that of the load is zero at t = 0.

        It is minus the work that weight, pressure, base and half-space do on the column, less what is stored at first.
        """
        if self.record is None:
            return None
        kinetic, strain, springs = self.record[[KINETIC, STRAINED, SPRINGS]]
        load = np.full_like(kinetic, -(strain[0] + springs[0]))
        return energies_of((kinetic, strain, springs, load), self.record[:SUMS].T, not self.newmark)


def solve_contact_column(
    column: Column,
    scheme: Scheme,
    drive: Drive,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
    options: ColumnOptions | None = None,
) -> ColumnContactResult:
    """Step a column of contacts from its starting velocities.

    A numerical failure is an outcome, not an exception: the history then ends with the last step that was reached.

    Parameters
    ----------
    drive : Drive
        What drives it; it holds one instant more than there are steps.
    columns : sequence of str
        ``displacement`` of the top [m], ``contact_pressure``, the force of the base on the column [Pa], and at the
        heights ``displacement_1``, ... [m], ``velocity_1``, ... [m/s], ``stress_1``, ... [Pa, positive in compression;
        in shear minus the shear stress], and where a contact is ``force_1``, ... [Pa, on the block above], ``gap_1``,
        ... and ``slip_1``, ... [m].
    heights : sequence of float
        Heights above the base [m]; where two blocks meet, the lower one is observed.
    options
        How contacts are found and what is kept; the defaults if absent.

    Raises
    ------
    ValueError
        If a column is unknown, a height lies outside or has no contact, or column, scheme and options exclude each
        other.
    """
    options = options or ColumnOptions()
    check_contact_column(column, scheme, options)
    began = perf_counter()
    stages = len(scheme.stages)
    instants = 1 + (len(drive.pressure) - 1) // stages
    n = len(column.heights)
    observed = observed_columns(column, columns, heights)
    equations = [
        ColumnStage(*step_equations(column, scheme, options.solve_limit, options.bonded, place))
        for place in range(stages)
    ]
    numbers, blocks, joints = equations[-1]
    state = start_state(column, scheme, drive, options.settled, numbers, blocks, joints)
    values = np.zeros((instants, len(columns)))
    states = np.zeros((instants if options.states else 0, n), dtype=np.int8)
    solves, switches = zeros(instants, instants, dtype=np.int64)
    record = np.zeros((instants if options.energies else 0, RECORDED))
    parts = (drive.displacement, drive.velocity, drive.acceleration, drive.pressure)
    forcing = DriveSteps(*(np.array(part, dtype=float) for part in parts))
    seconds = stages * instants * (PLAIN_STEP + n * PLAIN_BLOCK)
    ready = perf_counter()
    (reached, ended), _, how = run_loop(
        make_column_steps,
        (),
        (equations[0], equations[-1], state, _room_for_state(n), _room(n), forcing, observed),
        (values, states, solves, switches, record),
        seconds * (PLAIN_ENERGIES if options.energies else 1.0) * options.repeats,
    )
    rows = slice(1, reached + 1)
    early = () if ended == FOUND else (f"{COLUMN_OUTCOMES[ended]} at step {reached + 1}",)
    return ColumnContactResult(
        **times_of(scheme, reached, began, ready),
        columns=dict(zip(columns, values[rows].T + 0.0, strict=True)),
        unknowns=n + int(np.count_nonzero(blocks.stiffness)),
        nonzeros=3 * (n - numbers.first) - 2,
        factorisations=0,
        solves=int(solves.sum()),
        notes=(f"stepped, {how}: contacts {'open and close' if column.law == 'unilateral' else 'slip'}", *early),
        outcome=COLUMN_OUTCOMES[ended],
        step_solves=solves[rows],
        step_switches=switches[rows],
        states=states[rows].T if options.states else None,
        record=record[: reached + 1].T if options.energies else None,
        newmark=scheme.table is None,
    )


def check_contact_column(column: Column, scheme: Scheme, options: ColumnOptions) -> None:
    """Raise ValueError where column, scheme and options exclude each other."""
    if column.law == "bonded":
        raise ValueError("law: must be unilateral or frictional, got 'bonded', which solve_column steps")
    if scheme.damped:
        values = f"{scheme.mass_damping:g}, {scheme.stiffness_damping:g}"
        raise ValueError(f"mass_damping, stiffness_damping: must be 0 where a column has contacts, got {values}")
    lowest = int(not column.rests_on_base or column.contacts[0] is None)
    if scheme.lag and (column.impedance or (column.rests_on_base and column.contacts[0] is None)):
        below = "half-space" if column.impedance else "base welded to the lowest block"
        raise ValueError(f"scheme: {scheme.name} takes contacts on a base or none, got a {below}")
    if scheme.explicit and any(math.isinf(spring.stiffness) for spring in _springs_from(column, lowest)):
        raise ValueError("stiffness: must be finite and no faces welded in an explicit scheme (alpha = 0), got inf")
    if options.settled and not (column.law == "unilateral" and column.rests_on_base):
        base = "such a base" if column.rests_on_base else "another base"
        raise ValueError(
            f"settled: goes with law = 'unilateral' on a base of prescribed motion only, got {column.law!r} on {base}"
        )


# ---- equations -------------------------------------------------------------------------------------------------------


def _springs_from(column: Column, first: int) -> list[Spring]:
    """Return the spring at the foot of every block from one on, rigid and inseparable where faces are welded."""
    welded = Spring(0.0, math.inf)
    return [welded if spring is None else spring for spring in column.contacts[first:]]


def step_equations(
    column: Column, scheme: Scheme, solve_limit: int | None = None, bonded: bool = False, place: int = -1
) -> tuple[StepNumbers, BlockColumn, JointLaws]:
    """Return the equations of a stage as numbers, of the last one unless its `place` says otherwise."""
    stage = scheme.stages[place]
    weight = implicit_weight(stage)
    share = (1 - stage.af) / (1 - stage.am)
    welded = column.rests_on_base and column.contacts[0] is None
    first = 0 if column.rests_on_base and not welded else 1
    n = len(column.heights)
    dt2 = scheme.step**2
    mass = column.densities * column.heights
    rigid = np.isinf(column.moduli)
    stiffness = np.where(rigid, 0.0, column.moduli / column.heights)
    # D as a product keeps the digits that A^2 - B^2 loses in long steps
    A = mass / 3 + weight * dt2 * stiffness
    B = mass / 6 - weight * dt2 * stiffness
    D = mass / 2 * (mass / 6 + 2 * weight * dt2 * stiffness)
    own = dt2 * np.where(rigid, 1 / mass, A / D)
    across = dt2 * np.where(rigid, -1 / mass, B / D)
    stretch = np.where(rigid, 0.0, dt2 / (mass / 12 + weight * dt2 * stiffness))
    impedance = (column.impedance or 0.0) / scheme.step
    dashpot = 1 / (1 + share * stage.delta * impedance * own[0])
    dashpot_coupling = -share * stage.delta * impedance * across[0] * dashpot
    diagonal = own.copy()
    diagonal[1:] += own[:-1]
    top = 0.0 if rigid[0] else dt2 / A[0]  # of the lowest block where its foot is the base
    if n > 1:
        diagonal[1] += top - own[0] if welded else dashpot_coupling * across[0]
    coupling = np.concatenate([[0.0], across])
    if welded:
        coupling[1] = 0.0
    lowest = 0 if column.rests_on_base else 1
    springs = _springs_from(column, lowest)
    compliance, upper, gaps = np.zeros((3, n))
    compliance[lowest:] = [1 / spring.stiffness for spring in springs]
    upper[lowest:] = [math.inf if bonded else spring.strength for spring in springs]
    gaps[lowest:] = [spring.gap for spring in springs]
    opens = np.zeros(n, dtype=np.int64)
    if column.law == "unilateral" and not bonded:
        opens[lowest:] = [face is not None for face in column.contacts[lowest:]]
    joints = JointLaws(
        diagonal=weight * diagonal + compliance,
        coupling=weight * coupling,
        compliance=compliance,
        lower=np.where(opens == 1, 0.0, -upper),
        upper=upper,
        opens=opens,
        gap=gaps,
    )
    blocks = BlockColumn(mass, stiffness, dt2 / mass, stretch / 2, stretch * stiffness, stretch * mass / 12 / dt2)
    numbers = StepNumbers(
        stage=plain_stage(stage)._replace(gg=scheme.gg),
        stages=len(scheme.stages),
        newmark=scheme.table is None,
        averages=scheme.averages,
        share=float(share),
        lag=float(scheme.lag),
        step=scheme.step,
        fall=-column.gravity * dt2,
        first=first,
        welded=int(welded),
        welded_mobility=float(top),
        welded_coupling=-1.0 if rigid[0] else float(mass[0] / 6 / A[0]),
        impedance=impedance,
        dashpot=float(dashpot),
        dashpot_coupling=float(dashpot_coupling),
        limit=solve_limit or 0,
    )
    return numbers, blocks, joints


def _room(n: int) -> ColumnWork:
    room: list[Any] = [*zeros(n, n, n, n), np.zeros(n, dtype=np.int64)]
    room += [StepStart(*zeros(2 * n, 2 * n)), *zeros(2 * n, 2 * n)]
    return ColumnWork(*room)


def _room_for_state(n: int) -> ColumnState:
    room: list[Any] = [*zeros(n, n, 2 * n, 2 * n, n, n, n + 1), np.zeros(n, dtype=np.int64)]
    return ColumnState(*room)


# ---- start -----------------------------------------------------------------------------------------------------------


def start_state(
    column: Column,
    scheme: Scheme,
    drive: Drive,
    settled: bool,
    numbers: StepNumbers,
    blocks: BlockColumn,
    joints: JointLaws,
) -> ColumnState:
    """Return the state at t = 0: unstrained with the gaps of the contacts, or under static forces."""
    n = len(blocks.mass)
    lowest = 0 if column.rests_on_base else 1
    state = _room_for_state(n)
    base_speed = scheme.step * drive.velocity[0] if column.rests_on_base else 0.0
    state.p[:n] = scheme.step * column.velocities
    rigid = joints.compliance == 0
    rigid[:lowest] = False
    welds = rigid & (joints.opens == 0) & np.isinf(joints.upper)  # their blocks get a common velocity at once
    rigid_forces(blocks, state.p, base_speed, joints, welds, np.zeros(n + 1), lowest)
    state.gap[:] = joints.gap
    if numbers.first == 0:
        state.gap[0] -= drive.displacement[0]
    unilateral = joints.opens == 1
    # springs have the forces of the gaps; rigid contacts, and welds, have none before the accelerations are known
    spring = joints.compliance > 0
    state.force[:n] = np.where(spring, -state.gap / np.where(spring, joints.compliance, 1.0), 0.0)
    state.force[:n] = np.clip(state.force[:n], joints.lower, joints.upper)
    state.force[n] = drive.pressure[0]
    if settled:
        write_static(column, state, blocks, joints, float(drive.displacement[0]))
        rigid = np.zeros(n, dtype=bool)
    elif not column.rests_on_base:
        state.force[0] = numbers.impedance * (2 * scheme.step * drive.velocity[0] - state.p[0] + state.p[n] / 2)
    state.state[:] = np.where(unilateral & (state.force[:n] <= 0), OPEN, STICK)
    if scheme.start == "consistent":
        unknown = rigid & (~unilateral | (state.gap == 0))
        state.a[:n] = numbers.fall
        half_stretch = np.where(blocks.stiffness > 0, 6 * blocks.mobility, 0.0)
        state.a[n:] = -2 * half_stretch * blocks.stiffness * state.e
        base_change = scheme.step**2 * drive.acceleration[0]
        states = rigid_forces(blocks, state.a, base_change, joints, unknown, state.force, lowest)
        state.state[unknown] = states[unknown]
    if numbers.welded:
        _move_foot(drive, state, numbers, blocks)
    state.p[:] = late_momentum(scheme, state.p, state.a)
    return state


def _move_foot(drive: Drive, state: ColumnState, numbers: StepNumbers, blocks: BlockColumn) -> None:
    """Give the foot of the lowest block the motion of the base, and the base the force that this needs."""
    base_speed = numbers.step * drive.velocity[0]
    base_change = numbers.step**2 * drive.acceleration[0]
    n = len(state.u)
    top_speed = state.p[0] + state.p[n] / 2
    top_change = state.a[0] + state.a[n] / 2
    if blocks.stiffness[0] == 0:
        top_speed = base_speed
        top_change = base_change
    state.p[[0, n]] = (base_speed + top_speed) / 2, top_speed - base_speed
    state.a[[0, n]] = (base_change + top_change) / 2, top_change - base_change
    m = blocks.mass[0] / numbers.step**2
    if blocks.stiffness[0] == 0:
        state.force[0] = state.force[1] + m * (state.a[0] - numbers.fall)
    else:
        state.force[0] = m * (base_change / 3 + top_change / 6 - numbers.fall / 2) - blocks.stiffness[0] * state.e[0]


def write_static(column: Column, state: ColumnState, blocks: BlockColumn, joints: JointLaws, base: float) -> None:
    """Write the state at rest: every contact carries the weight above it; a pressure on the top acts from t = 0 on."""
    weights = column.gravity * blocks.mass
    n = len(weights)
    carried = np.append(np.cumsum(weights[::-1])[::-1], 0.0)
    state.force[:n] = carried[:n]
    mean = (carried[:n] + carried[1:]) / 2
    state.e[:] = np.where(blocks.stiffness > 0, -mean / np.where(blocks.stiffness > 0, blocks.stiffness, 1.0), 0.0)
    state.gap[:] = -state.force[:n] * joints.compliance
    tops = base + np.cumsum(state.gap - joints.gap + state.e)
    state.u[:] = tops - state.e / 2


def rigid_forces(
    blocks: BlockColumn,
    rates: Array,
    base: float,
    joints: JointLaws,
    rigid: Array,
    force: Array,
    lowest: int,
) -> NDArray[np.int64]:
    """Add to rates of means and stretches what forces change, of rigid contacts those by which they keep together.

    It is the problem of a step, in the limit of short ones, for velocities or accelerations.

    Parameters
    ----------
    rates
        (2n,) rates in units of the step without forces; with them, when the function has returned.
    base
        The rate of the base.
    rigid
        Contacts whose forces are unknown.
    force
        (n + 1,) forces, or impulses; those of rigid contacts come out.

    Returns
    -------
    (n,) states of the rigid contacts.
    """
    n = len(blocks.mass)
    mean = rates[:n]
    stretch = rates[n:]
    half_stretch = np.where(blocks.stiffness > 0, 6 * blocks.mobility, 0.0)
    own = blocks.mobility + half_stretch / 2
    top = mean + stretch / 2
    q = mean - stretch / 2 - np.concatenate([[base], top[:-1]])
    problem = JointLaws(
        diagonal=own + np.concatenate([[0.0], own[:-1]]),
        coupling=np.concatenate([[0.0], half_stretch / 2 - blocks.mobility]),
        compliance=np.zeros(n),
        lower=np.where(rigid, joints.lower, force[:n]),
        upper=np.where(rigid, joints.upper, force[:n]),
        opens=np.where(rigid, joints.opens, 0),
        gap=joints.gap,
    )
    work = _room(n)
    work.tried[:] = np.where(rigid, STICK, SLIP)
    find_forces(problem, lowest, n, q, force, work, 0)
    mean += blocks.mobility * (force[:n] - force[1:])
    stretch -= half_stretch * (force[:n] + force[1:])
    return np.asarray(work.tried)


# ---- what is observed ------------------------------------------------------------------------------------------------


def observed_columns(column: Column, columns: Sequence[str], heights: Sequence[float]) -> Observed:
    """Return what the columns read."""
    names = column_names(heights, AT_HEIGHTS)
    for name in columns:
        if name not in names:
            raise ValueError(f"columns: must be among {', '.join(names)}, got {name!r}")
    rows = np.array([_observed_column(column, name, heights) for name in columns]).reshape(-1, 3)
    kinds, places = rows[:, :2].T.astype(np.int64).copy()
    return Observed(kinds, places, rows[:, 2].copy())


def _observed_column(column: Column, name: str, heights: Sequence[float]) -> tuple[int, int, float]:
    if name == DISPLACEMENT:
        return MOTION, len(column.heights) - 1, 0.5
    if name == PRESSURE:
        return FORCES, 0, 0.0
    part, _, number = name.rpartition("_")
    height = heights[int(number) - 1]
    block, share = column.block_at(height)
    if part in (DISPLACEMENT, "velocity"):
        return (MOTION if part == DISPLACEMENT else SPEED), block, share - 0.5
    if part == "stress":
        modulus = column.moduli[block]
        if math.isinf(modulus):
            return FORCES, block, 0.5
        return STRAIN, block, -modulus / column.heights[block]
    kind = {"force": FORCES, "gap": GAP, "slip": SLIDE}[part]
    for joint in column.joints:
        if abs(joint.height - height) <= NEAR * column.faces[-1]:
            return kind, column.face_of(joint), 0.0
    raise ValueError(f"heights: {name} needs a contact there, got {height!r} m")
