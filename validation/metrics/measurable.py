"""What the metrics of one run see."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from validation.metrics.poles import Pole, poles
from validation.metrics.values import NOT_REPORTED, UNDEFINED
from validation.runs.contact import ContactRecord
from validation.runs.history import DISPLACEMENT, Array, History
from validation.runs.modes import Mode, Switch
from validation.runs.row import Value
from validation.runs.run import Outcome


@dataclass(frozen=True)
class Measurable:
    """A history and what the solver reports beside it; what is not reported is empty."""

    history: History
    step: float  # dt [s]
    static: Mapping[str, float] = field(default_factory=dict)  # column to value at rest
    modes: tuple[Mode, ...] = ()
    static_reported: bool = True  # otherwise `static` is another solver's, and settling is measured from that
    diagnostics: Mapping[str, float] = field(default_factory=dict)
    outcome: Outcome = Outcome.COMPLETED
    switches: tuple[Switch, ...] | None = None  # of a unilateral contact
    contact: ContactRecord | None = None  # of a unilateral contact
    shadow: Callable[[], History | None] | None = None  # runs the scene again with p (1 + 1e-12)
    limit: Callable[[], Value] | None = None  # finds the largest w dt without growth

    def column(self, name: str) -> Array | None:
        """Return a column of the history, None where it has none or no step."""
        x = self.history.columns.get(name)
        return None if x is None or len(x) == 0 else x

    @cached_property
    def pole(self) -> Pole | str:
        """Strongest oscillating pole of the displacement about its static value."""
        x = self.history.columns.get(DISPLACEMENT)
        static = self.static.get(DISPLACEMENT)
        if x is None or static is None:
            return NOT_REPORTED
        if static == 0 or not np.all(np.isfinite(x)):
            return UNDEFINED
        strongest_first = poles(x / static - 1, self.step)
        return strongest_first[0] if strongest_first else UNDEFINED
