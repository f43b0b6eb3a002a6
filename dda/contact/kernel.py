r"""The open-close iteration in the force form: which of n contacts are closed, stick or slip, and their forces.

Without contact forces a step would bring the contacts to the gaps w_f and move them along the base by s_f. Forces
lambda = (N, T) add the flexibility C of the step,

    (w, s) = (w_f, s_f) + C lambda,

and the law holds at the end of the step: N = -p w of a closed contact, T = -p_s (s - r) of one that sticks. So

    closed      (C lambda)_w + N/p = -w_f
    sticks      (C lambda)_s + T/(beta p_s) = -(s_n - r + s_f),     T of a slipping contact is -sigma (tan(phi) N + c)

with beta = 1, and for a contact that closes in the step, which slides freely up to its crossing, s_n - r = 0 and

    beta = 1 - theta = (N/p) / (w_n + N/p),

found by Newton's method on beta = beta(N). No stiffness is added to C: a stiff spring costs no digit, and a rigid stop
is 1/p = 0. The iteration solves for the present states, updates all of them at once, stick and slip too, and ends when
none changes.

Where that does not end, frictionless contact is the linear complementarity problem w = w_f + C N, N = max(0, -p w),
which has one solution: the first contact that disagrees is set alone, again and again (Murty 1974). With shear there
may be no consistent state, or several. Of a few contacts all states are tried, and the only consistent one is taken;
of more they are set one by one until states come back.

The functions take numbers, and arrays or lists: `dda.stepping.compiled` compiles them where a history is long.
Nothing here knows a block: gaps, slides and C come in from outside.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.dense import Matrix, Vector, copy, dot, eliminate, scale_of, zeros
from dda.contact.unilateral import LAGGED, OPEN, SLIP, STICK, Unilateral
from dda.model.arrays import Array

Integers = NDArray[np.int64]
States = Any  # (n,) array, or a list of ints

Flexible = Any  # `Flexibility`, or what has its fields

FOUND = 0
NONE = 1
SEVERAL = 2
UNREACHED = 5  # beside the outcomes of `dda.stepping.driver` and of columns; no shorter step helps
FAILURES = {
    NONE: "no consistent contact state",
    SEVERAL: "several consistent contact states",
    UNREACHED: "pass limit exceeded",
}

ROUNDING = 1e-12  # of the limit, by which |T| of a sticking contact may exceed it
CROSSING_STEPS = 60  # of Newton's method, which takes about five
CROSSING_CHANGE = 1e-9  # of beta in its last step, whose square is below rounding
TO_PAIR = ((0.5, 0.5), (-1.0, 1.0))  # mean and difference of two slides
TO_OWN = ((1.0, -0.5), (1.0, 0.5))  # two slides from mean and difference
TRIED = 256  # contact states up to which all are tried: of 8 bonded contacts, or of 4 with friction


class Law(NamedTuple):
    """The numbers of `Unilateral` across the base, for one contact."""

    compliance: float  # 1/p [m/N]; 0 for a rigid stop
    closing: float  # gap below which an open contact closes [m]
    pull: float  # greatest tension of a closed contact [N]
    limit: int  # solves of the open-close iteration before the states are searched
    damping: float = 0.0  # c of a dashpot beside the spring, clipped [N s/m]


class ShearLaw(NamedTuple):
    """The numbers of `Unilateral` along the base."""

    softness: float  # 1/p_s [m/N]
    friction: float  # tan(phi) [-]
    cohesion: float  # c [N]
    slips: bool  # whether the shear has a limit
    lagged: bool  # whether that limit is that of the solve before


Shear = ShearLaw | None
"""None of contacts that slide freely: what needs the law is then left out of compiled code, half of what there is."""


class Contacts(NamedTuple):
    """State of n contacts, one entry each."""

    state: States  # OPEN, STICK (closed, without friction too), or SLIP in its direction
    gap: Vector  # w [m]
    stretch: Vector  # s - r of the closed ones [m]; 0 where open
    normal: Vector  # N [N], on the block, away from the base
    shear: Vector  # T [N], on the block, along the base
    slipped: Vector  # change of r by slip in the step [m]
    reference: Vector  # r [m]; of an open one s itself


class Free(NamedTuple):
    """What a step without contact forces does to the contacts.

    Two contacts have a second set of coordinates along the base, the mean of their slides and s_N - s_M, to which the
    forces H = T_M + T_N and G = (T_N - T_M)/2 belong: in a long step a rigid motion of 1e9 m may hide a difference
    that is elastic. Of another number of contacts the second set is the first one, and is not used.
    """

    gap: Vector  # w_f [m]
    slide: Vector  # s_f, displacement along the base in the step [m]
    paired: Vector  # that in the second set [m]


class Flexibility(NamedTuple):
    """What forces change of a step of one length."""

    C: Matrix  # (2n, 2n) flexibility in (w, s) [m/N]
    C_paired: Matrix  # (2n, 2n) flexibility in w and the second set [m/N]


class Work(NamedTuple):
    """Room for the equations of a solve."""

    tried: States  # (n,) states of the present solve
    saved: States  # (n,) states to compare with
    count: States  # (2,) how many contacts are closed, and how many of them close in the step
    closed: States  # (n,) numbers of the closed contacts
    closing: States  # (n,) places among these of contacts that close in the step
    active: States  # (n,) places among these of contacts whose T is unknown
    held: Vector  # (n,) c of each contact, or its limit under lagged friction [N]
    beta: Vector  # (n,) share 1 - theta of the closed contacts; 0 where T is not unknown
    change: Vector  # (n,) of beta in a step of Newton's method
    rate: Vector  # (n,) d beta / dN [1/N]
    A: Matrix  # (2n, 2n)
    right: Matrix  # (2n, n + 1) right-hand sides
    scale: Vector  # (2n,)
    slope: Matrix  # (n, n) dN/dbeta of the closing contacts
    newton: Matrix  # (n, n) and its right-hand side
    newton_right: Matrix
    first: Vector  # (2n,) forces of the first consistent state
    mean: Vector  # (n,) normal forces over the step, where they are not those of its end [N]


def law_of(law: Unilateral, limit: int) -> Law:
    """Return the numbers of a law across the base; `limit` bounds the solves before the states are searched."""
    return Law(law.compliance, -law.band[0], law.pull, limit, law.damping)


def shear_law_of(law: Unilateral) -> Shear:
    """Return the numbers of a law along the base, None without shear."""
    if not law.shear:
        return None
    return ShearLaw(
        softness=law.softness,
        friction=law.friction or 0.0,
        cohesion=law.cohesion,
        slips=law.friction is not None,
        lagged=law.rules == LAGGED,
    )


def at_rest(gap: Array) -> Contacts:
    """Return contacts without force, closed where they touch."""
    state = np.where(gap <= 0, STICK, OPEN)
    return Contacts(state, gap, *np.zeros((5, len(gap))))


def work_for(n: int) -> Work:
    """Return room for the equations of n contacts."""
    vectors = zeros(n, n, n, n, (2 * n, 2 * n), (2 * n, n + 1), 2 * n, (n, n), (n, n), (n, 1), 2 * n, n)
    return Work(*(zeros(n, n, 2, n, n, n, dtype=np.int64) + vectors))


def change_slides(flexibility: Matrix, change: tuple[tuple[float, float], tuple[float, float]], out: Matrix) -> None:
    """Write C of two contacts in other coordinates of their slides: by `TO_PAIR` or `TO_OWN` times these."""
    for row in range(4):
        for column in range(4):
            out[row][column] = flexibility[row][column]
    for row in range(4):
        first = out[row][2]
        second = out[row][3]
        for k in range(2):
            out[row][2 + k] = change[k][0] * first + change[k][1] * second
    for column in range(4):
        first = out[2][column]
        second = out[3][column]
        for k in range(2):
            out[2 + k][column] = change[k][0] * first + change[k][1] * second


# ---- the iteration ---------------------------------------------------------------------------------------------------


def find_contacts(
    law: Law, shear_law: Shear, before: Contacts, free: Free, flexible: Flexible, after: Contacts, work: Work
) -> tuple[int, int]:
    """Find the contacts at the end of a step; return the outcome and the number of solves.

    Parameters
    ----------
    law, shear_law, before, free, flexible
        Law of the contacts across and along the base, the contacts at the start of the step, the step without contact
        forces, and what forces change of it.
    after
        Where the contacts at the end of the step are written.
    work
        Room for the equations.
    """
    n = len(before.gap)
    copy(before.state, work.tried)
    if shear_law is not None:
        if shear_law.lagged:
            return lagged(law, shear_law, before, free, flexible, after, work)
        for i in range(n):
            work.held[i] = shear_law.cohesion
    for solve in range(1, law.limit + 1):
        trial(law, shear_law, before, free, flexible, after, work)
        if update_states(law, shear_law, after, work.tried, n) == 0:
            return FOUND, solve
    if shear_law is not None and choices_of(shear_law) ** n <= TRIED:
        return every_state(law, shear_law, before, free, flexible, after, work)
    return one_by_one(law, shear_law, before, free, flexible, after, work)


def spring_energy(law: Law, shear_law: Shear, contacts: Contacts, i: int) -> float:
    """Return the energy of the springs of a contact [J]."""
    N = spring_force(law, contacts, i)
    energy = N * N * law.compliance
    if shear_law is not None:
        T = contacts.shear[i]
        energy += T * T * shear_law.softness
    return float(energy / 2)


def spring_force(law: Law, contacts: Contacts, i: int) -> float:
    """Return the normal force of the spring of a contact, without that of a dashpot beside it [N]."""
    if law.damping > 0:
        return float(max(0.0 - contacts.gap[i], 0.0) / law.compliance)
    return float(contacts.normal[i])


def stays_closed(law: Law, N: float) -> bool:
    """Tell whether a closed contact with the normal force N [N] stays closed."""
    return -law.pull <= N


def closes(law: Law, w: float) -> bool:
    """Tell whether an open contact with the gap w [m] closes."""
    return w < law.closing


def shear_limit(shear_law: ShearLaw, N: float) -> float:
    """Return the greatest shear force tan(phi) N + c under the normal force N [N]; a bonded contact has none."""
    if not shear_law.slips:
        return math.inf
    return shear_law.friction * max(N, 0.0) + shear_law.cohesion


def agreed_state(law: Law, shear_law: Shear, state: int, gap: float, N: float, T: float, slipped: float) -> int:
    """Return the state that the law makes of a tried contact; with NaN another one than was tried.

    Parameters
    ----------
    slipped
        How far the contact slipped: against its direction, it sticks [m].
    """
    if state == OPEN:
        return STICK if closes(law, gap) else OPEN
    if not stays_closed(law, N):
        return OPEN
    if shear_law is None:
        return STICK
    if state == STICK:
        if abs(T) <= shear_limit(shear_law, N) * (1 + ROUNDING):
            return STICK
        return -SLIP if T > 0 else SLIP
    return state if state * slipped >= 0 else STICK


def update_states(law: Law, shear_law: Shear, after: Contacts, states: States, most: int) -> int:
    """Set the states that disagree with their forces, `most` at most; return how many disagree."""
    wrong = 0
    for i in range(len(after.gap)):
        state = agreed_state(
            law, shear_law, after.state[i], after.gap[i], after.normal[i], after.shear[i], after.slipped[i]
        )
        if state != states[i]:
            wrong += 1
            if wrong <= most:
                states[i] = state
    return wrong


def one_by_one(
    law: Law, shear_law: Shear, before: Contacts, free: Free, flexible: Flexible, after: Contacts, work: Work
) -> tuple[int, int]:
    """Set the first contact that disagrees, alone, until all agree or states come back."""
    n = len(before.gap)
    copy(work.tried, work.saved)
    solves = law.limit
    changes = 0
    next_save = 1
    while True:
        trial(law, shear_law, before, free, flexible, after, work)
        solves += 1
        if update_states(law, shear_law, after, work.tried, 1) == 0:
            return FOUND, solves
        changes += 1
        if all_equal(work.tried, work.saved, n):
            return NONE, solves
        if changes == next_save:  # Brent: of any circle the states of some power of two are met again
            next_save *= 2
            copy(work.tried, work.saved)


def all_equal(states: States, saved: States, n: int) -> bool:
    """Tell whether two sets of states are the same."""
    for i in range(n):  # noqa: SIM110
        if states[i] != saved[i]:
            return False
    return True


def every_state(
    law: Law, shear_law: ShearLaw, before: Contacts, free: Free, flexible: Flexible, after: Contacts, work: Work
) -> tuple[int, int]:
    """Try all states; take the only ones that agree with their forces, but for rounding."""
    n = len(before.gap)
    solves = law.limit
    choices = choices_of(shear_law)
    consistent = -1
    for number in range(choices**n):
        set_states(work.tried, number, choices, n)
        trial(law, shear_law, before, free, flexible, after, work)
        solves += 1
        if update_states(law, shear_law, after, work.tried, 0) > 0:
            continue
        if consistent < 0:
            consistent = number
            for i in range(n):
                work.first[i] = after.normal[i]
                work.first[n + i] = after.shear[i]
        elif not same_forces(after, work.first):
            return SEVERAL, solves + choices**n - 1 - number
    if consistent < 0:
        return NONE, solves
    set_states(work.tried, consistent, choices, n)
    trial(law, shear_law, before, free, flexible, after, work)
    return FOUND, solves


def choices_of(shear_law: ShearLaw) -> int:
    """Return how many states a contact with shear may be in."""
    return 4 if shear_law.slips else 2


def set_states(states: States, number: int, choices: int, n: int) -> None:
    """Set the states by the digits of a number, the last contact's first."""
    for i in range(n - 1, -1, -1):
        digit = number % choices
        states[i] = -SLIP if digit == 3 else digit
        number //= choices


