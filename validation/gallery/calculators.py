"""The calculators: what can be set on their pages and within which limits stands in `calculators.toml`.

The formulas are those of `static/formulas.js`, the arithmetic of the pages that of `static/calculators.js`.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Control:
    """A number that can be set by a slider or exactly, or, where there are `options`, one of several words."""

    id: str
    label: str
    unit: str = ""
    value: float = 0.0
    low: float = 0.0
    high: float = 0.0
    logarithmic: bool = False  # whether the slider runs over the logarithm
    options: tuple[tuple[str, str], ...] = ()  # value and text


@dataclass(frozen=True)
class Calculator:
    """A page with controls, numbers and charts."""

    id: str
    title: str
    question: str
    says: str
    controls: tuple[Control, ...]
    block: tuple[Control, ...]  # folded away: the paper's block is what most will ask about
    charts: tuple[tuple[str, str], ...]  # id and what a chart shows


def _calculators(data: dict[str, Any]) -> tuple[Calculator, ...]:
    """Return the calculators; `control` names controls that several of them share, a table is one of their own."""
    shared = {name: Control(**{"id": name, **control}) for name, control in data["control"].items()}

    def controls(entries: list[str | dict[str, Any]]) -> tuple[Control, ...]:
        return tuple(shared[entry] if isinstance(entry, str) else Control(**entry) for entry in entries)

    calculators = []
    for page in data["calculator"]:
        parts = {part: controls(page[part]) for part in ("controls", "block")}
        calculators.append(Calculator(**page | parts))
    return tuple(calculators)


CALCULATORS = _calculators(tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8")))
