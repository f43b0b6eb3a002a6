r"""Time steps of a column whose contacts open or slip, in the force form.

A block of mass m per area and stiffness K = E/h has a mean displacement u and a stretch e = top - foot, in which its
inertia m, m/12 and its stiffness 0, K are diagonal; a rigid block has no e. With b = alpha dt^2 the step without
contact forces gives every contact j, between the foot of block j and the top of the block below, the opening q_j, and
forces N_j (up on the foot, down on the top below) change it by a matrix of three diagonals:

    z = q + (C + diag(1/k)) N,      C_jj = b (A_j/D_j + A_{j-1}/D_{j-1}),      C_{j,j+1} = b B_j/D_j
    A = m/3 + b K,      B = m/6 - b K,      D = (m/2)(m/6 + 2 b K)

A unilateral contact has N >= 0, z >= 0 and z N = 0. A frictional one has -s <= N <= s and slips by z, positive at
N = -s only and negative at N = s only. A bonded or welded one has z = 0. All are one problem: the least of a strictly
convex function of N within bounds, which has exactly one solution. So no step is ever cut.

The open-close iteration starts from the states of the last step, solves for the forces of all contacts that stick (a
Thomas sweep over each run of them) and updates all states at once, until none changes. A contact whose slip has the
wrong sign is set to what it would do alone (stick, or slip the other way): so the iteration contracts where every
contact feels its neighbours less than half as much as itself. Where all B <= 0, unilateral contacts only close from the
second solve on, and N contacts take N + 1 solves at most. If states changed `SWEEPS` times the number of contacts, one
state is changed at a time (Murty 1974), which ends for every such matrix.

Other schemes take one stage or two of the same form (`dda.scheme.stage`) with b = alpha (1 - af)/(1 - am) dt^2. Where
the forces are balanced between the ends of a step, what the start gives of them is known before the iteration.

What is carried are stretches, and of each contact the gap (of one that sticks -N/k, set, no sum of increments); the
displacements follow from these, from the base upwards. So neither stiff springs nor long steps, in which weight alone
would move a block by g dt^2, cost digits. The state is in units of the step, p = dt v and a for dt^2 a: rates of the
means of all blocks, then those of the stretches.

The kernel of a block, `dda.contact.kernel`, is dense and knows four states and two forces a contact; `dda.stepping`'s
loop keeps forces, gaps and states of all contacts at every step, and cuts. A column of N blocks needs neither: its
solve is O(N), and 80 contacts over 1e5 steps are kept only where they are observed. The names of the states are shared.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from dda.contact.dense import Vector, copy
from dda.contact.kernel import FOUND, NONE, ROUNDING
from dda.contact.unilateral import OPEN, SLIP, STICK
from dda.scheme.stage import Stage, inertia_force, predictor, velocity_corrector
from dda.stepping.driver import OVERFLOW
from dda.stepping.energy import ALGORITHMIC, DAMPING, FRICTION, GIVEN, IMPULSE, SUMS, SWITCHING, bulk_loss

States = Any  # (n,) array, or a list of ints
Rows = Any  # array of two dimensions

LIMIT = 4  # outcome besides those of `dda.stepping.driver`: the limit of solves was exceeded
SWEEPS = 4  # solves for each contact with all states updated at once; N + 1, in shear 2 N + 1, are the most known
ONE_BY_ONE = 1000  # solves for each contact after that, beyond any known problem
# of a step, after its sums: energies, momentum, extremes of the contacts
KINETIC, STRAINED, SPRINGS, MOMENTUM, WIDEST, DEEPEST, OPEN_SHARE, FURTHEST = range(SUMS, SUMS + 8)
RECORDED = FURTHEST + 1

MOTION, SPEED, STRAIN, FORCES, GAP, SLIDE = range(6)  # what an observer reads


class BlockColumn(NamedTuple):
    """Blocks from the base upwards, (n,) each."""

    mass: Vector  # m [kg/m^2]
    stiffness: Vector  # K = E/h [Pa/m]; 0 where rigid
    mobility: Vector  # dt^2/m, acceleration of the mean by a force
    half_stretch: Vector  # that of the stretch by half the sum of the two forces; 0 where rigid
    relaxation: Vector  # that of the stretch by the stretch itself [-]
    inertia_share: Vector  # (m/12) / (m/12 + b K), of its inertia in these two; 0 where rigid


class JointLaws(NamedTuple):
    """Contacts by the block above them, (n,) each; the first one is not used where the column does not rest on a base.

    Where there is none at the base, the force N_0 there is none, or follows N_1 by a dashpot or the base's own motion.
    """

    diagonal: Vector  # C_jj + 1/k_j [m/Pa]
    coupling: Vector  # (n + 1,) C_{j-1,j}, of the last block and the pressure on the top; 0 at first [m/Pa]
    compliance: Vector  # 1/k_j [m/Pa]
    lower: Vector  # bounds of the force [Pa]
    upper: Vector
    opens: States  # 1 of a unilateral contact
    gap: Vector  # at t = 0 [m]


class StepNumbers(NamedTuple):
    """Numbers of a stage of the scheme and of the base."""

    stage: Stage
    stages: int  # of the scheme
    newmark: bool  # whether it is Newmark's
    averages: bool  # whether its stage balances the forces between the ends of the step
    share: float  # (1 - af)/(1 - am): weight of the forces at the end
    lag: float  # by how much of a step velocities are older than displacements
    step: float  # dt [s]
    fall: float  # -g dt^2, acceleration by weight
    first: int  # number of the lowest contact
    welded: int  # 1 where the lowest block's foot moves as the base does
    welded_mobility: float  # dt^2 / (m/3 + alpha dt^2 K) of its top; 0 where it is rigid
    welded_coupling: float  # (m/6) / (m/3 + alpha dt^2 K), by which its top lags behind its foot; -1 where it is rigid
    impedance: float  # z/dt of a half-space below
    dashpot: float  # 1 / (1 + delta dt z A_0/D_0): what the dashpot leaves of its force before the step
    dashpot_coupling: float  # by which N_1 changes the force N_0 of the dashpot
    limit: int  # solves that end the run; 0: none


class ColumnStage(NamedTuple):
    """The equations of a stage."""

    numbers: StepNumbers
    blocks: BlockColumn
    joints: JointLaws


class ColumnState(NamedTuple):
    """Where the column is, in units of the step."""

    u: Vector  # (n,) mean displacement [m]
    e: Vector  # (n,) stretch [m]
    p: Vector  # (2n,) dt times the rates of means, then of stretches
    a: Vector  # (2n,) dt^2 times their accelerations
    gap: Vector  # (n,) gap of a unilateral contact, negative when pressed; stretch of the spring of another [m]
    slip: Vector  # (n,) sum of slips [m]
    force: Vector  # (n + 1,) N at the foot of every block, and the pressure on the top [Pa]
    state: States  # (n,) OPEN, STICK or SLIP in its direction


class StepStart(NamedTuple):
    """Rates and accelerations at the start of a step, as in `ColumnState`."""

    p: Vector
    a: Vector


class ColumnWork(NamedTuple):
    """Room for a step."""

    q: Vector  # (n,) openings without contact forces
    opening: Vector  # (n,) z of the contacts that do not stick
    pivot: Vector
    right: Vector
    tried: States
    start: StepStart  # of two stages
    known: Vector  # (2n,) what forces and accelerations at the start leave of the accelerations
    speed: Vector  # (2n,) dt times the rates at the time of the displacements


class DriveSteps(NamedTuple):
    """What drives the column at t = 0 and at the end of every stage, (stages * steps + 1,) each."""

    displacement: Vector  # of the base [m]
    velocity: Vector  # of the base, or of the incident wave above a half-space [m/s]
    acceleration: Vector  # of the base [m/s^2]
    pressure: Vector  # on the top [Pa]


class Observed(NamedTuple):
    """What is kept of every step."""

    kind: States  # (columns,)
    place: States  # block or contact
    weight: Vector  # of the stretch beside the mean, or what is multiplied


# ---- forces of the contacts ------------------------------------------------------------------------------------------


def find_forces(
    joints: JointLaws, first: int, n: int, q: Vector, force: Vector, work: ColumnWork, limit: int
) -> tuple[int, int]:
    """Find states and forces of contacts first..n-1 from the states `work.tried`; return outcome and solves.

    Parameters
    ----------
    q
        Openings without forces.
    force
        (n + 1,) forces: known ones outside of first..n-1 and those of contacts at a bound go in, all come out.
    limit
        Solves that end the search; 0: none.
    """
    together = SWEEPS * (n + 1)
    solves = 0
    slack = 0.0
    while True:
        solve_sticking(joints, first, n, q, force, work)
        solves += 1
        if solves > together:  # blocks which touch in common flight have states that only rounding tells apart
            slack = 0.0
            for j in range(n + 1):
                slack = max(slack, ROUNDING * abs(force[j]))
        if update_states(joints, first, n, q, force, work, solves <= together, slack) == 0:
            return FOUND, solves
        if solves == limit:
            return LIMIT, solves
        if solves > together + ONE_BY_ONE * (n + 1):
            return NONE, solves


def solve_sticking(joints: JointLaws, first: int, n: int, q: Vector, force: Vector, work: ColumnWork) -> None:
    """Write the forces of the contacts that stick, given those of all others: Gauss, from the base upwards."""
    coupling = joints.coupling
    diagonal = joints.diagonal
    pivot = work.pivot
    right = work.right
    tried = work.tried
    sticks_below = False
    for j in range(first, n):
        if tried[j] != STICK:
            sticks_below = False
            continue
        if sticks_below:
            factor = coupling[j] / pivot[j - 1]
            pivot[j] = diagonal[j] - factor * coupling[j]
            right[j] = 0.0 - q[j] - factor * right[j - 1]
        else:
            pivot[j] = diagonal[j]
            right[j] = 0.0 - q[j]
            if j > 0:
                right[j] -= coupling[j] * force[j - 1]
        sticks_below = True
    for j in range(n - 1, first - 1, -1):
        if tried[j] == STICK:
            force[j] = (right[j] - coupling[j + 1] * force[j + 1]) / pivot[j]


def update_states(
    joints: JointLaws, first: int, n: int, q: Vector, force: Vector, work: ColumnWork, together: bool, slack: float
) -> int:
    """Set the states that disagree with forces and openings, and the forces at bounds; return how many disagreed.

    Parameters
    ----------
    together
        Set all of them, else the first one alone.
    slack
        Force by which one that disagrees does so at least [Pa].
    """
    coupling = joints.coupling
    tried = work.tried
    wrong = 0
    below = 0.0
    if first > 0:
        below = force[0]
    for j in range(first, n):
        here = force[j]
        state = tried[j]
        new = state
        if state == STICK:
            if not joints.lower[j] - slack < here < joints.upper[j] + slack:
                new = bound_state(joints, j, here)
        else:
            opening = q[j] + joints.diagonal[j] * here + coupling[j] * below + coupling[j + 1] * force[j + 1]
            work.opening[j] = opening
            if abs(opening) > slack * joints.diagonal[j] and (opening > 0) == (state == -SLIP):
                new = alone(joints, j, here - opening / joints.diagonal[j])
        if new != state:
            wrong += 1
            set_state(joints, j, new, force, tried)
            if not together:
                break
        below = here
    return wrong


def bound_state(joints: JointLaws, j: int, force: float) -> int:
    """Return the state of a contact that was taken to stick with some force; one of NaN keeps it."""
    if force <= joints.lower[j]:
        return OPEN if joints.opens[j] == 1 else SLIP
    if force >= joints.upper[j]:
        return -SLIP
    return STICK


def alone(joints: JointLaws, j: int, force: float) -> int:
    """Return the state of a contact whose opening has the wrong sign, by the force that would close it alone."""
    if force < joints.lower[j]:
        return SLIP
    if force > joints.upper[j]:
        return -SLIP
    return STICK


def set_state(joints: JointLaws, j: int, state: int, force: Vector, tried: States) -> None:
    """Write a state, and the force of a contact at a bound."""
    tried[j] = state
    if state == -SLIP:
        force[j] = joints.upper[j]
    elif state != STICK:
        force[j] = joints.lower[j]


# ---- the step --------------------------------------------------------------------------------------------------------


def predict(
    numbers: StepNumbers,
    blocks: BlockColumn,
    state: ColumnState,
    start: StepStart,
    drive: DriveSteps,
    row: int,
    work: ColumnWork,
) -> None:
    """Bring the state to what is known before the contact forces, and write the openings without these.

    Parameters
    ----------
    start
        The start of the step: the state itself where there is one stage.
    row
        Of the drive, at the end of the stage.
    """
    stage = numbers.stage
    n = len(state.u)
    p = state.p
    a = state.a
    e = state.e
    if numbers.averages:
        known_accelerations(numbers, blocks, state, start, work)
    state.u[0] += predictor(stage, start.p[0], start.a[0], p[0], a[0])
    if numbers.welded == 1:
        below = predict_welded(numbers, blocks, state, start, drive, row, work)
    else:
        below = drive.displacement[row] - drive.displacement[row - 1]
    for i in range(numbers.welded, n):
        k = n + i
        moved = predictor(stage, start.p[i], start.a[i], p[i], a[i])
        half = predictor(stage, start.p[k], start.a[k], p[k], a[k])
        p[i] = velocity_corrector(stage, start.p[i], start.a[i], a[i], 0.0)
        p[k] = velocity_corrector(stage, start.p[k], start.a[k], a[k], 0.0)
        moved += stage.alpha * (numbers.share * numbers.fall + work.known[i])
        e[i] += half
        half = 0.5 * (half - stage.alpha * (numbers.share * blocks.relaxation[i] * e[i] - work.known[k]))
        work.q[i] = state.gap[i] + (moved - half - below)
        below = moved + half


def known_accelerations(
    numbers: StepNumbers, blocks: BlockColumn, state: ColumnState, start: StepStart, work: ColumnWork
) -> None:
    """Write what the start of a step gives of the accelerations at its end: (af R0 - am a0)/(1 - am), R0 by M."""
    stage = numbers.stage
    n = len(state.u)
    for i in range(n):
        above = state.force[i + 1]
        below = state.force[i]
        mean = numbers.fall + blocks.mobility[i] * (below - above)
        work.known[i] = inertia_force(stage, 0.0, mean, start.a[i])
        work.known[n + i] = 0.0
        if blocks.stiffness[i] > 0:
            stretch = 0.0 - 12 * blocks.mobility[i] * (blocks.stiffness[i] * state.e[i] + (below + above) / 2)
            work.known[n + i] = blocks.inertia_share[i] * inertia_force(stage, 0.0, stretch, start.a[n + i])
    if numbers.welded == 1:  # of its top alone, as a force; the base's inertia is a load, as in `dda.column.stepping`
        mass = 1 / blocks.mobility[0]
        force = numbers.fall * mass / 2 - state.force[1] - blocks.stiffness[0] * state.e[0]
        force -= mass / 6 * (start.a[0] - start.a[n] / 2)
        work.known[0] = inertia_force(stage, 0.0, force, mass / 3 * (start.a[0] + start.a[n] / 2))


def correct(numbers: StepNumbers, blocks: BlockColumn, state: ColumnState, work: ColumnWork) -> None:
    """Write the state under the contact forces."""
    n = len(state.u)
    below = state.force[numbers.welded]
    for i in range(numbers.welded, n):
        k = n + i
        above = state.force[i + 1]
        mean = numbers.fall + blocks.mobility[i] * (below - above)
        stretch = 0.0 - blocks.relaxation[i] * state.e[i] - blocks.half_stretch[i] * (below + above)
        below = above
        state.a[i] = numbers.share * mean + work.known[i]
        state.a[k] = numbers.share * stretch + work.known[k]
        state.p[i] += numbers.stage.delta * state.a[i]
        state.p[k] += numbers.stage.delta * state.a[k]
        state.e[i] += numbers.stage.alpha * state.a[k]


def predict_welded(
    numbers: StepNumbers,
    blocks: BlockColumn,
    state: ColumnState,
    start: StepStart,
    drive: DriveSteps,
    row: int,
    work: ColumnWork,
) -> float:
    """Predict the lowest block, whose foot is the base; return how far its top moves without contact forces.

    Displacement, velocity and acceleration of the foot are those of the base: from its displacement alone average
    acceleration would make accelerations that alternate, ever more, around the right ones.
    """
    stage = numbers.stage
    base = drive.displacement[row] - drive.displacement[row - 1]
    base_speed = numbers.step * drive.velocity[row]
    base_change = numbers.step * numbers.step * drive.acceleration[row]
    n = len(state.u)
    p = state.p
    top_speed = start.p[0] + start.p[n] / 2
    top_change = start.a[0] + start.a[n] / 2
    change_before = state.a[0] + state.a[n] / 2
    moved = predictor(stage, top_speed, top_change, p[0] + p[n] / 2, change_before)
    predicted_speed = velocity_corrector(stage, top_speed, top_change, change_before, 0.0)
    if blocks.stiffness[0] == 0:
        moved = base - stage.alpha * base_change
        predicted_speed = base_speed - stage.delta * base_change
    state.e[0] += moved - base
    p[0] = (base_speed + predicted_speed) / 2
    p[n] = predicted_speed - base_speed
    state.a[0] = base_change
    return float(moved + stage.alpha * top_acceleration(numbers, blocks, state, 0.0, work))


def top_acceleration(
    numbers: StepNumbers, blocks: BlockColumn, state: ColumnState, above: float, work: ColumnWork
) -> float:
    """Return that of the top of a predicted block whose foot's acceleration is `state.a[0]`, under a force on it."""
    weight = numbers.fall / blocks.mobility[0] / 2
    force = numbers.share * (weight - above - blocks.stiffness[0] * state.e[0]) + work.known[0]
    coupling = numbers.welded_coupling
    if blocks.stiffness[0] > 0:
        coupling *= numbers.share
    return float(numbers.welded_mobility * force - coupling * state.a[0])


