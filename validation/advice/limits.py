"""Numbers and words that users state: what they must be, and how one that is not is refused."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from validation.errors import InputError
from validation.runs.numbers import stated_text

LARGEST_RATIO = 2.0  # of critical damping; a larger target was meant in per cent


@dataclass(frozen=True)
class Limit:
    """An interval in which a number must lie, without its ends but for those that are allowed."""

    field: str
    rule: str = "must be positive and finite"
    above: float = 0.0
    below: float = math.inf
    ends: tuple[float, ...] = ()
    advice: str | None = None

    def check(self, value: float | None) -> None:
        """Raise InputError with the rule for a number out of the interval or NaN; None is not looked at."""
        if value is None or self.above < value < self.below or value in self.ends:
            return
        raise InputError(self.rule, field=self.field, value=stated_text(value), advice=self.advice)


def check_ratio(damping: float, least: float) -> None:
    """Raise InputError for a target damping ratio out of `least` to `LARGEST_RATIO`."""
    advice = f"{damping:g} % is {damping / 100:g}" if damping > LARGEST_RATIO else None
    rule = f"must be a damping ratio from {least:g} to {LARGEST_RATIO:g}, where 1 is critical"
    Limit("damping", rule, least, LARGEST_RATIO, (least, LARGEST_RATIO), advice).check(damping)


def check_choice(field: str, value: str, choices: Iterable[str]) -> None:
    """Raise InputError, with the choices, for a word that is none of them."""
    listed = list(choices)
    if value not in listed:
        raise InputError(f"must be one of {', '.join(listed)}", field=field, value=repr(value))