def same_forces(after: Contacts, first: Vector) -> bool:
    """Tell whether two answers differ by rounding only, as at the very limit of stick and slip."""
    n = len(after.gap)
    size = 0.0
    apart = 0.0
    for i in range(n):
        size = max(size, abs(first[i]), abs(first[n + i]))
        apart = max(apart, abs(first[i] - after.normal[i]), abs(first[n + i] - after.shear[i]))
    return bool(apart <= ROUNDING * size)


# ---- friction as common programs have it -----------------------------------------------------------------------------


def lagged(
    law: Law, shear_law: ShearLaw, before: Contacts, free: Free, flexible: Flexible, after: Contacts, work: Work
) -> tuple[int, int]:
    """Find the contacts with friction one solve behind and out of the convergence test, as common programs do.

    It is here to be recognised and explained, not to be used. What such programs do (Shi's and those that descend
    from it):

    - the iteration ends when no contact opens or closes any more; stick and slip are not looked at;
    - a slipping contact carries T = -sigma (tan(phi) N + c) with N of the solve before, of the last step in the first;
    - after a solve a sticking contact slips from then on if |T| > tan(phi) N + c, a slipping one sticks if it moved
      against its slip within the step;
    - r of a slipping contact is s at the beginning of each step, so that it sticks again from (almost) no shear force.

    A contact that slips too late carries too much, one that sticks again has lost its force: a stable block creeps,
    all the more the smaller the step. Dead bands (`Unilateral.band`) are another matter, and make it worse.
    """
    n = len(before.gap)
    copy(before.state, work.tried)
    for i in range(n):
        work.held[i] = shear_limit(shear_law, before.normal[i])
    for solve in range(1, law.limit + 1):
        trial(law, shear_law, before, free, flexible, after, work)
        same = True
        for i in range(n):
            # its own movement within the step decides whether a contact slips on
            moved = after.slipped[i] + after.stretch[i] - before.stretch[i]
            state = agreed_state(law, shear_law, after.state[i], after.gap[i], after.normal[i], after.shear[i], moved)
            if (state == OPEN) != (work.tried[i] == OPEN):
                same = False
            work.tried[i] = state
            work.held[i] = shear_limit(shear_law, after.normal[i])
        if same:
            for i in range(n):
                restart_reference(before, after, i, work.tried[i])
            return FOUND, solve
    return NONE, law.limit


