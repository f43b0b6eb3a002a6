"""Metrics between a run and its reference."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from validation.metrics.values import NOT_REPORTED, QUANTITIES, _as_number, _finite, _ratio, largest, norm
from validation.runs.history import Array, History
from validation.runs.results import Value


def relative_l2(value: Array, reference: Array) -> Value:
    """||value - reference|| / ||reference|| over the history."""
    return _ratio(norm(value - reference), norm(reference))


def relative_max(value: Array, reference: Array) -> Value:
    """Maximum of |value - reference| over maximum of |reference|, over the history."""
    return _ratio(largest(value - reference), largest(reference))


PAIR: dict[str, tuple[str, Callable[[Array, Array], Value]]] = {
    f"{name}.{part}": (column, function)
    for name, column in QUANTITIES.items()
    for part, function in (("l2", relative_l2), ("max", relative_max))
}
SCALED = {f"{name}.scaled": name for name in QUANTITIES}
WORST = "worst.max"
PAIRS = (*PAIR, *SCALED, WORST)


def pair(metric: str, history: History, reference: History, static: Mapping[str, Value] | None = None) -> Value:
    """Return a metric between a run and its reference, on their common steps.

    Parameters
    ----------
    metric
        Of `PAIR`; or `<quantity>.scaled`, the maximum error over the larger of the reference's maximum and the static
        value (a wave that has not arrived leaves nothing to divide by); or `worst.max`, the larger of the two `.max`.
    history, reference
        The run and what it is compared with.
    static
        Metrics of the run, for the static values of `.scaled`.
    """
    if metric == WORST:
        both = [pair(f"{name}.max", history, reference) for name in ("displacement", "pressure")]
        return next((value for value in both if not isinstance(value, float)), max(both, key=_as_number))
    if metric in SCALED:
        name = SCALED[metric]
        still = (static or {}).get(f"{name}.static")
        return _scaled(QUANTITIES[name], history, reference, still) if isinstance(still, float) else NOT_REPORTED
    column, function = PAIR[metric]
    if column not in history.columns or column not in reference.columns:
        return NOT_REPORTED
    n = min(len(history.time), len(reference.time))
    with np.errstate(all="ignore"):
        return _finite(function(history.columns[column][:n], reference.columns[column][:n]))


def _scaled(column: str, history: History, reference: History, static: float) -> Value:
    if column not in history.columns or column not in reference.columns:
        return NOT_REPORTED
    value, exact = history.columns[column], reference.columns[column]
    with np.errstate(all="ignore"):
        return _finite(_ratio(largest(value - exact), max(largest(exact), abs(static))))
