r"""Closed forms of the Newmark scheme with kinetic and viscous damping for one mode.

For z^n the corrector, the predictor and A + c V + w^2 D = 0 give, with Omega = w dt and e = c dt,

    (1 + alpha Omega^2 + delta e) z^2 + [Omega^2 (1/2 - alpha + gg (delta - alpha)) + e (1 - 2 delta) - 1 - gg] z
        + gg + gg Omega^2 (1/2 - delta + alpha) - e (1 - delta) = 0.

At e = 0 these are trace and determinant of `dda.scheme.spectral`.
"""

from __future__ import annotations

import cmath
import math

from dda.scheme.newmark import Scheme


def eigenvalues(scheme: Scheme, frequency: float) -> tuple[complex, complex]:
    """Return the two eigenvalues of a step of a mode of frequency w [rad/s], the larger modulus first."""
    square = (frequency * scheme.step) ** 2
    e = scheme.step * (scheme.mass_damping + scheme.stiffness_damping * frequency**2)
    alpha = scheme.alpha
    delta = scheme.delta
    gg = scheme.gg
    leading = 1 + alpha * square + delta * e
    trace = (1 + gg - e * (1 - 2 * delta) - square * (0.5 - alpha + gg * (delta - alpha))) / leading
    det = (gg + gg * square * (0.5 - delta + alpha) - e * (1 - delta)) / leading
    root = cmath.sqrt(trace * trace - 4 * det)
    first = max((trace + root) / 2, (trace - root) / 2, key=abs)
    return first, det / first if first else 0j


def damping_ratio(scheme: Scheme, frequency: float) -> float:
    """Return xi; at least one where overdamped, NaN where a root is not positive."""
    first, second = eigenvalues(scheme, frequency)
    if first.imag == 0 and not (first.real > 0 and second.real > 0):
        return math.nan
    logs = cmath.log(first), cmath.log(second)
    size = cmath.sqrt(logs[0] * logs[1]).real
    return -(logs[0] + logs[1]).real / (2 * size) if size > 0 else math.nan
