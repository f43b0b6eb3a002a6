r"""What a step on contact that opens takes from the energy, whatever stands on the contacts.

For any Newmark scheme whose accelerations obey M A = F - K0 D + B' lambda at both ends of a step, with
c = alpha - delta/2 and V the velocity after gg,

    E1 - E0 = - (delta - 1/2) dD' K0 dD - c h^2 [ A' M A / 2 ] - (delta - 1/2) c h^2 dA' M dA
              + sum over contacts of U1 - U0 + dw [(1 - delta) N0 + delta N1] + ds [(1 - delta) T0 + delta T1],

[ ] the change over the step and U = N^2/(2 p) + T^2/(2 p_s). A contact that keeps its state is part of the
algorithmic loss, one that opens or closes is a switching loss (negative: a gain). Of what a contact loses that slips,
friction takes -T1 (r1 - r0), never negative; a dashpot beside a spring takes -dw times what it adds to the spring's
force. Where the base moves by y the loads work on x = D + R y, and its own work -lambda' B R y is counted as theirs.
Kinetic damping takes (1 - gg^2) V' M V / 2 of the velocity before gg. What the first step's A0 adds where M A0 was not
F - K0 D0 is algorithmic, too. Of other schemes the algorithmic loss is what the others leave of the balance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dda.contact.dense import Vector
from dda.contact.kernel import Contacts, Law, Shear, spring_energy, spring_force
from dda.contact.unilateral import OPEN, Unilateral
from dda.model.arrays import Array

STORED = ("kinetic", "strain", "springs", "load")
LOST = ("algorithmic", "kinetic damping", "switching", "friction")
ENERGIES = STORED + LOST
ALGORITHMIC, DAMPING, SWITCHING, FRICTION, GIVEN, IMPULSE, CONTACT = range(7)  # of the sums [J, N s]
SUMS = 7
DASHPOT = "dashpot"  # names of the sum `CONTACT` among the energies, where there are dashpots, or impacts
IMPACT = "impact"


def accounted(
    kinetic: Callable[..., float], account_stage: Callable[..., None], add_algorithmic_loss: Callable[..., None]
) -> Callable[..., None]:
    """Return what adds the losses of a part of a step to the sums, as `dda.stepping.driver.driver` takes it.

    Parameters
    ----------
    kinetic
        Returns the kinetic energy of the velocities that a body carries [J]: (body, state).
    account_stage
        Adds what a stage loses beside kinetic damping: (body, shear_law, stage, before, after, part, sums).
    add_algorithmic_loss
        Adds what the step loses beside the contacts, unless the others leave it of the balance (`by_balance` of the
        body): (body, state, after, part, sums).
    """

    def account(body: Any, shear_law: Shear, state: Any, after: Any, part: Any, sums: Vector) -> None:
        """Add what an accepted part of a step loses, and what loads and base give [J]."""
        discount = body.gg**part.ratio
        late_start = body.lag != 0 and part.begun == 0  # a discount leaves of P the momentum of half a step before
        if discount != 1 and not late_start:
            sums[DAMPING] += (1 - discount * discount) * kinetic(body, state)
        before = state
        if body.stages == 2:
            before = body.between
            account_stage(body, shear_law, body.first, state, before, part, sums)
        account_stage(body, shear_law, body.last, before, after, part, sums)
        if not body.by_balance:
            add_algorithmic_loss(body, state, after, part, sums)

    return account


def add_contact_losses(
    law: Law,
    shear_law: Shear,
    before: Contacts,
    after: Contacts,
    slipped: Vector,
    slide: Vector,
    base: Vector,
    late: float,
    length: float,
    share: float,
    sums: Vector,
) -> None:
    """Add what the contacts lose in a part of a step of some length [s], and what the base gives through them [J].

    Parameters
    ----------
    slipped
        Change of each contact's reference by slip [m].
    slide, base
        Displacement of each contact along the base, less that of the base, and of the base along and away from itself.
    late
        Weight of the forces at the end beside those at the beginning.
    share
        Number of contacts that each of these stands for.
    """
    for i in range(len(after.gap)):
        N = (1 - late) * before.normal[i] + late * after.normal[i]
        T = (1 - late) * before.shear[i] + late * after.shear[i]
        friction = 0.0 - after.shear[i] * slipped[i]
        work = N * (after.gap[i] - before.gap[i]) + T * slide[i]
        released = spring_energy(law, shear_law, before, i) - spring_energy(law, shear_law, after, i)
        lost = released - work - friction
        if law.damping > 0:
            spring = (1 - late) * spring_force(law, before, i) + late * spring_force(law, after, i)
            dashpot = (spring - N) * (after.gap[i] - before.gap[i])
            lost -= dashpot
            sums[CONTACT] += share * dashpot
        keeps_state = (before.state[i] == OPEN) == (after.state[i] == OPEN)
        sums[ALGORITHMIC if keeps_state else SWITCHING] += share * lost
        sums[FRICTION] += share * friction
        sums[GIVEN] += share * (N * base[1] + T * base[0])
        sums[IMPULSE] += share * length * N


def bulk_loss(alpha: float, delta: float, h2: float, stiff: float, kinetic: float, kinetic_of_change: float) -> float:
    """Return the algorithmic loss without contact [J].

    Parameters
    ----------
    stiff
        dD' K0 dD [J].
    kinetic, kinetic_of_change
        [A' M A / 2], and dA' M dA / 2 [J/s^2].
    """
    over = delta - 0.5
    return over * stiff + (alpha - delta / 2) * h2 * (kinetic + 2 * over * kinetic_of_change)


def spring_energies(law: Unilateral, normal: Array, shear: Array) -> Array:
    """Return the energy of the springs of all contacts after every step, whose rows the forces have [J]."""
    energies: Array = np.sum(normal**2 * law.compliance + shear**2 * law.softness, axis=1) / 2
    return energies


def energies_of(stored: Sequence[Array], sums: Array, by_balance: bool) -> dict[str, Array]:
    """Return the energies by `ENERGIES` [J] after every step, losses summed from t = 0 on.

    Parameters
    ----------
    stored
        Kinetic energy, strain energy, that of the springs and that of the load without what the base gave, from t = 0
        on, (steps + 1,) each.
    sums
        (steps + 1, SUMS) of the steps.
    by_balance
        Whether the algorithm loses what the others leave of the total.
    """
    kinetic, strain, springs, load = stored
    load = load - sums[:, GIVEN]
    algorithmic = sums[:, ALGORITHMIC]
    damped = sums[:, DAMPING]
    switching = sums[:, SWITCHING]
    friction = sums[:, FRICTION]
    if by_balance:
        total = kinetic + strain + springs + load
        algorithmic = total[0] - total - damped - switching - friction - sums[:, CONTACT]
    parts = (kinetic, strain, springs, load, algorithmic, damped, switching, friction)
    return {name: part[1:] for name, part in zip(ENERGIES, parts, strict=True)}
