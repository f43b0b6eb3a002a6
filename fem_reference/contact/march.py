r"""Steps of bodies on their contacts, of any scheme: free motion of a stage, its contact, its end; and the energies.

With the stages of `fem_reference.scheme.stage`, the rows B of the relative displacements and the mean forces
(1 - af) N + af N0 of both ends of a step, a stage is that of the free bodies, and

    q = y + B (dD - dDg) - (motion of the ground),      W = beta' h^2 B S^-1 B',      dD1 = dD + b h^2 S^-1 B' N,

without a division by beta h^2; where the scheme is explicit W is zero. Nothing depends on the contact states but the
small problem of the forces. The relative displacement y of a row that is pressed is -c N, which keeps the digits that
the difference of displacements has not. With implicit contact (Kane, Repetto, Ortiz and Marsden, 1999) A is the bodies'
own, M A1 = F - K D1, under average acceleration, and the forces of the step's end throw them besides, D by dt^2 / 2 and
V by dt times Q = M^-1 B' N::

    D1 = D* + alpha dt^2 (A1 + Q / (2 alpha)),   V1 = gg V + dt ((1 - delta) A + delta A1) + dt Q

**Energies.** With d( ) the change over a stage, U the energy of a row's spring and forces weighted by delta (1/2 where
the scheme is not Newmark's, 1 at the end of a step for implicit contact), a row loses

    -dU - dy [(1 - delta) N0 + delta N1]

of which -N1 ds, where it slips by ds against its force, is the loss by friction. What it loses beside it while its
point stays closed belongs to the scheme's own loss, what it loses while that opens or closes is the loss by switching.
Where M A = F - K D + B' N at both ends of a step of length h, V0 the velocity after gg and c = alpha - delta/2,
Newmark's scheme takes

    (delta - 1/2) dD' K dD + c h^2 [d(A' M A) / 2 + (delta - 1/2) dA' M dA]

of the bodies themselves. A start with A0 = 0 is out of balance by F0 = F - K D0 + B' N0, which adds (1 - delta) dD' F0
to the first step. Of another scheme the loss is what the energies leave.

These functions run as they stand, or compiled by numba (`fem_reference.contact.compilation`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fem_reference.contact.iteration import CONVERGED, OVERFLOW, Fallback, find_contact
from fem_reference.contact.law import INSIDE, Equations, Law, States, Trial, crossed, equations_of, is_pressed
from fem_reference.problem.problem import Array
from fem_reference.problem.stages import Stage
from fem_reference.scheme.stage import (
    Body,
    Motion,
    end_of_stage,
    free_acceleration,
    mean_load,
    predicted_change,
    velocity_at_end,
)

ALGORITHMIC = 0
DISCOUNT = 1
SWITCHING = 2
FRICTION = 3
GROUND = 4
SUMS = 5
"""Where `ContactState.sums` has what the scheme, gg, switching and friction have taken from t = 0 on, and the work of
the ground on the bodies [J]; how many they are."""


class ContactStage(NamedTuple):
    """The bodies on their contacts in one stage of one length of step; operators know products with vectors.

    B, F, pushes and ground are those of `fem_reference.contact.system.ContactSystem`.
    """

    stage: Stage
    body: Body
    law: Law
    B: Any
    response: Any  # S^-1 B', over 2 alpha for implicit contact, shape (unknowns, rows)
    impulse: Any  # M^-1 B' for implicit contact, else anything
    F: Array
    pushes: Any
    ground: Array
    h: float  # length of step [s]
    gg: float  # factor on the velocity for it [-]
    ratio: float  # it over the scheme's own [-]
    duration: float  # of the stage, over the step [-]
    stagger: float  # time from that of the velocity to the end of the step [s]
    end_weight: float  # of the forces at the end of the stage in the energy that rows lose [-]
    is_implicit: bool  # whether contact is
    is_newmark: bool  # whether the scheme's own loss has Newmark's closed form


class ContactState(NamedTuple):
    """Motion and contact at the end of a step."""

    D: Array  # displacement of the unknowns [m]
    V: Array  # velocity [m/s]
    A: Array  # acceleration [m/s2]
    place: Array  # relative displacement of each row beyond its reference [m], of one that opens its gap, (rows,)
    force: Array  # N [N]
    states: States
    slid: Array  # sum of what its reference has moved while it bore a force [m]
    parts: Array  # what is prescribed, shape (parts,)
    sums: Array  # energies lost and the ground's work [J], shape (SUMS,)
    position: float  # number of steps from t = 0
    is_undiscounted: bool  # whether gg does not act on V: the first half step of a staggered scheme
    is_out_of_balance: bool  # whether A0 = 0 is not that of the loads: before the first step


class Record(NamedTuple):
    """What is kept of steps, one row each."""

    displacements: Array  # of the observing rows on D, shape (steps, columns)
    velocities: Array  # of those on V at the end of the step
    accelerations: Array  # of those on A
    place: Array  # of `ContactState`, shape (steps, rows)
    force: Array
    slid: Array
    states: States
    stored: Array  # kinetic energy, strain energy and work of the constant load [J], shape (steps, 3)
    sums: Array  # shape (steps, SUMS)
    solves: Array  # solutions of the open-close iteration [-], shape (steps,)
    cuts: Array  # of the step, shape (steps,); no march cuts


def part_of(record: Record, steps: slice) -> Record:
    """What is kept of some of the steps, to be filled or read."""
    return Record._make(kept[steps] for kept in record)


class Watch(NamedTuple):
    """Rows that observe the bodies, and whether the energies are wanted."""

    D: Array  # shape (columns, unknowns)
    V: Array
    A: Array
    energies: bool
    losses: bool


def march(
    stages: tuple[ContactStage, ...],
    watch: Watch,
    state: ContactState,
    prescribed: Array,
    record: Record,
    fallback: Fallback | None = None,
) -> tuple[ContactState, int, int, int]:
    """Make as many steps as the record has rows, and fill it, while they have a contact and finite numbers.

    Returns the state after the completed steps, their number, the solutions of the last step, and how it has ended.

    Parameters
    ----------
    prescribed
        What is prescribed at the ends of the stages, shape (steps, stages, parts).
    fallback
        What finds the contact of a stage whose iteration does not end, `fall_back`; the march ends there if None.
    """
    solves = 0
    equations = equations_of(stages[0].law, state.states, np.ones(len(state.force)))
    for n in range(len(record.solves)):
        following, equations, solves, outcome = advance(stages, equations, state, prescribed[n], watch.losses, fallback)
        if outcome != CONVERGED:
            return state, n, solves, outcome
        if not keep(stages[0], watch, following, record, n):
            return state, n, solves, OVERFLOW
        record.solves[n] = solves
        state = following
    return state, len(record.solves), solves, CONVERGED


def advance(
    stages: tuple[ContactStage, ...],
    equations: Equations,
    state: ContactState,
    prescribed: Array,
    losses: bool,
    fallback: Fallback | None,
) -> tuple[ContactState, Equations, int, int]:
    """One step: the state at its end, equations for the next, number of solutions of the contact, how it has ended."""
    latest = state
    solves = 0
    for number in range(len(stages)):
        if len(stages) > 1:
            # Those of the stage before are of another matrix.
            equations = equations_of(stages[number].law, latest.states, np.ones(len(state.force)))
        latest, equations, stage_solves, outcome = advance_stage(
            stages[number], equations, state, latest, prescribed[number], losses, fallback
        )
        solves += stage_solves
        if outcome != CONVERGED:
            return state, equations, solves, outcome
    return latest, equations, solves, CONVERGED


def advance_stage(
    now: ContactStage,
    equations: Equations,
    start: ContactState,
    latest: ContactState,
    parts: Array,
    losses: bool,
    fallback: Fallback | None,
) -> tuple[ContactState, Equations, int, int]:
    """One stage from the `start` of the step, the stage before having ended in the `latest` state; as `advance`."""
    stage = now.stage
    gg = 1.0 if start.is_undiscounted else now.gg
    origin = Motion(start.D, start.V, start.A)
    before = Motion(latest.D, latest.V, latest.A)
    F = load(now.F, now.pushes, mean_load(stage, start.parts, parts))
    predicted = predicted_change(stage, now.h, gg, origin, before)
    e = free_acceleration(stage, now.h, gg, now.body, origin, before, predicted, F)
    if stage.af != 0:
        e = e + stage.af * (now.response @ start.force)
    change = predicted + (stage.beta / (1 - stage.am) * now.h**2) * e
    if latest.position != start.position:
        change = change - (latest.D - start.D)
    moved = now.B @ change - ground_motion(now.ground, parts - latest.parts)
    if not np.isfinite(moved.sum()):
        return latest, equations, 0, OVERFLOW

    trial, states, solves, outcome = find_contact(
        now.law, equations, latest.place + moved, latest.place, latest.states, fallback
    )
    if outcome != CONVERGED:
        return latest, trial.equations, solves, outcome
    e = e + (1 - stage.af) * (now.response @ trial.force)
    end = end_of_stage(stage, now.h, gg, origin, before, predicted, e, start.D)
    if now.is_implicit:
        end = thrown(now, gg, origin, before, end, trial.force)
    sums = latest.sums.copy() if losses else latest.sums
    following = moved_rows(now, latest, trial, states, parts, end, sums)
    if losses:
        add_losses(now, start, latest, following, trial, gg)
    return following, trial.equations, solves, outcome


def load(F: Array, pushes: Any, parts: Array) -> Array:
    """Loads under what is prescribed; where that moves the ground alone `pushes` has no columns."""
    return F + pushes @ parts if pushes.shape[1] > 0 else F


def ground_motion(ground: Array, change: Array) -> Array:
    """Displacement of the ground of each row for a change of what is prescribed."""
    moved = np.zeros(len(ground))
    for part in range(len(change)):
        if change[part] != 0:
            moved = moved + change[part] * ground[:, part]
    return moved


def thrown(now: ContactStage, gg: float, start: Motion, before: Motion, end: Motion, force: Array) -> Motion:
    """The end of a step of implicit contact: the bodies' own acceleration, and what the forces throw."""
    Q = now.impulse @ force
    A = end.A - Q / (2 * now.stage.beta)
    return Motion(end.D, velocity_at_end(now.stage, now.h, gg, start, before, A) + now.h * Q, A)


