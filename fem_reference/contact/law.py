r"""Contact by rows: what each row obeys, the forces of given states, and the states that forces ask for.

A row has a force N and a relative displacement y of the two sides, which the forces change by the flexibility W of the
bodies; c = 1 / k is the compliance of its spring. Beyond what its spring gives way it opens or slips by

    z = q + (W + c) N,       q the relative displacement without forces, beyond the reference of its spring,

which is zero while N is inside of its bounds; at the lower bound z >= 0, at the upper z <= 0.

=============== ==================================== ==============================================================
law             bounds                               at a bound
=============== ==================================== ==============================================================
unilateral      0, infinity                          opens: y is its gap, and the spring has its length again
bonded          -infinity, infinity                  never
strength        -s, s                                slips by z, which the reference takes along
Coulomb         -+ (tan(angle) N_p + c_p)            slips by z; N_p and cohesion c_p of the row that presses it
=============== ==================================== ==============================================================

**Friction of a point that closes.** A row with a partner that opens bears nothing while the partner is open: its
reference follows it. Where the partner closes within a step, from a gap w0 >= 0 to w1 < 0, the reference is the
displacement at the crossing, r = y0 + (y1 - y0) w0 / (w0 - w1), which stores no energy while open and loses no slip of
the step. Hence its spring counts with the share phi of the step in which it was closed,

    z = phi q + (phi W + c) N,      phi = w1 / (w1 - w0), one where the partner was closed.

For any phi from 0 to 1 the spring gains no more energy than a step of delta = 1 puts into it.

These functions run as they stand, or compiled by numba (`fem_reference.contact.compilation`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.problem import Array, Flags, Indices

States = NDArray[np.int8]
AT_LOWER = -1
INSIDE = 0
AT_UPPER = 1
"""States of a row: at its lower bound, as one that is open; inside of its bounds, as one that holds; at its upper.