def correct_welded(numbers: StepNumbers, blocks: BlockColumn, state: ColumnState, work: ColumnWork) -> None:
    """Write the lowest block, whose foot is the base, and the force of the base on it."""
    n = len(state.u)
    base_change = state.a[0]
    a = top_acceleration(numbers, blocks, state, state.force[1], work)
    state.e[0] += numbers.stage.alpha * a
    state.p[0] += numbers.stage.delta * a / 2
    state.p[n] += numbers.stage.delta * a
    if blocks.stiffness[0] == 0:
        state.e[0] = 0.0
        state.p[n] = 0.0
    state.a[0] = (base_change + a) / 2
    state.a[n] = a - base_change
    state.force[0] = state.force[1] + (state.a[0] - numbers.fall) / blocks.mobility[0]


def dashpot_force(
    numbers: StepNumbers, blocks: BlockColumn, state: ColumnState, velocity: float, work: ColumnWork
) -> float:
    """Return the force of the half-space on a predicted column, z (2 v - velocity of the foot) [Pa]."""
    n = len(state.u)
    gained = numbers.share * (numbers.fall + blocks.relaxation[0] * state.e[0] / 2)
    gained += work.known[0] - work.known[n] / 2
    foot = state.p[0] - state.p[n] / 2 + numbers.stage.delta * gained
    force: float = numbers.impedance * (2 * numbers.step * velocity - foot) * numbers.dashpot
    return force


