r"""The Newmark scheme on single modes with viscous damping, A + c V + w^2 D = F, c = a0 + a1 w^2.

With Omega = w dt and e = c dt the roots of a step are those of

    (1 + alpha Omega^2 + delta e) z^2 + [Omega^2 (1/2 - alpha + gg (delta - alpha)) + e (1 - 2 delta) - 1 - gg] z
        + gg + gg Omega^2 (1/2 - delta + alpha) - e (1 - delta) = 0,

and the motion of many modes under a load that is switched on is stepped, all of them at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.problem import Array, Scheme

ROUNDING = 16 * np.finfo(float).eps
"""Of a sum over modes, over the sum of their moduli."""
SLACK = 1e-12
"""Of a root's modulus, beyond one, by rounding."""


def roots(omega: float, scheme: Scheme) -> NDArray[np.complex128]:
    """The two roots of one mode of w dt = `omega`."""
    square = omega * omega
    return _roots(1.0, square, _viscosity(square, scheme), scheme)


def _viscosity(square: float | Array, scheme: Scheme) -> float | Array:
    """E = c dt of modes with (w dt)^2 = `square`."""
    return scheme.mass_damping * scheme.step + scheme.stiffness_damping / scheme.step * square


def _roots(one: float, square: float, e: float | Array, scheme: Scheme) -> NDArray[np.complex128]:
    alpha = scheme.alpha
    delta = scheme.delta
    gg = scheme.gg
    middle = square * (0.5 - alpha + gg * (delta - alpha)) + e * (1 - 2 * delta) - one * (1 + gg)
    last = one * gg + gg * square * (0.5 - delta + alpha) - e * (1 - delta)
    roots = np.roots([float(one + alpha * square + delta * e), float(middle), float(last)])
    return np.asarray(np.resize(roots if len(roots) else 0.0, 2), complex)


def applicable(scheme: Scheme) -> str | None:
    """Why a scheme cannot step a damped continuum, in words; None if its roots stay bounded at all frequencies."""
    far = _roots(0.0, 1.0, scheme.stiffness_damping / scheme.step, scheme)
    near = [roots(omega, scheme) for omega in np.geomspace(1e-3, 1e6, 200)]
    if scheme.alpha > 0 and max(float(np.max(np.abs(pair))) for pair in (far, *near)) <= 1 + SLACK:
        return None
    return (
        f"alpha = {scheme.alpha!r}, delta = {scheme.delta!r}, gg = {scheme.gg!r} with viscous damping "
        "is unstable for some frequencies of a continuum"
    )


def weighted_response(omega: Array, weights: Array, scheme: Scheme, steps: int) -> Array:
    """Sum over modes of weights times w^2 D under a unit load, at steps 1 to `steps`, shape (quantities, steps)."""
    k = omega * omega
    e = _viscosity(k, scheme)
    denominator = 1 + scheme.delta * e + scheme.alpha * k
    y = np.zeros_like(omega)
    p = np.zeros_like(omega)
    q = k.copy() if scheme.start == "consistent" else np.zeros_like(omega)  # dt^2 w^2 A
    responses = np.empty((len(weights), steps))
    for n in range(steps):
        y = y + scheme.gg * p + (0.5 - scheme.alpha) * q
        p = scheme.gg * p + (1 - scheme.delta) * q
        q = (k * (1 - y) - e * p) / denominator
        y = y + scheme.alpha * q
        p = p + scheme.delta * q
        total = weights @ y
        rounding = ROUNDING * (np.abs(weights) @ np.abs(y))
        responses[:, n] = np.where(np.abs(total) <= rounding, 0.0, total)  # before a wave has come there is nothing
    return responses
