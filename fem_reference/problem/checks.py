"""Checks of what a problem is made of: each message names field, rule and value."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import fields
from typing import Any


def require(condition: bool, field: str, rule: str, value: object) -> None:
    """Raise a `ValueError` that names field, rule and value, unless a condition holds."""
    if not condition:
        raise ValueError(f"{field}: {rule}, got {value!r}")


def require_numbers(
    data: Any, positive: Collection[str] = (), unsigned: Collection[str] = (), infinite: Collection[str] = ()
) -> None:
    """Raise a `ValueError` for the first number of a dataclass that is not finite, or out of its range.

    Fields that are named must be positive, or not negative (`unsigned`), or may be infinite.
    """
    for field in fields(data):
        name = field.name
        value = getattr(data, name)
        if not isinstance(value, int | float):
            continue
        require(
            math.isfinite(value) or (value == math.inf and name in infinite), name, "must be a finite number", value
        )
        require(value > 0 or name not in positive, name, "must be positive", value)
        require(value >= 0 or name not in unsigned, name, "must not be negative", value)