def place_blocks(numbers: StepNumbers, joints: JointLaws, state: ColumnState, base: float) -> None:
    """Write the mean displacements from stretches, gaps and slips, above the base or above the lowest block."""
    u = state.u
    e = state.e
    if numbers.first == 0 or numbers.welded == 1:
        lowest = 0
        below = base
    else:
        lowest = 1
        u[0] += numbers.stage.alpha * state.a[0]
        below = u[0] + e[0] / 2
    for i in range(lowest, len(u)):
        foot = below + (state.gap[i] - joints.gap[i]) + state.slip[i]
        u[i] = foot + e[i] / 2
        below = foot + e[i]


def accept_contacts(joints: JointLaws, first: int, state: ColumnState, work: ColumnWork) -> int:
    """Write gaps, slips and states; return how many states changed."""
    gap = state.gap
    switches = 0
    for j in range(first, len(gap)):
        tried = work.tried[j]
        if tried != state.state[j]:
            switches += 1
            state.state[j] = tried
        if tried == OPEN:
            gap[j] = work.opening[j]
        else:
            gap[j] = 0.0 - state.force[j] * joints.compliance[j]
            if tried != STICK:
                state.slip[j] += work.opening[j]
    return switches


def make_column_steps(
    first: ColumnStage,
    last: ColumnStage,
    state: ColumnState,
    before: ColumnState,
    work: ColumnWork,
    drive: DriveSteps,
    observed: Observed,
    values: Rows,
    states: Rows,
    solves: Any,
    switches: Any,
    energies: Rows,
) -> tuple[int, int]:
    """Make the steps; return how many were reached, and how it ended.

    Parameters
    ----------
    first, last
        The stages of the scheme, `last` alone where there is one.
    before
        Room for the state before a stage, used with energies only.
    values, states
        (steps + 1, columns) what is observed, and (steps + 1, n) states of the contacts, or (0, n) if not asked for.
    solves, switches
        (steps + 1,) solves of the open-close iteration, the confirming one included, and states that changed.
    energies
        (steps + 1, RECORDED), or no rows if they are not asked for.
    """
    count = last.numbers.stages
    start = StepStart(state.p, state.a) if count == 1 else work.start
    write_step(last, state, work, observed, 0, values, states, energies)
    for step in range(1, len(values)):
        if len(energies) > 0:
            for k in range(SUMS):
                energies[step, k] = energies[step - 1, k]
            add_damping(last, state, energies, step)
        if count > 1:
            copy(state.p, start.p)
            copy(state.a, start.a)
        for k in range(count):
            stage = last if k + 1 == count else first
            row = count * (step - 1) + k + 1
            if len(energies) > 0:
                copy_state(stage.numbers, state, before, step)
            outcome = make_stage(stage, state, start, work, drive, row, step, solves, switches)
            if outcome != FOUND:
                return step - 1, outcome
            if len(energies) > 0:
                account(stage, before, state, drive, row, step, energies)
        if not write_step(last, state, work, observed, step, values, states, energies):
            return step - 1, OVERFLOW
    return len(values) - 1, FOUND


