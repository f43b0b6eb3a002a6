"""Isotropic linear elastic material in plane stress or plane strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from dda.model.checks import check_among, check_positive

Hypothesis = Literal["plane stress", "plane strain"]


@dataclass(frozen=True)
class Material:
    """Isotropic linear elastic material.

    The moduli are products and quotients of 1 - mu, 1 + mu and 1 - 2 mu, each exact or
    correctly rounded near its zero, so that nearly singular materials keep their digits.
    """

    density: float  # rho [kg/m^3]
    young: float  # E [Pa]
    poisson: float  # mu [-]
    hypothesis: Hypothesis = "plane stress"  # or "plane strain"

    def __post_init__(self) -> None:
        check_positive(density=self.density, young=self.young)
        check_among(("plane stress", "plane strain"), hypothesis=self.hypothesis)
        strain = self.hypothesis == "plane strain"
        if not (-1 < self.poisson < 0.5 or (self.poisson == 0.5 and not strain)):
            rule = "-1 < mu < 0.5 in plane strain" if strain else "-1 < mu <= 0.5 in plane stress"
            raise ValueError(f"poisson: must satisfy {rule}, got {self.poisson!r}")

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + mu)) [Pa]."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def constrained_modulus(self) -> float:
        """Lambda + 2 G [Pa]: stress over strain when the other direct strain is held.

        E / (1 - mu^2) in plane stress, E (1 - mu) / ((1 + mu)(1 - 2 mu)) in plane strain.
        """
        mu = self.poisson
        if self.hypothesis == "plane stress":
            return self.young / ((1 - mu) * (1 + mu))
        return self.young * (1 - mu) / ((1 + mu) * (1 - 2 * mu))

    @property
    def free_modulus(self) -> float:
        """4 G (lambda + G) / (lambda + 2 G) [Pa]: stress over strain when the other direct stress is zero.

        E in plane stress, E / (1 - mu^2) in plane strain.
        """
        mu = self.poisson
        return self.young if self.hypothesis == "plane stress" else self.young / ((1 - mu) * (1 + mu))

    @property
    def contraction(self) -> float:
        """C = lambda / (lambda + 2 G) [-]: free lateral contraction, mu or mu / (1 - mu)."""
        mu = self.poisson
        return mu if self.hypothesis == "plane stress" else mu / (1 - mu)

    def elasticity(self) -> NDArray[np.float64]:
        """Return the 3 x 3 matrix of stress over strain (sx, sy, txy) = C (ex, ey, gxy) [Pa].

        Eq. (21) with its missing factor E / (1 - mu^2).
        """
        C = self.constrained_modulus
        c = self.contraction
        return np.array([[C, c * C, 0.0], [c * C, C, 0.0], [0.0, 0.0, self.shear_modulus]])
