"""Nested named tuples of numbers and arrays as records of pointers, for compiled code.

numba takes a named tuple by value: each call passes all words of all arrays in it, two thousand for blocks in the
plane, and both compiling and running cost by their number. Of a record a call passes one pointer. Unlike those of
NumPy these hold where an array is and how long, not what is in it: code is the same for every size.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

Layout = Any  # the dtype of a number; dtype, dimensions and order of an array; (field, layout) of all parts of a tuple
WORD = 8  # bytes


class Structure:
    """A named tuple as compiled code takes it: `data` holds its words, `dtype` says what they are."""

    def __init__(self, value: Any) -> None:
        """Write the words of a named tuple, whose arrays it keeps alive."""
        self.value = value
        self.dtype = layout_of(value)
        self.data = words_of(value)

    @property
    def _numba_type_(self) -> Any:
        return type_of(self.dtype)


def layout_of(value: Any) -> Layout:
    """Return what the words of a named tuple, an array or a number are."""
    if isinstance(value, tuple):
        names = getattr(value, "_fields", ())
        return tuple((name, layout_of(part)) for name, part in zip(names, value, strict=True))
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.ndim, "C" if value.flags.c_contiguous else "A"
    return "f8" if isinstance(value, float) else "i8"


def words_of(value: Any) -> bytes:
    """Return the words of a named tuple, an array (`dda.march.pointers.ARRAY`, which nothing owns) or a number."""
    if isinstance(value, tuple):
        return b"".join(words_of(part) for part in value)
    if isinstance(value, np.ndarray):
        words = (0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides)
        return np.array(words, dtype=np.int64).tobytes()
    return np.array(value, dtype=layout_of(value)).tobytes()


@functools.cache
def type_of(layout: Layout) -> Any:
    """Return the type of numba for such words."""
    from dda.march.pointers import Pointers, array_type, number_type

    if isinstance(layout, str):
        return number_type(layout)
    if layout and isinstance(layout[0], str):
        return array_type(*layout)
    fields: list[tuple[str, Any]] = []
    offset = 0
    for name, part in layout:
        fields.append((name, {"type": type_of(part), "offset": offset}))
        offset += size_of(part)
    return Pointers(fields, offset)


def size_of(layout: Layout) -> int:
    """Return how many bytes such words have."""
    if isinstance(layout, str):
        return WORD
    if layout and isinstance(layout[0], str):
        dimensions: int = layout[1]
        return WORD * (5 + 2 * dimensions)
    return sum(size_of(part) for _, part in layout)
