"""Whether two histories are one bit for bit, and how far two runs of one program are apart.

Two programs that solve the same equations differ in their last digits: sums are taken in another order. A history whose
every bit is that of another solver is that solver's, however it was called. Two runs of one program agree to rounding;
what differs by more is noise, and a verdict on it is one on a single draw.
"""

from __future__ import annotations

import numpy as np

from validation.metrics.pairs import relative_l2
from validation.runs.history import History

FEWEST_VALUES = 10  # different ones of a column: fewer may agree by chance, as at rest or over a few steps of free fall
ROUNDING = 1e-9  # relative L2: threads add in another order from run to run, and stiff contacts amplify that


def is_identical(history: History, other: History) -> bool:
    """Whether all columns that both have are the same bit for bit, and one of them has values enough to tell."""
    common = [name for name in history.columns if name in other.columns]
    if any(history.columns[name].tobytes() != other.columns[name].tobytes() for name in common):
        return False
    return any(len(np.unique(history.columns[name])) >= FEWEST_VALUES for name in common)


def largest_difference(history: History, again: History) -> tuple[str, float]:
    """Return the column in which two runs of one scene differ most, and ||again - history|| / ||history|| [1].

    An empty name and 0 where none differs by more than rounding; infinity where one run lacks the column or has another
    length.
    """
    worst = ("", 0.0)
    for name in sorted({*history.columns, *again.columns}):
        first = history.columns.get(name)
        second = again.columns.get(name)
        if first is None or second is None or first.shape != second.shape:
            return name, np.inf
        if first.tobytes() == second.tobytes():
            continue
        with np.errstate(all="ignore"):
            difference = relative_l2(second, first)
        size = difference if isinstance(difference, float) and np.isfinite(difference) else np.inf
        if size > max(ROUNDING, worst[1]):
            worst = (name, size)
    return worst