def make_stage(
    stage: ColumnStage,
    state: ColumnState,
    start: StepStart,
    work: ColumnWork,
    drive: DriveSteps,
    row: int,
    step: int,
    solves: Any,
    switches: Any,
) -> int:
    """Bring the state to the end of a stage; return the outcome."""
    numbers = stage.numbers
    blocks = stage.blocks
    joints = stage.joints
    n = len(state.u)
    first = numbers.first
    force = state.force
    predict(numbers, blocks, state, start, drive, row, work)
    force[n] = drive.pressure[row]
    if first > 0 and numbers.impedance > 0:
        force[0] = dashpot_force(numbers, blocks, state, drive.velocity[row], work)
    for j in range(first, n):
        work.tried[j] = state.state[j]
    outcome, count = find_forces(joints, first, n, work.q, force, work, numbers.limit)
    solves[step] += count
    if outcome != FOUND:
        return outcome
    if numbers.welded == 1:
        correct_welded(numbers, blocks, state, work)
    elif first > 0:
        force[0] += numbers.dashpot_coupling * force[1]
    correct(numbers, blocks, state, work)
    switches[step] += accept_contacts(joints, first, state, work)
    place_blocks(numbers, joints, state, drive.displacement[row])
    return FOUND


# ---- what is kept ----------------------------------------------------------------------------------------------------


