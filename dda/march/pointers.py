"""numba's types of what `dda.march.structure` writes, in a module that is imported where numba is wanted."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import from_dtype, types
from numba.core import datamodel

ARRAY = ("meminfo", "parent", "nitems", "itemsize", "data", "shape", "strides")  # the words of an array
models: Any = datamodel  # whose names mypy does not know


class Pointers(types.Record):
    """A record that holds arrays of numba, which no record of NumPy does."""

    def __init__(self, fields: list[tuple[str, Any]], size: int) -> None:
        """Take the fields, by name: type and offset."""
        self.size = size
        super().__init__(fields, size, aligned=True)

    def __repr__(self) -> str:
        """Return its name, which numba asks for at every pass, and would write anew."""
        return str(self.name)

    @property
    def dtype(self) -> Any:
        """What NumPy sees of it."""
        return np.dtype((np.void, self.size))


def number_type(dtype: str) -> Any:
    """Return the type of a number."""
    return from_dtype(np.dtype(dtype))


def array_type(dtype: str, dimensions: int, order: str) -> Any:
    """Return the type of an array.

    Raises
    ------
    RuntimeError
        If this numba holds arrays in other words: then nothing is compiled.
    """
    kind: Any = types.Array
    array = kind(number_type(dtype), dimensions, order)
    fields = models.default_manager.lookup(array)._fields
    if fields != ARRAY:
        raise RuntimeError(f"arrays of numba: must hold {ARRAY}, got {fields}")
    return array


models.register_default(Pointers)(models.models.RecordModel)
