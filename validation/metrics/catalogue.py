"""The catalogue of metrics, ``catalogue.toml``: what each is called, its unit, what it needs, and its function."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from validation.metrics import columns, contact, growth, modes, pairs
from validation.metrics.measurable import Measurable
from validation.metrics.pairs import Pairing
from validation.metrics.values import UNDEFINED, finite
from validation.runs.beside import table_beside
from validation.runs.history import History
from validation.runs.row import Metrics, Value

HISTORY = "history"
STATIC = "static"
MODES = "modes"
DIAGNOSTICS = "diagnostics"
REFERENCE = "reference"
SWITCHES = "switches"
CONTACT = "contact"
LINEAR = frozenset({STATIC, MODES, DIAGNOSTICS})  # what a solver can report of a linear scene only


@dataclass(frozen=True)
class Metric:
    """One metric: a function of a `Measurable`, or of a `Pairing` where it needs a reference."""

    id: str
    words: str  # what a person reads instead of the id
    unit: str  # "1" for a ratio
    says: str
    needs: frozenset[str]  # among history, static, modes, diagnostics, switches, contact, reference
    function: Callable[[Any], Value]
    measure: str = "history"  # the part of a study's `measures` that asks for it
    undefined: str = UNDEFINED  # why it has no value where it has none, "not settled"

    @property
    def linear(self) -> bool:
        """Whether it has a meaning for linear scenes only."""
        return bool(self.needs & LINEAR)


ROOMS = {"columns": columns, "contact": contact, "growth": growth, "modes": modes, "pairs": pairs}


def _read() -> list[Metric]:
    """Return the metrics of the catalogue, in its order."""
    metrics = []
    for entry in table_beside(__file__)["metric"]:
        room, _, name = entry.pop("function").partition(".")
        function = partial(getattr(ROOMS[room], name), **entry.pop("with", {}))
        needs = frozenset(entry.pop("needs"))
        if CONTACT in needs:
            function = partial(contact.reported, part=function)
        metrics.append(Metric(needs=needs, function=function, **entry))
    return metrics


COUNTS = frozenset({"switches.count", "contact.state_changes"})  # beside all that are measured in steps
ALL = {metric.id: metric for metric in _read()}
KIND = ALL.pop("stability.kind")  # a word, which no gate can bound
PAIRS = {name: metric for name, metric in ALL.items() if REFERENCE in metric.needs}
SOLO = {name: metric for name, metric in ALL.items() if name not in PAIRS}
CATALOGUE = SOLO | PAIRS


def words_of(metric: str) -> str:
    """Return what a person reads instead of the id of a metric, the id where the catalogue lacks it."""
    entry = ALL.get(metric)
    return metric if entry is None else entry.words


def in_words(metric: str, value: Value) -> Value:
    """Return the value of a metric; where it is undefined, why: "never opens"."""
    entry = ALL.get(metric)
    return entry.undefined if entry is not None and value == UNDEFINED else value


def is_count(metric: str) -> bool:
    """Whether a metric counts something: its zero is none, not a small number."""
    entry = CATALOGUE.get(metric)
    return metric in COUNTS or (entry is not None and entry.unit == "step")


def measured_by(measures: Collection[str], only: Collection[str] | None = None) -> list[Metric]:
    """Return the metrics of one run that the parts of a study's `measures` ask for, of them those named in `only`."""
    metrics = [metric for metric in (*SOLO.values(), KIND) if metric.measure in measures]
    return metrics if only is None else [metric for metric in metrics if metric.id in only]


def solo(
    m: Measurable, measures: Collection[str] = ("history", "modes"), only: Collection[str] | None = None
) -> dict[str, Value]:
    """Return the metrics of one run that are asked for; none of them is ever NaN."""
    with np.errstate(all="ignore"):
        return {metric.id: finite(metric.function(m)) for metric in measured_by(measures, only)}


def pair(metric: str, history: History, reference: History, run: Metrics | None = None) -> Value:
    """Return a metric of `PAIRS` between a run and its reference, on their common steps.

    `run` holds metrics of the run, for the static values of `.scaled`.
    """
    return PAIRS[metric].function(Pairing(history, reference, run or {}))
