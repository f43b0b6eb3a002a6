"""Names of types that many rooms use."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Data = Mapping[str, Any]  # plain data, as of a table or a record
Fields = dict[str, Any]  # the same, to be filled
NamedNumbers = dict[str, float]
NamedTexts = dict[str, str]
NamePair = tuple[str, str]  # such as scene and solver
NumberPair = tuple[float, float]  # such as lower and upper edge
NumbersByName = Mapping[str, float]
Words = tuple[str, ...]
