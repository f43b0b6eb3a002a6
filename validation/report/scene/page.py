"""The description of a scene: its model, its steps, and the numbers that follow, before anything runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from validation.advice.plain import Line
from validation.report.blocks import Blocks, Callout, Listing, TableColumn, table
from validation.report.scene import numbers
from validation.report.scene.drawing import drawing
from validation.report.scene.hooks import Number, ShowingHooks
from validation.runs.numbers import stated_text
from validation.scenes import features
from validation.scenes.keys import described, stated
from validation.scenes.plausibility import plausibility_warnings
from validation.scenes.scene import Scene

WRITTEN = {  # keys of `contact`, `damping` and `run` that have words of their own
    *("law", "stiffness", "shear_stiffness", "friction", "cohesion", "rule", "gap"),
    *("mass", "solvers", "columns"),
}
SWEPT_VALUES = 6  # of a key that are shown


@dataclass(frozen=True)
class SceneDescription:
    """What is known of a scene before anything runs."""

    cases: Sequence[Scene]  # of very many a choice
    count: int  # of all cases
    varied: Mapping[str, Sequence[str]]  # the values of each varied key, as text
    solvers: Sequence[str]
    gates: int = 0  # of its own

    @classmethod
    def of(cls, scene: Scene) -> SceneDescription:
        """Return the description of a scene and its sweep."""
        varied = {key: [*map(stated_text, values)] for key, values in scene.sweep.items() if key != "mode"}
        return cls(numbers.cases(scene), len(scene.expand()), varied, scene.run.solvers, len(scene.gate))

    @cached_property
    def numbers(self) -> list[list[Number]]:
        """The derived numbers of each case."""
        return [numbers.numbers(case) for case in self.cases]

    @property
    def remarks(self) -> Counter[str]:
        """How many cases lie beyond each limit."""
        counts: Counter[str] = Counter()
        for case, case_numbers in zip(self.cases, self.numbers, strict=True):
            counts.update(numbers.remarks(case, case_numbers))
        return counts

    def blocks(self, width: int | None = None) -> Blocks:
        """Return the model, the numbers with their range, and the limits that cases lie beyond."""
        sample = len(self.cases)
        caption = ""
        if self.count > 1:
            of_all = f"{sample} of {self.count}" if sample < self.count else f"all {self.count}"
            caption = f"over {of_all} cases of the sweep (the first one is above):"
        rows = []
        for name, (low, high, number) in numbers.ranges(self.numbers).items():
            ends = dict.fromkeys((f"{low:.4g}", f"{high:.4g}"))
            rows.append((name, " .. ".join(ends), number.unit, number.says))
        return [
            Listing("\n".join(drawing(self.cases[0], width))),
            table(("", TableColumn("", "fill")), list(self._facts())),
            table(("", TableColumn("value"), "", TableColumn("what it is", "fill")), rows, caption),
            *(
                Callout(f"{text} (in {count} of {sample} cases)" if sample > 1 else text, "warn")
                for text, count in self.remarks.items()
            ),
        ]

    def _facts(self) -> Iterator[Line]:
        """Yield steps and scheme of the first case, what the scene varies and is run with."""
        first = self.cases[0]
        yield from ShowingHooks.of(first).stepping(first)
        if others := list(_other_keys(first)):
            yield "keys", ", ".join(others)
        if scene_features := features.of(first):
            yield "features", ", ".join(scene_features)
        for field, values in self.varied.items():
            more = f", ... ({len(values)})" if len(values) > SWEPT_VALUES else ""
            yield "varied", f"{field} = {', '.join(values[:SWEPT_VALUES])}{more}"
        case_count = f"; {self.count} cases" if self.count > 1 else ""
        yield "solvers", f"{', '.join(self.solvers)}{case_count}"
        if self.gates:
            yield "gates", f"{self.gates} in the scene"


def _other_keys(scene: Scene) -> Iterator[str]:
    """Yield the keys that are neither in the drawing nor in the lines above."""
    for place, section in scene.tables().items():
        if place in ("contact", "damping", "run"):
            for name, value, key in stated(section):
                if name not in WRITTEN:
                    yield described(name, value, key)


def as_data(scene: Scene) -> dict[str, Any]:
    """Return the scene as a file states it, and each number's range, as plain data."""
    description = SceneDescription.of(scene)
    return {
        "scene": scene.definition(),
        "cases": description.count,
        "numbers": {
            name: {"low": low, "high": high, "unit": number.unit}
            for name, (low, high, number) in numbers.ranges(description.numbers).items()
        },
        "remarks": dict(description.remarks),
        "warnings": plausibility_warnings(scene),
    }
