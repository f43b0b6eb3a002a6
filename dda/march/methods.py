r"""Other ways to find the contacts of a step: forces that keep the energy, passes of the augmented Lagrangian, impacts.

Each is a function for `dda.march.step.stage_with`, or a stage of its own. They are frictionless.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dda.contact.conserving import conserving
from dda.contact.dense import Vector, copy
from dda.contact.rows import FOUND, INSIDE, LOWER, UNREACHED, Flexibility, Laws, Rows, Solved, find, flexed
from dda.march.account import account, add_bulk_loss, add_damping, half_square
from dda.march.energy import ALGORITHMIC, CONTACT, GIVEN, IMPULSE
from dda.march.step import (
    Course,
    March,
    Part,
    StageRoom,
    State,
    keep_modes,
    length_of,
    move_rows,
    prescribe,
    push_modes,
    stage_with,
    steps_by,
    write_loads,
)

FAR = 1e300  # m/s, of a contact that no impulse reaches


class Method(NamedTuple):
    """The numbers of a rule of contact."""

    springs: Laws  # of the passes of the augmented Lagrangian
    penetration: float  # to which they reduce it [m]
    pass_limit: int  # of them in a step
    restitution: float  # of impacts [-]


def at_end(march: March, before: Rows, flexible: Flexibility, after: Rows) -> Solved:
    """Find the contacts whose law holds at the end of the step."""
    outcome, solves = find(march.laws, before, flexible, after, march.work)
    copy(after.force, march.work.mean)
    return outcome, solves


def by_energy(march: March, before: Rows, flexible: Flexibility, after: Rows) -> Solved:
    """Find the contacts whose forces do the work of their springs."""
    return conserving(march.laws, before, flexible, after, march.work)


def account_conserving(march: March, state: State, after: State, course: Course, part: Part, sums: Vector) -> None:
    """Add what an accepted part of a step loses [J]: nothing by its contacts."""
    add_damping(march, part, half_square(state.p) / (march.scheme.step * march.scheme.step), sums)
    add_bulk_loss(march, state, after, part, sums)


def by_passes(march: March, before: Rows, flexible: Flexibility, after: Rows) -> Solved:
    r"""Find the contacts on a rigid stop by passes over springs (Uzawa).

    These are preloaded by the forces of the pass before,

        N = max(0, lam - r w),    w = w_f + W N,    then lam <- N,

    beginning with lam = 0 in every step, until none is pressed deeper than the tolerance. For one contact every pass
    leaves 1/(1 + r W) of the penetration, so that it takes ln(|w_f| / tolerance) / ln(1 + r W) of them: few on springs
    that are stiff against the step's flexibility, thousands in short steps. The limit is the rigid stop,
    N = max(0, -w_f / W), and impacts on it rebound as on that, with no limit for dt -> 0.
    """
    method = march.method
    springs = method.springs
    work = march.work
    m = len(before.force)
    gap = march.room.force
    for r in range(m):
        gap[r] = work.q[r]
        work.mean[r] = 0.0
    start = before
    solves = 0
    for _ in range(method.pass_limit):
        for r in range(m):
            work.q[r] = gap[r] - work.mean[r] * springs.compliance[r]
        outcome, spent = find(springs, start, flexible, after, work)
        solves += spent
        march.tally[0] += 1
        if outcome != FOUND:
            return outcome, solves
        start = after  # its states are those of the next pass, but for contacts that open
        deepest = 0.0
        for r in range(m):
            if after.state[r] == INSIDE:
                after.opening[r] = (work.mean[r] - after.force[r]) * springs.compliance[r]
                deepest = max(deepest, 0.0 - after.opening[r])
            else:
                after.opening[r] = gap[r] + flexed(springs, flexible, r, after.force)
            work.mean[r] = after.force[r]
        if not deepest > method.penetration:
            return FOUND, solves
    return UNREACHED, solves


# ---- impacts ---------------------------------------------------------------------------------------------------------


def make_impact_stage(
    march: March, stage: StageRoom, start: State, before: State, after: State, course: Course, part: Part
) -> Solved:
    r"""Make a step on rigid contact with a coefficient of restitution, by the theta method (Moreau and Jean).

    With u = gg v at the start and impulses P, mode by mode,

        s h (v1 - u) = h^2 F - h^2 k (z + theta h u) + h B' P,        s = 1 + theta^2 h^2 k
        z1 = z + h (theta v1 + (1 - theta) u)

    Without impulses this is Newmark's scheme with alpha = theta^2 and delta = 2 theta - 1/2, whose weights it takes; no
    acceleration is carried, and how it starts does not matter. A contact that would be closed half a step on,
    w + h w'/2 <= 0 with the rate w' at the start, after gg, keeps Newton's law of restitution,

        w'_1 + e w' >= 0,    P >= 0,    P (w'_1 + e w') = 0,    w'_1 = w'_f + G P,

    a linear complementarity problem for the rates; all others have P = 0. So e is exact at every step and every phase.
    The gap itself is in no law: what a landing has left of penetration, up to V h, stays (drift). With several contacts
    e is that of each, as Newton has it: an impulse at one corner changes the rate of the other, which then may leave
    faster than by e times its own. Forces of contact are N = P/h, which grow as 1/h in an impact.

    M. Jean, The non-smooth contact dynamics method, 1999; J. J. Moreau, Numerical aspects of the sweeping process,
    1999.
    """
    room = march.room
    body = march.body
    length = length_of(march, stage, part.ratio)
    h = length.numbers[2]
    theta = math.sqrt(stage.numbers.alpha)
    discount = length.numbers[0] * length.numbers[1]  # of p: u times the length
    prescribe(march, course, stage, part)
    mean_loads(march, theta)
    write_loads(march)
    for i in range(len(body.k)):
        held = room.load[i] - body.k[i] * (before.z[i] + theta * discount * start.p[i])
        room.x[i] = length.inverse[i] * h * h * held
    rows = after.rows
    move_rows(body, start.p, room.free)
    move_rows(body, room.x, room.force)
    for r in range(len(rows.force)):
        rate = discount * room.free[r] / h
        end = rate + room.force[r] / h
        near = before.rows.opening[r] + h * rate / 2 <= 0
        rows.state[r] = INSIDE if near else LOWER
        march.work.q[r] = end + march.method.restitution * rate if near else FAR
    outcome, solves = find(march.laws, rows, length.flexible, rows, march.work)
    if outcome != FOUND:
        return outcome, solves
    push_modes(march, rows.force)
    for i in range(len(body.k)):
        begun = discount * start.p[i]
        end = begun + room.x[i] + h * length.inverse[i] * room.pushed[i]
        room.x[i] = theta * end + (1 - theta) * begun
        after.z[i] = before.z[i] + room.x[i]
        after.p[i] = end / length.numbers[0]
        after.a[i] = 0.0
    move_rows(body, room.x, room.free)
    for r in range(len(rows.force)):
        rows.opening[r] = before.rows.opening[r] + room.free[r]
        rows.force[r] /= h
        after.path[r] = 0.0
    return FOUND, solves


def mean_loads(march: March, late: float) -> None:
    """Write the shares of the loads over a stage, `late` of them as at its end, in place of those at its end."""
    room = march.room
    for j in range(2, len(room.end)):
        room.end[j] = (1 - late) * room.start[j] + late * room.end[j]


def account_impact(march: March, state: State, after: State, course: Course, part: Part, sums: Vector) -> None:
    """Add what an accepted part of a step loses [J].

    An impact takes -P (w'_0 + w'_1)/2, and the algorithm

        (theta - 1/2) [ (v1 - u)' (v1 - u) + (z1 - z)' k (z1 - z) - sum of P (w'_1 - w'_0) ].
    """
    body = march.body
    room = march.room
    scheme = march.scheme
    length = length_of(march, march.last, part.ratio)
    h = length.numbers[2]
    theta = math.sqrt(march.last.numbers.alpha)
    discount = length.numbers[0] * length.numbers[1]  # of p: u times the length
    add_damping(march, part, half_square(state.p) / (scheme.step * scheme.step), sums)
    prescribe(march, course, march.last, part)
    mean_loads(march, theta)
    stored = 0.0
    for i in range(len(body.k)):
        moved = after.z[i] - state.z[i]
        room.x[i] = part.ratio * after.p[i] - discount * state.p[i]
        stored += body.k[i] * moved * moved + room.x[i] * room.x[i] / (h * h)
        sums[GIVEN] += (room.end[2] - 1) * body.loads[0][i] * moved
    move_rows(body, state.p, room.free)
    move_rows(body, room.x, room.force)
    for r in range(len(after.rows.force)):
        P = h * after.rows.force[r]
        before = discount * room.free[r] / h
        difference = room.force[r] / h
        sums[CONTACT] -= P * (before + difference / 2)
        sums[IMPULSE] += P
        stored -= P * difference
    sums[ALGORITHMIC] += (theta - 0.5) * stored


def keep_passes(march: March, state: State, rows: object, number: int) -> bool:
    """Write what `keep_modes` does, and the passes since a step was kept."""
    rows[number, 2 * len(state.z)] = march.tally[0]  # type: ignore[index]
    march.tally[0] = 0.0
    return keep_modes(march, state, rows, number)  # type: ignore[arg-type]


make_steps = steps_by(stage_with(at_end), account, keep_modes)
make_conserving_steps = steps_by(stage_with(by_energy), account_conserving, keep_modes)
make_augmented_steps = steps_by(stage_with(by_passes), account, keep_passes)
make_impact_steps = steps_by(make_impact_stage, account_impact, keep_modes)