def write_step(
    stage: ColumnStage,
    state: ColumnState,
    work: ColumnWork,
    observed: Observed,
    step: int,
    values: Rows,
    states: Rows,
    energies: Rows,
) -> bool:
    """Write what is kept of a state; tell whether it is finite."""
    n = len(state.u)
    joints = stage.joints
    p = state.p
    if stage.numbers.lag != 0:
        p = work.speed
        discount = stage.numbers.stage.gg if step == 0 else 1.0  # of what `late_momentum` made of those at t = 0
        for i in range(2 * n):
            p[i] = discount * state.p[i] + stage.numbers.lag * state.a[i]
    for k in range(len(observed.kind)):
        kind = observed.kind[k]
        place = observed.place[k]
        weight = observed.weight[k]
        if kind == MOTION:
            value = state.u[place] + weight * state.e[place]
        elif kind == SPEED:
            value = (p[place] + weight * p[n + place]) / stage.numbers.step
        elif kind == STRAIN:
            value = weight * state.e[place]
        elif kind == FORCES:  # that of one contact, or the mean of both of a rigid block
            value = (1 - weight) * state.force[place] + weight * state.force[place + 1]
        elif kind == GAP:
            value = max(state.gap[place], 0.0) if joints.opens[place] == 1 else 0.0
        else:
            value = state.slip[place]
        values[step, k] = value
    if len(states) > 0:
        for j in range(n):
            states[step, j] = state.state[j]
    if len(energies) > 0:
        store(stage, state, p, energies, step)
    total = 0.0
    for i in range(n):
        total += state.u[i]
    return math.isfinite(total)


