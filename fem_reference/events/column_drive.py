"""What drives columns and bars: pieces of entire functions, their Taylor coefficients and a bound on what follows.

A drive is a displacement of the base (or of the wave that comes up through the half-space) or a pressure on the top; of
bars the base's drive is its velocity.
On each piece it is a polynomial, a sine or a Ricker pulse, so that a step that ends where the piece does has a power
series with a proven remainder.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

from flint import arb, arb_poly, arb_series, ctx

from fem_reference.events.enclosure import ZERO, term_count

ANGLE = 6.0  # length of a step times the greatest rate [rad]; few more than lie between two switches of a busy column
# Greatest pi f times a step: n terms leave (sqrt(2 e / n))^n, below 60 digits at 92 and below the 28 of reports in
# each of the parts into which they cut a step. Twice as much needs as many terms for the time passed.
RICKER_ANGLE = 1.0


def tail_sum(ratio: arb) -> arb:
    """What the terms of a tail and three of its derivatives come to, over the first term times the cube of its number.

    Terms c_(n+i) <= c q^i have the sum of (n + i)^3 c_(n+i) <= n^3 c S, with S = sum of (1 + i)^3 q^i =
    (1 + 4 q + q^2) / (1 - q)^4; infinite where the ratio q is not proven to be below one.
    """
    q = ratio.upper()
    if not q < 1:
        return arb("inf")
    return (1 + 4 * q + q * q) / (1 - q) ** 4


@contextmanager
def capped(count: int) -> Iterator[None]:
    """Power series of so many terms."""
    before = ctx.cap
    ctx.cap = count
    try:
        yield
    finally:
        ctx.cap = before


@dataclass(frozen=True)
class Polynomial:
    """Sum of c_k (t - origin)^k."""

    coefficients: tuple[float | arb, ...]
    origin: float = 0.0  # [s]

    def longest_step(self) -> float:
        """The longest step [s]; nothing bounds it."""
        return math.inf

    def term_count(self, length: float) -> int:
        """How many terms leave nothing that the digits of the context would show."""
        return len(self.coefficients)

    def series(self, start: arb, length: float, count: int) -> list[arb]:
        """Coefficients of the first powers of (t - start) / length."""
        about = arb_poly([start - arb(self.origin), arb(length)])
        shifted = arb_poly([arb(c) for c in self.coefficients])(about).coeffs()
        return [*shifted, *[ZERO] * count][:count]

    def tail(self, start: arb, length: float, count: int) -> arb:
        """Bound of the terms from `count` on times the cube of their number."""
        return ZERO if len(self.coefficients) <= count else arb("inf")

    def antiderivative(self, start: arb, value: arb) -> Polynomial:
        """The integral that has a value at an instant."""
        powers = [ZERO, *(arb(c) / (k + 1) for k, c in enumerate(self.coefficients))]
        powers[0] = value - arb_poly(powers)(start - arb(self.origin))
        return Polynomial(tuple(powers), self.origin)


@dataclass(frozen=True)
class Sine:
    """offset + amplitude sin(w (t - origin) + quarters pi / 2)."""

    amplitude: arb
    rate: arb  # w [rad/s]
    offset: arb
    quarters: int = 0
    origin: float = 0.0  # [s]

    def longest_step(self) -> float:
        """The longest step, of `ANGLE` radians [s]."""
        return ANGLE / float(self.rate.upper())

    def term_count(self, length: float) -> int:
        """As of `Polynomial`."""
        return term_count(float(self.rate.upper()) * length)

    def series(self, start: arb, length: float, count: int) -> list[arb]:
        """As of `Polynomial`."""
        phase = self.rate * (start - arb(self.origin)) + arb.pi() * self.quarters / 2
        with capped(count):
            sine = arb_series([phase, self.rate * arb(length)], prec=count).sin()
            return [sine[k] * self.amplitude + (0 if k else self.offset) for k in range(count)]

    def tail(self, start: arb, length: float, count: int) -> arb:
        """As of `Polynomial`."""
        step = self.rate * arb(length)
        first = abs(self.amplitude) * step**count / arb(count).fac()
        return tail_sum(step / (count + 1)) * arb(count) ** 3 * first

    def antiderivative(self, start: arb, value: arb) -> Sine:
        """The same of a sine without an offset."""
        turned = Sine(self.amplitude / self.rate, self.rate, ZERO, (self.quarters - 1) % 4, self.origin)
        return replace(turned, offset=value - turned.series(start, 1.0, 1)[0])


@dataclass(frozen=True)
class Ricker:
    """size (1 - 2 b^2) e^(-b^2) with b = pi f (t - 2/f), or its integral size (t - 2/f) e^(-b^2)."""

    size: float
    pulse_frequency: float  # f [Hz]
    integral: bool = False

    def longest_step(self) -> float:
        """The longest step, of `RICKER_ANGLE` [s]."""
        return RICKER_ANGLE / (math.pi * self.pulse_frequency) * (1 - 1e-12)

    def term_count(self, length: float) -> int:
        """As of `Polynomial`."""
        angle = math.pi * self.pulse_frequency * length
        rounded = 2.0 ** (math.ceil(2 * math.log2(max(angle, 1e-200))) / 2)  # few angles, whose counts are kept
        return _ricker_term_count(rounded, ctx.prec)

    def series(self, start: arb, length: float, count: int) -> list[arb]:
        """As of `Polynomial`."""
        f = arb(self.pulse_frequency)
        late = start - 2 / f
        with capped(count):
            delay = arb_series([late, arb(length)], prec=count)
            b = delay * (arb.pi() * f)
            bell = (b * b * -1).exp() * arb(self.size)
            pulse = bell * delay if self.integral else bell - bell * b * b * 2
            return [pulse[k] for k in range(count)]

    def tail(self, start: arb, length: float, count: int) -> arb:
        """As of `Polynomial`, by Cauchy's estimate on a disc."""
        f = arb(self.pulse_frequency)
        w = arb.pi() * f
        # e^(-b^2) is at most e^(y^2) where |Im b| <= y; y^2 = count / 2 makes the estimate least
        y = (arb(count) / 2).sqrt()
        radius = y / (w * arb(length))
        largest = abs(w * (start - 2 / f)) + y
        factor = largest / w if self.integral else 1 + 2 * largest**2
        first = abs(arb(self.size)) * factor * (y * y).exp() / radius**count
        return tail_sum(1 / radius) * arb(count) ** 3 * first

    def antiderivative(self, start: arb, value: arb) -> Ricker:
        """The integral that is zero long before the pulse; at t = 0 it is e^(-4 pi^2) of its greatest values."""
        return replace(self, integral=True)


