"""Moduli of an elastic material in the plane."""

from __future__ import annotations


class Elastic:
    """What has Young's modulus, Poisson's ratio and a hypothesis of the plane problem."""

    young: float
    poisson: float
    hypothesis: str

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + mu)) [Pa]."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def lame(self) -> float:
        """First Lame parameter of the plane problem [Pa].

        E mu / (1 - mu^2) in plane stress, E mu / ((1 + mu) (1 - 2 mu)) in plane strain; both factors
        of the denominator are exact in floating point near their zeros.
        """
        mu = self.poisson
        last = 1 - mu if self.hypothesis == "plane stress" else 1 - 2 * mu
        return self.young * mu / ((1 + mu) * last)

    @property
    def wave_modulus(self) -> float:
        """Modulus lam + 2 G of a plane wave [Pa]."""
        return self.lame + 2 * self.shear_modulus
