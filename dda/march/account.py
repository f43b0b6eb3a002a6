"""What a step takes from the energy, whatever body moves; the formulas are in `dda.march.energy`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dda.contact.dense import Matrix, Vector
from dda.contact.rows import Laws, Rows
from dda.march.energy import ALGORITHMIC, CONTACT, DAMPING, FRICTION, GIVEN, IMPULSE, SWITCHING, bulk_loss
from dda.march.step import AnyState, Course, March, Part, StageRoom, State, prescribe


def account_with(
    half_square: Callable[[Any], float], add_bulk_loss: Callable[..., None]
) -> Callable[[March, State, State, Course, Part, Vector], None]:
    """Return what adds up the losses of a part of a step.

    Parameters
    ----------
    half_square
        Of a vector of modes.
    add_bulk_loss
        Adds what Newmark's step loses beside the contacts: (march, state, after, part, sums).
    """

    def account(march: March, state: State, after: State, course: Course, part: Part, sums: Vector) -> None:
        """Add what an accepted part of a step loses, and what loads and base give [J]."""
        scheme = march.scheme
        dt2 = scheme.step * scheme.step
        add_damping(march, part, half_square(state.p) / dt2, sums)
        before = state
        if scheme.stages == 2:
            account_stage(march, march.first, state, march.between, course, part, sums)
            before = march.between
        account_stage(march, march.last, before, after, course, part, sums)
        if scheme.newmark:
            add_bulk_loss(march, state, after, part, sums)

    return account


def add_bulk_loss(march: March, state: State, after: State, part: Part, sums: Vector) -> None:
    """Add what Newmark's step loses beside the contacts [J]."""
    dt2 = march.scheme.step * march.scheme.step
    alpha = march.last.numbers.alpha
    delta = march.last.numbers.delta
    k = march.body.k
    stiff = 0.0
    change = 0.0
    for i in range(len(k)):
        moved = after.z[i] - state.z[i]
        faster = after.a[i] - state.a[i]
        stiff += k[i] * moved * moved
        change += faster * faster / 2
        if part.begun == 0:  # A0 may be any; later a is that of the forces
            sums[ALGORITHMIC] += (1 - delta) * moved * (state.R[i] - state.a[i]) / dt2
    kinetic = half_square(after.a) - half_square(state.a)
    h2 = dt2 * part.ratio * part.ratio
    sums[ALGORITHMIC] += bulk_loss(alpha, delta, h2, stiff, kinetic / dt2 / dt2, change / dt2 / dt2)


def half_square(x: Vector) -> float:
    """Return x' x / 2."""
    total = 0.0
    for i in range(len(x)):
        total += x[i] * x[i]
    return total / 2


def add_damping(march: March, part: Part, kinetic: float, sums: Vector) -> None:
    """Add what the discount takes of the kinetic energy of the velocity that a part of a step starts with [J]."""
    discount = march.scheme.gg**part.ratio
    late_start = march.scheme.lag != 0 and part.begun == 0  # a discount leaves the velocity of half a step before
    if discount != 1 and not late_start:
        sums[DAMPING] += (1 - discount * discount) * kinetic


def account_stage(
    march: March, stage: StageRoom, before: State, after: State, course: Course, part: Part, sums: Vector
) -> None:
    """Add what the contacts lose in a stage, and what base and loads give.

    All forces act with the weights 1 - delta and delta at the two ends of Newmark's step, with one half at those of
    another scheme's stage.
    """
    prescribe(march, course, stage, part)
    room = march.room
    loads = march.body.loads
    late = stage.numbers.delta if march.scheme.newmark else 0.5
    for j in range(len(loads)):
        share = (1 - late) * room.start[2 + j] + late * room.end[2 + j] - march.body.stored[j]
        if share != 0.0:
            for i in range(len(before.z)):
                sums[GIVEN] += share * loads[j][i] * (after.z[i] - before.z[i])
    length = march.scheme.step * part.ratio * (stage.numbers.end - stage.numbers.begin)
    late = late if march.scheme.averages else 1.0
    add_contact_losses(march, march.laws, march.body.ground, before, after, late, length, sums)


def add_contact_losses(
    march: March,
    laws: Laws,
    ground: Matrix,
    before: AnyState,
    after: AnyState,
    late: float,
    length: float,
    sums: Vector,
) -> None:
    """Add what the contacts lose in a stage of some length [s], and what the base gives through them [J].

    Parameters
    ----------
    ground
        (m, 2) what a unit displacement of the base takes from the openings.
    late
        Weight of the forces at the end beside those at the beginning.
    """
    room = march.room
    n = laws.contacts
    rows = after.rows
    for r in range(len(rows.force)):
        if laws.retardation == 0 and before.rows.force[r] == 0.0 and rows.force[r] == 0.0:
            continue  # open all the while
        force = (1 - late) * before.rows.force[r] + late * rows.force[r]
        moved = rows.opening[r] - before.rows.opening[r] + (after.path[r] - before.path[r])
        friction = 0.0 - rows.force[r] * rows.slip[r]
        spring = spring_force(laws, before.rows, r)
        end = spring_force(laws, rows, r)
        lost = laws.compliance[r] * (spring * spring - end * end) / 2 - force * moved - friction
        if laws.retardation > 0:
            dashpot = ((1 - late) * spring + late * end - force) * moved
            lost -= dashpot
            sums[CONTACT] += dashpot
        contact = r if r < n else r - n
        keeps_state = before.rows.state[contact] == rows.state[contact]
        sums[ALGORITHMIC if keeps_state else SWITCHING] += lost
        sums[FRICTION] += friction
        for axis in range(2):
            sums[GIVEN] += force * ground[r][axis] * (room.end[axis] - room.start[axis])
        sums[IMPULSE] += length * force * ground[r][1]


def spring_force(laws: Laws, rows: Rows, r: int) -> float:
    """Return the force of the spring of a row, without that of a dashpot beside it [N]."""
    if laws.retardation > 0:
        return float(max(0.0 - rows.opening[r], 0.0) / laws.compliance[r])
    return float(rows.force[r])


account = account_with(half_square, add_bulk_loss)
