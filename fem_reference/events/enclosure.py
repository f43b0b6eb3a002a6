"""Ball arithmetic: the first instant at which a smooth function falls through zero, enclosed and proven.

A ball is a midpoint with a radius that holds the number; Arb (python-flint) rounds every operation outwards. An
interval of the search is passed over only where Taylor's formula shows that the function stays positive or rises in
it, with balls for its value and slope at the middle and for its second derivative over the whole interval. Where the
same formula shows that it falls throughout, the signs at the ends decide, and the interval Newton operator proves that
exactly one root lies in the ball that is returned.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import NamedTuple

from flint import arb, arb_poly, ctx

BITS_A_DIGIT = 3.3219281
GUARD_BITS = 24  # beyond the digits that are asked for
ZERO = arb(0)
NEWTON_STEPS = 200
LEAST_DIGITS = 30


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Ball arithmetic of so many bits, whatever the caller's own precision is."""
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def bits_of(digits: float) -> int:
    """The bits in which so many decimal digits are computed."""
    return int(digits * BITS_A_DIGIT) + GUARD_BITS


def check_request(end: float, digits: int) -> None:
    """Raise a `ValueError` if `end` is not positive and finite, or `digits` is below `LEAST_DIGITS`."""
    if not (math.isfinite(end) and end > 0):
        raise ValueError(f"end: must be positive and finite, got {end!r}")
    if digits < LEAST_DIGITS:
        raise ValueError(f"digits: must be at least {LEAST_DIGITS}, got {digits!r}")


def ball(radius: arb | float) -> arb:
    """The ball about zero."""
    return arb(0, radius)


def radius_of(value: arb) -> float:
    """Radius of a ball as a float, rounded upwards."""
    return float(value.rad()) * (1 + 1e-15)


@cache
def _term_count(angle: float, bits: int) -> int:
    logarithm = 0.0
    n = 0
    while logarithm > -bits - 12 or n < 2 * angle + 3:
        n += 1
        logarithm += math.log2(angle / n)
    return n


def term_count(angle: float) -> int:
    """Terms of a series over an angle whose remainder is below the digits of the current context."""
    rounded = 2.0 ** (math.ceil(2 * math.log2(max(angle, 1e-200))) / 2)  # few angles, whose counts are kept
    return _term_count(rounded, ctx.prec)


class Local(NamedTuple):
    """A function about the middle of an interval."""

    value: arb  # at the middle
    slope: arb  # at the middle
    bend: arb  # encloses the second derivative over the interval, unless this is a point


Smooth = Callable[[arb, arb], Local]  # from the middle of an interval and half its length to the function there


class Fall(NamedTuple):
    """The first fall of a function through zero."""

    at: arb  # encloses the root
    grazing: bool  # whether it was too flat to prove that the root is the only one


def polynomial(
    coefficients: list[arb], end: arb, begin: arb = ZERO, tail: arb = ZERO, most: float = math.inf
) -> Smooth:
    """A polynomial, given by the balls of its coefficients, as a function of the distance of its argument from `begin`.

    `end` is the greatest argument, `tail` what is left out of the polynomial and of its first two derivatives. After
    `most` evaluations a `RuntimeError` ends the search.
    """
    value = arb_poly(coefficients)
    slope = value.derivative()
    bend = slope.derivative()
    third = arb_poly([abs(c) for c in bend.derivative().coeffs()])(end)  # bounds the third derivative
    rest = ball(tail)
    looks = itertools.count(1)

    def local(middle: arb, half: arb) -> Local:
        if next(looks) > most:
            raise RuntimeError(f"more than {most} evaluations")
        x = begin + middle
        about = bend(x) + rest
        return Local(value(x) + rest, slope(x) + rest, about + ball((third * half).upper()) if half else about)

    return local


def first_fall(function: Smooth, end: arb, touches: list[arb] | None = None, floor: arb | None = None) -> Fall | None:
    """The first point in (0, end] at which a function, positive just after zero, falls through zero; None if none.

    `touches` takes the points at which the function comes so near to zero, over intervals of half the digits, that a
    crossing can be neither proven nor excluded; they count as none, as does what is below `floor`.
    """
    finest = end * arb(2) ** (-ctx.prec // 2)
    pending = [(ZERO, end)]
    while pending:
        low, high = pending.pop()
        half = ((high - low) / 2).mid()
        middle = (low + half).mid()
        value, slope, bend = function(middle, half)
        down = bend.lower()
        if value - abs(slope) * half + (down * half * half / 2 if down < 0 else 0) > 0:
            continue
        change = abs(bend) * half
        if slope - change > 0:
            continue
        falls = slope + change < 0
        if falls or half < finest:
            if function(high, ZERO).value < 0:
                return _root(function, low, high) if falls else Fall(middle + ball(half), True)
            if not falls and touches is not None:
                touches.append(middle)
        elif floor is not None and abs(value) + (abs(slope) + change) * half < floor:
            continue
        else:
            pending += [(middle, high), (low, middle)]
    return None


def _root(function: Smooth, low: arb, high: arb) -> Fall:
    """The root of a function that falls throughout an interval, by Newton's method inside the bracket."""
    exact = ZERO
    x = ((low + high) / 2).mid()
    width = high - low
    start = low
    end = high
    for _ in range(NEWTON_STEPS):
        here = function(x, exact)
        if here.value > 0:
            low = x
        elif here.value < 0:
            high = x
        else:
            break
        following = (x - here.value / here.slope).mid()
        if not low <= following <= high:
            following = ((low + high) / 2).mid()
        finished = abs(following - x) <= width * arb(2) ** (4 - ctx.prec)
        x = following
        if finished:
            break
    here = function(x, exact)
    reach = ((abs(here.value) / abs(here.slope)).upper() * 4 + width * arb(2) ** (8 - ctx.prec)).mid()
    near = function(x, reach)
    offset = near.value / (near.slope + near.bend * ball(reach))
    if not abs(offset) < reach:  # too flat for the operator; the bracket is proven by its signs all the same
        return Fall(((start + end) / 2).mid() + ball((end - start) / 2), True)
    return Fall(x - offset, False)
