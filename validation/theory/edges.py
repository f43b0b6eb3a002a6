"""Where something ceases to hold, between a value at which it does and one at which it does not."""

from __future__ import annotations

import math
from collections.abc import Callable


def edge(holds: Callable[[float], bool], inside: float, outside: float, tolerance: float) -> float:
    """Return the last positive value at which something holds, by halving the ratio of two that enclose it.

    It holds `inside` and not `outside`, whichever is larger; the inner end is returned to a relative `tolerance`.
    """
    while abs(outside / inside - 1) > tolerance:
        middle = math.sqrt(inside * outside)
        if holds(middle):
            inside = middle
        else:
            outside = middle
    return inside
