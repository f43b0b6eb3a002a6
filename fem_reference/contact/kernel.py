r"""Steps of a block on contact points, as plain functions of arrays and numbers.

A step has the stages of its scheme (`fem_reference.problem.stages`), with u = gg V, b = beta / (1 - am) and
E = (1 - am) A1 + am A, the acceleration of the equation of motion. With S = M + beta' dt^2 K of the block without the
base's springs and B the rows of the points' gaps and slips, a stage is::

    D* = D + dt (d_u u + d_g Vg) + dt^2 (e_0 A + e_g Ag - b am A)
    E  = S^-1 (F - K [(1 - af) D* + af D]) + S^-1 B' [(1 - af) (N, T) + af (N0, T0)]
    D1 = D* + b dt^2 E,   A1 = (E - am A) / (1 - am),   V1 = u + dt (g_0 A + g_g Ag + gamma A1)

the free block, then the contact forces of both ends of the step in the mean of the scheme, without a division by
beta dt^2. For Newmark's scheme D* = D + gg dt V + dt^2 (1/2 - alpha) A, E = A1 and the forces are those of the end. The
gaps and slips at the end are those of the free block plus C (N, T), C = beta' dt^2 B S^-1 B', zero where the scheme is
explicit. Nothing depends on the contact states but the small problem of the
forces. The displacement of a base that moves is taken from the gaps and slips. With implicit contact (Kane, Repetto,
Ortiz and Marsden, 1999) A is the block's own, M A1 = F - K D1, under average acceleration, and the forces of the
step's end throw it besides, D by dt^2 / 2 and V by dt times Q = M^-1 B' (N, T)::

    D1 = D* + alpha dt^2 (A1 + Q / (2 alpha)),   V1 = gg V + dt ((1 - delta) A + delta A1) + dt Q

**The law of a point.** It is open with N = 0 and w >= 0, or closed with w = -N / k and N >= 0. A closed point that
sticks bears T = -k_t (s - r) with its slip s and reference r. While it is open its reference follows its slip; where
it closes within a step, from a gap w0 >= 0 to w1 < 0, the reference is the slip at the crossing,
r = s0 + (s1 - s0) w0 / (w0 - w1), which stores no energy while open and loses no slip of the step. Hence

    T = -k_t phi (s1 - r0),    phi = w1 / (w1 - w0) for a point that closes, 1 for one that was closed.

For any phi from 0 to 1 the spring gains no more energy than a step of delta = 1 puts into it. With friction (Coulomb)
the point sticks where |T| <= tan(angle) N + c, c its part of the base's cohesion, and slides otherwise,

    T = -d (tan(angle) N + c),    r = s1 + T / k_t,    d = 1 towards +x or -1, with d dr >= 0,

which takes the energy -T dr >= 0. An open point has no cohesion, and has it again where it closes.

**The states of a step.** They are guessed, the forces solved for, and all states corrected at once until none changes.
For three and more points that may cycle (Ben Gharbia and Gilbert, 2010). Without shear springs the first wrong state
is then set again and again, which ends at the only contact there is, as C + diag(1/k) is positive definite (Murty,
1974). With them some steps have no consistent states and some have several: all sets of states are tried if there are
few, and with friction the first wrong state is set again and again if there are many.

These functions run as they stand, or compiled by numba (`fem_reference.contact.compilation`), in the same order of
operations. K, M and S^-1 are then the diagonals of the block in its natural modes; as they stand they may be operators.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.problem import Array

States = NDArray[np.int8]
OPEN = 0
STICK = 1
SLIP = 2
"""States of a point: open; closed, its shear spring held; closed and sliding towards +x (-SLIP: towards -x)."""
STATES = (OPEN, STICK, SLIP, -SLIP)
CONVERGED = 0
NONE = 1
SEVERAL = 2
OVERFLOW = 3
UNSETTLED = 4
"""How a step ends: with its contact, with no consistent set of states, with several, with numbers that overflow;
where there is no fallback, without an end of the iteration."""
ENUMERATED = 256
"""Greatest number of sets of states that are all tried: eight points that hold, four that may slide."""
SINGLY = 4
SINGLY_FRICTIONLESS = 100
"""Greatest number of changes of one point after the other, over the number of points."""
PASSES = 60
"""Greatest number of corrections of the crossings for given states."""
SETTLED = 1e-13
"""Change of phi at which the crossings are settled [-]."""
ROUNDED = 1e-12
"""Share of the friction by which a sliding point may miss it."""
ALIKE = 1e-9
"""Difference of forces below which two sets of states are one contact, over the largest force."""
TIME = 0
BASE = 1
INPUT = 3
LOSSES = 4
STARTED = 8
UNDISCOUNTED = 9
TOTALS = 10
"""Where `ContactState.totals` has its numbers, and how many they are."""
ENERGY_COLUMNS = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOSS_COLUMNS = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")
COUNTS = ("solves", "cuts")
UNILATERAL_COLUMNS = (
    "displacement",
    "contact_pressure",
    "horizontal_displacement",
    "rotation",
    "velocity",
    "base_shear",
    "open_share",
    "largest_gap",
    "largest_penetration",
    "largest_slide",
    *ENERGY_COLUMNS,
    *LOSS_COLUMNS,
    *COUNTS,
)
"""Columns of a history, one row a step: v at the centroid [m]; sum of N over the base's length [Pa]; u and rotation at
the centroid [m, 1]; velocity of the centre of mass upwards [m/s]; sum of T over the base's length [Pa]; share of the
base with a positive gap [-]; largest gap and penetration, and largest way that a point has slid while closed, there
less back [m]; energies [J], of the loads -F'D less the work of a moving base; energies lost from t = 0 on [J], negative
where gained, by friction never; solutions of the open-close iteration and cuts of the step [-]."""


class Block(NamedTuple):
    """The block in one stage of one length of step; operators are diagonals, or know products with vectors."""

    K: Any  # elastic stiffness without the springs of the base [N/m]
    M: Any  # mass [kg]
    inverse: Any  # S^-1 of the stage [1/kg]
    B: Any  # rows of the gaps, then slips, of the points, shape (forces, unknowns)
    response: Any  # S^-1 B' of the forces, over 2 alpha for implicit contact, shape (unknowns, forces)
    impulse: Any  # M^-1 B' for implicit contact, shape (unknowns, forces)
    F: Array  # constant load [N], shape (unknowns,)
    rows: Array  # rows that give v, u and the rotation at the centroid, shape (3, unknowns)
    momentum: Array  # row that gives the velocity of the centre of mass upwards, shape (unknowns,)
    gg: float  # factor on the velocity for this length of step [-]
    step: float  # length of step [s]
    stagger: float  # time from that of the velocity to the end of the step [s]
    duration: float  # of the stage, over the step [-]
    beta: float  # numbers of the stage: `fem_reference.problem.stages.Stage`
    gamma: float
    d_u: float
    d_g: float
    e_0: float
    e_g: float
    g_0: float
    g_g: float
    am: float
    af: float
    end_weight: float  # of the forces at the end of the stage in the energy that points lose [-]
    has_closed_loss: bool  # whether the scheme's own loss has Newmark's closed form


class Law(NamedTuple):
    """The contact of all points for one stage of one length of step."""

    C: Array  # gaps, then slips, of unit forces [m/N], shape (forces, forces)
    compliance: Array  # 1 / k of each point [m/N], shape (points,)
    shear_stiffness: Array  # k_t of each point [N/m], shape (points,)
    tangent: float  # of the angle of friction; infinite where nothing slides [-]
    cohesion: Array  # c of each point [N], shape (points,)
    share: Array  # share of the base that belongs to each point [-], shape (points,)
    length: float  # length of the base [m]
    limit: int  # greatest number of solutions of the open-close iteration [-]
    implicit: bool  # whether contact is implicit


class ContactState(NamedTuple):
    """Motion and contact at the end of a step."""

    D: Array  # displacement of the unknowns [m]
    V: Array  # velocity [m/s]
    A: Array  # acceleration [m/s2]
    gap: Array  # gap w of each point [m], negative where pressed, shape (points,)
    slip: Array  # displacement s of each point along the base [m]; zero without shear springs
    reference: Array  # slip r at which the shear spring of each point is unstrained [m]
    normal: Array  # normal force N of each point on the block [N]
    shear: Array  # tangential force T of each point on the block [N]
    states: States  # state of each point
    slid: Array  # sum of what the reference of each point has moved while it was closed [m]
    totals: (
        Array  # time [s], the base's displacement [m, m] and work on the block [J], losses [J], started, undiscounted
    )

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Points that are closed."""
        closed: NDArray[np.bool_] = self.states != OPEN
        return closed


