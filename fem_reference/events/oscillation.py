"""Smooth functions of one variable, and the first instant at which one falls through zero.

The search misses no crossing: an interval is passed over only where Taylor's formula with a bound on the
third derivative shows that the function stays positive, or that it rises.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal, getcontext
from functools import cached_property

from fem_reference.events.decimals import HALF, ZERO, cos_sin, root


class Smooth:
    """A function whose third derivative has a bound."""

    def __call__(self, s: Decimal) -> tuple[Decimal, Decimal, Decimal]:
        """Value, first and second derivative."""
        raise NotImplementedError

    @property
    def third(self) -> Decimal:
        """Bound of the third derivative."""
        raise NotImplementedError

    def size(self, s: Decimal) -> Decimal:
        """Sum of the absolute values of the terms at s, the scale of their rounding."""
        raise NotImplementedError

    def first_fall(self, end: Decimal, start: Decimal = ZERO) -> Decimal | None:
        """The first s in (start, end] at which the function falls through zero, None if it does not.

        The function is positive just after the start, where it may be zero. Zeros that it touches without
        crossing by more than half of the digits are no crossings.
        """
        finest = Decimal(10) ** (-getcontext().prec // 2) * end
        tolerance = Decimal(10) ** (8 - getcontext().prec) * self.size(end)
        pending = [(start, end)] if tolerance and start < end else []
        while pending:
            low, high = pending.pop()
            half = (high - low) * HALF
            verdict = self._verdict(low + half, half)
            if verdict == "falls" or (verdict == "unknown" and half < finest):
                if self(high)[0] < -tolerance:
                    return root(lambda s: self(s)[:2], low, high)
            elif verdict == "unknown":
                pending += [(low + half, high), (low, low + half)]
        return None

    def _verdict(self, centre: Decimal, half: Decimal) -> str:
        """What Taylor's formula says of the interval of a half length about a centre."""
        value, slope, bend = self(centre)
        square = half * half * HALF
        if value - abs(slope) * half - max(ZERO, -bend) * square - self.third * square * half / 3 > 0:
            return "positive"
        if abs(slope) > abs(bend) * half + self.third * square:
            return "rises" if slope > 0 else "falls"
        return "unknown"


@dataclass(frozen=True)
class Oscillation(Smooth):
    """c0 + c1 s + c2 s^2 + sum of A cos(w s) + B sin(w s)."""

    polynomial: tuple[Decimal, Decimal, Decimal]  # c0, c1, c2
    waves: tuple[tuple[Decimal, Decimal, Decimal], ...]  # (w, A, B) of each oscillation, w > 0

    def __call__(self, s: Decimal) -> tuple[Decimal, Decimal, Decimal]:
        """Value, first and second derivative."""
        c0, c1, c2 = self.polynomial
        value, slope, bend = c0 + s * (c1 + s * c2), c1 + 2 * c2 * s, 2 * c2
        for w, A, B in self.waves:
            cosine, sine = cos_sin(w * s)
            even, odd = A * cosine + B * sine, w * (B * cosine - A * sine)
            value, slope, bend = value + even, slope + odd, bend - w * w * even
        return value, slope, bend

    @cached_property
    def third(self) -> Decimal:
        """Bound of the third derivative."""
        return sum(((abs(A) + abs(B)) * w**3 for w, A, B in self.waves), ZERO)

    @cached_property
    def fastest(self) -> Decimal:
        """Greatest angular frequency, zero without oscillations."""
        return max((w for w, _, _ in self.waves), default=ZERO)

    def size(self, s: Decimal) -> Decimal:
        """Sum of the absolute values of the terms at s, the scale of their rounding."""
        c0, c1, c2 = self.polynomial
        return abs(c0) + abs(c1 * s) + abs(c2 * s * s) + sum((abs(A) + abs(B) for _, A, B in self.waves), ZERO)
