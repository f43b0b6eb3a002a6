r"""Closed forms of the Newmark scheme with kinetic damping for one mode.

For a mode of frequency w, Omega = w dt, beta = 1 + alpha Omega^2 and X = Omega^2 / beta, every
step but the first maps the mode's state with two eigenvalues lambda = 1 + y (the third one is zero),

    y^2 + b y + c = 0,    b = 1 - gg + (1/2 + gg delta) X,    c = (1 + gg)/2 X,

and the product 1 - b + c = gg (1 + (1/2 - delta) X).

At gg = 1 this is eq. (11), (12). Nothing is subtracted from one, so that slow modes keep their digits. A complex pair
is written lambda = exp((-xi + i sqrt(1 - xi^2)) w' dt). All functions take arrays of Omega [-].
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


def coefficients(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> tuple[Array, Array]:
    """Return b and c of y^2 + b y + c = 0; the product of the eigenvalues is 1 - b + c."""
    X = _x(omega, alpha)
    return 1 - gg + (0.5 + gg * delta) * X, (1 + gg) / 2 * X


def pair(b: Number, c: Number) -> ComplexArray:
    """Return both y of y^2 + b y + c = 0, last axis of length two."""
    middle = -np.asarray(b) / 2
    discriminant = middle * middle - c
    root = np.sqrt(np.abs(discriminant))
    first = middle + np.copysign(root, middle)
    second = np.divide(c, first, out=np.zeros_like(first), where=first != 0)
    real = np.stack([first, second], axis=-1).astype(complex)
    conjugate = np.stack([middle + 1j * root, middle - 1j * root], axis=-1)
    return np.asarray(np.where((discriminant < 0)[..., None], conjugate, real))


def largest_first(eigenvalues: ComplexArray) -> ComplexArray:
    """Return eigenvalues by their moduli, along the last axis."""
    order = np.argsort(-np.abs(eigenvalues), axis=-1, kind="stable")
    return np.asarray(np.take_along_axis(eigenvalues, order, axis=-1))


def eigenvalues(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> ComplexArray:
    """Return the two eigenvalues, last axis of length two, the larger modulus first."""
    return largest_first(1 + pair(*coefficients(omega, alpha, delta, gg)))


def spectral_radius(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return max |lambda|; sqrt(det), the paper's (13), holds for a complex pair only."""
    b, c = coefficients(omega, alpha, delta, gg)
    largest = largest_first(1 + pair(b, c))[..., 0]
    return np.asarray(np.where(largest.imag != 0, np.sqrt(np.abs(1 + (c - b))), np.abs(largest)))


def logarithms(b: Number, c: Number) -> ComplexArray:
    """Return ln lambda of both eigenvalues, last axis of length two, NaN where one is real and not positive."""
    y = pair(b, c)
    product = np.asarray(np.subtract(c, b))[..., None]  # of the eigenvalues, less one
    with np.errstate(all="ignore"):
        size = np.where(y.imag == 0, np.log1p(y.real), np.log1p(product) / 2)
        logs = size + 1j * np.arctan2(y.imag, 1 + y.real)
    positive = np.all((y.imag != 0) | (y.real > -1), axis=-1, keepdims=True)
    return np.asarray(np.where(positive, logs, np.nan))


def damping_of(b: Number, c: Number) -> Array:
    """Return xi = -Re(ln lambda) / |ln lambda|, of real eigenvalues -(ln l1 + ln l2) / (2 sqrt(ln l1 ln l2))."""
    logs = logarithms(b, c)
    with np.errstate(all="ignore"):
        return np.asarray(-np.sum(logs, axis=-1).real / (2 * np.sqrt(np.prod(logs, axis=-1)).real))


def damping_ratio(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return xi; at least one where overdamped, NaN where an eigenvalue is not positive."""
    return damping_of(*coefficients(omega, alpha, delta, gg))


def period_elongation(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return w / w' - 1, w' dt = |ln lambda|, or sqrt(ln l1 ln l2)."""
    logs = logarithms(*coefficients(omega, alpha, delta, gg))
    with np.errstate(all="ignore"):
        return np.asarray(np.asarray(omega, dtype=float) / np.sqrt(np.prod(logs, axis=-1)).real - 1)


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