class Equations(NamedTuple):
    """The equations of a set of states, solved: (N, T) = inverse (constant - weight (free gaps, slips))."""

    states: States
    inverse: Array
    weight: Array
    constant: Array  # what cohesion adds


class Trial(NamedTuple):
    """Forces, gaps and slips of guessed states."""

    forces: Array  # N, then T, of the points [N]
    yielded: Array  # what the forces change of gaps, then slips [m]
    moved: Array  # gaps, then slips beyond the references at the start of the step [m]
    settled: bool  # whether the crossings belong to the forces
    equations: Equations  # of the last states whose points all were closed or stay open, for the next trial


Fallback = Callable[[Law, Trial, Array, Array, States, States], tuple[Trial, States, int, int]]


def march(
    blocks: tuple[Block, ...],
    laws: tuple[Law, ...],
    state: ContactState,
    base: Array,
    columns: NDArray[np.int64],
    energies: bool,
    losses: bool,
    table: Array,
    fallback: Fallback | None = None,
) -> tuple[ContactState, int, int, int]:
    """Make as many steps as the table has rows, while they have a contact and finite numbers.

    Parameters
    ----------
    blocks, laws, state
        The block and its contact in each stage of a step, and the state to begin with.
    base
        Displacement of the base at the ends of the stages, normal to it and along it [m], shape (steps, stages, 2).
    columns
        Numbers of the columns that are kept, in the order of `UNILATERAL_COLUMNS`.
    energies, losses
        Whether energies and losses are among them.
    table
        What is kept of each step (filled), shape (steps, columns).
    fallback
        What finds the contact of a stage whose iteration does not end, `fall_back`; the march ends there if None.

    Returns
    -------
    tuple
        State after the completed steps, their number, solutions of the contact in the last step, how it has ended.
    """
    solves = 0
    equations = equations_of(laws[0], state.states, np.ones(len(state.gap)))
    for n in range(len(table)):
        following, equations, solves, outcome = advance(blocks, laws, equations, state, base[n], losses, fallback)
        if outcome != CONVERGED:
            return state, n, solves, outcome
        row = observed(blocks[0], laws[0], following, energies, float(solves))
        for i in range(len(columns)):
            table[n, i] = row[columns[i]]
            if not np.isfinite(table[n, i]):
                return state, n, solves, OVERFLOW
        state = following
    return state, len(table), solves, CONVERGED


