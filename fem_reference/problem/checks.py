"""Checks of what a problem is made of: each message names field, rule and value."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import fields
from typing import Any


def require(condition: bool, field: str, rule: str, value: object) -> None:
    """Raise for a value that breaks a rule.

    Raises
    ------
    ValueError
        If the condition does not hold.
    """
    if not condition:
        raise ValueError(f"{field}: {rule}, got {value!r}")


def require_numbers(
    data: Any, positive: Collection[str] = (), unsigned: Collection[str] = (), infinite: Collection[str] = ()
) -> None:
    """Raise for a number among the fields of a dataclass that is not finite, or out of its range.

    Parameters
    ----------
    data
        The dataclass.
    positive, unsigned
        Fields that must be positive, or not negative.
    infinite
        Fields that may be infinite.

    Raises
    ------
    ValueError
        For the first field that is wrong.
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
