r"""The contact problem of a step, by rows: which rows are at a bound, and the force of every one.

A row is one direction of one contact: its opening y and its force lambda. Without contact forces a step would bring the
openings to q; forces add the flexibility W of the step. The laws hold at the end of the step:

    z = q + (W + c) lambda,      lower <= lambda <= upper,
    z = 0 inside of the bounds,  z >= 0 at the lower bound,  z <= 0 at the upper one,

with the compliance c = 1/p of the spring. No stiffness is added to W: a stiff spring costs no digit, and a rigid
contact is c = 0. One law serves all contacts:

    unilateral   0 <= N                        z is the gap of an open contact
    bonded       no bounds
    strength     -s <= T <= s                  z is the slip
    friction     |T| <= tan(phi) N + c         z is the slip; T = 0 where N is at its bound, of an open contact
    smooth       T = 0                         a way of rigid spring (c = 0) and no bounds: nothing is solved for

A row inside of its bounds is at y = -c lambda, which is set and no sum of increments. Rows 0 .. n-1 are those of n
contacts; where contacts have friction, or are bonded along the base too, row n + i is the way of contact i along it.

A contact that closes in the step slides freely up to its crossing, so that of its way the share

    beta = (c N) / (w_n + c N)

behind it counts; it is found by Newton's method on beta = beta(N). Two contacts along one base have a second set of
coordinates, the mean of their ways and their difference: in a long step a rigid motion of 1e9 m may hide a difference
that is elastic.

The iteration solves for the present states, updates all of them at once, and ends when none changes. Where it does not
end, the first row that disagrees is set alone, again and again (Murty 1974), which ends for every problem without
friction: it has exactly one solution. With friction there may be none, or several: of a few contacts all states are
tried, and the only consistent one is taken.

All is written once, for numbers in arrays or lists: `dda.march.compiled` compiles it where a history is long. Nothing
here knows a block: openings and flexibility come in from outside.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from dda.contact.dense import Matrix, Vector, copy, eliminate, zeros
from dda.contact.unilateral import LAGGED, Unilateral

States = Any  # (m,) array, or a list of ints
Solved = tuple[int, int]  # an outcome, and how many solves it took

LOWER = -1  # of a row: its force is at the lower bound, open or slipping forwards
INSIDE = 0  # closed, sticking
UPPER = 1  # slipping backwards

FOUND = 0
NONE = 1
SEVERAL = 2
OVERFLOW = 3
LIMIT = 4  # the limit of solves
UNREACHED = 5  # no shorter step helps, here and below
TOO_MANY = 6
TOO_DEEP = 7
OUTCOMES = {
    FOUND: "completed",
    NONE: "no consistent contact state",
    SEVERAL: "several consistent contact states",
    OVERFLOW: "overflow",
    LIMIT: "solve limit exceeded",
    UNREACHED: "pass limit exceeded",
    TOO_MANY: "more contacts than there is room for",
    TOO_DEEP: "a corner deeper in a block than a step can bring it",
}

ROUNDING = 1e-12  # of a bound, by which the force of a sticking row may exceed it
CROSSING_STEPS = 60  # of Newton's method, which takes about five
CROSSING_CHANGE = 1e-9  # of beta in its last step, whose square is below rounding
TRIED = 256  # states up to which all are tried: of 8 bonded contacts, or of 4 with friction


class Laws(NamedTuple):
    """The laws of all rows, (m,) each unless said."""

    contacts: int  # n
    rows: int  # m, n or 2n; records may be longer
    compliance: Vector  # c [m/N]; 0: rigid
    lower: Vector  # least force of a row inside of its bounds [N]
    upper: Vector  # greatest one; of a row with friction its cohesion [N]
    opens: States  # 1 of a unilateral row, which carries nothing at its lower bound
    friction: Vector  # (n,) tan(phi) of the contacts along the base [-]; of a bonded one zero, with infinite bounds
    slips: bool  # whether any way along the base has a limit
    lagged: bool  # whether that limit is that of the solve before
    paired: bool  # whether rows 2 and 3 are also known as the mean and the difference of two ways
    banded: bool  # whether W has one diagonal beside the main one, the two in the rows of (2, m)
    closing: float  # opening below which an open row closes [m]
    retardation: float  # tau = damping/p of dashpots beside all springs [s]
    together: int  # solves with all states updated at once
    most: int  # solves that end the search; 0: none


class Rows(NamedTuple):
    """The rows between two steps, (m,) each."""

    state: States
    opening: Vector  # y: gap of an open row, stretch -c lambda of another [m]
    force: Vector  # lambda [N]
    slip: Vector  # z of the rows at a bound that do not open, in the last step [m]


class Flexibility(NamedTuple):
    """What unit forces add to the openings in a step of one length [m/N]."""

    W: Matrix  # (m, m), or (2, m) of a band
    paired: Matrix  # (m, m) that in mean and difference of two ways
    own: Vector  # (1,) the part of it in y, of y + tau y'; 1 without dashpots


class Work(NamedTuple):
    """Room for the equations of a solve."""

    q: Vector  # (m,) openings at the end of the step without forces, of y + tau y' with dashpots
    late: Vector  # (m,) tau y' in them
    pair: Vector  # (2,) mean and difference of q of two ways
    z: Vector  # (m,)
    tried: States  # (m,) states of the present solve
    saved: States  # (m,) states to compare with
    unknown: States  # (m,) rows whose forces are unknown
    place: States  # (m,) their places in the equations
    closing: States  # (n,) contacts that close in the step and stick
    beta: Vector  # (n,)
    rate: Vector  # (n,) d beta / dN [1/N]
    held: Vector  # (n,) limit along the base beside tan(phi) N [N]
    A: Matrix  # (m, m)
    right: Matrix  # (m, n + 1)
    scale: Vector  # (m,)
    slope: Matrix  # (n, n) dN/dbeta of the contacts that close
    newton: Matrix  # (n, n), and its right-hand side
    newton_right: Matrix
    first: Vector  # (m,) forces of the first consistent states
    mean: Vector  # (m,) forces over the step, where they are not those of its end [N]


def work_for(contacts: int, rows: int, banded: bool = False) -> Work:
    """Return room for the equations."""
    n = contacts
    m = rows
    dense = (1, 1) if banded else (m, m)
    columns = 1 if banded else n + 1
    pairs = 1 if banded else n
    vectors = zeros(m, m, 2, m)
    integers = zeros(m, m, m, m, n, dtype=np.int64)
    rest = zeros(n, n, n, dense, (m, columns), m, (pairs, pairs), (pairs, pairs), (pairs, 1), m, m)
    return Work(*vectors, *integers, *rest)


def flexibility_for(rows: int, banded: bool) -> Flexibility:
    """Return room for a flexibility."""
    shape = (2, rows) if banded else (rows, rows)
    return Flexibility(np.zeros(shape), np.zeros(shape), np.ones(1))


def laws_of(law: Unilateral, contacts: int, rows: int, limit: int, share: float = 1.0) -> Laws:
    """Return the laws of contacts that open, or of so many of which each stands for `share` corners.

    Parameters
    ----------
    rows
        n, or 2n with springs along the base.
    limit
        Solves before the states are searched.
    """
    across = np.arange(rows) < contacts
    cohesion = law.cohesion if law.friction is not None else math.inf
    return Laws(
        contacts=contacts,
        rows=rows,
        compliance=np.where(across, law.compliance, law.softness) / share,
        lower=np.where(across, -law.pull, -cohesion) * share,
        upper=np.where(across, math.inf, cohesion) * share,
        opens=across.astype(np.int64),
        friction=np.full(contacts, law.friction or 0.0),
        slips=law.friction is not None,
        lagged=law.rules == LAGGED and rows > contacts,
        paired=rows == 4 and contacts == 2,
        banded=False,
        closing=-law.band[0],
        retardation=law.damping * law.compliance,
        together=limit,
        most=0,
    )


def rows_of(opening: Vector, state: States) -> Rows:
    """Return rows without force."""
    m = len(opening)
    return Rows(np.array(state, dtype=np.int64), np.array(opening, dtype=float), np.zeros(m), np.zeros(m))


# ---- the iteration ---------------------------------------------------------------------------------------------------


def find(laws: Laws, before: Rows, flexible: Flexibility, after: Rows, work: Work) -> Solved:
    """Find states, forces and openings at the end of a step; return the outcome and the number of solves.

    Parameters
    ----------
    before
        The rows at the start of the step.
    flexible
        What forces change of it.
    after
        Where the rows at its end are written.
    work
        Room for the equations, with the openings `work.q` of a step without contact forces.
    """
    n = laws.contacts
    m = laws.rows
    copy(before.state, work.tried)
    if laws.lagged:
        return lagged(laws, before, flexible, after, work)
    for i in range(m - n):
        work.held[i] = laws.upper[n + i]
    for solves in range(1, laws.together + 1):
        solve(laws, before, flexible, after, work)
        if update(laws, flexible, after, work, m) == 0:
            return FOUND, solves
        if solves == laws.most:
            return LIMIT, solves
    if (m > n or laws.retardation > 0) and choices_of(laws, m) ** n <= TRIED:
        return every_state(laws, before, flexible, after, work)
    return one_by_one(laws, before, flexible, after, work)


def update(laws: Laws, flexible: Flexibility, after: Rows, work: Work, most: int) -> int:
    """Set the states that disagree with forces and openings, `most` at most; return how many contacts disagree."""
    n = laws.contacts
    tried = work.tried
    force = after.force
    lower = laws.lower
    upper = laws.upper
    damped = laws.retardation > 0
    rows = laws.rows
    friction = rows > n and laws.slips
    wrong = 0
    for i in range(n):
        old = tried[i]
        state = old
        if damped or old != INSIDE or not lower[i] <= force[i] <= upper[i]:
            state = across(laws, flexible, after, work, i)
        if state != old:
            wrong += 1
            if wrong <= most:
                tried[i] = state
                if rows > n:
                    tried[n + i] = INSIDE  # what opens or closes begins anew
        elif friction and state == INSIDE:
            way = along(laws, after, work, i, work.z[n + i], 0.0)
            if way != tried[n + i]:
                wrong += 1
                if wrong <= most:
                    tried[n + i] = way
    return wrong


def across(laws: Laws, flexible: Flexibility, after: Rows, work: Work, r: int) -> int:
    """Return the state that its law makes of a tried row across the base."""
    if laws.retardation > 0:
        return with_dashpot(laws, flexible, after, work, r)
    own = flexible.W[r][r] + laws.compliance[r]
    state = work.tried[r]
    return next_state(
        state, after.force[r], work.z[r], own, laws.lower[r], laws.upper[r], laws.opens[r], laws.closing, 0.0
    )


def next_state(
    state: int,
    force: float,
    z: float,
    own: float,
    lower: float,
    upper: float,
    opens: int,
    closing: float,
    slack: float,
) -> int:
    """Return the state that its law makes of a row: of NaN another one where it opens, else the same.

    Parameters
    ----------
    own
        W_rr + c of the row [m/N].
    lower, upper, opens, closing
        Its `Laws`.
    slack
        Force by which one that disagrees does so at least [N].
    """
    if state == INSIDE:
        if force >= lower - slack:
            return UPPER if force > upper + slack else INSIDE
        return LOWER if opens == 1 or force < lower else INSIDE
    if opens == 1:
        return INSIDE if z < closing - slack * own else LOWER
    if not state * z > slack * own:
        return int(state)
    alone = force - z / own  # the force that would close it alone
    return LOWER if alone < lower else UPPER if alone > upper else INSIDE


def along(laws: Laws, after: Rows, work: Work, i: int, slipped: float, slack: float) -> int:
    """Return the state that friction makes of the way of a closed contact along the base.

    Parameters
    ----------
    slipped
        How far it slipped: against its direction, it sticks [m].
    slack
        Way by which one that disagrees does so at least [m].
    """
    r = laws.contacts + i
    state = work.tried[r]
    force = after.force[r]
    if state == INSIDE:
        more = abs(force) - shear_limit(laws, i, after.force[i]) * (1 + ROUNDING)
        if more <= 0 or more * laws.compliance[r] < slack:
            return INSIDE
        return UPPER if force > 0 else LOWER
    return int(state) if state * slipped <= slack else INSIDE


def shear_limit(laws: Laws, i: int, N: float) -> float:
    """Return the greatest force tan(phi) N + c along the base under the normal force N [N]; a bonded one has none."""
    if not laws.slips:
        return math.inf
    least = 0.0 if laws.lagged else laws.lower[i]  # of a contact with a strength, a tension lowers the limit
    return float(laws.friction[i] * max(N, least) + laws.upper[laws.contacts + i])


def is_smooth(laws: Laws, i: int) -> bool:
    """Tell whether the way of a contact carries nothing: no spring, no bound."""
    r = laws.contacts + i
    return bool(laws.upper[r] == 0 and laws.friction[i] == 0 and laws.compliance[r] == 0)


def one_by_one(laws: Laws, before: Rows, flexible: Flexibility, after: Rows, work: Work) -> Solved:
    """Set the first row that disagrees, alone, until all agree or states come back."""
    m = laws.rows
    copy(work.tried, work.saved)
    solves = laws.together
    changes = 0
    next_save = 1
    while True:
        solve(laws, before, flexible, after, work)
        solves += 1
        if update(laws, flexible, after, work, 1) == 0:
            return FOUND, solves
        if solves == laws.most:
            return LIMIT, solves
        changes += 1
        if all_equal(work.tried, work.saved, m):
            return NONE, solves
        if changes == next_save:  # Brent: of any circle the states of some power of two are met again
            next_save *= 2
            copy(work.tried, work.saved)


def all_equal(states: States, saved: States, m: int) -> bool:
    """Tell whether two sets of states are the same."""
    for r in range(m):  # noqa: SIM110  (numba knows no generators)
        if states[r] != saved[r]:
            return False
    return True


def every_state(laws: Laws, before: Rows, flexible: Flexibility, after: Rows, work: Work) -> Solved:
    """Try all states; take the only ones that agree with their forces, but for rounding.

    Of contacts with dashpots, which may have several (`with_dashpot`), the first ones.
    """
    m = laws.rows
    choices = choices_of(laws, m)
    count = choices**laws.contacts
    solves = laws.together
    consistent = -1
    for number in range(count):
        set_states(laws, work.tried, number, choices, m)
        solve(laws, before, flexible, after, work)
        solves += 1
        if update(laws, flexible, after, work, 0) > 0:
            continue
        if laws.retardation > 0:
            return FOUND, solves
        if consistent < 0:
            consistent = number
            copy(after.force, work.first)
        elif not same_forces(after, work.first):
            return SEVERAL, solves + count - 1 - number
    if consistent < 0:
        return NONE, solves
    set_states(laws, work.tried, consistent, choices, m)
    solve(laws, before, flexible, after, work)
    return FOUND, solves


def choices_of(laws: Laws, rows: int) -> int:
    """Return how many states a contact may be in: open, sticking, slipping in either direction."""
    return 4 if rows > laws.contacts and laws.slips else 2


def set_states(laws: Laws, states: States, number: int, choices: int, rows: int) -> None:
    """Set the states by the digits of a number, the last contact's first."""
    n = laws.contacts
    for i in range(n - 1, -1, -1):
        digit = number % choices
        states[i] = LOWER if digit == 0 else INSIDE
        if rows > n:
            states[n + i] = LOWER if digit == 2 else UPPER if digit == 3 else INSIDE
        number //= choices


