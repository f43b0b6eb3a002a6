"""A scheme on every mode of a continuum, Newmark's from trace and determinant.

For Omega = w dt, beta = 1 + alpha Omega^2 and h = Omega^2 / beta a step has the eigenvalues 0 and the
roots of lambda^2 - trace lambda + det = 0, where::

    trace = 1 - h / 2 + gg (1 - delta h),   det = gg (1 + (1/2 - delta) h)

With x = 1 - w^2 D (one at rest, zero at the static value), x from step 1 on is a sum of two powers,
fixed by the first two steps. All differences from one are formed without subtraction, so that slow
modes keep their phase over many steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme import staged, viscous

Complex = NDArray[np.complex128]

CHUNK = 4096
"""Modes that are summed at a time."""
CLOSE = 1e-2
"""Distance of two real roots below which their powers are not summed apart."""


class Spectrum(NamedTuple):
    """Roots of a step, one entry for each mode."""

    trace: Array  # sum of the two roots [-]
    det: Array  # their product [-]
    discriminant: Array  # trace^2 - 4 det [-]
    mu: Array  # 2 - trace [-]: the sum of the roots' distances from one
    product: Array  # 1 - trace + det [-]: the product of these distances


def applicable(scheme: Scheme) -> str | None:
    """Why a scheme cannot step a continuum, in words; None if it can.

    A continuum has modes of every frequency: the roots must stay in the unit disk up to h = 1 / alpha.
    """
    if scheme.table is not None:
        return staged.applicable(scheme)
    if scheme.damped:
        return viscous.applicable(scheme)
    if scheme.alpha == 0:
        return "alpha is 0, and an explicit step is unstable for the high frequencies of a continuum"
    h = 1 / scheme.alpha
    det = scheme.gg * (1 + (0.5 - scheme.delta) * h)
    far = 2 * (1 + scheme.gg) - h * (0.5 + scheme.gg * (2 * scheme.delta - 0.5))
    slack = 1e-12
    if far < -slack or abs(det) > 1 + slack:
        return (
            f"alpha = {scheme.alpha!r}, delta = {scheme.delta!r}, gg = {scheme.gg!r} "
            "is unstable for the high frequencies of a continuum"
        )
    return None


def h_of(omega: Array, scheme: Scheme) -> Array:
    """Omega^2 / (1 + alpha Omega^2), also where Omega^2 overflows."""
    with np.errstate(over="ignore"):
        inverse = 1 / np.asarray(omega, float)
        result: Array = 1 / (inverse * inverse + scheme.alpha)
    return result


def trace(h: Array, scheme: Scheme) -> Array:
    """1 - h / 2 + gg (1 - delta h)."""
    return 1 - h / 2 + scheme.gg * (1 - scheme.delta * h)


def determinant(h: Array, scheme: Scheme) -> Array:
    """Gg (1 + (1/2 - delta) h)."""
    return scheme.gg * (1 + (0.5 - scheme.delta) * h)


def spectrum(omega: Array, scheme: Scheme) -> Spectrum:
    """Trace, determinant and the differences from one that would cancel."""
    gg = scheme.gg
    delta = scheme.delta
    h = h_of(omega, scheme)
    slope = 0.5 + gg * delta
    linear = 1 + 3 * gg - 2 * gg * delta * (1 - gg)
    return Spectrum(
        trace=trace(h, scheme),
        det=determinant(h, scheme),
        discriminant=(1 - gg) ** 2 + h * (slope**2 * h - linear),
        mu=(1 - gg) + slope * h,
        product=(1 + gg) / 2 * h,
    )


def roots(omega: float, scheme: Scheme) -> Complex:
    """Roots of one mode: the two of Newmark's scheme that are not zero, the three of a scheme with a table."""
    if scheme.table is not None:
        return staged.roots(omega, scheme)
    if scheme.damped:
        return viscous.roots(omega, scheme)
    s = spectrum(np.array([omega]), scheme)
    if s.discriminant[0] < 0:
        log, sign = _pair(s, scheme, h_of(np.array([omega]), scheme))
        root = sign * np.exp(log)
        return np.concatenate([root, np.conj(root)])
    near, far = _distances(s)
    return np.array([1 - near[0], 1 - far[0]], complex)


def _distances(s: Spectrum) -> tuple[Array, Array]:
    """Distances of the two real roots from one, the near and the far root, from their sum and product."""
    gap = np.sqrt(np.maximum(s.discriminant, 0.0))
    far = (s.mu + gap) / 2
    # All digits of the near root come from the product; both vanish together at h = 0, gg = 1 only.
    near = np.divide(s.product, far, out=np.zeros_like(far), where=far > 0)
    return near, far


