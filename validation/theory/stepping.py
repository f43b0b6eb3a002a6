r"""A time step of Newmark's scheme and what it makes of a harmonic motion, written apart from the solvers.

With M A + C V + K D = F e^{iwt} taken at the steps, z = e^{iw dt} and gg times V at the start of each step,

    (z - gg) V = dt ((1 - delta) + delta z) A
    (z - 1) D  = gg dt V + dt^2 ((1/2 - alpha) + alpha z) A

are the corrector (7) and the predictor (6). Hence A = -W2 D with the squared frequency

    W2 = -(z - 1)(z - gg) / (dt^2 [gg ((1 - delta) + delta z) + (1/2 - alpha + alpha z)(z - gg)]),

and the stepped system answers as the system that is exact in time does at a complex frequency: (K - W2 M) D = F.
Frequencies may be arrays; everything is in SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.scenes.scene import Scene

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Stepping:
    """A time step and the parameters of its scheme."""

    step: float  # dt [s]
    alpha: float = 0.5  # [-]
    delta: float = 1.0  # [-]
    gg: float = 1.0  # share of the velocity that a step starts with [-]
    rate: float | None = None  # of gg = exp(-rate dt), where the discount is stated so [1/s]
    implicit: bool = False  # the force of a contact fully implicit, average acceleration in the block

    @classmethod
    def of(cls, scene: Scene) -> Stepping:
        """Return the stepping of a scene."""
        t = scene.time
        implicit = scene.column is None and scene.contact.rule == "implicit"
        return cls(t.step, t.alpha, t.delta, t.discount, t.gg_rate, implicit)

    def at(self, step: float) -> Stepping:
        """Return the scheme at another step; a discount stated as a rate stays one."""
        gg = self.gg if self.rate is None else math.exp(-self.rate * step)
        return replace(self, step=step, gg=gg)

    @property
    def has_contact_forces(self) -> bool:
        """Whether a contact has a force at the end of a step: alpha > 0."""
        return self.implicit or self.alpha > 0

    @property
    def words(self) -> str:
        """The numbers in words."""
        return f"dt = {self.step:.6g} s, (alpha, delta) = ({self.alpha:.6g}, {self.delta:.6g}), gg = {self.gg:.9g}"

    def squared_frequency(self, omega: ArrayLike) -> Complex:
        """Return W2 [1/s^2] at angular frequencies w [rad/s]: A = -W2 D."""
        half = 0.5 * self.step * np.asarray(omega, float)
        turn = 2j * np.sin(half) * np.exp(1j * half)  # z - 1 without subtraction
        ahead = (1 - self.gg) + turn  # z - gg
        below = self.gg * (1 + self.delta * turn) + (0.5 + self.alpha * turn) * ahead
        return np.asarray(-turn * ahead / (self.step**2 * below), complex)

    def velocity_factor(self, omega: ArrayLike) -> Complex:
        """Return S [1/s] of V = S D, which is i w in exact time: -W2 dt ((1 - delta) + delta z) / (z - gg)."""
        half = 0.5 * self.step * np.asarray(omega, float)
        turn = 2j * np.sin(half) * np.exp(1j * half)
        below = self.gg * (1 + self.delta * turn) + (0.5 + self.alpha * turn) * ((1 - self.gg) + turn)
        return np.asarray(turn * (1 + self.delta * turn) / (self.step * below), complex)

    def rayleigh(self) -> tuple[float, float]:
        """Return (a0 [1/s], a1 [s]) of the Rayleigh damping that the step hides, in the limit w dt -> 0.

        a0 = 2 (1 - gg) / ((1 + gg) dt) is the kinetic part, -Im W2 / w there; a1 = (delta - 1/2) dt is the algorithmic
        one, for gg near 1. A free vibration loses a0 = -ln(gg) / dt, the same to second order in 1 - gg.
        """
        return 2 * (1 - self.gg) / ((1 + self.gg) * self.step), (self.delta - 0.5) * self.step
