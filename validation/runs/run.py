"""Runs and their outcomes: what every solver gives back."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from validation.runs.history import Array, History


class WordWithSentence(enum.StrEnum):
    """A word with its `sentence` for a table or a report."""

    _value_: str
    sentence: str

    def __new__(cls, word: str, sentence: str = "") -> Self:
        """Make the word, by which it is found and written; who looks one up gives no sentence."""
        member = str.__new__(cls, word)
        member._value_ = word
        member.sentence = sentence
        return member


class Outcome(WordWithSentence):
    """How a run ended; `sentence` says it in words."""

    COMPLETED = "completed", "The run reached its last step with finite numbers."
    OVERFLOW = "overflow", "The numbers left the range of double precision."
    UNSTABLE = (
        "unstable as predicted",
        "The step exceeds the stability limit of the scheme and the numbers grew as predicted.",
    )
    MISPREDICTED = (
        "unstable, not as predicted",
        "The step exceeds the stability limit of the scheme and the numbers grew at another rate.",
    )
    UNBOUNDED = (
        "unbounded growth",
        "The motion is a thousand times beyond what the load and the energy at the start can drive; use a smaller step "
        "or another scheme.",
    )
    NOT_A_NUMBER = "not a number", "The history holds values that are not numbers."
    WRONG_SHAPE = "wrong shape", "The history does not hold one value for each step of the scene."
    WRONG_UNITS = "wrong units", "The history has wrong units or a wrong sign."
    NO_CONTACT_STATE = (
        "no consistent contact state",
        "No contact state is consistent, not even over a hundredth of the step; use a smaller step.",
    )
    SEVERAL_CONTACT_STATES = (
        "several consistent contact states",
        "Several contact states are consistent, even over a hundredth of the step; use a smaller step.",
    )
    TOO_MANY_CONTACTS = (
        "more contacts than there is room for",
        "Blocks touch at more places than there is room for, eight of a block; cut their outlines into fewer corners.",
    )
    TOO_DEEP = (
        "a corner deeper in a block than a step can bring it",
        "A corner lies deeper in a block than a step can bring it and springs let it be pressed; use a smaller step or "
        "stiffer springs.",
    )
    SOLVE_LIMIT = (
        "solve limit exceeded",
        "The open-close iteration of a step needs more solves than its limit; allow one more than there are contacts.",
    )
    PASS_LIMIT = (
        "pass limit exceeded",
        "The passes of the augmented Lagrangian did not reach its penetration within their limit; use a stiffer "
        "penalty, a greater penetration or a longer step.",
    )
    HORIZON = (
        "exact up to a horizon",
        "The exact motion could be followed up to an instant only, its horizon; run no more steps than lead there.",
    )
    RAISED = "raised", "The solver raised an error."
    TIMEOUT = "timeout", "The solver did not finish within its time limit."
    REFUSED = "refused", "The scene asks for something that the solver must refuse."
    NOT_APPLICABLE = "not applicable", "The solver does not apply to this scene."
    NOT_RUN = "not run", "Software that the solver needs is not installed."


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
