"""Numbers of an independent program on columns whose contacts open or slip, read from ``known.toml``."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

EVENTS = "column-events"
BARS = "bars-events"


@dataclass(frozen=True)
class Sample:
    """A column of a history at an instant."""

    scene: str
    solver: str
    column: str
    time: float  # [s]
    printed: str

    @property
    def value(self) -> float:
        """The number."""
        return float(self.printed)

    @property
    def half(self) -> float:
        """Half a unit of its last digit."""
        return half_unit(self.printed)


def half_unit(printed: str) -> float:
    """Return half a unit of the last digit of a number as it was printed."""
    digits, _, exponent = printed.lower().partition("e")
    return 0.5 * 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


def _samples() -> tuple[Sample, ...]:
    samples = []
    for entry in TABLES["samples"]:
        for number, printed in enumerate(entry["printed"], start=entry["first"]):
            if printed != "-":
                column = f"{entry['quantity']}_{number}"
                samples.append(Sample(entry["scene"], entry["solver"], column, entry["time"], printed))
    return tuple(samples)


def _by_scheme(name: str) -> dict[tuple[float, ...], Any]:
    """Return a table by alpha, delta, gg and time step."""
    return {tuple(scheme): values for scheme, values in TABLES[name]}


TABLES: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
KNOWN: tuple[Sample, ...] = _samples()
BAR_PIECES: list[float] = TABLES["bar_pieces"]
BLOCK_PIECES: list[float] = TABLES["block_pieces"]
CRADLE_BARS: list[float] = TABLES["cradle_bars"]
SLIPPING_JOINT: dict[float, list[float]] = dict(TABLES["slipping_joint"])
RESTING_SOLVES: dict[float, list[float]] = dict(TABLES["resting_solves"])
SHAKEN_SOLVES: dict[float, list[float]] = dict(TABLES["shaken_solves"])
RESIDUAL_SLIPS: dict[tuple[float, ...], list[str]] = _by_scheme("residual_slips")
SETTLED: dict[tuple[float, ...], float] = _by_scheme("settled")