def same_forces(after: Rows, first: Vector) -> bool:
    """Tell whether two answers differ by rounding only, as at the very limit of stick and slip."""
    size = 0.0
    apart = 0.0
    for r in range(len(first)):
        size = max(size, abs(first[r]))
        apart = max(apart, abs(first[r] - after.force[r]))
    return bool(apart <= ROUNDING * size)


# ---- other rules of contact ------------------------------------------------------------------------------------------


def with_dashpot(laws: Laws, flexible: Flexibility, after: Rows, work: Work, r: int) -> int:
    """Return the state of a contact with a dashpot beside its spring, clipped: N = max(0, -(k w + c w')), frictionless.

    With tau = c/k it presses as a spring without dashpot would at w + tau w'. It is closed if its gap without its own
    force is negative. The gap itself would be no rule: where the dashpot alone stops the block, it is positive with
    the force and negative without it, and there would be no answer. A closed contact whose force would pull carries
    nothing while its spring relaxes.

    The force jumps where a contact closes. One contact has one answer; two that press each other's gap may have several
    (of random states 0.7 % for a square block, 4 % for a slender one), of which the iteration takes that which it
    reaches from the states before. Where there is none the step is cut.
    """
    force = after.force[r]
    others = flexed(laws, flexible, r, after.force) - flexible.W[r][r] * force
    alone = work.q[r] - work.late[r] + flexible.own[0] * others
    pulls = force < 0 if work.tried[r] == INSIDE else work.z[r] >= 0
    if math.isnan(alone):  # which agrees, and ends the history
        return int(work.tried[r])
    return INSIDE if alone < 0 and not pulls else LOWER


