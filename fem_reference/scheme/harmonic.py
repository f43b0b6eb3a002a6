r"""What the scheme makes of a load that vibrates, F e^{iwt}, once transients have gone.

One step applied to powers of z = e^{iw dt} is a pair of linear equations,

    [ z - gg         0     ] [ V ]        [ dt (delta z + 1 - delta)         ]
    [ -gg dt         z - 1 ] [ D ]  =  A  [ dt^2 (alpha z + 1/2 - alpha)     ],

and D = -A / W2 solves it by Cramer's rule: W2 = -(z - gg)(z - 1) / det. With M A + K D = F every model, meshed or
exact in space, answers as (K - W2 M) D = F.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.problem import Array, Scheme

Complex = NDArray[np.complex128]


def squares(frequencies: Array, scheme: Scheme, exact: bool = False) -> Complex:
    """W2 at frequencies in Hz [1/s2]: as stepped, or of the motion that is exact in time.

    The latter is w^2 - i c w, with the rate c = -ln(gg) / dt of kinetic damping.

    Raises
    ------
    ValueError
        If gg is zero where the exact motion is asked for: it has no rate.
    """
    w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    if not exact:
        return _stepped(w * scheme.step, scheme) / scheme.step**2
    if scheme.gg == 0:
        raise ValueError("gg: must be positive for a damping rate -ln(gg) / dt, got 0")
    return np.asarray(w * (w + 1j * np.log(scheme.gg) / scheme.step))


def rates(frequencies: Array, scheme: Scheme, exact: bool = False) -> Complex:
    """V / D at frequencies in Hz [1/s]: as stepped, or i w."""
    w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    if exact:
        return np.asarray(1j * w)
    away, _, determinant = _cramer(w * scheme.step, scheme)
    return np.asarray(away * (1 + scheme.delta * away) / (scheme.step * determinant))


def _stepped(turn: Array, scheme: Scheme) -> Complex:
    """W2 dt^2 for w dt = `turn`; where the load moves nothing at all, as large as rounding lets it be."""
    away, velocity_difference, determinant = _cramer(turn, scheme)
    return np.asarray(-away * velocity_difference / determinant)


def _cramer(turn: Array, scheme: Scheme) -> tuple[Complex, Complex, Complex]:
    """Z - 1, z - gg and the determinant, kept off zero."""
    # z - 1 = (cos - 1) + i sin, the real part as a square: no digit of a slow load is lost
    away = -2 * np.sin(turn / 2) ** 2 + 1j * np.sin(turn)
    velocity_difference = away + (1 - scheme.gg)
    determinant = scheme.gg * (1 + scheme.delta * away) + velocity_difference * (0.5 + scheme.alpha * away)
    least = np.finfo(float).eps
    return away, velocity_difference, np.where(abs(determinant) < least, least, determinant)


def answering(frequencies: Array, scheme: Scheme, exact: bool = False) -> tuple[Complex, Complex]:
    """W2' [1/s2] at which the undamped model answers, and the factor 1 / (1 + a1 S) on its answer.

    (K + S C - W2 M) D = F with C = a0 M + a1 K is (1 + a1 S) (K - W2' M) D = F.
    """
    W2 = squares(frequencies, scheme, exact)
    if not scheme.damped:
        return W2, np.ones_like(W2)
    S = rates(frequencies, scheme, exact)
    factor = 1 / (1 + scheme.stiffness_damping * S)
    return np.asarray(factor * (W2 - scheme.mass_damping * S)), np.asarray(factor)
