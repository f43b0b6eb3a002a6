"""What a unilateral contact and the block above it did at each step, alike for every solver."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from validation.runs.history import Array

STORED = ("kinetic", "strain", "springs", "load")  # J; of the loads -F x
# J, summed from t = 0 on; negative where energy was gained, as no friction does
LOST = ("algorithmic", "kinetic damping", "switching", "friction")
LOST_AT_IMPACTS = ("dashpot", "impact")  # J, likewise, of the contacts that have one


@dataclass(frozen=True)
class Rebound:
    """One contact of one corner: the rates of its gap before it closes and after it opens."""

    closing: float  # rate at which the gap closes, positive [m/s]
    opening: float | None  # rate at which it opens again [m/s]; None where that is not seen within the run

    @property
    def restitution(self) -> float | None:
        """Opening over closing rate [-]; None where it does not open again."""
        return None if self.opening is None else self.opening / self.closing


@dataclass(frozen=True)
class ContactRecord:
    """A run's contact over time, arrays of the shape (steps,), element 0 of step 1; None or empty where not given."""

    time: Array  # of the steps [s]
    force: Array  # sum of the normal forces on the block [N]
    impulse: Array  # its integral from t = 0 on [N s]
    penetration: Array  # largest one of any corner or point of the base [m], not negative
    gap: Array  # likewise
    open_share: Array  # of the corners, or of the base, that carries nothing [-]
    start_velocity: float  # of the centre of mass at t = 0, upwards [m/s]
    start_energy: float  # kinetic energy at t = 0 [J]
    input_energy: float  # that and what the loads put in statically, as the scale of changes [J]
    velocity: Array | None = None  # of the centre of mass, upwards [m/s]
    rebounds: tuple[Rebound, ...] | None = None  # contacts that begin within the run, in the order of their beginning
    energies: Mapping[str, Array] = field(default_factory=dict)  # by `STORED`, `LOST` and `LOST_AT_IMPACTS` [J]
    solves: Array | None = None  # of the open-close iteration of each step [-]
    cuts: Array | None = None  # of each step [-]
    slip: Array | None = None  # largest way that any corner or point has slipped from its start [m]


def rebounds_of_steps(gap: Array, step: float) -> list[tuple[int, Rebound]]:
    """Return the contacts of one corner, seen from step to step, each with the index of its first closed step.

    `gap` is that of the corner at each step, negative where it is closed [m], `step` is dt [s]. The rate before is that
    of the last step without contact, that after is that of the first step which begins and ends without contact: no
    contact force has entered either. A contact without such a step before it is left out.
    """
    closed = gap <= 0
    edges = [*(np.flatnonzero(np.diff(closed)) + 1), len(gap)]
    rebounds = []
    for first, last in itertools.pairwise(edges):
        if closed[first] and first >= 2 and not closed[first - 2] and gap[first - 1] < gap[first - 2]:
            free = last + 2 < len(gap) and not closed[last : last + 3].any()
            after = float(gap[last + 2] - gap[last + 1]) / step if free else None
            rebounds.append((int(first), Rebound(float(gap[first - 2] - gap[first - 1]) / step, after)))
    return rebounds