def lagged(laws: Laws, before: Rows, flexible: Flexibility, after: Rows, work: Work) -> Solved:
    """Find the contacts with friction one solve behind and out of the convergence test, as common programs do.

    It is here to be recognised and explained, not to be used. What such programs do (Shi's and those that descend
    from it):

    - the iteration ends when no contact opens or closes any more; stick and slip are not looked at;
    - a slipping contact carries T = -sigma (tan(phi) N + c) with N of the solve before, of the last step in the first;
    - after a solve a sticking contact slips from then on if |T| > tan(phi) N + c, a slipping one sticks if it moved
      against its slip within the step;
    - a slipping contact starts each step without stretch, so that it sticks again from (almost) no shear force.

    A contact that slips too late carries too much, one that sticks again has lost its force: a stable block creeps,
    all the more the smaller the step. Dead bands (`Unilateral.band`) are another matter, and make it worse.
    """
    n = laws.contacts
    for i in range(n):
        work.held[i] = shear_limit(laws, i, before.force[i])
    for solves in range(1, laws.together + 1):
        solve(laws, before, flexible, after, work)
        same = True
        for i in range(n):
            # its own movement within the step decides whether a contact slips on
            moved = after.slip[n + i] + after.opening[n + i] - before.opening[n + i]
            state = across(laws, flexible, after, work, i)
            way = INSIDE
            if state == INSIDE and work.tried[i] == INSIDE:
                way = along(laws, after, work, i, moved, 0.0)
            if state != work.tried[i]:
                same = False
            work.tried[i] = state
            work.tried[n + i] = way
            work.held[i] = shear_limit(laws, i, after.force[i])
        if same:
            for i in range(n):
                begin_anew(before, after, n + i, work.tried[n + i])
            return FOUND, solves
    return NONE, laws.together


