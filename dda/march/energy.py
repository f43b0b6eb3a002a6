r"""The energies of a history, by name, and what a step loses without contact.

For any Newmark scheme whose accelerations obey M A = F - K D + B' lambda at both ends of a step, with
c = alpha - delta/2, V the velocity after gg and ways y of the rows,

    E1 - E0 = - (delta - 1/2) dD' K dD - c h^2 [ A' M A / 2 ] - (delta - 1/2) c h^2 dA' M dA
              + sum over rows of U1 - U0 + dy [(1 - delta) lambda0 + delta lambda1],

[ ] the change over the step and U = lambda^2 c / 2. A contact that keeps its state is part of the algorithmic loss, one
that opens or closes is a switching loss (negative: a gain). Of what a row loses that slips, friction takes
-lambda1 times its slip, never negative; a dashpot beside a spring takes -dy times what it adds to the spring's force.
Where the base moves its work is counted as that of the loads. Kinetic damping takes (1 - gg^2) V' M V / 2 of the
velocity before gg. What the first step's A0 adds where M A0 was not F - K D0 is algorithmic, too. Of other schemes the
algorithmic loss is what the others leave of the balance.
"""

from __future__ import annotations

from collections.abc import Sequence

from dda.model.arrays import Array, Columns

STORED = ("kinetic", "strain", "springs", "load")
LOST = ("algorithmic", "kinetic damping", "switching", "friction")
ENERGIES = STORED + LOST
ALGORITHMIC, DAMPING, SWITCHING, FRICTION, GIVEN, IMPULSE, CONTACT = range(7)  # of the sums [J, N s], `LOST` first
SUMS = 7
DASHPOT = "dashpot"  # names of the sum `CONTACT` among the energies, where there are dashpots, or impacts
IMPACT = "impact"


def bulk_loss(alpha: float, delta: float, h2: float, stiff: float, kinetic: float, kinetic_of_change: float) -> float:
    """Return the algorithmic loss without contact [J].

    Parameters
    ----------
    stiff
        dD' K dD [J].
    kinetic, kinetic_of_change
        [A' M A / 2], and dA' M dA / 2 [J/s^2].
    """
    over = delta - 0.5
    return over * stiff + (alpha - delta / 2) * h2 * (kinetic + 2 * over * kinetic_of_change)


def energies_of(stored: Sequence[Array], sums: Array, by_balance: bool) -> Columns:
    """Return the energies by `ENERGIES` [J] from t = 0 on, (steps + 1,) each, losses summed.

    Parameters
    ----------
    stored
        Kinetic energy, strain energy, that of the springs and that of the load without what was given, from t = 0 on,
        (steps + 1,) each.
    sums
        (steps + 1, SUMS) of the steps.
    by_balance
        Whether the algorithm loses what the others leave of the total.
    """
    parts = dict(zip(ENERGIES, [*stored, *sums.T[: len(LOST)]], strict=True))
    parts["load"] = parts["load"] - sums[:, GIVEN]
    if by_balance:
        total = sum(parts[name] for name in STORED)
        parts["algorithmic"] = total[0] - total
        for loss in (DAMPING, SWITCHING, FRICTION, CONTACT):
            parts["algorithmic"] -= sums[:, loss]
    return parts
