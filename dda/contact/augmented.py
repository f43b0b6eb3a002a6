r"""Augmented Lagrangian: a rigid stop reached by passes over springs (Uzawa), frictionless.

A pass finds the contacts on springs r that are preloaded by the forces of the pass before,

    N = max(0, lam - r w),    w = w_f + C N,    then lam <- N,

beginning with lam = 0 in every step, and the passes end when no contact is pressed deeper than the tolerance. For one
contact every pass leaves 1/(1 + r C) of the penetration, so that it takes ln(|w_f| / tolerance) / ln(1 + r C) of them:
few on springs that are stiff against the step's flexibility, thousands in short steps. The limit is the rigid stop,
N = max(0, -w_f / C), and impacts on it rebound as on that, with no limit for dt -> 0.
"""

from __future__ import annotations

from dda.contact.dense import dot
from dda.contact.kernel import FOUND, UNREACHED, Contacts, Flexible, Free, Law, Work, find_contacts
from dda.contact.unilateral import OPEN


def augmented(
    law: Law,
    penetration: float,
    limit: int,
    before: Contacts,
    free: Free,
    preloaded: Free,
    flexible: Flexible,
    after: Contacts,
    work: Work,
) -> tuple[int, int, int]:
    """Find the contacts at the end of a step; return the outcome, the number of solves and that of passes.

    Parameters
    ----------
    law
        That of the springs r.
    penetration
        The tolerance [m].
    limit
        Passes of a step.
    preloaded
        Room for the gaps at which the preloaded springs are without force.
    """
    n = len(before.gap)
    lam = work.mean
    for i in range(n):
        lam[i] = 0.0
    start = before
    solves = 0
    for number in range(1, limit + 1):
        for i in range(n):
            preloaded.gap[i] = free.gap[i] - lam[i] * law.compliance
        outcome, spent = find_contacts(law, None, start, preloaded, flexible, after, work)
        solves += spent
        if outcome != FOUND:
            return outcome, solves, number
        start = after  # its states are those of the next pass, but for contacts that open
        deepest = 0.0
        for i in range(n):
            if after.state[i] == OPEN:
                after.gap[i] = free.gap[i] + dot(flexible.C[i], after.normal, n)
            else:
                after.gap[i] = (lam[i] - after.normal[i]) * law.compliance
                deepest = max(deepest, 0.0 - after.gap[i])
            lam[i] = after.normal[i]
        if not deepest > penetration:
            return FOUND, solves, number
    return UNREACHED, solves, limit
