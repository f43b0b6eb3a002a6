"""Polynomials plus a decaying exponential times polynomials in ball arithmetic, and where such a sum first falls.

Waves on a bar with a spring at its end are such functions, f(s) = P(s) + exp(-kappa s) Q(s).
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, arb_poly

from fem_reference.events.enclosure import Fall, Local, ball, first_fall, is_blank

NOTHING = arb_poly([])
NOISE_BITS = 130
"""Bits after which a term counts as zero, of the size of the velocities and of the power of the decay rate."""


@dataclass(frozen=True)
class Exponential:
    """P(s) + exp(-kappa s) Q(s); a function of the time s since a piece began."""

    kappa: arb  # decay rate, positive
    P: arb_poly
    Q: arb_poly = NOTHING

    def __add__(self, other: Exponential) -> Exponential:
        return Exponential(self.kappa, self.P + other.P, self.Q + other.Q)

    def __mul__(self, factor: arb | int) -> Exponential:
        return Exponential(self.kappa, self.P * factor, self.Q * factor)

    def plus(self, *P: arb) -> Exponential:
        """The function with a polynomial added."""
        return Exponential(self.kappa, self.P + arb_poly([*P]), self.Q)

    def __call__(self, s: arb) -> arb:
        """Value."""
        return self.P(s) + (-self.kappa * s).exp() * self.Q(s)

    def derivative(self) -> Exponential:
        """Derivative P' + exp(-kappa s) (Q' - kappa Q)."""
        return Exponential(self.kappa, self.P.derivative(), self.Q.derivative() - self.Q * self.kappa)

    def shifted(self, s: arb) -> Exponential:
        """The function of the time since s."""
        later = arb_poly([s, 1])
        return Exponential(self.kappa, self.P(later), self.Q(later) * (-self.kappa * s).exp())

    def integral(self, start: arb) -> Exponential:
        """Antiderivative with the value `start` at zero; beside the exponential S' - kappa S = Q."""
        S = _particular(self.Q, -self.kappa)
        return Exponential(self.kappa, self.P.integral() + (start - S[0]), S)

    def relaxed(self, start: arb) -> Exponential:
        """The w with w' + kappa w = f and the value `start` at zero; beside the exponential R' = Q."""
        P = _particular(self.P, self.kappa)
        return Exponential(self.kappa, P, self.Q.integral() + (start - P[0]))

    def without_noise(self, scale: arb) -> Exponential:
        """The function without the terms that rounding has left of what cancels, which count as zero."""
        parts = []
        for part, rate in ((self.P, arb(1)), (self.Q, self.kappa)):
            coefficients = part.coeffs()
            for k, c in enumerate(coefficients):
                if c.contains(0) and abs(c) < scale * arb(2) ** -NOISE_BITS * rate**k:
                    coefficients[k] = arb(0)
            parts.append(arb_poly(coefficients))
        return Exponential(self.kappa, *parts)

    def first_sign(self) -> int:
        """Sign just after zero, 0 for the zero function."""
        function = self
        for _ in range(self.P.length() + self.Q.length() + 1):
            value = function.P[0] + function.Q[0]
            if not is_blank(value):
                return 1 if value > 0 else -1
            function = function.derivative()
        return 0

    def first_fall(self, end: arb, touches: list[arb] | None = None) -> Fall | None:
        """The first s in (0, end] at which the function falls through zero, None if it does not.

        The function is positive just after zero; see `enclosure.first_fall`.
        """
        function = self
        if self.P.length() == 0:  # the exponential, which may be smaller than any number, has no zero
            function = Exponential(self.kappa, self.Q)
        if function.P.length() + function.Q.length() == 0:
            return None
        slope = function.derivative()
        bend = slope.derivative()

        def local(middle: arb, half: arb) -> Local:
            return Local(function(middle), slope(middle), bend(middle + ball(half)))

        return first_fall(local, end, touches)


def _particular(G: arb_poly, kappa: arb) -> arb_poly:
    """The polynomial w with w' + kappa w = G."""
    w: list[arb] = []
    above = arb(0)
    for k in range(G.length() - 1, -1, -1):
        above = (G[k] - (k + 1) * above) / kappa
        w.insert(0, above)
    return arb_poly(w)