def advance(
    blocks: tuple[Block, ...],
    laws: tuple[Law, ...],
    equations: Equations,
    state: ContactState,
    base: Array,
    losses: bool,
    fallback: Fallback | None,
) -> tuple[ContactState, Equations, int, int]:
    """One step: the state at its end, equations for the next, number of solutions of the contact, how it has ended."""
    latest = state
    solves = 0
    for stage in range(len(blocks)):
        if len(blocks) > 1:
            # Those of the stage before are of another matrix.
            equations = equations_of(laws[stage], latest.states, np.ones(len(state.gap)))
        latest, equations, stage_solves, outcome = advance_stage(
            blocks[stage], laws[stage], equations, state, latest, base[stage], stage > 0, losses, fallback
        )
        solves += stage_solves
        if outcome != CONVERGED:
            return state, equations, solves, outcome
    return latest, equations, solves, CONVERGED


def advance_stage(
    block: Block,
    law: Law,
    equations: Equations,
    start: ContactState,
    state: ContactState,
    base: Array,
    is_later: bool,
    losses: bool,
    fallback: Fallback | None,
) -> tuple[ContactState, Equations, int, int]:
    """One stage from the `start` of the step, the stage before having ended in `state`; as `advance`."""
    D = start.D
    V = start.V
    A = start.A
    h = block.step
    am = block.am
    af = block.af
    compliance = block.beta / (1 - am) * h**2
    gg = 1.0 if start.totals[UNDISCOUNTED] > 0 else block.gg
    predicted = D + (gg * h * block.d_u) * V + (h**2 * block.e_0) * A
    if is_later:
        predicted = predicted + (h * block.d_g) * state.V + (h**2 * block.e_g) * state.A
    if am != 0:
        predicted = predicted - (compliance * am) * A
    strained = predicted
    if af != 0:
        strained = (1 - af) * predicted + af * D
    free_acceleration = block.inverse * (block.F - block.K * strained)
    if af != 0:
        free_acceleration = free_acceleration + block.response @ (af * forces_of(law, start))
    change = block.B @ (predicted - state.D + compliance * free_acceleration)
    if not np.isfinite(change).all():
        return state, equations, 0, OVERFLOW
    count = len(state.gap)
    free = np.empty(len(change))
    for i in range(count):
        change[i] -= base[0] - state.totals[BASE]
        free[i] = state.gap[i] + change[i]
    for i in range(len(change) - count):
        change[count + i] -= base[1] - state.totals[BASE + 1]
        free[count + i] = state.slip[i] - state.reference[i] + change[count + i]

    trial, states, solves, outcome = contact(law, equations, free, state.gap, state.states, fallback)
    if outcome != CONVERGED:
        return state, trial.equations, solves, outcome

    balanced = free_acceleration + block.response @ ((1 - af) * trial.forces)
    D1 = predicted + compliance * balanced
    A1 = balanced
    if am != 0:
        A1 = (balanced - am * A) / (1 - am)
    if law.implicit:
        thrown = block.impulse @ trial.forces
        A1 = A1 - thrown / (2 * block.beta)
        V1 = gg * V + h * (block.g_0 * A + block.gamma * A1 + thrown)
    else:
        V1 = gg * V + h * (block.g_0 * A + block.gamma * A1)
    if is_later:
        V1 = V1 + (h * block.g_g) * state.A
    totals = state.totals.copy()
    totals[UNDISCOUNTED] = 0.0
    if losses:
        discounted = 0.0 if is_later else (1 - gg**2) * (V @ (block.M * V)) / 2
        totals[LOSSES + 1] += discounted
        if block.has_closed_loss:
            add_block_losses(block, law, state, D1, A1, totals)
        else:
            add_balance_losses(block, law, state, trial.forces, D1, V1, A1, discounted, totals)
    following = moved_points(block, law, state, base, trial, change + trial.yielded, states, D1, V1, A1, totals)
    return following, trial.equations, solves, outcome


