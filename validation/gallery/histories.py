r"""Histories as data of a page: few enough samples for all of them together, none of the peaks lost.

A history of n steps is cut into K equal parts, and of each part the least and the greatest value are kept in the order
in which they occur; one of at most 2 K steps is kept whole. A value is stored in two bytes,

    y = low + (high - low) k / 65534,   k = 0 ... 65534,

so that it is right to 8e-6 of the range of its history; k = 65535 stands for no value.
"""

from __future__ import annotations

import base64
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from validation.runs.history import Array, History

MOST = 800  # samples of a line
LEAST = 60
STEPS = 65534  # of the range, in two bytes
NONE = 65535  # stands for no value
BYTES = 2 * 4 / 3  # of a sample in base64


def samples_for(lines: int, room: float) -> int:
    """Return how many samples each of so many lines may have within a number of bytes, an even number."""
    return 2 * round(min(MOST, max(LEAST, room / BYTES / max(lines, 1))) / 2)


@dataclass(frozen=True)
class Sampling:
    """Which steps of the longest history of a case are looked at together."""

    count: int  # steps
    samples: int

    @property
    def whole(self) -> bool:
        """Whether every step is kept."""
        return self.count <= self.samples

    @property
    def edges(self) -> list[int]:
        """First step of each part, and the end."""
        parts = self.samples // 2
        return [i * self.count // parts for i in range(parts + 1)]

    def sampled(self, values: Array) -> Array:
        """Return the kept values of a history, NaN behind its end."""
        padded = np.full(self.count, np.nan)
        padded[: len(values)] = values
        if self.whole:
            return padded
        return np.concatenate([_extremes(padded[a:b]) for a, b in itertools.pairwise(self.edges)])

    def times(self, time: Array) -> Array:
        """Return the instants at which the kept values are drawn: begin and middle of each part."""
        if self.whole:
            return time
        pairs = [(a, (a + b) // 2) for a, b in itertools.pairwise(self.edges)]
        return np.asarray(time[np.array(pairs).ravel()])


def _extremes(values: Array) -> Array:
    """Return least and greatest of a part in the order in which they occur."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return np.full(2, np.nan)
    return finite[sorted([int(np.argmin(finite)), int(np.argmax(finite))])]


def packed(values: Array) -> list[Any]:
    """Return [low, high, text]: the range of the values, and each of them in two bytes, least one first."""
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    with np.errstate(all="ignore"):
        share = (values / 2 - low / 2) / (high / 2 - low / 2) if high > low else np.zeros_like(values)
    numbers = np.where(np.isfinite(values), np.rint(STEPS * np.nan_to_num(share)), NONE).astype("<u2")
    return [low, high, base64.b64encode(numbers.tobytes()).decode()]


def lines_of(histories: Mapping[str, History], samples: int) -> dict[str, Any]:
    """Return the lines of a case as plain data: instants, whether every step is there, values by column and solver."""
    if not histories:
        return {"time": [0.0, 0.0, ""], "steps": 0, "whole": True, "columns": {}}
    longest = max(histories.values(), key=lambda history: len(history.time))
    sampling = Sampling(len(longest.time), samples)
    columns: dict[str, dict[str, list[Any]]] = {}
    for solver, history in histories.items():
        for column, values in history.columns.items():
            columns.setdefault(column, {})[solver] = packed(sampling.sampled(values))
    time = longest.time
    return {
        "time": [float(time[0]), float(time[-1]), _instants(time, sampling)],
        "steps": sampling.count,
        "whole": sampling.whole,
        "columns": columns,
    }


def _instants(time: Array, sampling: Sampling) -> str | list[float]:
    """Return the instants [s]; nothing where they follow from first, last and the number of steps."""
    even = np.linspace(time[0], time[-1], len(time))
    if np.allclose(time, even, rtol=0, atol=1e-6 * abs(time[-1] - time[0]) / max(len(time) - 1, 1)):
        return ""
    return [float(f"{t:.9g}") for t in sampling.times(time)]
