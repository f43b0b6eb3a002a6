"""What a step takes from the energy, whatever body moves; the formulas are in `dda.march.energy`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dda.contact.dense import Matrix, Vector
from dda.contact.rows import Laws, Rows
from dda.march.energy import ALGORITHMIC, CONTACT, DAMPING, FRICTION, GIVEN, IMPULSE, SWITCHING, bulk_loss
from dda.march.step import AnyState, Course, March, Part, StageRoom, State, prescribe


def over_stages(account_stage: Callable[..., None]) -> Callable[..., None]:
    """Return what adds up the stages of a part of a step: (march, state, after, course, part, sums).

    Parameters
    ----------
    account_stage
        Adds what belongs to one of them: (march, stage, before, after, course, part, sums).
    """

    def account_stages(
        march: March, state: AnyState, after: AnyState, course: Course, part: Part, sums: Vector
    ) -> None:
        """Add what belongs to the stages of an accepted part of a step."""
        before = state
        if march.scheme.stages == 2:
            account_stage(march, march.first, state, march.between, course, part, sums)
            before = march.between
        account_stage(march, march.last, before, after, course, part, sums)

    return account_stages


def account_with(
    half_square: Callable[[Any], float], add_bulk_loss: Callable[..., None]
) -> Callable[[March, AnyState, AnyState, Course, Part, Vector], None]:
    """Return what adds up the losses of a part of a step.

    Parameters
    ----------
    half_square
        Of a vector of modes.
    add_bulk_loss
        Adds what Newmark's step loses beside the contacts: (march, state, after, part, sums).
    """

    def account(march: March, state: AnyState, after: AnyState, course: Course, part: Part, sums: Vector) -> None:
        """Add what an accepted part of a step loses, and what loads and base give [J]."""
        scheme = march.scheme
        dt2 = scheme.step * scheme.step
        add_damping(march, part, half_square(state.p) / dt2, sums)
        account_stages(march, state, after, course, part, sums)
        if scheme.newmark:
            add_bulk_loss(march, state, after, part, sums)

    return account


def add_bulk_loss(march: March, state: AnyState, after: AnyState, part: Part, sums: Vector) -> None:
    """Add what Newmark's step loses beside the contacts [J]."""
    dt2 = march.scheme.step * march.scheme.step
    alpha = march.last.numbers.alpha
    delta = march.last.numbers.delta
    k = march.body.k
    z = after.z
    a = after.a
    z_before = state.z
    a_before = state.a
    stiff = 0.0
    change = 0.0
    for i in range(len(k)):
        moved = z[i] - z_before[i]
        faster = a[i] - a_before[i]
        stiff += k[i] * moved * moved
        change += faster * faster / 2
        if part.begun == 0:  # A0 may be any; later a is that of the forces
            sums[ALGORITHMIC] += (1 - delta) * moved * (state.R[i] - a_before[i]) / dt2
    kinetic = half_square(a) - half_square(a_before)
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
    stored = march.body.stored
    late = stage.numbers.delta if march.scheme.newmark else 0.5
    z = after.z
    z_before = before.z
    for j in range(len(loads)):
        share = (1 - late) * room.start[2 + j] + late * room.end[2 + j] - stored[j]
        load = loads[j]
        if share != 0.0:
            given = 0.0
            for i in range(len(z)):
                given += load[i] * (z[i] - z_before[i])
            sums[GIVEN] += share * given
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
    compliance = laws.compliance
    damped = laws.retardation > 0
    n = laws.contacts
    rows = after.rows
    old = before.rows
    along = march.room.end[0] - march.room.start[0]
    away = march.room.end[1] - march.room.start[1]
    keeping = 0.0
    switching = 0.0
    for r in range(len(rows.force)):
        spring = old.force[r]
        end = rows.force[r]
        if spring == 0.0 and end == 0.0 and not damped:
            continue  # open all the while
        force = (1 - late) * spring + late * end
        moved = rows.opening[r] - old.opening[r] + (after.path[r] - before.path[r])
        friction = 0.0 - end * rows.slip[r]
        if damped:
            spring = spring_force(laws, old, r)
            end = spring_force(laws, rows, r)
        lost = compliance[r] * (spring * spring - end * end) / 2 - force * moved - friction
        if damped:
            dashpot = ((1 - late) * spring + late * end - force) * moved
            lost -= dashpot
            sums[CONTACT] += dashpot
        contact = r if r < n else r - n
        if old.state[contact] == rows.state[contact]:
            keeping += lost
        else:
            switching += lost
        sums[FRICTION] += friction
        sums[GIVEN] += force * (ground[r][0] * along + ground[r][1] * away)
        sums[IMPULSE] += length * force * ground[r][1]
    sums[ALGORITHMIC] += keeping
    sums[SWITCHING] += switching


def spring_force(laws: Laws, rows: Rows, r: int) -> float:
    """Return the force of the spring of a row that has a dashpot beside it [N]."""
    return float(max(0.0 - rows.opening[r], 0.0) / laws.compliance[r])


account_stages = over_stages(account_stage)
account = account_with(half_square, add_bulk_loss)
