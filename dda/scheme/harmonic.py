r"""Steady vibrations of the scheme: what a step makes of a frequency.

Let all quantities go as z^n with z = e^{iw dt}. The velocity corrector (7) and the displacement that (6) gives are

    (z - gg) V = dt (1 + delta (z - 1)) A
    (z - 1) D  = gg dt V + dt^2 (1/2 + alpha (z - 1)) A

so that A = -W2 D with one complex number W2 for each frequency, whatever the model: the stepped system answers a
steady load, M A + K D = F e^{iwt}, as (K - W2 M) D = F.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dda.scheme.newmark import Scheme

Complex = NDArray[np.complex128]


def squared_frequency(scheme: Scheme, omega: ArrayLike) -> Complex:
    """Return W2 = -A / D of the stepped system [1/s^2]; it tends to w^2 as dt does to zero at gg = 1.

    Parameters
    ----------
    omega : array_like
        Angular frequencies w of the load [rad/s].
    """
    forward, velocity_difference, moved = _parts(scheme, omega)
    return np.asarray(-(forward / scheme.step) * (velocity_difference / scheme.step) / moved)


def _parts(scheme: Scheme, omega: ArrayLike) -> tuple[Complex, Complex, Complex]:
    """Return z - 1 and z - gg, and (z - 1)(z - gg) D / (dt^2 A), which the two lines give."""
    half = np.asarray(omega, float) * (scheme.step / 2)
    forward: Complex = np.asarray(2j * np.sin(half) * np.exp(1j * half))  # all digits of a slow load
    velocity_difference: Complex = np.asarray(forward + (1 - scheme.gg))
    moved: Complex = scheme.gg * (1 + scheme.delta * forward) + (0.5 + scheme.alpha * forward) * velocity_difference
    eps = np.finfo(float).eps
    return (
        forward,
        velocity_difference,
        np.where(np.abs(moved) > eps, moved, eps),
    )  # a load that turns every step may move nothing


def velocity_factor(scheme: Scheme, omega: ArrayLike) -> Complex:
    """Return S = V / D of the stepped system [1/s]; it tends to i w as dt does to zero."""
    forward, _, moved = _parts(scheme, omega)
    return np.asarray(forward * (1 + scheme.delta * forward) / (scheme.step * moved))


def chosen(scheme: Scheme, frequencies: ArrayLike, exact: bool) -> tuple[Complex, Complex]:
    """Return W2 and S at frequencies in Hz, as stepped or what they tend to with dt.

    The limit is w^2 - i c w if kinetic damping keeps its rate c = -ln(gg) / dt, and S = i w.

    Raises
    ------
    ValueError
        If gg is zero, which has no rate.
    """
    w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    if not exact:
        return squared_frequency(scheme, w), velocity_factor(scheme, w)
    if scheme.gg == 0:
        raise ValueError("gg: must be positive for a damping rate -ln(gg) / dt, got 0")
    rate = -math.log(scheme.gg) / scheme.step
    return np.asarray(w * w - 1j * rate * w), np.asarray(1j * w, complex)


def answering(scheme: Scheme, frequencies: ArrayLike, exact: bool) -> tuple[Complex, Complex]:
    """Return the squared frequency at which the undamped system answers, and the factor on its answer.

    With C = a0 M + a1 K, (K + S C - W2 M) D = F is (1 + a1 S) (K - W2' M) D = F, W2' = (W2 - a0 S) / (1 + a1 S).
    """
    W2, S = chosen(scheme, frequencies, exact)
    if not scheme.damped:
        return W2, np.ones_like(W2)
    stiffer = 1 + scheme.stiffness_damping * S
    return np.asarray((W2 - scheme.mass_damping * S) / stiffer), np.asarray(1 / stiffer)
