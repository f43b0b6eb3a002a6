"""Numbers with so many digits that rounding does not count."""

from __future__ import annotations

import functools

PLACES = 192
"""Binary places: a number from 1e-30 on keeps far more digits than a double."""
_ONE = 1 << PLACES


class Exact:
    """A fixed-point number x = scaled / 2^PLACES; doubles that it meets are taken as they are."""

    __slots__ = ("scaled",)

    def __init__(self, scaled: int) -> None:
        self.scaled = scaled

    @classmethod
    def of(cls, value: float) -> Exact:
        """Return the value of a double."""
        return cls(_cut(value))

    def __add__(self, other: Exact | float) -> Exact:
        return Exact(self.scaled + _scaled(other))

    def __radd__(self, other: float) -> Exact:
        return Exact(_scaled(other) + self.scaled)

    def __sub__(self, other: Exact | float) -> Exact:
        return Exact(self.scaled - _scaled(other))

    def __rsub__(self, other: float) -> Exact:
        return Exact(_scaled(other) - self.scaled)

    def __mul__(self, other: Exact | float) -> Exact:
        return Exact(self.scaled * _scaled(other) >> PLACES)

    def __rmul__(self, other: float) -> Exact:
        return Exact(_scaled(other) * self.scaled >> PLACES)

    def __truediv__(self, other: Exact | float) -> Exact:
        return Exact((self.scaled << PLACES) // _scaled(other))

    def __float__(self) -> float:
        return self.scaled / _ONE

    def __ge__(self, other: float) -> bool:
        return self.scaled >= _scaled(other)

    def __gt__(self, other: float) -> bool:
        return self.scaled > _scaled(other)

    def __le__(self, other: float) -> bool:
        return self.scaled <= _scaled(other)


def _scaled(value: Exact | float) -> int:
    """Return a number times 2^PLACES, cut to an integer."""
    return value.scaled if isinstance(value, Exact) else _cut(value)


@functools.lru_cache(maxsize=64)  # a step meets the same few constants again and again
def _cut(value: float) -> int:
    numerator, denominator = value.as_integer_ratio()
    return (numerator << PLACES) // denominator