def begin_anew(before: Rows, after: Rows, r: int, state: int) -> None:
    """Set state and stretch with which the next step begins under the lagged rules."""
    moved = after.slip[r] + after.opening[r]  # the stretch from the old reference
    if after.state[r] != INSIDE:
        after.opening[r] = moved - before.opening[r] if state == INSIDE else 0.0
        after.slip[r] = moved - after.opening[r]
    elif state != INSIDE:
        after.slip[r] = after.opening[r]
        after.opening[r] = 0.0
    after.state[r] = state


# ---- one solve -------------------------------------------------------------------------------------------------------


def solve(laws: Laws, before: Rows, flexible: Flexibility, after: Rows, work: Work) -> None:
    """Write the rows at the end of the step in the states `work.tried`, whether their forces agree or not."""
    n = laws.contacts
    m = laws.rows
    copy(work.tried, after.state)
    if m == 1:
        after.force[0] = 0.0
        if work.tried[0] == INSIDE:
            after.force[0] = (0.0 - work.q[0]) / (flexible.W[0][0] + laws.compliance[0])
    else:
        closing = 0
        for i in range(m - n):
            work.beta[i] = 1.0
            if before.state[i] == INSIDE or work.tried[i] != INSIDE or work.tried[n + i] != INSIDE:
                continue
            if not is_smooth(laws, i):
                work.closing[closing] = i
                closing += 1
        solve_dense(laws, flexible, after, work, closing)
        if closing > 0:
            find_crossings(laws, before, flexible, after, work, closing)
    compliance = laws.compliance
    damped = laws.retardation > 0
    tried = work.tried
    force = after.force
    for r in range(m):
        after.slip[r] = 0.0
        after.opening[r] = 0.0 - force[r] * compliance[r]  # no sum: a closed row keeps its digits
        if tried[r] != INSIDE:
            write_at_bound(laws, before, after, work, r, work.q[r] + flexed(laws, flexible, r, after.force))
        if damped:
            unretarded(laws, flexible, after, work, r)