def copy_state(numbers: StepNumbers, source: ColumnState, target: ColumnState, step: int) -> None:
    """Copy what the balance of energy needs of the state before a step."""
    copy(source.u, target.u)
    copy(source.e, target.e)
    copy(source.gap, target.gap)
    copy(source.slip, target.slip)
    copy(source.force, target.force)
    copy(source.state, target.state)
    if step == 1 or numbers.stage.alpha != numbers.stage.delta / 2:
        copy(source.a, target.a)


def kinetic_of(mass: Vector, rates: Vector) -> float:
    """Return half the squares of rates of means and stretches by their inertia, m and m/12."""
    n = len(mass)
    total = 0.0
    for i in range(n):
        total += mass[i] * (rates[i] * rates[i] + rates[n + i] * rates[n + i] / 12)
    return total / 2


def store(stage: ColumnStage, state: ColumnState, p: Vector, energies: Rows, step: int) -> None:
    """Write kinetic energy, strain energy and that of the springs [J/m^2], momentum, and the extremes of contacts."""
    numbers = stage.numbers
    blocks = stage.blocks
    joints = stage.joints
    strain = 0.0
    springs = 0.0
    momentum = 0.0
    widest = 0.0
    deepest = 0.0
    furthest = 0.0
    open_contacts = 0
    contacts = 0
    mass = blocks.mass
    stiffness = blocks.stiffness
    compliance = joints.compliance
    opens = joints.opens
    e = state.e
    for i in range(len(e)):
        strain += stiffness[i] * e[i] * e[i]
        momentum += mass[i] * p[i]
    for j in range(numbers.first, len(e)):
        force = state.force[j]
        springs += compliance[j] * force * force
        if opens[j] == 1:
            gap = state.gap[j]
            contacts += 1
            if gap > widest:
                widest = gap
            elif -gap > deepest:
                deepest = -gap
            if state.state[j] == OPEN:
                open_contacts += 1
        elif abs(state.slip[j]) > furthest:
            furthest = abs(state.slip[j])
    energies[step, KINETIC] = kinetic_of(blocks.mass, p) / (numbers.step * numbers.step)
    energies[step, STRAINED] = strain / 2
    energies[step, SPRINGS] = springs / 2
    energies[step, MOMENTUM] = momentum / numbers.step
    energies[step, WIDEST] = widest
    energies[step, DEEPEST] = deepest
    energies[step, OPEN_SHARE] = open_contacts / max(contacts, 1)
    energies[step, FURTHEST] = furthest