def restart_reference(before: Contacts, after: Contacts, i: int, state: int) -> None:
    """Set state and reference with which the next step begins."""
    moved = after.slipped[i] + after.stretch[i]  # s - r with the old reference
    if abs(after.state[i]) == SLIP:
        after.stretch[i] = moved - before.stretch[i] if state == STICK else 0.0
        after.slipped[i] = moved - after.stretch[i]
    elif abs(state) == SLIP:
        after.slipped[i] = after.stretch[i]
        after.stretch[i] = 0.0
    after.state[i] = state


# ---- one solve -------------------------------------------------------------------------------------------------------


def trial(
    law: Law, shear_law: Shear, before: Contacts, free: Free, flexible: Flexible, after: Contacts, work: Work
) -> None:
    """Write the contacts at the end of the step in the states `work.tried`, whether their forces agree or not."""
    n = len(before.gap)
    closed = 0
    closing = 0
    for i in range(n):
        state = work.tried[i]
        after.state[i] = state
        after.normal[i] = 0.0
        after.shear[i] = 0.0
        after.slipped[i] = 0.0
        after.reference[i] = before.reference[i]
        if state != OPEN:
            work.closed[closed] = i
            if shear_law is not None:
                work.beta[closed] = 1.0 if state == STICK else 0.0
                if state == STICK and before.state[i] == OPEN:
                    work.closing[closing] = closed
                    closing += 1
            closed += 1
    work.count[0] = closed
    work.count[1] = closing
    if closed > 0:
        solve_forces(law, shear_law, before, free, flexible, after, work)
        if shear_law is not None and closing > 0:
            find_crossings(law, shear_law, before, free, flexible, after, work)
    for i in range(n):
        after.stretch[i] = 0.0
        if after.state[i] != OPEN:
            after.gap[i] = 0.0 - after.normal[i] * law.compliance  # no sum: a closed contact keeps its digits
        else:
            after.gap[i] = free.gap[i]
            if closed > 0:
                after.gap[i] += moved_by_forces(shear_law, flexible.C[i], after)
        if shear_law is not None:
            after.stretch[i] = 0.0 - after.shear[i] * shear_law.softness
            if abs(after.state[i]) == SLIP:
                moved = free.slide[i] + moved_by_forces(shear_law, flexible.C[n + i], after)
                if before.state[i] == OPEN:
                    moved *= crossing_share(law, before.gap[i], after.normal[i])
                after.slipped[i] = before.stretch[i] + moved - after.stretch[i]


