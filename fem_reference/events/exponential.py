"""Polynomials plus a decaying exponential times polynomials, and where such a sum first falls through zero.

Waves on a bar with a spring at its end are such functions, f(s) = P(s) + exp(-kappa s) Q(s). With
D f = f' + kappa f = exp(-kappa s) (exp(kappa s) f)', the sequence f, D f, D D f, ... ends, after one more step
than the degree of Q, in a polynomial, and goes on with its derivatives. Between two zeros of any member lies
one of the next, so that the theorem of Budan and Fourier holds as for polynomials: with V(s) the changes of
sign along the sequence, f has at most V(a) - V(b) zeros in (a, b], and differs from it by an even number. No
crossing is missed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from itertools import pairwise, zip_longest

from fem_reference.events.decimals import ZERO, root

Coefficients = tuple[Decimal, ...]

NOISE = Decimal("1e-40")
"""Part of its terms below which a sum counts as zero."""
FINEST = Decimal("1e-30")
"""Part of an interval below which two crossings are one touch."""


@dataclass(frozen=True)
class Exponential:
    """P(s) + exp(-kappa s) Q(s); a function of the time s since a piece began."""

    kappa: Decimal  # decay rate, positive
    P: Coefficients  # coefficients of 1, s, s^2, ...
    Q: Coefficients = ()  # coefficients of 1, s, s^2, ... beside the exponential

    def __add__(self, other: Exponential) -> Exponential:
        return Exponential(self.kappa, _sum(self.P, other.P), _sum(self.Q, other.Q))

    def __mul__(self, factor: Decimal) -> Exponential:
        return Exponential(self.kappa, tuple(factor * x for x in self.P), tuple(factor * x for x in self.Q))

    def plus(self, *P: Decimal) -> Exponential:
        """The function with a polynomial added."""
        return Exponential(self.kappa, _sum(self.P, P), self.Q)

    def __call__(self, s: Decimal) -> Decimal:
        """Value."""
        decaying = (-self.kappa * s).exp() * _value(self.Q, s) if self.Q else ZERO
        return _value(self.P, s) + decaying

    def derivative(self) -> Exponential:
        """Derivative P' + exp(-kappa s) (Q' - kappa Q)."""
        return Exponential(
            self.kappa, _derivative(self.P), _sum(_derivative(self.Q), tuple(-self.kappa * x for x in self.Q))
        )

    def shifted(self, s: Decimal) -> Exponential:
        """The function of the time since s."""
        if not s:
            return self
        fade = (-self.kappa * s).exp() if self.Q else ZERO
        return Exponential(self.kappa, _shifted(self.P, s), tuple(fade * x for x in _shifted(self.Q, s)))

    def integral(self, start: Decimal) -> Exponential:
        """Antiderivative with the value `start` at zero; beside the exponential S' - kappa S = Q."""
        S: list[Decimal] = []
        above = ZERO
        for k in range(len(self.Q) - 1, -1, -1):
            above = ((k + 1) * above - self.Q[k]) / self.kappa
            S.insert(0, above)
        P = (start - (S[0] if S else ZERO), *(x / (k + 1) for k, x in enumerate(self.P)))
        return Exponential(self.kappa, P, tuple(S))

    def relaxed(self, start: Decimal) -> Exponential:
        """The w with w' + kappa w = f and the value `start` at zero; beside the exponential R' = Q."""
        P: list[Decimal] = []
        above = ZERO
        for k in range(len(self.P) - 1, -1, -1):
            above = (self.P[k] - (k + 1) * above) / self.kappa
            P.insert(0, above)
        first = start - (P[0] if P else ZERO)
        return Exponential(self.kappa, tuple(P), (first, *(x / (k + 1) for k, x in enumerate(self.Q))))

    def without_noise(self, scale: Decimal) -> Exponential:
        """The function without what rounding has left of polynomial terms that cancel."""
        P = [x if abs(x) > NOISE * scale else ZERO for x in self.P]
        while P and not P[-1]:
            P.pop()
        return Exponential(self.kappa, tuple(P), self.Q)

    def first_sign(self) -> int:
        """Sign just after zero, 0 for the zero function."""
        signs = [x for x in self._sequence() if x]
        return signs[0] if signs else 0

    def first_fall(self, end: Decimal) -> Decimal | None:
        """The first s in (0, end] at which the function falls through zero, None if it does not.

        The function is positive just after zero. An interval is passed over if the theorem allows no
        zero in it, or if its slope is too small for one.
        """
        pending = [(self._node(ZERO), self._node(end))]
        while pending:
            low, high = pending.pop()
            bound, length = low.changes - high.changes, high.at - low.at
            fine = length < FINEST * end
            if high.here.start < 0 and (bound <= 1 or fine):
                return self._crossing(low.at, high.at)
            if bound > 0 and not fine and low.here.start <= length * low.here.steepest(length):
                middle = self._node((low.at + high.at) / 2)
                pending += [(middle, high), (low, middle)]
        return None

    def _node(self, s: Decimal) -> Node:
        here = self.shifted(s)
        return Node(s, here, here.changes())

    def _crossing(self, low: Decimal, high: Decimal) -> Decimal:
        slope = self.derivative()
        return root(lambda s: (self(s), slope(s)), low, high)

    @property
    def start(self) -> Decimal:
        """Value at zero."""
        return (self.P[0] if self.P else ZERO) + (self.Q[0] if self.Q else ZERO)

    def steepest(self, length: Decimal) -> Decimal:
        """Bound of |f'| from zero to a length."""
        slope = self.derivative()
        return _value(tuple(map(abs, slope.P)), length) + _value(tuple(map(abs, slope.Q)), length)

    def changes(self) -> int:
        """Changes of sign along f, D f, D D f, ... at zero."""
        signs = [x for x in self._sequence() if x]
        return sum(a != b for a, b in pairwise(signs))

    def _sequence(self) -> Iterable[int]:
        """Signs of f, D f, D D f, ... and of the derivatives of the last polynomial, at zero."""
        P, factorial = self.P, Decimal(1)
        for i, x in enumerate(self.Q):
            factorial *= max(1, i)
            yield _sign((P[0] if P else ZERO), factorial * x)
            P = _sum(_derivative(P), tuple(self.kappa * x for x in P))
        for x in P:
            yield _sign(x, ZERO)


@dataclass(frozen=True)
class Node:
    """A point of the search for a crossing."""

    at: Decimal  # argument s of the function
    here: Exponential  # the function of the argument since s
    changes: int  # its changes of sign


def _sign(a: Decimal, b: Decimal) -> int:
    """Sign of a + b, 0 where both cancel."""
    total = a + b
    if abs(total) <= NOISE * (abs(a) + abs(b)):
        return 0
    return 1 if total > 0 else -1


def _sum(a: Coefficients, b: Coefficients) -> Coefficients:
    return tuple(x + y for x, y in zip_longest(a, b, fillvalue=ZERO))


def _value(a: Coefficients, s: Decimal) -> Decimal:
    total = ZERO
    for x in reversed(a):
        total = total * s + x
    return total


def _derivative(a: Coefficients) -> Coefficients:
    return tuple(k * x for k, x in enumerate(a))[1:]


def _shifted(a: Coefficients, s: Decimal) -> Coefficients:
    """Coefficients about s, by repeated synthetic division."""
    c = list(a)
    for i in range(len(c) - 1):
        for k in range(len(c) - 2, i - 1, -1):
            c[k] += s * c[k + 1]
    return tuple(c)