def add_damping(stage: ColumnStage, state: ColumnState, energies: Rows, step: int) -> None:
    """Add what the discount takes of the velocities that a step starts with [J/m^2]."""
    numbers = stage.numbers
    gg = numbers.stage.gg
    kinetic = energies[step - 1, KINETIC]
    if numbers.lag != 0 and step == 1:
        return
    if numbers.lag != 0:
        kinetic = kinetic_of(stage.blocks.mass, state.p) / (numbers.step * numbers.step)
    energies[step, DAMPING] += (1 - gg * gg) * kinetic


def account(
    stage: ColumnStage,
    before: ColumnState,
    after: ColumnState,
    drive: DriveSteps,
    drive_row: int,
    step: int,
    energies: Rows,
) -> None:
    """Add what a stage loses, and what weight, pressure, base and half-space put in [J/m^2]; see `dda.stepping.energy`.

    All forces act with the weights 1 - delta and delta at the two ends of Newmark's step, with one half at those of
    another scheme's stage, whose algorithmic loss the energies leave. A base that moves with a block welded to it does
    not move as Newmark's formulas do: its work is as accurate as the scheme.
    """
    numbers = stage.numbers
    blocks = stage.blocks
    joints = stage.joints
    n = len(after.u)
    first = numbers.first
    late = numbers.stage.delta if numbers.newmark else 0.5
    dt2 = numbers.step * numbers.step
    row = energies[step]
    stiff = 0.0
    work = 0.0
    stiffness = blocks.stiffness
    mass = blocks.mass
    e0 = before.e
    e1 = after.e
    u0 = before.u
    u1 = after.u
    for i in range(n):
        stretched = e1[i] - e0[i]
        stiff += stiffness[i] * stretched * stretched
        work += mass[i] * (u1[i] - u0[i])
    kinetic = 0.0
    change = 0.0
    if numbers.newmark and numbers.stage.alpha != late / 2:
        kinetic = kinetic_of(blocks.mass, after.a) - kinetic_of(blocks.mass, before.a)
        for i in range(n):
            faster = after.a[i] - before.a[i]
            wider = after.a[n + i] - before.a[n + i]
            change += mass[i] * (faster * faster + wider * wider / 12) / 2
    row[ALGORITHMIC] += bulk_loss(numbers.stage.alpha, late, 1 / dt2, stiff, kinetic, change)
    switching = 0.0
    keeping = 0.0
    dissipated = 0.0
    for j in range(first, n):
        early_force = before.force[j]
        late_force = after.force[j]
        slipped = after.slip[j] - before.slip[j]
        friction = 0.0 - late_force * slipped
        lost = joints.compliance[j] * (early_force * early_force - late_force * late_force) / 2 - friction
        lost -= ((1 - late) * early_force + late * late_force) * (after.gap[j] - before.gap[j] + slipped)
        if before.state[j] == after.state[j]:
            keeping += lost
        else:
            switching += lost
        dissipated += friction
    row[ALGORITHMIC] += keeping
    row[SWITCHING] += switching
    row[FRICTION] += dissipated
    foot = after.u[0] - before.u[0] - (after.e[0] - before.e[0]) / 2
    if first == 0:
        foot = drive.displacement[drive_row] - drive.displacement[drive_row - 1]
    top = after.u[n - 1] - before.u[n - 1] + (after.e[n - 1] - before.e[n - 1]) / 2
    base_force = (1 - late) * before.force[0] + late * after.force[0]
    top_force = (1 - late) * before.force[n] + late * after.force[n]
    row[GIVEN] += numbers.fall / dt2 * work + base_force * foot - top_force * top
    row[IMPULSE] += numbers.step * (numbers.stage.end - numbers.stage.begin) * base_force
    if step == 1 and numbers.newmark:  # A0 may be any, later accelerations follow from the forces
        row[ALGORITHMIC] += (1 - late) * missing_work(numbers, blocks, before, after)


def missing_work(numbers: StepNumbers, blocks: BlockColumn, before: ColumnState, after: ColumnState) -> float:
    """Return the work in the first step of the forces at t = 0 that A0 leaves out [J/m^2]."""
    dt2 = numbers.step * numbers.step
    work = 0.0
    for i in range(len(after.u)):
        missing = before.force[i] - before.force[i + 1] + blocks.mass[i] * (numbers.fall - before.a[i]) / dt2
        work += missing * (after.u[i] - before.u[i])
        if blocks.stiffness[i] > 0:
            missing = 0.0 - (before.force[i] + before.force[i + 1]) / 2 - blocks.stiffness[i] * before.e[i]
            missing -= blocks.mass[i] / 12 * before.a[len(after.u) + i] / dt2
            work += missing * (after.e[i] - before.e[i])
    return work