def moved_by_forces(shear_law: Shear, row: Vector, after: Contacts) -> float:
    """Return a row of C times the forces [m]."""
    n = len(after.gap)
    total = dot(row, after.normal, n)
    if shear_law is not None:
        for j in range(n):
            total += row[n + j] * after.shear[j]
    return total


def crossing_share(law: Law, before: float, N: float) -> float:
    """Return beta = 1 - theta = (N/p) / (w_n + N/p), the share of the step's slide behind the crossing.

    Parameters
    ----------
    before : float
        The gap w_n before the step [m]; one that is not positive has crossed already.
    N : float
        The normal force after the step [N]; a tension has not crossed.
    """
    if before <= 0:
        return 1.0
    if N <= 0:
        return 0.0
    penetration = N * law.compliance
    return penetration / (before + penetration)


def crossing_rate(law: Law, before: float, N: float) -> float:
    """Return the derivative of `crossing_share` by N [1/N]."""
    if before <= 0 or N <= 0:
        return 0.0
    reach = before + N * law.compliance
    return law.compliance * before / reach / reach


def find_crossings(
    law: Law, shear_law: ShearLaw, before: Contacts, free: Free, flexible: Flexible, after: Contacts, work: Work
) -> None:
    """Solve again with the beta of the contacts that close, by Newton's method; NaN where it does not end."""
    closing = work.count[1]
    for _ in range(CROSSING_STEPS):
        for k in range(closing):
            place = work.closing[k]
            i = work.closed[place]
            work.rate[k] = crossing_rate(law, before.gap[i], after.normal[i])
            work.newton_right[k][0] = crossing_share(law, before.gap[i], after.normal[i]) - work.beta[place]
        for k in range(closing):
            for j in range(closing):
                identity = 1.0 if j == k else 0.0
                work.newton[k][j] = identity - work.rate[k] * work.slope[k][j]
            work.scale[k] = 1.0
        eliminate(work.newton, work.newton_right, work.scale, closing, 1)
        settled = True
        for k in range(closing):
            place = work.closing[k]
            change = work.newton_right[k][0]
            work.beta[place] = min(max(work.beta[place] + change, 0.0), 1.0)
            if not abs(change) <= CROSSING_CHANGE * work.beta[place]:
                settled = False
        solve_forces(law, shear_law, before, free, flexible, after, work)
        if settled:
            return
    for place in range(work.count[0]):
        after.normal[work.closed[place]] = math.nan
        after.shear[work.closed[place]] = math.nan


