"""Sums of exponentials times polynomials in ball arithmetic, f(s) = Re sum of Q_r(s) exp(r s), and where one falls.

Waves in bars with springs between them are such functions: a rate is zero, the decay rate -kappa of a spring against
the bars that it joins, or i w of a sine that drives them. All functions of one motion share a table of rates, so that
terms of the same rate are added and cancel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from flint import acb, acb_poly, arb, arb_poly, ctx

from fem_reference.events.enclosure import Fall, Local, ball, first_fall, is_blank

Rate = arb | acb
Polynomial = arb_poly | acb_poly
NOISE_BITS = 100
"""Bits, of the size of the velocities, below which a coefficient that may be zero counts as zero."""
SPARE_BITS = 20
"""Bits beyond the precision below which a coefficient counts as zero even if it is none."""

BISECTIONS = 40
"""Quarters in which the reach of a derivative's sign is sought."""


@dataclass(frozen=True)
class Rates:
    """The rates of a motion, and the sizes by which noise is told from numbers."""

    values: tuple[Rate, ...]  # rates [1/s]; the first is zero
    velocity: arb  # size of the velocities [m/s]
    end: arb  # last instant [s]

    def index(self, rate: Rate) -> int:
        """Number of a rate in the table.

        Raises
        ------
        LookupError
            If it is not in the table.
        """
        for number, value in enumerate(self.values):
            if isinstance(value, acb) == isinstance(rate, acb) and value.overlaps(rate):
                return number
        raise LookupError(f"rate: must be in the table, got {rate}")

    def unit(self, number: int) -> arb:
        """Size of a derivative of a term over the term [1/s]."""
        rate = self.values[number]
        return abs(rate) if number and isinstance(rate, arb) else 1 / self.end


def distinct(rates: list[Rate]) -> tuple[Rate, ...]:
    """Zero and those rates that differ from each other."""
    table: list[Rate] = [arb(0)]
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
        """Whether any term is left."""
        return any(Q.length() for Q in self.terms.values())

    def __call__(self, s: arb) -> arb:
        """Value."""
        value = arb(0)
        for number, Q in self.terms.items():
            term = Q(s)
            if number:
                term = term * (self.rates.values[number] * s).exp()
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
        if s == 0:
            return self
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
        return antiderivative.plus(start - antiderivative(arb(0)))

    def relaxed(self, kappa: arb, start: arb) -> ExponentialSum:
        """The w with w' + kappa w = f and the value `start` at zero; beside exp(-kappa s) itself R' = Q."""
        own = self.rates.index(-kappa)
        terms: dict[int, Polynomial] = {own: arb_poly([])}
        for number, Q in self.terms.items():
            terms[number] = Q.integral() if number == own else _particular(Q, self.rates.values[number] + kappa)
        particular = ExponentialSum(self.rates, terms)
        terms[own] = terms[own] + arb_poly([start - particular(arb(0))])
        return ExponentialSum(self.rates, terms)

    def without_noise(self) -> ExponentialSum:
        """The function without the terms that rounding has left of what cancels, and without those far below it."""
        terms: dict[int, Polynomial] = {}
        for number, Q in self.terms.items():
            unit = self.rates.unit(number)
            uncertain = self.rates.velocity * arb(2) ** -NOISE_BITS
            negligible = self.rates.velocity * arb(2) ** -(ctx.prec + SPARE_BITS)
            coefficients = Q.coeffs()
            for k, c in enumerate(coefficients):
                if abs(c) < negligible or (c.contains(0) and abs(c) < uncertain):
                    coefficients[k] = arb(0)
                uncertain *= unit
                negligible *= unit
            cleaned = type(Q)(coefficients)
            if cleaned.length():
                terms[number] = cleaned
        return ExponentialSum(self.rates, terms)

    def first_sign(self) -> int:
        """Sign just after zero, 0 for the zero function."""
        function = self
        for _ in range(sum(2 * Q.length() for Q in self.terms.values())):
            value = function(arb(0))
            if not is_blank(value):
                return 1 if value > 0 else -1
            function = function.derivative()
        return 0

    def first_fall(self, end: arb, touches: list[arb] | None = None) -> Fall | None:
        """The first s in (0, end] at which the function, positive just after zero, falls through it, or None.

        See `enclosure.first_fall`.
        """
        if not self:
            return None
        slope = self.derivative()
        bend = slope.derivative()
        start = self._positive_until(end)
        near: list[arb] = []

        def local(middle: arb, half: arb) -> Local:
            now = middle + start
            return Local(self(now), slope(now), bend(now + ball(half)))

        fall = first_fall(local, (end - start).mid(), near, stop_in_noise=True)
        if touches is not None:
            touches += [start + s for s in near]
        return None if fall is None else Fall(fall.at + start, fall.grazing)

    def _positive_until(self, end: arb) -> arb:
        """A point up to which a function that is zero at zero is positive by the first derivative that is not.

        Below it the function is smaller than its rounding, so that no bisection could tell.
        """
        derivative = self
        for _ in range(sum(2 * Q.length() for Q in self.terms.values())):
            value = derivative(arb(0))
            if not is_blank(value):
                break
            derivative = derivative.derivative()
        if derivative is self or not value > 0:
            return arb(0)
        reach = (end / 4).mid()
        for _ in range(BISECTIONS):
            if derivative(reach / 2 + ball(reach / 2)) > 0:
                return reach
            reach = (reach / 4).mid()
        return arb(0)


def _particular(G: Polynomial, rate: Rate) -> Polynomial:
    """The polynomial w with w' + rate w = G."""
    coefficients = G.coeffs()
    above = type(rate)(0)
    for k in range(len(coefficients) - 1, -1, -1):
        above = (coefficients[k] - (k + 1) * above) / rate
        coefficients[k] = above
    return acb_poly(coefficients) if isinstance(rate, acb) or isinstance(G, acb_poly) else arb_poly(coefficients)
