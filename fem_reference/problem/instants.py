"""Instants at which a motion that is known piece by piece is asked for."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fem_reference.problem.problem import Array


def instants(times: ArrayLike, end: float) -> Array:
    """Times as an array, shape (times,) [s].

    Raises
    ------
    ValueError
        If an instant is not from 0 to `end`.
    """
    t = np.array(times, float, ndmin=1)
    if t.ndim != 1 or not np.all((t >= 0) & (t <= end)):
        raise ValueError(f"times: must be a list of instants from 0 to the end {end!r}, got {times!r}")
    return t


def by_pieces(t: Array, starts: ArrayLike) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """Yield the pieces that instants fall into, by their starts in the order of time, and the indices of these."""
    index = np.searchsorted(starts, t, side="right") - 1
    order = np.argsort(index, kind="stable")
    pieces, first = np.unique(index[order], return_index=True)
    yield from zip(pieces.tolist(), np.split(order, first[1:]), strict=True)