A row whose partner is open is inside."""
PASSES = 60
"""Most corrections of the crossings for given states."""
SETTLED = 1e-13
"""Change of phi at which the crossings are settled [-]."""
ROUNDED = 1e-12
"""Share of the friction by which a row that slips may miss it."""


class Law(NamedTuple):
    """All rows, in one stage of one length of step; every array but W has the shape (rows,)."""

    W: Array  # relative displacements of unit forces [m/N], shape (rows, rows)
    compliance: Array  # 1 / k of the spring [m/N]
    lower: Array  # bounds of the force but for friction [N]
    upper: Array
    friction: Array  # tan(angle) that the force of the partner counts in the bounds [-]
    partner: Indices  # row before it that presses it; its own number where there is none
    slips: Flags  # whether it slips at its bounds, and does not open
    limit: int  # most solutions of the open-close iteration [-]
    single_limit: int  # then changes of one point after the other [-]


class Equations(NamedTuple):
    """The equations of a set of states, solved: N = inverse (constant - weight q)."""

    states: States
    inverse: Array
    weight: Array
    constant: Array  # bounds of those at them


class Trial(NamedTuple):
    """Forces and relative displacements of guessed states."""

    force: Array  # N [N]
    place: Array  # q + W N [m]
    settled: bool  # whether the crossings belong to the forces
    equations: Equations  # of the last states in which no row crossed, for the next trial


def is_pressed(law: Law, states: States, row: int) -> bool:
    """Whether a row has no partner, or one that is closed."""
    partner = law.partner[row]
    return bool(partner == row or states[partner] == INSIDE)


def equations_of(law: Law, states: States, phi: Array) -> Equations:
    """The equations of given states, solved.

    phi q + (phi W + c) N = 0 of rows inside, N = bound + tan(angle) N_p of those at a bound, N = 0 of those whose
    partner is open. Divided by its size each row is as good as any other for the pivots; phi and c may be zero.
    """
    count = len(states)
    weight = np.zeros(count)
    constant = np.zeros(count)
    known = np.zeros(count)  # forces that depend on no other one
    unknown = np.ones(count)
    for row in range(count):
        if states[row] == INSIDE and is_pressed(law, states, row):
            continue
        if is_pressed(law, states, row):
            constant[row] = law.upper[row] if states[row] > 0 else law.lower[row]
        if law.friction[row] == 0 or not is_pressed(law, states, row):
            known[row] = constant[row]
            unknown[row] = 0.0
    matrix = np.eye(count)
    for row in range(count):
        if not is_pressed(law, states, row):
            continue
        if states[row] != INSIDE:
            if law.friction[row] != 0:
                matrix[row, law.partner[row]] -= states[row] * law.friction[row]
            continue
        size = law.compliance[row] + phi[row] * law.W[row, row]
        if size > 0:
            weight[row] = phi[row] / size
            matrix[row] = weight[row] * law.W[row] * unknown
            matrix[row, row] += law.compliance[row] / size
            constant[row] = -weight[row] * (law.W[row] @ known)
    try:
        inverse = np.ascontiguousarray(np.linalg.inv(matrix))
    except Exception:  # the only clause that numba compiles: a singular matrix, whose states nothing then asks for
        inverse = np.full((count, count), np.nan)
    return Equations(states.copy(), inverse, weight, constant)


def crossed(force: float, gap: float, compliance: float) -> float:
    """Share phi of the step for which a row has been closed that began at a gap."""
    depth = max(force, 0.0) * compliance
    distance = depth + max(gap, 0.0)
    return depth / distance if distance > 0 else 1.0


def solution(law: Law, equations: Equations, q: Array, gap: Array, states: States, guess: States) -> Trial:
    """Forces and places for guessed states, with the crossings that belong to them: phi = phi(forces(phi)).

    `q` are the relative displacements without forces, beyond the references, `gap` those at the start of the step [m],
    with their `states`; `equations` serve again if they are those of the guess.
    """
    count = len(q)
    phi = np.ones(count)
    closing = False
    for row in range(count):
        if law.slips[row] and guess[row] == INSIDE and is_pressed(law, guess, row) and not is_pressed(law, states, row):
            phi[row] = 0.5
            closing = True
    if not closing:
        if (equations.states != guess).any():
            equations = equations_of(law, guess, phi)
        force = equations.inverse @ (equations.constant - equations.weight * q)
        return Trial(force, q + law.W @ force, True, equations)

    part = 1.0
    last = np.inf
    size = np.inf
    force = np.zeros(count)
    crosses = phi < 1
    for _ in range(PASSES):
        now = equations_of(law, guess, phi)
        force = now.inverse @ (now.constant - now.weight * q)
        change = np.zeros(count)
        for row in range(count):
            if crosses[row]:
                partner = law.partner[row]
                change[row] = crossed(force[partner], gap[partner], law.compliance[partner]) - phi[row]
        size = np.abs(change).max()
        if size <= SETTLED:
            break
        # A crossing that is passed to and fro is approached by smaller corrections.
        if size >= last:
            part = part / 2
        last = size
        phi = phi + part * change
    return Trial(force, q + law.W @ force, bool(size <= SETTLED), equations)


def agreed(law: Law, trial: Trial, gap: Array, states: States, guess: States) -> tuple[States, int]:
    """States that the forces and places of guessed states ask for, and the first point that differs, or -1.

    A point is a row without partner and the rows that it presses.
    """
    wrong = -1
    following = guess.copy()
    for row in range(len(guess)):
        following[row] = agreed_state(law, trial, gap, states, guess, following, row)
        if following[row] != guess[row] and (wrong < 0 or law.partner[row] < wrong):
            wrong = law.partner[row]
    return following, wrong


def agreed_state(law: Law, trial: Trial, gap: Array, states: States, guess: States, following: States, row: int) -> int:
    """State that a row asks for, those of the rows before it being known.

    What slips on against its friction keeps its direction; what would turn round is held first, as it may rest. At a
    strength it does what it would do if its row were alone.
    """
    force = trial.force[row]
    place = trial.place[row]
    compliance = law.compliance[row]
    if not law.slips[row]:
        closed = force >= law.lower[row] if guess[row] == INSIDE else place < 0
        return INSIDE if closed else AT_LOWER
    if not is_pressed(law, following, row):
        return INSIDE
    friction = 0.0
    phi = 1.0
    holding = force
    partner = law.partner[row]
    if partner != row:
        pressing = trial.force[partner]
        if guess[partner] != INSIDE:
            pressing = max(-trial.place[partner], 0.0) / law.compliance[partner]
        friction = law.friction[row] * max(pressing, 0.0)
        if states[partner] != INSIDE:
            phi = crossed(pressing, gap[partner], law.compliance[partner])
        if guess[partner] != INSIDE:
            holding = -phi * place / compliance
    if guess[row] != INSIDE:
        beyond = phi * place + compliance * force
        if guess[row] * beyond <= ROUNDED * compliance * abs(force):
            return int(guess[row])
        if partner != row:
            return INSIDE
        holding = force - beyond / (compliance + law.W[row, row])
    if holding > law.upper[row] + friction:
        return AT_UPPER
    return AT_LOWER if holding < law.lower[row] - friction else INSIDE
