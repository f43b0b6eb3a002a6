"""Runs and their outcomes: what every solver gives back."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field

from validation.runs.history import Array, History


class Outcome(enum.StrEnum):
    """How a run ended; `sentence` says it in words."""

    COMPLETED = "completed"
    OVERFLOW = "overflow"
    UNSTABLE = "unstable as predicted"
    MISPREDICTED = "unstable, not as predicted"
    NOT_A_NUMBER = "not a number"
    WRONG_SHAPE = "wrong shape"
    WRONG_UNITS = "wrong units"
    NO_CONTACT_STATE = "no consistent contact state"
    SEVERAL_CONTACT_STATES = "several consistent contact states"
    RAISED = "raised"
    TIMEOUT = "timeout"
    REFUSED = "refused"
    NOT_APPLICABLE = "not applicable"
    NOT_RUN = "not run"

    @property
    def sentence(self) -> str:
        """One sentence for a table or a report."""
        return _SENTENCES[self]


_SENTENCES = {
    Outcome.COMPLETED: "The run reached its last step with finite numbers.",
    Outcome.OVERFLOW: "The numbers left the range of double precision.",
    Outcome.UNSTABLE: "The step lies beyond the limit of the scheme and the numbers grew as predicted.",
    Outcome.MISPREDICTED: "The step lies beyond the limit of the scheme and the numbers grew at another rate.",
    Outcome.NOT_A_NUMBER: "The history holds values that are not numbers.",
    Outcome.WRONG_SHAPE: "The history does not hold one value for each step of the scene.",
    Outcome.WRONG_UNITS: "The history is in other units or has another sign.",
    Outcome.NO_CONTACT_STATE: "No state of the contacts fits the step, not even a hundredth of it; use a smaller step.",
    Outcome.SEVERAL_CONTACT_STATES: "Several states of the contacts fit a hundredth of the step; use a smaller step.",
    Outcome.RAISED: "The solver raised an error.",
    Outcome.TIMEOUT: "The solver did not finish within its time limit.",
    Outcome.REFUSED: "The scene asks for what the solver must refuse.",
    Outcome.NOT_APPLICABLE: "The solver does not apply to this scene.",
    Outcome.NOT_RUN: "A part that the solver needs is not installed.",
}


@dataclass(frozen=True)
class Run:
    """A history with its outcome, its work and its error estimate.

    `work` counts unknowns, nonzeros, factorisations, solves and steps; `seconds` holds setup and stepping [s].
    """

    outcome: Outcome
    history: History | None = None
    work: Mapping[str, int] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    estimate: float | None = None  # estimated relative error of the run's own numerics [1]

    def _finished(self) -> History:
        if self.history is None:
            raise ValueError(f"no history: {self.outcome.sentence} {' '.join(self.notes)}".strip())
        return self.history

    @property
    def time(self) -> Array:
        """Times of the steps [s]."""
        return self._finished().time

    @property
    def displacement(self) -> Array:
        """Vertical displacement v of the centroid point [m]."""
        return self._finished().displacement

    @property
    def contact_pressure(self) -> Array:
        """Mean contact pressure [Pa], positive in compression."""
        return self._finished().contact_pressure