def forces_of(law: Law, state: ContactState) -> Array:
    """N, then T where there are shear springs, of the points [N]."""
    forces = np.empty(len(law.C))
    count = len(state.gap)
    for i in range(len(forces)):
        forces[i] = state.normal[i] if i < count else state.shear[i - count]
    return forces


def contact(
    law: Law, equations: Equations, free: Array, gap: Array, states: States, fallback: Fallback | None
) -> tuple[Trial, States, int, int]:
    """Contact of a step: all states are corrected at once until none changes.

    Parameters
    ----------
    law, equations
        The law, and equations that may serve again.
    free
        Gaps without forces at the end of the step, then slips without forces beyond the references [m].
    gap, states
        Gaps and states at the start of the step, shape (points,).
    fallback
        What follows where that does not end within `law.limit` solutions.

    Returns
    -------
    tuple
        Forces, gaps and slips; states; number of solutions; how it has ended.
    """
    trial = solution(law, equations, free, gap, states, states)
    guess = states
    for solves in range(1, law.limit + 1):
        following, wrong = corrected(law, trial, gap, states, guess)
        if trial.settled and wrong < 0:
            return trial, guess, solves, CONVERGED
        guess = following
        if solves < law.limit:
            trial = solution(law, trial.equations, free, gap, states, guess)
    if fallback is None:
        return trial, guess, law.limit, UNSETTLED
    return fallback(law, trial, free, gap, states, guess)


