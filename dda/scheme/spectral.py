r"""Closed forms of the Newmark scheme with kinetic damping for one mode.

For a mode of frequency w, Omega = w dt, beta = 1 + alpha Omega^2 and X = Omega^2 / beta, every
step but the first maps the mode's state with two eigenvalues lambda = 1 + y (the third one is zero),

    y^2 + b y + c = 0,    b = 1 - gg + (1/2 + gg delta) X,    c = (1 + gg)/2 X,

and the product 1 - b + c = gg (1 + (1/2 - delta) X).

At gg = 1 this is eq. (11), (12). Slow modes have y near zero and keep their digits by y; what a step removes nearly
wholly, as with small gg, has lambda near zero and keeps them by lambda. A complex pair is written
lambda = exp((-xi + i sqrt(1 - xi^2)) w' dt). All functions take arrays of Omega [-].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dda.model.arrays import Array

Number = float | Array  # alpha, delta and gg may vary with Omega where a function takes arrays
ComplexArray = NDArray[np.complex128]
NEAR_ONE = 0.5  # distance of an eigenvalue from one, below which its logarithm is that of 1 + y


def _x(omega: ArrayLike, alpha: Number) -> Array:
    """Return X = Omega^2 / (1 + alpha Omega^2), safe for huge Omega."""
    Omega = np.asarray(omega, dtype=float)
    small = np.minimum(Omega, 1.0)
    inverse = 1 / np.maximum(Omega, 1.0)
    with np.errstate(divide="ignore", under="ignore"):
        x: Array = np.where(Omega <= 1, small**2 / (1 + alpha * small**2), 1 / (inverse**2 + alpha))
    return x


class Quadratic(NamedTuple):
    """The equation of two eigenvalues."""

    b: Array  # of y^2 + b y + c = 0
    c: Array
    product: Array  # of the eigenvalues, 1 - b + c, which keeps its digits where it is small
    change: Array  # of it from one, which keeps them where it is near one


def newmark_quadratic(omega: ArrayLike, alpha: Number, delta: Number, gg: Number) -> Quadratic:
    """Return the equation of the two eigenvalues."""
    X = _x(omega, alpha)
    grown = (0.5 - delta) * X
    return Quadratic(1 - gg + (0.5 + gg * delta) * X, (1 + gg) / 2 * X, gg * (1 + grown), gg * grown - (1 - gg))


def pair(of: Quadratic) -> tuple[ComplexArray, ComplexArray]:
    """Return both y and both lambda, last axis of length two, by equations of their own: small ones keep digits."""
    middle = -of.b / 2
    center = 1 + middle
    is_fast = np.abs(center) < np.abs(middle)
    discriminant = np.where(is_fast, center * center - of.product, middle * middle - of.c)
    root = np.sqrt(np.abs(discriminant))
    large_y = middle + np.copysign(root, middle)
    small_y = np.divide(of.c, large_y, out=np.zeros_like(large_y), where=large_y != 0)
    large = center + np.copysign(root, center)
    small = np.divide(of.product, large, out=np.zeros_like(large), where=large != 0)
    is_of_large_y = np.signbit(center) == np.signbit(middle)
    with_large_y = np.where(is_of_large_y, large, small)
    with_small_y = np.where(is_of_large_y, small, large)
    is_complex = (discriminant < 0)[..., None]
    turned = 1j * np.stack([root, -root], axis=-1)
    y = np.where(is_complex, middle[..., None] + turned, np.stack([large_y, small_y], axis=-1))
    z = np.where(is_complex, center[..., None] + turned, np.stack([with_large_y, with_small_y], axis=-1))
    return np.asarray(y), np.asarray(z)


def largest_first(eigenvalues: ComplexArray) -> ComplexArray:
    """Return eigenvalues by their moduli, along the last axis."""
    order = np.argsort(-np.abs(eigenvalues), axis=-1, kind="stable")
    return np.asarray(np.take_along_axis(eigenvalues, order, axis=-1))


def eigenvalues(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> ComplexArray:
    """Return the two eigenvalues, last axis of length two, the larger modulus first."""
    return largest_first(pair(newmark_quadratic(omega, alpha, delta, gg))[1])


def spectral_radius(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return max |lambda|; sqrt(det), the paper's (13), holds for a complex pair only."""
    of = newmark_quadratic(omega, alpha, delta, gg)
    largest = largest_first(pair(of)[1])[..., 0]
    return np.asarray(np.where(largest.imag != 0, np.sqrt(np.abs(of.product)), np.abs(largest)))


def logarithms(of: Quadratic) -> ComplexArray:
    """Return ln lambda of both eigenvalues, last axis of length two, NaN where one is real and not positive."""
    y, z = pair(of)
    change = of.change[..., None]
    product = of.product[..., None]
    with np.errstate(all="ignore"):
        of_product = np.where(np.abs(change) < NEAR_ONE, np.log1p(change), np.log(product))
        of_real = np.where(np.abs(y) < NEAR_ONE, np.log1p(y.real), np.log(z.real))
        size = np.where(y.imag == 0, of_real, of_product / 2)
        logs = size + 1j * np.arctan2(y.imag, z.real)
    positive = np.all((y.imag != 0) | (z.real > 0), axis=-1, keepdims=True)
    return np.asarray(np.where(positive, logs, np.nan))


def damping_of(of: Quadratic) -> Array:
    """Return xi = -Re(ln lambda) / |ln lambda|, of real eigenvalues -(ln l1 + ln l2) / (2 sqrt(ln l1 ln l2))."""
    logs = logarithms(of)
    with np.errstate(all="ignore"):
        return np.asarray(-np.sum(logs, axis=-1).real / (2 * np.sqrt(np.prod(logs, axis=-1)).real))


def damping_ratio(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return xi; at least one where overdamped, NaN where an eigenvalue is not positive."""
    return damping_of(newmark_quadratic(omega, alpha, delta, gg))


def period_elongation(omega: ArrayLike, alpha: Number, delta: Number, gg: Number = 1.0) -> Array:
    """Return w / w' - 1, w' dt = |ln lambda|, or sqrt(ln l1 ln l2)."""
    logs = logarithms(newmark_quadratic(omega, alpha, delta, gg))
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
