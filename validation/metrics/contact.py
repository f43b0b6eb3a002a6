"""Metrics of a contact that opens and closes."""

from __future__ import annotations

from validation.metrics.measurable import Measurable
from validation.metrics.values import NOT_REPORTED, UNDEFINED
from validation.runs.row import Value


def count(m: Measurable) -> Value:
    """Openings and closings after t = 0, of all corners."""
    return NOT_REPORTED if m.switches is None else float(len(m.switches))


def first(m: Measurable, opens: bool) -> Value:
    """Time of the first opening, or of the first closing, after t = 0 [s]; undefined where there is none."""
    if m.switches is None:
        return NOT_REPORTED
    return next((switch.time for switch in m.switches if switch.opens is opens), UNDEFINED)
