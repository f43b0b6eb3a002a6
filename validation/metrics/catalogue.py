"""The catalogue of metrics."""

from __future__ import annotations

import numpy as np

from validation.metrics.columns import Measurable, _solo_quantity, _tension_metrics
from validation.metrics.modes import _contact_metrics, _mode_metrics
from validation.metrics.pairs import PAIRS
from validation.metrics.values import QUANTITIES, _finite
from validation.runs.history import History
from validation.runs.results import Value
from validation.solvers import stability


def solo(m: Measurable, modes: bool = True) -> dict[str, Value]:
    """Return the metrics of one run, those of its first axial mode if asked."""
    found: dict[str, Value] = {}
    with np.errstate(all="ignore"):
        for name in QUANTITIES:
            found |= _solo_quantity(name, m)
        found |= _tension_metrics(m)
        found |= _mode_metrics(m) | _contact_metrics(m) if modes else {}
    return {key: _finite(value) for key, value in found.items()}


SOLO = tuple(solo(Measurable(History(np.zeros(0), {}), 1.0, {}, ())))
METRICS = (*SOLO, *stability.METRICS, stability.GROWTH, stability.LIMIT, stability.DRIFT, *PAIRS)