class _Power(NamedTuple):
    """Roots in the form sign * exp(log), so that a root near the negative axis keeps its distance from it."""

    log: Array | Complex  # logarithm of sign times the root
    sign: Array  # 1 or -1

    def minus_one(self, k: NDArray[np.int64]) -> Array | Complex:
        """Power k less one, without cancellation for roots near one."""
        alternating = self.sign**k
        result: Array | Complex = np.where(alternating > 0, np.expm1(k * self.log), -np.exp(k * self.log) - 1)
        return result


def _pair(s: Spectrum, scheme: Scheme, h: Array) -> _Power:
    """One root of each complex pair: the upper one where the trace is positive, else the lower one."""
    radius = np.log1p((scheme.gg - 1) + scheme.gg * (0.5 - scheme.delta) * h) / 2
    angle = np.arctan2(np.sqrt(-s.discriminant), np.abs(s.trace))
    return _Power(radius + 1j * angle, np.where(s.trace < 0, -1.0, 1.0))


def _one_minus(mu: Array) -> _Power:
    """The real root 1 - mu; a zero root becomes the least positive power."""
    tiny = np.log(1e-300)
    with np.errstate(divide="ignore"):
        modulus = np.where(mu < 0.5, np.log1p(-np.minimum(mu, 0.5)), np.log(np.abs(1 - mu)))
    return _Power(np.maximum(modulus, tiny), np.where(mu > 1, -1.0, 1.0))


def first_steps(omega: Array, scheme: Scheme) -> tuple[Array, Array]:
    """1 - x = w^2 D after the first and the second step from rest, without cancellation.

    The load is one per unit mass; lengths are measured in units of dt^2.
    """
    alpha = scheme.alpha
    delta = scheme.delta
    gg = scheme.gg
    h = h_of(omega, scheme)
    # Omega^2 D for unit load: every term carries h = Omega^2 / beta. rest = 1 / beta.
    rest = 1 - alpha * h
    A0 = 1.0 if scheme.start == "consistent" else 0.0
    y1 = h * (alpha + (0.5 - alpha) * A0)
    A1 = 1 - y1
    V1 = (1 - delta) * A0 + delta * A1
    # D2 = (D1 + gg V1 + (1/2 - alpha) A1 + alpha) / beta, times Omega^2.
    y2 = rest * y1 + h * (gg * V1 + (0.5 - alpha) * A1 + alpha)
    return y1, y2


def weighted_response(omega: Array, weights: Array, scheme: Scheme, steps: int) -> Array:
    """Sum over modes of weights * (1 - x) at steps 1 to `steps`.

    Parameters
    ----------
    omega
        Omega = w dt of each mode, lowest first, shape (modes,).
    weights
        One row for each quantity, shape (quantities, modes).
    scheme
        The scheme.
    steps
        Number of steps.

    Returns
    -------
    ndarray
        Shape (quantities, steps).
    """
    if scheme.table is not None:
        return staged.weighted_response(omega, weights, scheme, steps)
    if scheme.damped:
        return viscous.weighted_response(omega, weights, scheme, steps)
    # On a soft spring the lowest mode barely moves and is all that moves: 1 - x would cancel there.
    slowest = _lowest(omega[:1], scheme, steps)
    total: Array = weights[:, :1] * slowest + weights[:, 1:].sum(axis=1, keepdims=True)
    for begin in range(1, len(omega), CHUNK):
        part = slice(begin, begin + CHUNK)
        used = np.any(weights[:, part] != 0, axis=0)
        total -= _chunk(omega[part][used], weights[:, part][:, used], scheme, steps)
    return total


def _lowest(omega: Array, scheme: Scheme, steps: int) -> Array:
    """1 - x of one mode at steps 1 to `steps`, keeping the digits of small values."""
    s = spectrum(omega, scheme)
    (y1, y2) = first_steps(omega, scheme)
    x1 = 1 - y1
    rise = y1 - y2
    k = np.arange(steps)
    if s.trace[0] < 0:
        return np.asarray(1 - _chunk(omega, np.ones((1, 1)), scheme, steps)[0], dtype=np.float64)
    if abs(s.discriminant[0]) <= CLOSE**2 * s.product[0]:
        return _stepped(float(s.det[0]), float(s.product[0]), float(y1[0]), float(y2[0]), steps)
    gap = np.sqrt(np.abs(s.discriminant))
    if s.discriminant[0] < 0:
        amplitude = x1 - 2j * (rise + s.mu / 2 * x1) / gap
        turned = amplitude * _pair(s, scheme, h_of(omega, scheme)).minus_one(k)
        return np.asarray(y1 - turned.real, dtype=np.float64)
    near, far = _distances(s)
    slow = (rise + far * x1) / gap * _one_minus(near).minus_one(k)
    fast = (rise + near * x1) / gap * _one_minus(far).minus_one(k)
    return np.asarray(y1 - (slow - fast).real, dtype=np.float64)