def fall_back(
    law: Law, trial: Trial, free: Array, gap: Array, states: States, guess: States
) -> tuple[Trial, States, int, int]:
    """Try all sets of states where shear springs hold few points, correct one after the other without or with many."""
    has_friction = law.tangent < np.inf
    choices = 4 if has_friction else 2
    if len(free) > len(gap):
        if float(choices) ** len(gap) <= ENUMERATED:
            return only_contact(law, trial, free, gap, states, choices)
        if not has_friction:
            return trial, guess, law.limit, NONE
    return singly(law, trial, free, gap, states, guess)


def singly(
    law: Law, trial: Trial, free: Array, gap: Array, states: States, guess: States
) -> tuple[Trial, States, int, int]:
    """Set the first state that is wrong until none is, from where all at once have led."""
    guess = guess.copy()
    has_friction = law.tangent < np.inf
    most = (SINGLY if has_friction else SINGLY_FRICTIONLESS) * len(gap)
    for changes in range(1, most + 1):
        trial = solution(law, trial.equations, free, gap, states, guess)
        following, wrong = corrected(law, trial, gap, states, guess)
        if wrong < 0:
            # Without friction this ends at the only contact, and counts as one solution.
            return trial, guess, law.limit + (changes if has_friction else 1), CONVERGED if trial.settled else NONE
        guess[wrong] = following[wrong]
    return trial, guess, law.limit + most, NONE


def only_contact(
    law: Law, trial: Trial, free: Array, gap: Array, states: States, choices: int
) -> tuple[Trial, States, int, int]:
    """Try all sets of states for the one whose forces, gaps and slips ask for it.

    Two sets with the same forces are one contact: a point without any force has several names for its state.
    """
    outcome = NONE
    first = trial
    names = states
    for number in range(choices ** len(gap)):
        guess = states.copy()
        rest = number
        for i in range(len(gap) - 1, -1, -1):
            guess[i] = STATES[rest % choices]
            rest = rest // choices
        trial = solution(law, trial.equations, free, gap, states, guess)
        if not trial.settled or corrected(law, trial, gap, states, guess)[1] >= 0:
            continue
        if outcome == NONE:
            outcome = CONVERGED
            first = trial
            names = guess
            continue
        size = max(largest(trial.forces), largest(first.forces))
        if largest(trial.forces - first.forces) > ALIKE * size:
            outcome = SEVERAL
    return first, names, law.limit + 1, outcome


