"""What numbers must be: a refusal names field, rule and value in one line."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike


def _check(rule: str, holds: Callable[[Any], bool], values: Mapping[str, Any]) -> None:
    for field, value in values.items():
        if not holds(value):
            raise ValueError(f"{field}: must be {rule}, got {value!r}")


def check_finite(**values: ArrayLike) -> None:
    """Raise ValueError for infinity and NaN, also in vectors."""
    _check("finite", lambda value: bool(np.isfinite(value).all()), values)


def check_positive(**values: float) -> None:
    """Raise ValueError unless all values are finite and positive."""
    _check("finite and positive", lambda value: math.isfinite(value) and value > 0, values)


def check_not_negative(**values: float) -> None:
    """Raise ValueError unless all values are finite and not negative."""
    _check("finite and not negative", lambda value: math.isfinite(value) and value >= 0, values)


def check_share(**values: float) -> None:
    """Raise ValueError unless all values are between 0 and 1, these included."""
    _check("between 0 and 1", lambda value: 0 <= value <= 1, values)


def check_count(**values: int) -> None:
    """Raise ValueError unless all values are positive integers."""
    _check("a positive integer", lambda n: isinstance(n, int) and not isinstance(n, bool) and n > 0, values)


def check_among(known: Sequence[str], **values: str) -> None:
    """Raise ValueError unless all values are among the known ones."""
    _check(f"among {', '.join(known)}", lambda value: value in known, values)


def check_columns(known: Sequence[str], columns: Sequence[str]) -> None:
    """Raise ValueError unless every column is known."""
    for name in columns:
        check_among(known, columns=name)


def check_number(field: str, number: int, count: int) -> None:
    """Raise ValueError unless a number is one of so many."""
    if not 0 <= number < count:
        raise ValueError(f"{field}: must be between 0 and {count - 1}, got {number!r}")


def check_damping(damped: bool, moving: bool) -> None:
    """Raise ValueError for viscous damping on a moving base, whose velocity the scheme does not know."""
    if damped and moving:
        raise ValueError("damping: mass and stiffness damping do not go with a base that moves, got both")
