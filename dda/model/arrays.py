"""The arrays of real numbers that all rooms compute with."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
ArrayPair = tuple[Array, Array]
Columns = dict[str, Array]  # by the name of what they hold
ROUNDING = 64 * np.finfo(float).eps  # of the terms of a sum: each carries a few roundings, and there is a handful


def without_rounding(values: ArrayLike, scale: ArrayLike) -> Array:
    """Return values, exact zeros where they are no more than the rounding of their terms, of the size `scale`."""
    return np.where(np.abs(values) <= ROUNDING * np.asarray(scale), 0.0, values)