def solve_forces(
    law: Law, shear_law: Shear, before: Contacts, free: Free, flexible: Flexible, after: Contacts, work: Work
) -> None:
    """Write N and T of the closed contacts for given `work.beta`, and dN/dbeta of those that close."""
    closed = work.count[0]
    closing = work.count[1]
    if shear_law is None and closed == 1:
        i = work.closed[0]
        after.normal[i] = (0.0 - free.gap[i]) / (flexible.C[i][i] + law.compliance)
        return
    active = 0
    paired = False
    if shear_law is not None:
        for place in range(closed):
            if work.beta[place] > 0:
                work.active[active] = place
                active += 1
        paired = active == 2 and len(before.gap) == 2 and keeps_pair(shear_law, flexible, work)
    size = closed + active
    assemble(law, shear_law, before, free, flexible, paired, closed, active, work)
    for place in range(size):
        work.scale[place] = scale_of(work.A[place][place])
    if shear_law is not None:
        if shear_law.slips:
            add_friction(shear_law, before, flexible, closed, active, work)
        for k in range(closing):  # a unit of force in the shear equation of a closing contact; T makes dN/dbeta of it
            for row in range(size):
                work.right[row][1 + k] = 0.0
            if paired:
                work.right[2][1 + k] = 0.5
                work.right[3][1 + k] = -1.0 if work.closing[k] == 0 else 1.0
            else:
                for j in range(active):
                    if work.active[j] == work.closing[k]:
                        work.right[closed + j][1 + k] = 1.0
    eliminate(work.A, work.right, work.scale, size, 1 + closing)
    for place in range(closed):
        i = work.closed[place]
        after.normal[i] = work.right[place][0]
        after.shear[i] = 0.0
        if shear_law is not None and shear_law.slips and abs(work.tried[i]) == SLIP:
            limit = friction_of(shear_law) * work.right[place][0] + work.held[i]
            after.shear[i] = 0.0 - limit if work.tried[i] > 0 else limit
    if shear_law is not None:
        if paired:
            after.shear[0] = work.right[2][0] / 2 - work.right[3][0]
            after.shear[1] = work.right[2][0] / 2 + work.right[3][0]
        else:
            for k in range(active):
                after.shear[work.closed[work.active[k]]] = work.right[closed + k][0]
        for k in range(closing):
            beta = work.beta[work.closing[k]]
            T = after.shear[work.closed[work.closing[k]]]
            strength = T * shear_law.softness / (beta * beta) if beta > 0 else 0.0
            for j in range(closing):
                work.slope[j][k] = work.right[work.closing[j]][1 + k] * strength