def moved_rows(
    now: ContactStage,
    state: ContactState,
    trial: Trial,
    states: States,
    parts: Array,
    end: Motion,
    sums: Array,
) -> ContactState:
    """State at the end of a stage; its sums of energies are those of the stage before."""
    law = now.law
    force = trial.force
    count = len(force)
    place = np.empty(count)
    slid = state.slid.copy()
    for row in range(count):
        if states[row] != INSIDE and not law.slips[row]:
            place[row] = trial.place[row]
            continue
        place[row] = -force[row] * law.compliance[row]
        if states[row] != INSIDE and is_pressed(law, states, row):
            phi = 1.0
            partner = law.partner[row]
            if not is_pressed(law, state.states, row):
                # It has slipped from where its partner closed.
                phi = crossed(force[partner], state.place[partner], law.compliance[partner])
            slip = phi * trial.place[row] + law.compliance[row] * force[row]
            if slip * states[row] < 0:
                slid[row] += slip
    position = state.position + now.ratio * now.duration
    return ContactState(end.D, end.V, end.A, place, force, states, slid, parts, sums, position, False, False)


def add_losses(
    now: ContactStage, start: ContactState, state: ContactState, end: ContactState, trial: Trial, gg: float
) -> None:
    """Add what a stage from `state` to `end` loses to the sums of `end`."""
    law = now.law
    late = now.end_weight
    sums = end.sums
    mean = (1 - late) * state.force + late * end.force
    for row in range(len(mean)):
        partner = law.partner[row]
        stays = law.slips[partner] or (state.states[partner] == INSIDE) == (end.states[partner] == INSIDE)
        moved = (trial.place[row] if law.slips[row] else end.place[row]) - state.place[row]
        friction = -end.force[row] * (end.slid[row] - state.slid[row])
        lost = law.compliance[row] * (state.force[row] ** 2 - end.force[row] ** 2) / 2 - moved * mean[row] - friction
        sums[ALGORITHMIC if stays else SWITCHING] += lost
        sums[FRICTION] += friction
    sums[GROUND] += ground_motion(now.ground, end.parts - state.parts) @ mean
    discounted = 0.0
    if state.position == start.position:
        discounted = (1 - gg**2) * (start.V @ (now.body.M * start.V)) / 2
    sums[DISCOUNT] += discounted
    if now.is_newmark:
        sums[ALGORITHMIC] += newmark_loss(now, state, end)
    else:
        sums[ALGORITHMIC] += balance_loss(now, state, end, mean) - discounted


