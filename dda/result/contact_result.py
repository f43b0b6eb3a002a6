"""What can be read from a history on contact that opens: of one block, of its sub-blocks, of a block that turns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dda.contact.rows import FOUND, INSIDE, OUTCOMES
from dda.contact.unilateral import OPEN, SLIP, STICK
from dda.march.step import History
from dda.model.arrays import Array, Columns
from dda.result.result import Result, times_of
from dda.scheme.newmark import Scheme


@dataclass(frozen=True, eq=False, kw_only=True)
class MarchResult(Result):
    """Histories of the steps that were reached; element 0 is step 1.

    `solves` counts the small systems of the open-close iteration, the confirming one of each step included.
    """

    outcome: str  # "completed", or why the history ends early, in words
    history: History  # from t = 0 on, by the rows of contact
    balance: Callable[[], Columns] | None  # makes the energies from t = 0 on, if they were asked for

    @property
    def step_solves(self) -> NDArray[np.int_]:
        """Solves of each step, repeated and cut ones included, (steps,)."""
        return np.asarray(self.history.solves[1:])

    @property
    def step_cuts(self) -> NDArray[np.int_]:
        """Times that each step was cut, (steps,)."""
        return np.asarray(self.history.cuts[1:])

    @cached_property
    def energies(self) -> Columns | None:
        """By `ENERGIES` [J, of a column J/m^2], (steps,), losses summed from t = 0 on; None if not asked for."""
        if self.balance is None:
            return None
        with np.errstate(all="ignore"):
            return {name: values[1:] for name, values in self.balance().items()}


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactResult(MarchResult):
    """Histories of the contacts; forces act on the block.

    The contacts are, of one block, the corners M and N of its base; of sub-blocks the points of the base in their order
    from M to N, two for each sub-block on it; of a block that turns all corners of its outline. What is no field is
    made when it is first asked for.
    """

    contacts: int  # of these; one may stand for both corners: it is N, and M has the same values
    multiplicity: float = 1.0  # how many corners it stands for
    base_contacts: tuple[int, int]  # rows of M and N
    make_slide: Callable[[], Array]
    make_velocity: Callable[[], Array]
    step_passes: NDArray[np.int_] | None = None  # of the augmented Lagrangian in each step

    def across(self, values: Array) -> Array:
        """Return what a row of each contact across the base holds at every step, (contacts, steps)."""
        rows: Array = values[1:, : self.contacts].T
        return np.vstack([rows, rows]) if self.contacts == 1 else rows

    def along(self, values: Array) -> Array:
        """Return the same along the base, zero without such rows; one contact is that of a symmetric motion."""
        rows: Array = values[1:].T
        if not len(rows):
            rows = np.zeros((self.contacts, rows.shape[1]))
        return np.vstack([-rows, rows]) + 0.0 if self.contacts == 1 else rows

    @cached_property
    def normal(self) -> Array:
        """N, away from the base, (contacts, steps) [N]."""
        return self.across(self.history.force) / self.multiplicity + 0.0

    @cached_property
    def shear(self) -> Array:
        """T, along the base from M to N, (contacts, steps) [N]."""
        return self.along(self.history.force[:, self.contacts :]) / self.multiplicity

    @cached_property
    def gap(self) -> Array:
        """w, negative when pressed, (contacts, steps) [m]."""
        return self.across(self.history.opening)

    @cached_property
    def slipped(self) -> Array:
        """Change of the shear reference by slip in each step, (contacts, steps) [m]."""
        return self.along(self.history.slip)

    @cached_property
    def slide(self) -> Array:
        """Displacement s along the base, less that of the base, (contacts, steps) [m]."""
        return self.make_slide()

    @cached_property
    def _velocity(self) -> Array:
        return self.make_velocity()

    @property
    def velocity(self) -> Array:
        """Of the centroid, upwards, (steps,) [m/s]."""
        return np.asarray(self._velocity[1])

    @property
    def horizontal_velocity(self) -> Array:
        """Of the centroid, (steps,) [m/s]."""
        return np.asarray(self._velocity[0])

    @cached_property
    def states(self) -> NDArray[np.int_]:
        """0 open, 1 closed and not slipping, 2 and -2 slipping towards N and M, (contacts, steps)."""
        state = self.history.state.astype(int)
        closed = self.across(state) == INSIDE
        way = np.asarray(self.along(state[:, self.contacts :]), dtype=int)
        return np.where(closed, np.where(way != INSIDE, -SLIP * way, STICK), OPEN)

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """Whether the contacts are closed, (contacts, steps)."""
        return np.asarray(self.states != OPEN)

    @cached_property
    def slip(self) -> Array:
        """Largest sum of what the reference of a contact moved while it was pressed, (steps,) [m]."""
        return np.asarray(np.abs(np.cumsum(self.slipped, axis=1)).max(axis=0))


def run_fields(
    history: History, outcome: int, scheme: Scheme, notes: Sequence[str], clock: tuple[float, float]
) -> dict[str, Any]:
    """Return the fields of a result that are the same for every body.

    The outcome is among `dda.contact.rows.OUTCOMES`; the clock has when set-up and steps began [s].
    """
    steps = len(history.solves) - 1
    early = () if outcome == FOUND else (f"{OUTCOMES[outcome]} at step {steps + 1}",)
    return {
        **times_of(scheme, steps, *clock),
        "solves": int(history.solves.sum()),
        "notes": (*notes, *early),
        "outcome": OUTCOMES[outcome],
        "history": history,
    }
