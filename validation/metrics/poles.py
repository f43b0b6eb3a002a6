"""Damping and frequency measured from a history by the matrix pencil method.

A linear model sampled at equal steps is a sum of powers, y_n = sum_k c_k z_k^n; the pencil of two shifted Hankel
matrices has the z_k as its eigenvalues (Hua and Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38, 1990).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.runs.history import Array

LONGEST = 400  # samples: enough for a pencil, small enough for its singular values
HELD = 1e-6  # of the maximum


@dataclass(frozen=True)
class Pole:
    """One power z^n of a signal: amplitude |c|, numerical frequency w' [rad/s] and damping ratio xi [1]."""

    amplitude: float
    frequency: float
    damping: float
    value: complex


def poles(signal: Array, step: float, order: int | None = None, tolerance: float = 1e-11) -> list[Pole]:
    """Return the oscillating poles of a signal sampled at equal steps, the largest amplitude first.

    Parameters
    ----------
    signal
        Samples y_n about their static value, shape (steps,).
    step
        Time step [s].
    order
        Number of powers; by default the numerical rank at `tolerance` of the largest singular value.

    Notes
    -----
    xi = -Re(ln z) / |ln z| and w' dt = |ln z| for a complex pair; real poles carry no xi and are left out. A signal
    that the poles do not give back to `HELD` of its maximum holds more modes than can be told apart: no poles.
    """
    thin = max(1, len(signal) // LONGEST)
    y = signal[: LONGEST * thin : thin]
    if len(y) < 6 or not np.any(y) or not np.all(np.isfinite(y)):  # over a tiny static value numbers overflow
        return []
    size = float(np.max(np.abs(y)))
    z, c, misfit = _fit(y / size, order, tolerance)
    if misfit > HELD:
        return []
    found = [_pole(zk, ck * size, step * thin) for zk, ck in zip(z, c, strict=True) if zk.imag > 1e-9]
    return sorted(found, key=lambda pole: -pole.amplitude)


def _fit(y: Array, order: int | None, tolerance: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128], float]:
    """Return the powers z, their coefficients c and the largest misfit."""
    half = len(y) // 2
    hankel = np.lib.stride_tricks.sliding_window_view(y, half)
    u, s, _ = np.linalg.svd(hankel, full_matrices=False)
    rank = order if order is not None else max(1, int(np.sum(s > tolerance * s[0])))
    u = u[:, : min(rank, u.shape[1] - 1)]
    z = np.linalg.eigvals(np.linalg.lstsq(u[:-1], u[1:], rcond=None)[0]).astype(complex)
    z = z[(np.abs(z) < 1.5) & (np.abs(z) > 1e-6)]
    powers = z[None, :] ** np.arange(len(y))[:, None]
    c = np.linalg.lstsq(powers, y.astype(complex), rcond=None)[0]
    return z, c, float(np.max(np.abs(powers @ c - y)))


def _pole(z: complex, c: complex, step: float) -> Pole:
    logarithm = np.log(z)
    size = abs(logarithm)
    return Pole(2 * abs(c), float(size / step), float(-logarithm.real / size), complex(z))