def solution(law: Law, equations: Equations, free: Array, gap: Array, states: States, guess: States) -> Trial:
    """Forces, gaps and slips for guessed states, with the crossings that belong to them: phi = phi(forces(phi))."""
    phi = np.ones(len(gap))
    closing = False
    if len(free) > len(gap):
        for i in range(len(gap)):
            if guess[i] == STICK and states[i] == OPEN:
                phi[i] = 0.5
                closing = True
    if not closing:
        if (equations.states != guess).any():
            equations = equations_of(law, guess, phi)
        forces = equations.inverse @ (equations.constant - equations.weight * free)
        yielded = law.C @ forces
        return Trial(forces, yielded, free + yielded, True, equations)

    part = 1.0
    last = np.inf
    size = np.inf
    forces = np.zeros(len(free))
    for _ in range(PASSES):
        now = equations_of(law, guess, phi)
        forces = now.inverse @ (now.constant - now.weight * free)
        change = np.zeros(len(gap))
        for i in range(len(gap)):
            if guess[i] == STICK and states[i] == OPEN:
                change[i] = crossed(forces[i], gap[i], law.compliance[i]) - phi[i]
        size = largest(change)
        if size <= SETTLED:
            break
        # A crossing that is passed to and fro is approached by smaller corrections.
        if size >= last:
            part = part / 2
        last = size
        phi = phi + part * change
    yielded = law.C @ forces
    return Trial(forces, yielded, free + yielded, size <= SETTLED, equations)


def equations_of(law: Law, states: States, phi: Array) -> Equations:
    """Return the equations of given states, solved.

    N / k + w = 0 of closed points, T + k_t phi s = 0 of those that stick, T + d tan(angle) N = -d c of those that
    slide, N = T = 0 of open ones. Divided by its size each row is as good as any other for the pivots; phi may be zero.
    """
    count = len(states)
    size = len(law.C)
    closed = np.zeros(size)
    weight = np.zeros(size)
    constant = np.zeros(size)
    diagonal = np.ones(size)
    for i in range(size):
        point = i % count
        if states[point] == OPEN:
            continue
        stiffness = 1.0
        diagonal_term = law.compliance[point]
        if i >= count:
            stiffness = 0.0 if abs(states[point]) == SLIP else law.shear_stiffness[point] * phi[point]
            diagonal_term = 1.0
        largest_term = diagonal_term + stiffness * law.C[i, i]
        closed[i] = 1.0
        weight[i] = stiffness / largest_term
        diagonal[i] = diagonal_term / largest_term
    matrix = weight.reshape((size, 1)) * law.C * closed
    for i in range(size):
        matrix[i, i] += diagonal[i]
        point = i % count
        if i >= count and abs(states[point]) == SLIP:
            direction = 1.0 if states[point] > 0 else -1.0
            matrix[i, point] += direction * law.tangent
            constant[i] = -direction * law.cohesion[point]
    try:
        inverse = np.ascontiguousarray(np.linalg.inv(matrix))
    except Exception:  # the only clause that numba compiles: a singular matrix, whose states nothing then asks for
        inverse = np.full((size, size), np.nan)
    return Equations(states.copy(), inverse, weight, constant)


def corrected(law: Law, trial: Trial, gap: Array, states: States, guess: States) -> tuple[States, int]:
    """States that the forces, gaps and slips of guessed states ask for, and the first point that differs, or -1."""
    wrong = -1
    following = guess.copy()
    for i in range(len(gap) - 1, -1, -1):
        is_closed = trial.forces[i] >= 0 if guess[i] != OPEN else trial.moved[i] < 0
        if not is_closed:
            following[i] = OPEN
        elif law.tangent == np.inf:
            following[i] = STICK
        else:
            following[i] = closed_state(law, trial, i, gap[i], states[i] != OPEN, guess[i])
        if following[i] != guess[i]:
            wrong = i
    return following, wrong


def closed_state(law: Law, trial: Trial, i: int, gap: float, was_closed: bool, guess: int) -> int:
    """State of a closed point under friction: what slides on against its friction keeps its direction.

    What would turn round is held first, as it may rest.
    """
    tangential = len(law.compliance) + i
    normal = trial.forces[i] if guess != OPEN else max(-trial.moved[i], 0.0) / law.compliance[i]
    holding = trial.forces[tangential]
    if guess != STICK:
        phi = 1.0 if was_closed else crossed(normal, gap, law.compliance[i])
        holding = -law.shear_stiffness[i] * phi * trial.moved[tangential]
    bound = law.tangent * max(normal, 0.0) + law.cohesion[i]
    if abs(guess) == SLIP:
        direction = 1 if guess > 0 else -1
        return SLIP * direction if -direction * holding >= (1 - ROUNDED) * bound else STICK
    if abs(holding) > bound:
        return -SLIP if holding > 0 else SLIP
    return STICK


