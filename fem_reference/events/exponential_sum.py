"""Sums of exponentials times polynomials in many digits, f(s) = Re sum of Q_r(s) exp(r s), and where one falls.

Waves in bars with springs between them are such functions: a rate is zero, the decay rate -kappa of a spring against
the bars that it joins, or i w of a sine that drives them. All functions of one motion share a table of rates, so that
terms of the same rate are added and cancel.

The coefficients are rounded to numbers without a radius: from echo to echo the balls of such sums, whose terms cancel,
grow by many digits where their functions lose none. What a motion is off is seen from one in more digits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from flint import acb, acb_poly, arb, arb_poly

from fem_reference.events.enclosure import ZERO, first_fall, polynomial
from fem_reference.events.switches import Work

Rate = Any  # arb, or acb of a sine; python-flint's stubs know no arithmetic of either
Polynomial = Any  # arb_poly, or acb_poly beside the rate of a sine
# Bits, of the size of the velocities, below which a coefficient counts as zero: bars that touch at rest, whose
# contacts would otherwise open and close in turns of no size and at the cost of all digits.
NEGLIGIBLE_BITS = 80
# Time over which a function is taken as a power series, over that in which its fastest exponential decays.
STRETCH = 2.0
ORDER = 48  # terms of that series; 2^48 / 48! = 2e-47
HALVINGS = 16  # doublings by which the intervals of the search grow behind a zero at its start
NEWTON_STEPS = 4  # steps in which a root of the series becomes one of the function


@dataclass(frozen=True)
class Rates:
    """The rates of a motion, and the sizes by which noise is told from numbers."""

    values: tuple[Rate, ...]  # rates [1/s]; the first is zero
    velocity: arb  # size of the velocities [m/s]
    travel: arb  # shortest time of a wave along a bar [s]
    end: arb  # last instant [s]
    work: Work = field(default_factory=Work, compare=False)

    def index(self, rate: Rate) -> int:
        """Number of a rate in the table."""
        kind = isinstance(rate, acb)
        alike = (isinstance(value, acb) == kind and value.overlaps(rate) for value in self.values)
        return next(number for number, found in enumerate(alike) if found)

    @cached_property
    def negligible(self) -> arb:
        """Velocity that counts as zero [m/s]."""
        return (self.velocity * arb(2) ** -NEGLIGIBLE_BITS).mid()

    @cached_property
    def negligible_length(self) -> arb:
        """Length that counts as zero [m]."""
        return (self.negligible * self.travel).mid()

    @cached_property
    def fastest(self) -> arb:
        """Greatest size of a derivative over its function [1/s]."""
        sizes: list[arb] = [1 / self.travel, *(abs(rate) for rate in self.values)]
        return max(sizes, key=float).mid()

    def unit(self, number: int) -> arb:
        """Size of a derivative of a term over the term [1/s]."""
        rate = self.values[number]
        size = abs(rate) if number and isinstance(rate, arb) else 1 / self.end
        return size


def distinct(rates: list[Rate]) -> tuple[Rate, ...]:
    """Zero and those rates that differ from each other."""
    table = [ZERO]
    for rate in rates:
        if not any(isinstance(rate, acb) == isinstance(other, acb) and rate.overlaps(other) for other in table):
            table.append(rate)
    return tuple(table)


@dataclass(frozen=True)
class ExponentialSum:
    """A function of the time s since a piece began."""

    rates: Rates
    terms: Mapping[int, Polynomial] = field(default_factory=dict)  # number of a rate to its polynomial

    @classmethod
    def polynomial(cls, rates: Rates, coefficients: list[arb]) -> ExponentialSum:
        """A polynomial, its constant first."""
        return cls(rates, {0: arb_poly(coefficients)} if coefficients else {})

    def __add__(self, other: ExponentialSum) -> ExponentialSum:
        terms = dict(self.terms)
        for number, Q in other.terms.items():
            terms[number] = terms[number] + Q if number in terms else Q
        return ExponentialSum(self.rates, terms)

    def __sub__(self, other: ExponentialSum) -> ExponentialSum:
        return self + other * -1

    def __mul__(self, factor: arb | int) -> ExponentialSum:
        return ExponentialSum(self.rates, {number: Q * factor for number, Q in self.terms.items()})

    def plus(self, *coefficients: arb) -> ExponentialSum:
        """The function with a polynomial added."""
        return self + ExponentialSum.polynomial(self.rates, [*coefficients])

    def __bool__(self) -> bool:
        return any(Q.length() for Q in self.terms.values())

    def __call__(self, s: arb) -> arb:
        """Value."""
        value = ZERO
        for number, Q in self.terms.items():
            term = Q(s)
            if number:
                term *= (self.rates.values[number] * s).exp()
            value += term.real if isinstance(term, acb) else term
        return value

    def derivative(self) -> ExponentialSum:
        """Derivative: of each term (Q' + r Q) exp(r s)."""
        terms = {}
        for number, Q in self.terms.items():
            terms[number] = Q.derivative() + Q * self.rates.values[number] if number else Q.derivative()
        return ExponentialSum(self.rates, terms)

    def shifted(self, s: arb) -> ExponentialSum:
        """The function of the time since s."""
        terms = {}
        for number, Q in self.terms.items():
            shift = acb_poly([s, 1]) if isinstance(Q, acb_poly) else arb_poly([s, 1])
            terms[number] = Q(shift) * (self.rates.values[number] * s).exp() if number else Q(shift)
        return ExponentialSum(self.rates, terms)

    def integral(self, start: arb) -> ExponentialSum:
        """Antiderivative with the value `start` at zero: beside each exponential S' + r S = Q."""
        terms = {}
        for number, Q in self.terms.items():
            terms[number] = _particular(Q, self.rates.values[number]) if number else Q.integral()
        antiderivative = ExponentialSum(self.rates, terms)
        return antiderivative.plus(start - antiderivative(ZERO))

    def relaxed(self, kappa: arb, start: arb) -> ExponentialSum:
        """The w with w' + kappa w = f and the value `start` at zero; beside exp(-kappa s) itself R' = Q."""
        own = self.rates.index(-kappa)
        terms = {own: arb_poly([])}
        for number, Q in self.terms.items():
            terms[number] = Q.integral() if number == own else _particular(Q, self.rates.values[number] + kappa)
        particular = ExponentialSum(self.rates, terms)
        terms[own] += arb_poly([start - particular(ZERO)])
        return ExponentialSum(self.rates, terms)

    def without_noise(self, integrated: bool = False) -> ExponentialSum:
        """The function, rounded, without the terms that are negligible beside the velocities, or their integrals."""
        size = self.rates.negligible_length if integrated else self.rates.negligible
        terms = {}
        for number, Q in self.terms.items():
            unit = self.rates.unit(number)
            negligible = size
            coefficients = Q.coeffs()
            for k, c in enumerate(coefficients):
                coefficients[k] = ZERO if abs(c) < negligible else c.mid()
                negligible *= unit
            cleaned = type(Q)(coefficients)
            if cleaned.length():
                terms[number] = cleaned
        return ExponentialSum(self.rates, terms)

    def first_sign(self) -> int:
        """Sign just after zero of a velocity, 0 for the zero function."""
        function = self
        negligible = self.rates.negligible
        for _ in range(sum(2 * Q.length() for Q in self.terms.values())):
            value = function(ZERO)
            if abs(value) > negligible:
                return 1 if value > 0 else -1
            function = function.derivative()
            negligible *= self.rates.fastest
        return 0

    def first_fall(self, end: arb, integrated: bool) -> arb | None:
        """The first s in (0, end] at which the function, positive just after zero, falls through it, or None.

        Its size is that of velocities, or of their integrals; what is negligible beside them is no crossing.
        """
        if not self:
            return None
        end = end.mid()
        floor = self.rates.negligible_length if integrated else self.rates.negligible
        start = ZERO
        flat = bool(abs(self(start)) < floor)
        while start < end:
            here = self.shifted(start).without_noise(integrated)
            here.count_terms()
            rates = [abs(self.rates.values[number]) for number in here.terms if number]
            length = (end - start).mid()
            if rates:
                length = min(length, (STRETCH / max(rates)).mid())
            if flat:  # a zero of a high order at the start, beside which bounds over the whole length say nothing
                length = min(length, max(start, (length * arb(2) ** -HALVINGS).mid()))
            # as one power series: its terms have cancelled, which those of polynomials and exponentials do in no ball
            fall = first_fall(polynomial(here.series(), length), length, floor=floor)
            if fall is not None:
                return self._polished((start + fall.at).mid())
            start = (start + length).mid()
        return None

    def count_terms(self) -> None:
        """Count the products of which the power series is made, as work."""
        self.rates.work.add(ORDER * sum(Q.length() for Q in self.terms.values()))

    def series(self) -> list[arb]:
        """Coefficients of the power series about zero, as many as `ORDER` and those of polynomials."""
        total = arb_poly([])
        for number, Q in self.terms.items():
            if not number:
                total += Q
                continue
            rate = self.rates.values[number]
            powers = [type(rate)(1)]
            for k in range(1, ORDER):
                powers.append(powers[-1] * rate / k)
            product = (Q * type(Q)(powers)).coeffs()[:ORDER]
            total += arb_poly([c.real if isinstance(c, acb) else c for c in product])
        return list(total.coeffs())

    def _polished(self, root: arb) -> arb:
        """A root of the series as one of the function, by Newton's method as far as that changes it little."""
        slope = self.derivative()
        change = self.rates.travel * arb(2) ** -NEGLIGIBLE_BITS
        for _ in range(NEWTON_STEPS):
            step = self(root) / slope(root)
            if not abs(step) < change:
                break
            root = (root - step).mid()
        return root


def _particular(G: Polynomial, rate: Rate) -> Polynomial:
    """The polynomial w with w' + rate w = G."""
    coefficients = G.coeffs()
    above = type(rate)(0)
    for k in range(len(coefficients) - 1, -1, -1):
        above = (coefficients[k] - (k + 1) * above) / rate
        coefficients[k] = above
    return acb_poly(coefficients) if isinstance(rate, acb) or isinstance(G, acb_poly) else arb_poly(coefficients)
