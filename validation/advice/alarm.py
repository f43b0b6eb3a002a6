"""One alarm: a result that looks better than it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from validation.runs.records import AlarmRecord


@dataclass(frozen=True)
class Alarm:
    """One alarm on one case, with the numbers behind it and a sentence."""

    kind: str
    scene: str
    sentence: str
    values: Mapping[str, float] = field(default_factory=dict)

    def record(self) -> AlarmRecord:
        """Return plain data, numbers rounded well above the last bits."""
        rounded = {key: float(f"{value:.4g}") for key, value in self.values.items()}
        return {"kind": self.kind, "scene": self.scene, "sentence": self.sentence, "values": rounded}