def crossed(normal: float, gap: float, compliance: float) -> float:
    """Share phi of the step for which a point has been closed that began at a gap."""
    depth = max(normal, 0.0) * compliance
    distance = depth + max(gap, 0.0)
    return depth / distance if distance > 0 else 1.0


def largest(values: Array) -> float:
    """Greatest absolute value."""
    size = 0.0
    for value in values:
        size = max(size, abs(value))
    return size


def moved_points(
    block: Block,
    law: Law,
    state: ContactState,
    base: Array,
    trial: Trial,
    change: Array,
    states: States,
    D1: Array,
    V1: Array,
    A1: Array,
    totals: Array,
) -> ContactState:
    r"""State at the end of a step, with the energies that its points lose and get added to `totals`.

    With d( ) the change over the stage, U the energy of a point's springs and forces weighted by delta (1/2 where the
    scheme is not Newmark's, 1 at the end of a step for implicit contact), a point loses
    -dU - dw [(1 - delta) N0 + delta N1] - ds [(1 - delta) T0 + delta T1]. -T1 dr of one that slides, whose reference
    moves by dr against T1, is the loss by friction. What a point loses beside it while it stays closed belongs to the
    scheme's own loss, what it loses while it opens or closes is the loss by switching.
    """
    count = len(state.gap)
    has_shear = len(trial.forces) > count
    late = block.end_weight
    gaps = np.empty(count)
    slips = np.zeros(count)
    references = np.zeros(count)
    normals = np.empty(count)
    shears = np.zeros(count)
    sums = np.zeros(count)
    for i in range(count):
        k_t = law.shear_stiffness[i]
        was_closed = state.states[i] != OPEN
        is_closed = states[i] != OPEN
        N = trial.forces[i]
        T = 0.0
        # A pressed spring's gap from its force keeps the digits that the difference of displacements has not.
        gap = -N * law.compliance[i] if is_closed else trial.moved[i]
        slip = 0.0
        slid = state.slid[i]
        if has_shear:
            T = trial.forces[count + i]
            slip = state.slip[i] + change[count + i]
            reference = slip
            if is_closed:
                strained = slip + T / k_t if k_t > 0 else slip
                reference = state.reference[i] if was_closed else strained
                if abs(states[i]) == SLIP:
                    reference = strained
                    # It has slid from its reference, or from where it closed.
                    begun = state.reference[i]
                    if not was_closed:
                        share = crossed(N, state.gap[i], law.compliance[i])
                        begun = state.slip[i] + (slip - state.slip[i]) * (1 - share)
                    onward = reference - begun
                    if onward * states[i] > 0:
                        slid += onward
            references[i] = reference
        mean_normal = (1 - late) * state.normal[i] + late * N
        mean_shear = (1 - late) * state.shear[i] + late * T
        friction = -T * (slid - state.slid[i])
        stored = (state.normal[i] ** 2 - N**2) * law.compliance[i] / 2
        if k_t > 0:
            stored += (state.shear[i] ** 2 - T**2) / k_t / 2
        lost = stored - (gap - state.gap[i]) * mean_normal - (slip - state.slip[i]) * mean_shear - friction
        totals[LOSSES if was_closed == is_closed else LOSSES + 2] += lost
        totals[LOSSES + 3] += friction
        totals[INPUT] += (base[0] - state.totals[BASE]) * mean_normal + (base[1] - state.totals[BASE + 1]) * mean_shear
        gaps[i] = gap
        slips[i] = slip
        normals[i] = N
        shears[i] = T
        sums[i] = slid
    totals[BASE] = base[0]
    totals[BASE + 1] = base[1]
    totals[TIME] += block.step * block.duration
    return ContactState(D1, V1, A1, gaps, slips, references, normals, shears, states, sums, totals)