def write_at_bound(laws: Laws, before: Rows, after: Rows, work: Work, r: int, z: float) -> None:
    """Write z of a row at a bound, which is its gap, or becomes its slip."""
    if laws.opens[r] == 1:
        after.opening[r] = z
    else:
        i = r - laws.contacts
        if i >= 0 and before.state[i] != INSIDE:
            z *= crossing_share(laws, before.opening[i], i, after.force[i])
        z += laws.compliance[r] * after.force[r]
        after.slip[r] = z
    work.z[r] = z


def unretarded(laws: Laws, flexible: Flexibility, after: Rows, work: Work, r: int) -> None:
    """Write the gap w of a contact with a dashpot in place of w + tau w'.

    w' goes with w, which keeps the digits of a stiff spring's penetration.
    """
    own = flexible.own[0]
    free = work.q[r] - work.late[r]
    if after.state[r] == INSIDE:
        after.opening[r] = own * (after.opening[r] - work.late[r]) + (1 - own) * free
    else:
        after.opening[r] = free + own * flexed(laws, flexible, r, after.force)


def flexed(laws: Laws, flexible: Flexibility, r: int, force: Vector) -> float:
    """Return W_r lambda [m]."""
    m = laws.rows
    W = flexible.W
    total = 0.0
    for s in range(m):
        total += W[r][s] * force[s]
    return float(total)