def _stepped(det: float, product: float, y1: float, y2: float, steps: int) -> Array:
    """Y = 1 - x from y(k+1) - y(k) = det (y(k) - y(k-1)) + product (1 - y(k)), for nearly equal roots."""
    y = y1
    rise = y2 - y1
    rows = []
    for _ in range(steps):
        rows.append(y)
        y += rise
        rise = det * rise + product * (1 - y)
    return np.array(rows)


def _chunk(omega: Array, weights: Array, scheme: Scheme, steps: int) -> Array:
    """Sum over modes of weights * x."""
    s = spectrum(omega, scheme)
    h = h_of(omega, scheme)
    (y1, y2) = first_steps(omega, scheme)
    pair = s.discriminant < 0
    close = ~pair & (s.discriminant <= (CLOSE * s.trace) ** 2)
    total = np.zeros((len(weights), steps))
    for chosen, response in ((pair, _turning), (~pair & ~close, _decaying), (close, _confluent)):
        if np.any(chosen):
            part = Spectrum(*(field[chosen] for field in s))
            x1 = (1 - y1)[chosen]
            rise = (y1 - y2)[chosen]
            total += response(part, h[chosen], weights[:, chosen], x1, rise, scheme, steps)
    return total


def _turning(s: Spectrum, h: Array, weights: Array, x1: Array, rise: Array, scheme: Scheme, steps: int) -> Array:
    """Complex pairs: r^k (x1 cos k phi + (x2 - x1 r cos phi) sin k phi / (r sin phi))."""
    sine = np.sqrt(-s.discriminant) / 2
    root = _pair(s, scheme, h)
    amplitude = x1 - 1j * root.sign * ((rise + s.mu / 2 * x1) / sine)
    return _powers(root, weights * amplitude, steps)


def _decaying(s: Spectrum, h: Array, weights: Array, x1: Array, rise: Array, scheme: Scheme, steps: int) -> Array:
    """Two distinct real roots: ((x2 - l2 x1) l1^k - (x2 - l1 x1) l2^k) / (l1 - l2)."""
    near, far = _distances(s)
    gap = np.sqrt(s.discriminant)
    total = _powers(_one_minus(near), weights * ((rise + far * x1) / gap), steps)
    return total - _powers(_one_minus(far), weights * ((rise + near * x1) / gap), steps)


def _confluent(s: Spectrum, h: Array, weights: Array, x1: Array, rise: Array, scheme: Scheme, steps: int) -> Array:
    """Nearly equal real roots: x1 l^k + (x2 - l x1) (l^k - m^k) / (l - m), without a difference of powers."""
    near, far = _distances(s)
    distance = np.where(s.trace >= 0, near, far)
    gap = np.where(s.trace >= 0, 1.0, -1.0) * np.sqrt(s.discriminant)
    larger = 1 - distance
    k = np.arange(steps)
    total = np.zeros((len(weights), steps))
    log, sign = _one_minus(distance)
    for i in range(len(log)):
        if larger[i] == 0:  # no damping is faster: at rest from the third step on
            total[:, :2] += weights[:, [i]] * np.array([x1[i], x1[i] + rise[i]])[:steps]
            continue
        quotient = k / larger[i]
        if gap[i] != 0:
            quotient = -np.expm1(k * np.log1p(-gap[i] / larger[i])) / gap[i]
        x = sign[i] ** k * np.exp(k * log[i]) * (x1[i] + (rise[i] + distance[i] * x1[i]) * quotient)
        total += weights[:, [i]] * x
    return total


def _powers(root: _Power, weights: Array | Complex, steps: int) -> Array:
    """Real part of the sum of weights * root^k for k = 0 to steps - 1, as one matrix product.

    With k = j B + i the powers factor into those of i and those of j B.
    """
    block = int(np.ceil(np.sqrt(steps)))
    i = np.arange(block)[:, None]
    j = block * np.arange(-(-steps // block))
    inner = root.sign**i * np.exp(i * root.log)
    outer = root.sign[:, None] ** j * np.exp(root.log[:, None] * j)
    rows = []
    for w in weights:
        product = inner.real @ (w[:, None] * outer).real
        if np.iscomplexobj(inner):
            product -= inner.imag @ (w[:, None] * outer).imag
        rows.append(product.T.ravel()[:steps])
    return np.array(rows).reshape(len(weights), steps)
