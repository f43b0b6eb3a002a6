"""One alarm: a result that looks better than it is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from validation.runs.beside import table_beside
from validation.runs.numbers import significant
from validation.runs.records import AlarmRecord
from validation.runs.row import Row, RowsBySolver
from validation.runs.texts import FILLED
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

SENTENCES: dict[str, str] = table_beside(__file__, "alarms.toml")


@dataclass(frozen=True)
class Alarm:
    """One alarm on one case, with the numbers behind it and a sentence."""

    kind: str
    scene: str
    sentence: str
    values: Mapping[str, float] = field(default_factory=dict)

    def record(self) -> AlarmRecord:
        """Return plain data, numbers rounded well above the last bits."""
        rounded = {key: significant(value, 4) for key, value in self.values.items()}
        return {"kind": self.kind, "scene": self.scene, "sentence": self.sentence, "values": rounded}


def alarm(kind: str, scene: str, values: Mapping[str, float] | None = None, **words: object) -> Alarm:
    """Return an alarm with the sentence of its kind, made of its numbers and of further words."""
    numbers = values or {}
    sentence = FILLED.vformat(SENTENCES[kind], (), {**numbers, **words})
    return Alarm(kind, scene, sentence, {name: value for name, value in numbers.items() if math.isfinite(value)})


def first_row(rows: RowsBySolver, role: Role) -> Row | None:
    """Return the row of the solver of the highest rank of a role that has one."""
    return next((rows[name] for name in by_role(role) if name in rows), None)


def number(row: Row | None, metric: str) -> float | None:
    """Return a number of a run; None where it has none."""
    value = None if row is None else row.metrics.get(metric)
    return value if isinstance(value, float) else None