def solve_dense(laws: Laws, flexible: Flexibility, after: Rows, work: Work, closing: int) -> None:
    """Write the forces for given `work.beta`, and dN/dbeta of the contacts that close."""
    n = laws.contacts
    m = laws.rows
    A = work.A
    right = work.right
    unknown = work.unknown
    size = list_unknown(laws, after, work)
    paired = laws.paired and size > 1 and unknown[size - 2] == 2 and keeps_pair(laws, flexible, work)
    W = flexible.paired if paired else flexible.W
    for a in range(size):
        r = unknown[a]
        row = A[a]
        flexibility = W[r]
        for b in range(size):
            row[b] = flexibility[unknown[b]]
        row[a] += laws.compliance[r] if r < n else laws.compliance[r] / work.beta[r - n]
        right[a][0] = 0.0 - work.q[r]
        for k in range(closing):
            right[a][1 + k] = 1.0 if r == n + work.closing[k] else 0.0
    if paired:
        set_pair(laws, work, size, closing)
    for a in range(size):
        diagonal = abs(A[a][a])
        work.scale[a] = 1 / math.sqrt(diagonal) if diagonal > 0 else 1.0
    for r in range(m):
        if work.tried[r] != INSIDE:
            add_bound(laws, flexible, after, work, size, r)
    eliminate(A, right, work.scale, size, 1 + closing)
    for a in range(size):
        after.force[unknown[a]] = right[a][0]
    if paired:
        total = right[size - 2][0]
        half = right[size - 1][0]
        after.force[2] = total / 2 - half
        after.force[3] = total / 2 + half
    for i in range(m - n):
        r = n + i
        if work.tried[r] != INSIDE and work.tried[i] == INSIDE:
            after.force[r] = work.tried[r] * (friction_of(laws, i) * after.force[i] + work.held[i])
    for k in range(closing):
        i = work.closing[k]
        beta = work.beta[i]
        strength = after.force[n + i] * laws.compliance[n + i] / (beta * beta) if beta > 0 else 0.0
        for j in range(closing):
            work.slope[j][k] = right[work.place[work.closing[j]]][1 + k] * strength


def list_unknown(laws: Laws, after: Rows, work: Work) -> int:
    """List the rows whose forces are unknown, write those of the others that follow no friction; return how many."""
    n = laws.contacts
    size = 0
    for r in range(laws.rows):
        after.force[r] = 0.0
        state = work.tried[r]
        if state == INSIDE and (r < n or holds_along(laws, work, r - n)):
            work.unknown[size] = r
            work.place[r] = size
            size += 1
        elif state != INSIDE and r < n and laws.opens[r] == 0:
            after.force[r] = laws.lower[r] if state == LOWER else laws.upper[r]
    return size


def holds_along(laws: Laws, work: Work, i: int) -> bool:
    """Tell whether the force along the base of a contact that does not slip is unknown."""
    return bool(work.tried[i] == INSIDE and work.beta[i] > 0 and not is_smooth(laws, i))


def add_bound(laws: Laws, flexible: Flexibility, after: Rows, work: Work, size: int, r: int) -> None:
    """Add the force of a row at a bound; that of friction follows N, and the matrix is no longer symmetric."""
    i = r - laws.contacts
    if i < 0:
        for a in range(size):
            work.right[a][0] -= flexible.W[work.unknown[a]][r] * after.force[r]
        return
    if work.tried[i] != INSIDE:
        return
    normal = work.place[i]
    friction = friction_of(laws, i)
    for a in range(size):
        flexibility = work.tried[r] * flexible.W[work.unknown[a]][r]
        work.A[a][normal] += friction * flexibility
        work.right[a][0] -= work.held[i] * flexibility