def keeps_pair(shear_law: ShearLaw, flexible: Flexible, work: Work) -> bool:
    """Tell whether the equations of two sticking contacts are those of H and G.

    These keep apart the rigid and the elastic flexibility, but mix unequal softnesses: beyond the rigid flexibility
    softness decides, and the contacts' own forces keep the digits.
    """
    first = shear_law.softness / work.beta[0]
    second = shear_law.softness / work.beta[1]
    return bool(first == second or max(first, second) <= flexible.C_paired[2][2])


def assemble(
    law: Law,
    shear_law: Shear,
    before: Contacts,
    free: Free,
    flexible: Flexible,
    paired: bool,
    closed: int,
    active: int,
    work: Work,
) -> None:
    """Write the equations of N of the closed contacts and T of those that stick, without the slipping ones' T."""
    n = len(before.gap)
    A = work.A
    C = flexible.C_paired if paired else flexible.C
    for row in range(closed + active):
        a = row_of(row, paired, n, closed, work)
        for column in range(closed + active):
            A[row][column] = C[a][row_of(column, paired, n, closed, work)]
    for place in range(closed):
        A[place][place] += law.compliance
        work.right[place][0] = 0.0 - free.gap[work.closed[place]]
    if shear_law is None:
        return
    if paired:
        first = shear_law.softness / work.beta[0]
        second = shear_law.softness / work.beta[1]
        A[2][2] += (first + second) / 4
        A[2][3] += (second - first) / 2
        A[3][2] += (second - first) / 2
        A[3][3] += first + second
        work.right[2][0] = 0.0 - free.paired[0] - (before.stretch[0] + before.stretch[1]) / 2
        work.right[3][0] = 0.0 - free.paired[1] - (before.stretch[1] - before.stretch[0])
        return
    for k in range(active):
        i = work.closed[work.active[k]]
        A[closed + k][closed + k] += shear_law.softness / work.beta[work.active[k]]
        work.right[closed + k][0] = 0.0 - (before.stretch[i] + free.slide[i])


def row_of(row: int, paired: bool, n: int, closed: int, work: Work) -> int:
    """Return the row of C that belongs to an equation."""
    if row < closed:
        return int(work.closed[row])
    if paired:
        return n + row - closed
    return int(n + work.closed[work.active[row - closed]])


def add_friction(
    shear_law: ShearLaw, before: Contacts, flexible: Flexible, closed: int, active: int, work: Work
) -> None:
    """Add T = -sigma (tan(phi) N + c) of the slipping contacts; the matrix is no longer symmetric."""
    n = len(before.gap)
    friction = friction_of(shear_law)
    for place in range(closed):
        i = work.closed[place]
        if abs(work.tried[i]) != SLIP:
            continue
        direction = -1.0 if work.tried[i] > 0 else 1.0
        for row in range(closed + active):
            flexibility = direction * flexible.C[row_of(row, False, n, closed, work)][n + i]
            work.A[row][place] += friction * flexibility
            work.right[row][0] -= work.held[i] * flexibility


def friction_of(shear_law: ShearLaw) -> float:
    """Return tan(phi) by which T of a slipping contact follows its N beside `work.held`, which may hold the limit."""
    return 0.0 if shear_law.lagged else shear_law.friction