def add_block_losses(block: Block, law: Law, state: ContactState, D1: Array, A1: Array, totals: Array) -> None:
    r"""Add the loss of Newmark's scheme in the block itself.

    With M A = F - K D + B' lambda at both ends of a step of length h, V0 the velocity after gg, c = alpha - delta/2 and
    d( ) the change over the step, the sum E of the energies of motion, strain, springs (U of each point) and loads
    obeys

        dE = - (delta - 1/2) dD' K dD - c h^2 [d(A' M A) / 2 + (delta - 1/2) dA' M dA]
             + sum over the points of dU + dw [(1 - delta) N0 + delta N1] + ds [(1 - delta) T0 + delta T1]

    A start with A0 = 0 is out of balance by F0 = F - K D0 + B' lambda0, which adds -(1 - delta) dD' F0 to the first
    step. With implicit contact N1 and T1 count alone.
    """
    c = block.beta - block.gamma / 2
    over = block.gamma - 0.5
    dD = D1 - state.D
    loss = over * (dD @ (block.K * dD))
    if totals[STARTED] == 0:
        # The points bear no forces at t = 0, and the block no strain.
        loss += (1 - block.gamma) * (dD @ (block.F - block.M * state.A))
        totals[STARTED] = 1
    if c != 0:
        dA = A1 - state.A
        stored = (A1 @ (block.M * A1) - state.A @ (block.M * state.A)) / 2
        loss += c * block.step**2 * (stored + over * (dA @ (block.M * dA)))
    totals[LOSSES] += loss


def add_balance_losses(
    block: Block,
    law: Law,
    state: ContactState,
    forces: Array,
    D1: Array,
    V1: Array,
    A1: Array,
    discounted: float,
    totals: Array,
) -> None:
    """Add what a stage takes of the energies of motion, strain and loads beside gg and the work of the points' forces.

    These forces are weighted as in `moved_points`.
    """
    dD = D1 - state.D
    V0 = state.V + block.stagger * state.A
    V_end = V1 + block.stagger * A1
    kinetic = (V_end @ (block.M * V_end) - V0 @ (block.M * V0)) / 2
    strain = (D1 @ (block.K * D1) - state.D @ (block.K * state.D)) / 2
    weight = block.end_weight
    mean = (1 - weight) * forces_of(law, state) + weight * forces
    work = (block.B @ dD) @ mean
    totals[LOSSES] += block.F @ dD + work - kinetic - strain - discounted


def observed(block: Block, law: Law, state: ContactState, energies: bool, solves: float) -> Array:
    """All columns of a step, in the order of `UNILATERAL_COLUMNS`; energies are zero where they are not asked for."""
    D = state.D
    V = state.V
    if block.stagger != 0:
        V = V + block.stagger * state.A
    motion = block.rows @ D
    row = np.zeros(len(UNILATERAL_COLUMNS))
    row[0] = motion[0]
    row[2] = motion[1]
    row[3] = motion[2]
    row[4] = block.momentum @ V
    for i in range(len(state.gap)):
        row[1] += state.normal[i] / law.length
        row[5] += state.shear[i] / law.length
        row[6] += law.share[i] if state.gap[i] > 0 else 0.0
        row[7] = max(row[7], state.gap[i])
        row[8] = max(row[8], -state.gap[i])
        row[9] = max(row[9], abs(state.slid[i]))
        row[12] += state.normal[i] ** 2 * law.compliance[i] / 2
        if law.shear_stiffness[i] > 0:
            row[12] += state.shear[i] ** 2 / law.shear_stiffness[i] / 2
    if energies:
        row[10] = V @ (block.M * V) / 2
        row[11] = D @ (block.K * D) / 2
        row[13] = -(block.F @ D) - state.totals[INPUT]
    for i in range(4):
        row[14 + i] = state.totals[LOSSES + i]
    row[18] = solves
    return row
