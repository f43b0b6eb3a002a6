r"""Closed forms of steady vibrations and waves under the Newmark scheme.

Those of a time step are in `theory.stepping`. Frequencies, steps and moduli may be arrays; everything is in SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from validation.runs.history import Array, ArrayPair
from validation.theory.stepping import Complex, Stepping

GROWTH = 1e-9  # of a wave over a block, by rounding


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
        wavenumber = 2 * np.arcsin(np.sqrt(opening / 2)) / self.height
        growing = wavenumber.imag * self.height > GROWTH
        return np.where(growing, 2 * np.pi / self.height - wavenumber, wavenumber)

    def travelled(self, stepping: Stepping, omega: ArrayLike, distance: float) -> ArrayPair:
        """Return the share of the amplitude left over a distance, and the error w / Re k / c - 1 of the phase speed."""
        omega = np.asarray(omega, float)
        k = self.wavenumber(stepping.squared_frequency(omega))
        speed = np.sqrt(np.real(self.modulus) / self.density)
        return np.exp(-np.abs(k.imag) * distance), omega / k.real / speed - 1


def joint_transmission(ratio: ArrayLike) -> Array:
    """Return |T| of a joint in a continuum, (1 + (1 / (2 r))^2)^(-1/2) with r = kj / (rho c w)."""
    return (1 + (0.5 / np.asarray(ratio, float)) ** 2) ** -0.5


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


def base_reflection(column: Column, stepping: Stepping, omega: ArrayLike, impedance: float) -> Complex:
    """Return R of a transmitting base under welded blocks: the wave up from it over the wave down to it, both there.

    The lowest face has half the neighbours of the others and a dashpot z: (A + S z) x0 + B x1 = 0 with V = S D. With
    lambda = e^{-ikh}, x_j = up lambda^j + down lambda^-j:

        R = -(A + S z + B / lambda) / (A + S z + B lambda),

    which tends to (rho c - z) / (rho c + z).
    """
    w2 = stepping.squared_frequency(omega)
    A, B = column.ends(w2)
    decay = np.exp(-1j * column.wavenumber(w2) * column.height)
    diagonal = A + stepping.velocity_factor(omega) * impedance
    return -(diagonal + B / decay) / (diagonal + B * decay)
