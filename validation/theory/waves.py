r"""Closed forms of steady vibrations and waves under the Newmark scheme, written apart from the solvers.

With M A + C V + K D = F e^{iwt} taken at the steps, z = e^{iw dt} and gg times V at the start of each step,

    (z - gg) V = dt ((1 - delta) + delta z) A
    (z - 1) D  = gg dt V + dt^2 ((1/2 - alpha) + alpha z) A

are the corrector (7) and the predictor (6). Hence A = -W2 D with the squared frequency

    W2 = -(z - 1)(z - gg) / (dt^2 [gg ((1 - delta) + delta z) + (1/2 - alpha + alpha z)(z - gg)]),

and the stepped system answers as the system that is exact in time does at a complex frequency: (K - W2 M) D = F.
Frequencies, steps and moduli may be arrays; everything is in SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.scenes.scene import Scene

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
GROWTH = 1e-9  # of a wave over a block, by rounding


@dataclass(frozen=True)
class Stepping:
    """A time step and the parameters of its scheme."""

    step: float  # dt [s]
    alpha: float = 0.5  # [-]
    delta: float = 1.0  # [-]
    gg: float = 1.0  # share of the velocity that a step starts with [-]

    @classmethod
    def of(cls, scene: Scene) -> Stepping:
        """Return the stepping of a scene."""
        t = scene.time
        return cls(t.step, t.alpha, t.delta, t.discount)

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


@dataclass(frozen=True)
class Column:
    """A column of equal blocks, affine along its axis, as a wave guide."""

    height: float  # h of a block [m]
    density: float  # [kg/m^3]
    modulus: complex  # E for mu = 0, else the modulus of the motion; G for a shear wave [Pa]
    glue: float | None = None  # kg of the springs between blocks per area [Pa/m]; None where the blocks are welded

    def ends(self, w2: ArrayLike) -> tuple[Complex, Complex]:
        """Return the dynamic stiffness (A, B) per area of a block, at its own end and across [Pa/m].

        A = M / h - W2 rho h / 3 and B = -M / h - W2 rho h / 6.
        """
        w2 = np.asarray(w2, complex)
        stiffness, inertia = self.modulus / self.height, w2 * self.density * self.height
        return np.asarray(stiffness - inertia / 3), np.asarray(-stiffness - inertia / 6)

    def wavenumber(self, w2: ArrayLike) -> Complex:
        """Return k [rad/m] of the wave e^{iwt - ikx} that does not grow towards +x.

        cos(kh) = (6 - 2 L) / (6 + L), L = W2 h^2 rho / M; with glue cos(kh) = (B^2 - A^2 - 2 A kg) / (2 B kg). Solved
        for 1 - cos(kh) = 2 sin^2(kh/2), which keeps the digits of long waves: A + B is formed without subtraction.
        Beyond the cut-off, where Re kh = pi, and in the second band of glued blocks it is the root that decays.
        """
        w2 = np.asarray(w2, complex)
        inertia = w2 * self.density * self.height  # -2 (A + B)
        B = self.ends(w2)[1]
        opening = inertia / (-2 * B)  # 1 - cos(kh)
        if self.glue is not None:
            opening *= 1 + (2 * self.modulus / self.height - inertia / 6) / (2 * self.glue)  # (A - B + 2 kg) / (2 kg)
        found = 2 * np.arcsin(np.sqrt(opening / 2)) / self.height
        growing = found.imag * self.height > GROWTH
        return np.asarray(np.where(growing, 2 * np.pi / self.height - found, found))

    def travelled(self, stepping: Stepping, omega: ArrayLike, distance: float) -> tuple[Array, Array]:
        """Return the share of the amplitude left over a distance, and the error w / Re k / c - 1 of the phase speed."""
        omega = np.asarray(omega, float)
        k = self.wavenumber(stepping.squared_frequency(omega))
        speed = np.sqrt(np.real(self.modulus) / self.density)
        return np.exp(-np.abs(k.imag) * distance), omega / k.real / speed - 1


def joint_transmission(ratio: ArrayLike) -> Array:
    """Return |T| of a joint in a continuum, (1 + (1 / (2 r))^2)^(-1/2) with r = kj / (rho c w)."""
    return np.asarray((1 + (0.5 / np.asarray(ratio, float)) ** 2) ** -0.5)


def joint_in_column(column: Column, w2: ArrayLike, stiffness: float) -> tuple[Complex, Complex]:
    """Return (T, R) of a joint of stiffness kj [Pa/m] between two like halves of a column of welded blocks.

    With lambda = e^{-ikh}, Z = A + B lambda and Q = kj Z / (Z + kj): R = -(A + B / lambda + Q) / (Z + Q) and
    T = kj (1 + R) / (Z + kj), the amplitudes at the joint's two sides.
    """
    A, B = column.ends(w2)
    decay = np.exp(-1j * column.wavenumber(w2) * column.height)
    Z = A + B * decay
    Q = stiffness * Z / (Z + stiffness)
    reflected = -(A + B / decay + Q) / (Z + Q)
    return np.asarray(stiffness * (1 + reflected) / (Z + stiffness)), np.asarray(reflected)
