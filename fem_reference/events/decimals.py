"""Decimal arithmetic of any number of digits, and roots in it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, getcontext, localcontext

ZERO, ONE, TWO = Decimal(0), Decimal(1), Decimal(2)
HALF = Decimal("0.5")


def working(digits: int) -> AbstractContextManager[Context]:
    """A decimal context of so many digits, whatever the caller's own context is."""
    return localcontext(Context(prec=digits, Emin=MIN_EMIN, Emax=MAX_EMAX))


def small(guard: int) -> Decimal:
    """10^(guard - digits): what is left of one when all but `guard` of the digits cancel."""
    return Decimal(10) ** (guard - getcontext().prec)


def root(function: Callable[[Decimal], tuple[Decimal, Decimal]], low: Decimal, high: Decimal) -> Decimal:
    """The root of a function that falls through zero between `low` and `high`.

    Newton's method, kept inside the bracket by bisection, until its step is below the digits.

    Parameters
    ----------
    function
        Value and derivative.
    low, high
        Ends of the bracket; the function is positive (or zero) at `low` and negative at `high`.
    """
    floor = small(4) * max(abs(low), abs(high))
    x = (low + high) / 2
    for _ in range(8 * getcontext().prec):
        value, slope = function(x)
        low, high = (x, high) if value >= 0 else (low, x)
        step = -value / slope if slope else ZERO
        following = x + step
        if not (slope and low <= following <= high):
            following = (low + high) / 2
        if abs(following - x) <= floor or high - low <= floor:
            return following
        x = following
    return x
