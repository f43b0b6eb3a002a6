"""One finished case as a row, and the values of its metrics."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field

from validation.runs.run import Outcome

Value = float | str | None  # a number, or "undefined", or "not reported"


@dataclass(frozen=True)
class Row:
    """One finished case: what was run, how it ended, what it measured and what it cost.

    `metrics` holds numbers, ``"undefined"`` (no meaning here) or ``"not reported"`` (the column is absent).
    """

    key: str
    study: str
    scene: str
    solver: str
    outcome: Outcome
    metrics: Mapping[str, Value]
    work: Mapping[str, int] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    estimate: float | None = None

    def line(self) -> str:
        """Return the row as one line of JSON."""
        return json.dumps(asdict(self), allow_nan=False)

    @classmethod
    def parse(cls, line: str) -> Row | None:
        """Return the row of a line, or None where the line is not whole (a run was killed while writing)."""
        try:
            data = json.loads(line)
            return cls(**data | {"outcome": Outcome(data["outcome"]), "notes": tuple(data["notes"])})
        except (ValueError, TypeError, KeyError):
            return None
