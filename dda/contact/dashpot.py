r"""A dashpot c beside each penalty spring, clipped: N = max(0, -(k w + c w')) at the end of the step, frictionless.

With tau = c/k a contact presses as a spring without dashpot would at y = w + tau w'. Forces change the gaps by C N
and their rates by C' N, so that

    y = y_f + (C + tau C') N,    N = max(0, -k y)    where the contact is closed,

and it is closed if its gap without its own force, w_i - C_ii N_i, is negative. The gap w_i itself would be no rule:
where the dashpot alone stops the block, w_i > 0 with the force and w_i < 0 without it, and there would be no answer. A
closed contact whose force would pull carries nothing while its spring relaxes.

The force jumps where a contact closes. One contact has one answer; two that press each other's gap may have several (of
random states 0.7 % for a square block, 4 % for a slender one), of which the iteration takes that which it reaches from
the states before. Where there is none the step is cut.
"""

from __future__ import annotations

from dda.contact.dense import copy, dot
from dda.contact.kernel import FOUND, NONE, Contacts, Flexible, Free, Law, Work, set_states, trial
from dda.contact.unilateral import OPEN, STICK


def damped(
    law: Law,
    before: Contacts,
    free: Free,
    retarded: Free,
    flexible: Flexible,
    retarded_flexible: Flexible,
    after: Contacts,
    work: Work,
) -> tuple[int, int]:
    """Find the contacts at the end of a step; return the outcome and the number of solves.

    Parameters
    ----------
    free, flexible
        Gaps w_f of a step without contact forces, and C [m], [m/N].
    retarded, retarded_flexible
        The same of y = w + tau w'; `retarded.slide` holds tau w'_f.
    """
    n = len(before.gap)
    copy(before.state, work.tried)
    solves = 0
    for _ in range(law.limit):
        trial(law, None, before, retarded, retarded_flexible, after, work)
        solves += 1
        if set_closed(free, flexible, after, work) == 0:
            return FOUND, solves
    for number in range(2**n):
        set_states(work.tried, number, 2, n)
        trial(law, None, before, retarded, retarded_flexible, after, work)
        solves += 1
        if set_closed(free, flexible, after, work) == 0:
            return FOUND, solves
    return NONE, solves


def set_closed(free: Free, flexible: Flexible, after: Contacts, work: Work) -> int:
    """Set the states that the law makes of the tried ones; return how many differ. NaN agrees, and ends the history."""
    wrong = 0
    n = len(after.gap)
    for i in range(n):
        without_own_force = free.gap[i] + dot(flexible.C[i], after.normal, n) - flexible.C[i][i] * after.normal[i]
        state = STICK if without_own_force < 0 and not would_pull(after, i) else OPEN
        if state != after.state[i]:
            wrong += 1
        work.tried[i] = state
    return wrong


def would_pull(after: Contacts, i: int) -> bool:
    """Tell whether spring and dashpot of a contact would pull: of an open one by y."""
    if after.state[i] == STICK:
        return bool(after.normal[i] < 0)
    return bool(after.gap[i] >= 0)


def set_gaps(slope: float, free: Free, retarded: Free, flexible: Flexible, after: Contacts) -> None:
    """Write the gaps w in place of y.

    Parameters
    ----------
    slope
        r = tau C'/C: w' goes with w as w' = w'_f + (r/tau) (w - w_f), so that w = (y - tau w'_f + r w_f) / (1 + r)
        keeps the digits of a stiff spring's penetration; 0 where forces do not move the gap within the step.
    """
    n = len(after.gap)
    for i in range(n):
        if after.state[i] == STICK and slope > 0:
            after.gap[i] = (after.gap[i] - retarded.slide[i] + slope * free.gap[i]) / (1 + slope)
        else:
            after.gap[i] = free.gap[i] + dot(flexible.C[i], after.normal, n)