def newmark_loss(now: ContactStage, state: ContactState, end: ContactState) -> float:
    """Loss of Newmark's scheme in the bodies themselves."""
    body = now.body
    c = now.stage.beta - now.stage.gamma / 2
    over = now.stage.gamma - 0.5
    dD = end.D - state.D
    loss = over * (dD @ (body.K * dD))
    if state.is_out_of_balance:
        # The rows bear no forces at t = 0, and the bodies no strain.
        loss += (1 - now.stage.gamma) * (dD @ (now.F - body.M * state.A))
    if c != 0:  # a saving of two products: the term is zero where c is
        dA = end.A - state.A
        stored = (end.A @ (body.M * end.A) - state.A @ (body.M * state.A)) / 2
        loss += c * now.h**2 * (stored + over * (dA @ (body.M * dA)))
    return float(loss)


def balance_loss(now: ContactStage, state: ContactState, end: ContactState, mean: Array) -> float:
    """What a stage takes of the energies of motion, strain and loads beside the work of the rows' mean forces."""
    body = now.body
    dD = end.D - state.D
    V0 = state.V + now.stagger * state.A
    V1 = end.V + now.stagger * end.A
    kinetic = (V1 @ (body.M * V1) - V0 @ (body.M * V0)) / 2
    strain = (end.D @ (body.K * end.D) - state.D @ (body.K * state.D)) / 2
    return float(now.F @ dD + (now.B @ dD) @ mean - kinetic - strain)


def keep(now: ContactStage, watch: Watch, state: ContactState, record: Record, n: int) -> bool:
    """Write a step into the record; tell whether all of its numbers are finite."""
    V = state.V
    if now.stagger != 0:
        V = V + now.stagger * state.A
    displacements = watch.D @ state.D
    velocities = watch.V @ V
    total = displacements.sum() + velocities.sum() + state.force.sum() + state.place.sum()
    record.displacements[n] = displacements
    record.velocities[n] = velocities
    if len(watch.A) > 0:
        record.accelerations[n] = watch.A @ state.A
        total += record.accelerations[n].sum()
    record.place[n] = state.place
    record.force[n] = state.force
    record.slid[n] = state.slid
    record.states[n] = state.states
    if watch.energies:
        record.stored[n, 0] = V @ (now.body.M * V) / 2
        record.stored[n, 1] = state.D @ (now.body.K * state.D) / 2
        record.stored[n, 2] = now.F @ state.D
        total += record.stored[n].sum()
    if watch.losses:
        record.sums[n] = state.sums
        total += state.sums.sum()
    return bool(np.isfinite(total))
