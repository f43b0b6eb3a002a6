"""One finished case as a row, and the values of its metrics."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from validation.runs.run import Outcome

Value = float | str | None  # a number, or "undefined", or "not reported"
Metrics = Mapping[str, Value]  # by their ids


@dataclass(frozen=True)
class Row:
    """One finished case: what was run, how it ended, what it measured and what it cost.

    `metrics` holds numbers, ``"undefined"`` (no meaning here) or ``"not reported"`` (the column is absent);
    `steps` and `columns` are those of the kept history; `provenance` the versions and the commit that made the row.
    """

    key: str
    study: str
    scene: str
    solver: str
    outcome: Outcome
    metrics: Metrics
    work: Mapping[str, int] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    estimate: float | None = None
    steps: int = 0
    columns: tuple[str, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def line(self) -> str:
        """Return the row as one line of JSON, with a digest of what it says."""
        data = dict(vars(self))
        return json.dumps(data | {"digest": _digest(data)}, allow_nan=False)

    @classmethod
    def parse(cls, line: str) -> Row | None:
        """Return the row of a line, or None where it is not as it was written (cut by a kill, damaged, edited)."""
        try:
            data = json.loads(line)
            if data.pop("digest") != _digest(data):
                return None
            known_fields = {
                name: value for name, value in data.items() if name in FIELDS
            }  # another version may say more
            typed = {
                "outcome": Outcome(data["outcome"]),
                "notes": tuple(data["notes"]),
                "columns": tuple(data["columns"]),
            }
            return cls(**known_fields | typed)
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            return None


RowsBySolver = Mapping[str, Row]
FIELDS = frozenset(field.name for field in fields(Row))


def _digest(data: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:16]
