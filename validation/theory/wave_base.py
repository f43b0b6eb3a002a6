"""Closed form of the reflection of a wave by a transmitting base under a column of welded blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from validation.theory.waves import Column, Complex, Stepping


def base_reflection(column: Column, stepping: Stepping, omega: ArrayLike, impedance: float) -> Complex:
    """Return R, the wave that goes up from the base over the one that comes down, both at the base.

    The lowest face has half the neighbours of the others and a dashpot z: (A + S z) x0 + B x1 = 0 with V = S D. With
    lambda = e^{-ikh}, x_j = up lambda^j + down lambda^-j:

        R = -(A + S z + B / lambda) / (A + S z + B lambda),

    which tends to (rho c - z) / (rho c + z).
    """
    w2 = stepping.squared_frequency(omega)
    A, B = column.ends(w2)
    decay = np.exp(-1j * column.wavenumber(w2) * column.height)
    own = A + stepping.velocity_factor(omega) * impedance
    return np.asarray(-(own + B / decay) / (own + B * decay))