def friction_of(laws: Laws, i: int) -> float:
    """Return tan(phi) by which T of a slipping contact follows its N beside `work.held`, which may hold the limit."""
    return 0.0 if laws.lagged else float(laws.friction[i])


def keeps_pair(laws: Laws, flexible: Flexibility, work: Work) -> bool:
    """Tell whether the equations of two sticking contacts are those of H = T_M + T_N and G = (T_N - T_M)/2.

    These keep apart the rigid and the elastic flexibility, but mix unequal softnesses: beyond the rigid flexibility
    softness decides, and the contacts' own forces keep the digits.
    """
    first = laws.compliance[2] / work.beta[0]
    second = laws.compliance[3] / work.beta[1]
    return bool(first == second or max(first, second) <= flexible.paired[2][2])


def set_pair(laws: Laws, work: Work, size: int, closing: int) -> None:
    """Write the equations of H and G, which come last."""
    H = size - 2
    G = size - 1
    first = laws.compliance[2] / work.beta[0]
    second = laws.compliance[3] / work.beta[1]
    work.A[H][H] += (first + second) / 4 - first
    work.A[G][G] += first
    work.A[H][G] += (second - first) / 2
    work.A[G][H] += (second - first) / 2
    work.right[H][0] = 0.0 - work.pair[0]
    work.right[G][0] = 0.0 - work.pair[1]
    for k in range(closing):
        work.right[H][1 + k] = 0.5
        work.right[G][1 + k] = -1.0 if work.closing[k] == 0 else 1.0


def unpair_ways(rows: Vector) -> None:
    """Write the ways of two contacts, rows 2 and 3, in the place of their mean and difference."""
    mean = rows[2]
    half = rows[3] / 2
    rows[2] = mean - half
    rows[3] = mean + half


def unpair(paired: Matrix, out: Matrix) -> None:
    """Write a flexibility in the ways of two contacts from that in their mean and difference."""
    for r in range(4):
        for s in range(4):
            out[r][s] = paired[r][s]
    for r in range(4):
        unpair_ways(out[r])
    for s in range(4):
        mean = out[2][s]
        half = out[3][s] / 2
        out[2][s] = mean - half
        out[3][s] = mean + half


# ---- contacts that close ---------------------------------------------------------------------------------------------


def crossing_share(laws: Laws, before: float, i: int, N: float) -> float:
    """Return beta, the share of the step's way behind the crossing.

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
    penetration = N * laws.compliance[i]
    return float(penetration / (before + penetration))


def crossing_rate(laws: Laws, before: float, i: int, N: float) -> float:
    """Return the derivative of `crossing_share` by N [1/N]."""
    if before <= 0 or N <= 0:
        return 0.0
    reach = before + N * laws.compliance[i]
    return float(laws.compliance[i] * before / reach / reach)


def find_crossings(laws: Laws, before: Rows, flexible: Flexibility, after: Rows, work: Work, closing: int) -> None:
    """Solve again with the beta of the contacts that close, by Newton's method; NaN where it does not end."""
    for _ in range(CROSSING_STEPS):
        for k in range(closing):
            i = work.closing[k]
            N = after.force[i]
            work.rate[k] = crossing_rate(laws, before.opening[i], i, N)
            work.newton_right[k][0] = crossing_share(laws, before.opening[i], i, N) - work.beta[i]
        for k in range(closing):
            for j in range(closing):
                identity = 1.0 if j == k else 0.0
                work.newton[k][j] = identity - work.rate[k] * work.slope[k][j]
            work.scale[k] = 1.0
        eliminate(work.newton, work.newton_right, work.scale, closing, 1)
        settled = True
        for k in range(closing):
            i = work.closing[k]
            change = work.newton_right[k][0]
            work.beta[i] = min(max(work.beta[i] + change, 0.0), 1.0)
            if not abs(change) <= CROSSING_CHANGE * work.beta[i]:
                settled = False
        solve_dense(laws, flexible, after, work, closing)
        if settled:
            return
    for i in range(laws.contacts):
        if work.tried[i] == INSIDE:
            after.force[i] = math.nan
