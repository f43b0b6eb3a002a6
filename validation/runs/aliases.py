"""Names of types that many rooms use."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

Data = Mapping[str, Any]  # plain data, as of a table or a record
Fields = dict[str, Any]  # the same, to be filled
NamedNumbers = dict[str, float]
NamedTexts = dict[str, str]
NamePair = tuple[str, str]  # such as scene and solver
NumberPair = tuple[float, float]  # such as lower and upper edge
NumbersByName = Mapping[str, float]
Progress = Callable[[int, int, str], None]  # is told what has been done, of how much, and what is next
Words = tuple[str, ...]
