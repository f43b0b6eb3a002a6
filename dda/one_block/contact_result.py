"""What can be read from a history on contact that opens: of one block, of its sub-blocks, of a block that turns."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dda.contact.rows import FOUND, INSIDE, OUTCOMES
from dda.contact.unilateral import OPEN, SLIP, STICK
from dda.march.step import History
from dda.model.arrays import Array
from dda.one_block.solution import Result, times_of
from dda.scheme.newmark import Scheme


def lazily(name: str, meaning: str) -> cached_property[Array]:
    """Return the property of a result that is made when it is first asked for."""

    def read(result: ContactResult) -> Array:
        return np.asarray(result.parts[name]())

    read.__doc__ = meaning
    return cached_property(read)


def at_corners(name: str) -> tuple[property, property]:
    """Return the properties of a result that are the corners M and N of another one, which has a row a contact."""
    return (
        property(lambda r: np.asarray(getattr(r, name)[r.base_contacts[0]]), doc=f"{name} at the corner M"),
        property(lambda r: np.asarray(getattr(r, name)[r.base_contacts[1]]), doc=f"{name} at the corner N"),
    )


def of_rows(name: str, along: bool, meaning: str, sign: float = 1.0, shared: bool = False) -> cached_property[Array]:
    """Return the property of a result that its history holds for each row of contact.

    Of a symmetric motion one contact stands for both corners: it is N, and M has the same value with a sign.

    Parameters
    ----------
    along
        Whether the rows along the base are meant, which contacts that slide freely do not have.
    shared
        Whether each corner has its share of the value of one contact.
    """

    def read(result: ContactResult) -> Array:
        n = result.contacts
        rows = getattr(result.history, name)[1:].T / (result.multiplicity if shared else 1.0)
        if name != "slip":  # which only the rows along the base have
            rows = rows[n:] if along else rows[:n]
        values: Array = rows if len(rows) else np.zeros((n, rows.shape[1]))
        return np.array([[sign], [1.0]]) * values + 0.0 if n == 1 else values

    read.__doc__ = meaning
    return cached_property(read)


@dataclass(frozen=True, eq=False)
class ContactResult(Result):
    """Histories of the steps that were reached; element 0 is step 1. Forces act on the block.

    The contacts are, of one block, the corners M and N of its base; of sub-blocks the points of the base in their order
    from M to N, two for each sub-block on it; of a block that turns all corners of its outline. What is no field is
    made when it is first asked for. `solves` counts the small systems of the open-close iteration, the confirming one
    of each step included.
    """

    outcome: str  # "completed", or why the history ends early, in words
    step_solves: NDArray[np.int_]  # solves of each step, repeated and cut ones included
    step_cuts: NDArray[np.int_]  # times that a step was cut
    history: History  # from t = 0 on, by the rows of contact
    contacts: int  # of these; one may stand for both corners
    multiplicity: float  # how many corners it stands for
    base_contacts: tuple[int, int]  # rows of M and N
    softness: float  # 1/p_s, 0 without springs in shear [m/N]
    parts: Mapping[str, Callable[[], Any]]  # makes the displacement along the base and the velocities
    balance: Callable[[], dict[str, Array]] | None  # makes the energies, if they were asked for
    _: KW_ONLY
    impulses: Array | None = None  # P of the rule "impact", (contacts, steps) [N s]
    step_passes: NDArray[np.int_] | None = None  # of the augmented Lagrangian in each step

    normal = of_rows("force", False, "N, away from the base, (contacts, steps) [N].", shared=True)
    shear = of_rows("force", True, "T, along the base from M to N, (contacts, steps) [N].", -1.0, shared=True)
    gap = of_rows("opening", False, "w, negative when pressed, (contacts, steps) [m].")
    slipped = of_rows("slip", True, "Change of the shear reference by slip in each step, (contacts, steps) [m].", -1.0)
    slide = lazily("slide", "Displacement s along the base, less that of the base, (contacts, steps) [m].")
    velocity = lazily("velocity", "Of the centroid, upwards, (steps,) [m/s].")
    horizontal_velocity = lazily("horizontal_velocity", "Of the centroid, (steps,) [m/s].")

    @cached_property
    def stretch(self) -> Array:
        """Stretch s - r of the shear springs, 0 where open, (contacts, steps) [m]."""
        return np.asarray(0.0 - self.shear * self.softness)

    @cached_property
    def states(self) -> NDArray[np.int_]:
        """0 open, 1 closed and not slipping, 2 and -2 slipping towards N and M, (contacts, steps)."""
        rows = self.history.state[1:].T.astype(int)
        closed = rows[: self.contacts] == INSIDE
        states = np.where(closed, STICK, OPEN)
        if len(rows) > self.contacts:
            way = rows[self.contacts :]
            states = np.where(closed & (way != INSIDE), -SLIP * way, states)
        if len(states) == 1:  # one contact for both corners: they slip in opposite directions
            return np.vstack([np.where(np.abs(states) == SLIP, -states, states), states])
        return states

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """Whether the contacts are closed, (contacts, steps)."""
        return np.asarray(self.states != OPEN)

    @cached_property
    def slip(self) -> Array:
        """Largest sum of what the reference of a contact moved while it was pressed, (steps,) [m]."""
        return np.asarray(np.abs(np.cumsum(self.slipped, axis=1)).max(axis=0))

    @cached_property
    def energies(self) -> dict[str, Array] | None:
        """By `ENERGIES` [J], losses summed from t = 0 on; None if not asked for."""
        if self.balance is None:
            return None
        with np.errstate(all="ignore"):
            return self.balance()

    normal_force_m, normal_force_n = at_corners("normal")
    shear_force_m, shear_force_n = at_corners("shear")
    gap_m, gap_n = at_corners("gap")
    slide_m, slide_n = at_corners("slide")
    shear_m, shear_n = at_corners("stretch")
    closed_m, closed_n = at_corners("closed")
    state_m, state_n = at_corners("states")


def run_fields(
    history: History, outcome: int, scheme: Scheme, notes: Sequence[str], clock: tuple[float, float]
) -> dict[str, Any]:
    """Return the fields of a result that are the same for every body.

    Parameters
    ----------
    outcome
        How the history ended, among `dda.contact.rows.OUTCOMES`.
    clock
        When the set-up began, and the steps [s].
    """
    steps = len(history.solves) - 1
    early = () if outcome == FOUND else (f"{OUTCOMES[outcome]} at step {steps + 1}",)
    return {
        **times_of(scheme, steps, *clock),
        "solves": int(history.solves.sum()),
        "notes": (*notes, *early),
        "outcome": OUTCOMES[outcome],
        "history": history,
        "step_solves": history.solves[1:],
        "step_cuts": history.cuts[1:],
    }