@cache
def _ricker_term_count(angle: float, bits: int) -> int:
    """Terms n from which on Cauchy's estimate (angle sqrt(2 e / n))^n is below the digits."""
    n = 8
    while n * math.log2(angle * math.sqrt(2 * math.e / n)) > -bits - 12:
        n += 1
    return n


Piece = Polynomial | Sine | Ricker
NOTHING = Polynomial((0.0,))


@dataclass(frozen=True)
class Course:
    """A function of time in pieces; the first one reaches back to t = 0."""

    breaks: tuple[float, ...]  # where the second and each further piece begins, increasing [s]
    pieces: tuple[Piece, ...]

    def piece_at(self, time: float) -> Piece:
        """The piece from an instant on."""
        return self.pieces[bisect_right(self.breaks, time)]

    def parts(self) -> list[tuple[float, Piece]]:
        """The pieces from t = 0 on, each with its beginning [s]."""
        first = bisect_right(self.breaks, 0.0)
        return list(zip((0.0, *self.breaks[first:]), self.pieces[first:], strict=True))

    def integral(self) -> Course:
        """The integral that is zero where the first piece begins."""
        value = ZERO
        start = ZERO
        pieces = []
        for number, piece in enumerate(self.pieces):
            pieces.append(piece.antiderivative(start, value))
            if number < len(self.breaks):
                start = arb(self.breaks[number])
                value = pieces[-1].series(start, 1.0, 1)[0]
        return Course(self.breaks, tuple(pieces))


Drive = Callable[[], Course]  # makes its course in the precision of the current context


def still() -> Course:
    """Nothing."""
    return Course((), (NOTHING,))


def constant(size: float) -> Drive:
    """A size from t = 0 on."""
    return lambda: Course((), (Polynomial((size,)),))


def integrated(drive: Drive, times: int = 1) -> Drive:
    """A drive that is integrated from t = 0, or from before the first row of a record, so many times."""

    def course() -> Course:
        integral = drive()
        for _ in range(times):
            integral = integral.integral()
        return integral

    return course


def half_sine(size: float, duration: float) -> Drive:
    """Size sin(pi t / T) until T and nothing after it."""
    return lambda: Course((duration,), (Sine(arb(size), arb.pi() / arb(duration), ZERO), NOTHING))


def sine(size: float, frequency: float, quarters: int = 0) -> Drive:
    """Size sin(2 pi f t + quarters pi / 2) from t = 0 on."""
    return lambda: Course((), (Sine(arb(size), 2 * arb.pi() * arb(frequency), ZERO, quarters),))


def triangle(size: float, duration: float) -> Drive:
    """Size (1 - t/T) until T and nothing after it."""
    return lambda: Course((duration,), (Polynomial((arb(size), -arb(size) / arb(duration))), NOTHING))


def ricker(size: float, frequency: float) -> Drive:
    """A Ricker pulse about 2/f."""
    return lambda: Course((), (Ricker(size, frequency),))


def recorded(times: Sequence[float], values: Sequence[float]) -> Drive:
    """A record that is linear between its rows and zero outside of them."""
    return lambda: Course(tuple(times), (NOTHING, *_lines(times, values), NOTHING))


def path(times: Sequence[float], values: Sequence[float]) -> Drive:
    """A record that is linear between its rows, and stays where it is before and after them."""
    before = Polynomial((values[0],))
    after = Polynomial((values[-1],))
    return lambda: Course(tuple(times), (before, *_lines(times, values), after))


def _lines(times: Sequence[float], values: Sequence[float]) -> Iterator[Polynomial]:
    """Yield what is between the rows of a record."""
    for (start, end), (first, last) in zip(pairwise(times), pairwise(values), strict=True):
        slope = (arb(last) - arb(first)) / (arb(end) - arb(start))
        yield Polynomial((arb(first), slope), start)
