r"""Rigid contact with a coefficient of restitution, by impulses: the law of Moreau and Jean, frictionless.

A contact that would be closed half a step on, w + h w'/2 <= 0 with the rate w' at the start of the step, keeps
Newton's law of restitution with an impulse P over the step,

    w'_1 + e w' >= 0,    P >= 0,    P (w'_1 + e w') = 0,    w'_1 = w'_f + G P,

a linear complementarity problem for the rates (w'_f is the rate at the end without impulses); all others have P = 0.
So e is exact at every step and every phase. The gap itself is in no law: what a landing has left of penetration, up to
V h, stays (drift). With several contacts e is that of each, as Newton has it: an impulse at one corner changes the rate
of the other, which then may leave faster than by e times its own.

M. Jean, The non-smooth contact dynamics method, 1999; J. J. Moreau, Numerical aspects of the sweeping process, 1999.
"""

from __future__ import annotations

from dda.contact.dense import Vector
from dda.contact.kernel import Contacts, Flexible, Free, Law, Work, find_contacts
from dda.contact.unilateral import OPEN, STICK

FAR = 1e300  # m/s, of a contact that no impulse reaches


def impulses(
    law: Law,
    restitution: float,
    length: float,
    before: Contacts,
    rate: Vector,
    free: Free,
    flexible: Flexible,
    after: Contacts,
    work: Work,
) -> tuple[int, int]:
    """Write the impulses into `after.normal` [N s], w'_1 + e w' into `after.gap` [m/s]; return outcome and solves.

    Parameters
    ----------
    law
        That of a rigid stop, for the rates.
    length
        h [s].
    before
        The contacts at the start of the step.
    rate
        w' at the start of the step [m/s].
    free
        In its gaps w'_f [m/s]; changed.
    flexible
        In C: G [m/s per N s].
    """
    for i in range(len(rate)):
        near = is_near(before.gap[i], rate[i], length)
        after.state[i] = STICK if near else OPEN
        free.gap[i] = free.gap[i] + restitution * rate[i] if near else FAR
    return find_contacts(law, None, after, free, flexible, after, work)


def is_near(gap: float, rate: float, length: float) -> bool:
    """Tell whether a contact would be closed half a step on."""
    return bool(gap + length * rate / 2 <= 0)
