r"""Closed forms of the Newmark scheme with kinetic damping for one mode.

For a mode of frequency w, Omega = w dt, beta = 1 + alpha Omega^2 and X = Omega^2 / beta, every
step but the first maps the mode's state with the eigenvalues of

    lambda^2 - trace lambda + det = 0,
    trace = 1 + gg - (1/2 + gg delta) X,        det = gg (1 + (1/2 - delta) X)

(the third eigenvalue is zero). At gg = 1 this is eq. (11), (12). A complex pair is written
lambda = exp((-xi + i sqrt(1 - xi^2)) w' dt). All functions take arrays of Omega [-].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dda.model.arrays import Array

Number = float | Array  # alpha, delta and gg may vary with Omega where a function takes arrays
ComplexArray = NDArray[np.complex128]


def _x(omega: ArrayLike, alpha: Number) -> Array:
    """Return X = Omega^2 / (1 + alpha Omega^2), safe for huge Omega."""
    Omega = np.asarray(omega, dtype=float)
    small = np.minimum(Omega, 1.0)
    inverse = 1 / np.maximum(Omega, 1.0)
    with np.errstate(divide="ignore", under="ignore"):
        x: Array = np.where(Omega <= 1, small**2 / (1 + alpha * small**2), 1 / (inverse**2 + alpha))
    return x


def trace(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return the sum of the two eigenvalues."""
    return (1 + gg) - (0.5 + gg * delta) * _x(omega, alpha)


def determinant(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return the product of the two eigenvalues, gg (1 + h) with h of eq. (12)."""
    return gg * (1 + (0.5 - delta) * _x(omega, alpha))


def _discriminant(omega: ArrayLike, alpha: Number, delta: Number, gg: Number) -> Array:
    """Return trace^2 - 4 det, arranged so that small Omega keeps its digits."""
    X = _x(omega, alpha)
    p = 0.5 + gg * delta
    b = 2 * (1 + gg) * p + 4 * gg * (0.5 - delta)
    return (1 - gg) ** 2 - X * (b - p * p * X)


def eigenvalues(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> ComplexArray:
    """Return the two eigenvalues, last axis of length two, the larger modulus first."""
    t = trace(omega, alpha, delta, gg)
    d = determinant(omega, alpha, delta, gg)
    disc = _discriminant(omega, alpha, delta, gg)
    root = np.sqrt(np.abs(disc))
    first = (t + np.where(t < 0, -root, root)) / 2
    second = np.divide(d, first, out=np.zeros_like(t), where=first != 0)
    pair = np.stack([first, second], axis=-1).astype(complex)
    conjugate = np.stack([t + 1j * root, t - 1j * root], axis=-1) / 2
    result: ComplexArray = np.where((disc < 0)[..., None], conjugate, pair)
    return result


def spectral_radius(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return max |lambda|; sqrt(det), the paper's (13), holds for a complex pair only."""
    det = determinant(omega, alpha, delta, gg)
    complex_pair = _discriminant(omega, alpha, delta, gg) < 0
    real = np.abs(eigenvalues(omega, alpha, delta, gg)[..., 0])
    radius: Array = np.where(complex_pair, np.sqrt(np.abs(det)), real)
    return radius


def _logarithms(omega: ArrayLike, alpha: Number, delta: Number, gg: Number) -> tuple[Array, Array, Array]:
    """Return the real part sum/2 and the half difference of the two logarithms, and the kind.

    For a complex pair ln lambda = re +- i half; for positive real roots ln lambda = re +- half.
    The kind is -1 for a complex pair, +1 for positive real roots, NaN where a root is not positive.
    """
    X = _x(omega, alpha)
    t = trace(omega, alpha, delta, gg)
    disc = _discriminant(omega, alpha, delta, gg)
    with np.errstate(all="ignore"):
        re = (np.log(gg) + np.log1p((0.5 - delta) * X)) / 2
        angle = np.arctan2(np.sqrt(-disc), t)
        second = (1 + gg) * X / (1 - t / 2 + np.sqrt(disc) / 2) / 2
        half = np.log1p(-second) - re
    positive = (disc >= 0) & (t > 0) & (determinant(omega, alpha, delta, gg) > 0)
    kind = np.where(disc < 0, -1.0, np.where(positive, 1.0, np.nan))
    return re, np.where(disc < 0, angle, half), kind


def damping_ratio(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return xi; at least one where overdamped, NaN where a root is not positive.

    Complex pair: -Re(ln lambda) / |ln lambda|; positive real roots:
    -(ln l1 + ln l2) / (2 sqrt(ln l1 ln l2)).
    """
    re, half, kind = _logarithms(omega, alpha, delta, gg)
    with np.errstate(all="ignore"):
        xi: Array = -re / np.sqrt(re**2 - kind * half**2)
    return xi


def numerical_omega(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return w' dt, the undamped frequency of the stepped mode: |ln lambda|, or sqrt(ln l1 ln l2)."""
    re, half, kind = _logarithms(omega, alpha, delta, gg)
    with np.errstate(all="ignore"):
        value: Array = np.sqrt(re**2 - kind * half**2)
    return value


def period_elongation(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return w / w' - 1."""
    with np.errstate(all="ignore"):
        elongation: Array = np.asarray(omega, dtype=float) / numerical_omega(omega, alpha, delta, gg) - 1
    return elongation


def critical_omega(alpha: float, delta: float, gg: float = 1.0) -> float:
    """Return the Omega beyond which the scheme grows; inf if it never does.

    A root leaves the unit circle at -1 where Omega^2 = 2 (1 + gg) / [1/2 + gg (2 delta - 1/2)
    - 2 alpha (1 + gg)], and a complex pair leaves it, for delta < 1/2 only, where
    Omega^2 = (1 - gg) / [gg (1/2 - delta) - alpha (1 - gg)].
    """
    flip = 0.5 + gg * (2 * delta - 0.5) - 2 * alpha * (1 + gg)
    spiral = gg * (0.5 - delta) - alpha * (1 - gg)
    at_flip = 2 * (1 + gg) / flip if flip > 0 else np.inf
    at_spiral = (1 - gg) / spiral if spiral > 0 else np.inf
    return float(np.sqrt(min(at_flip, at_spiral)))
