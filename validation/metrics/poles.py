"""Damping and frequency measured from a history by the matrix pencil method.

A linear model sampled at equal steps is a sum of powers, y_n = sum_k c_k z_k^n; the pencil of two shifted Hankel
matrices has the z_k as its eigenvalues (Hua and Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38, 1990).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.runs.history import Array

LONGEST = 400  # samples: enough for a pencil, small enough for its singular values
LEAST = 6  # samples
TURN = 1.0  # rad between two samples, at most: far from pi
STOPPED = 240.0  # dB that a filter takes from what would be read as a slower power: below the rounding of a signal
LARGEST_MISFIT = 1e-6  # of the maximum
CONSTANT_WITHIN = 1e-4  # of a power from 1
ROUGH = 0.1  # of the maximum: what the powers may leave of a signal of which they say something


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
    that the poles do not give back to `LARGEST_MISFIT` holds more modes than can be told apart: no poles.
    """
    y, thin = _window(signal, order, tolerance)
    if len(y) < LEAST or not np.any(y) or not np.all(np.isfinite(y)):  # over a tiny static value numbers overflow
        return []
    size = float(np.max(np.abs(y)))
    z, c, misfit = _fit(y / size, order, tolerance)
    if misfit > LARGEST_MISFIT:
        return []
    oscillating = [_pole(zk, ck * size, step * thin) for zk, ck in zip(z, c, strict=True) if zk.imag > 1e-9]
    return sorted(oscillating, key=lambda pole: -pole.amplitude)


@dataclass(frozen=True)
class Swing:
    """The value about which a signal swings, and its strongest oscillating pole, if any."""

    static: float | None
    pole: Pole | None
    misfit: float = math.inf  # what the powers leave of the samples, over the largest value [1]
    samples: int = 0  # to which they are fitted


def swing(signal: Array, step: float, order: int = 7) -> Swing:
    """Return the centre of a signal and its strongest oscillation, of which noise may be a part.

    Samples are at equal steps [s], shape (steps,). The static value is a power 1^n among the `order` powers, by default
    a constant and three modes.
    """
    size = float(np.max(np.abs(signal), initial=0.0))
    y, thin = _window(signal, order, 1e-11)
    if len(y) < 2 * order + 2 or size == 0:
        return Swing(None, None)
    z, c, misfit = _fit(y / size, order, 1e-11)
    constant = [k for k in range(len(z)) if abs(z[k] - 1) < CONSTANT_WITHIN and abs(z[k].imag) < 1e-9]
    final_mean = float(np.mean(signal[-max(2, len(signal) // 10) :]))
    static = None
    if misfit >= ROUGH:
        static = final_mean
    elif constant:
        static = float(np.sum(c[constant].real)) * size
    smallest_share = max(misfit, 1e-6)
    oscillating = [_pole(zk, ck * size, step * thin) for zk, ck in zip(z, c, strict=True) if zk.imag > 1e-6]
    strong = [pole for pole in oscillating if pole.amplitude > smallest_share * size]
    return Swing(static, max(strong, key=lambda pole: pole.amplitude, default=None), misfit, len(y))


def _window(signal: Array, order: int | None, tolerance: float) -> tuple[Array, int]:
    """Return the samples that are used, and how many steps they are apart.

    The first samples, every one of them; only where their strongest power turns slowly, every k-th one over a longer
    time, after a low-pass filter. A filter leaves the powers z^n of a signal as they are and changes their coefficients
    only; what would turn by more than pi between two samples, and be read as a slower power, is gone.
    """
    y = signal[:LONGEST]
    longest_stride = len(signal) // LONGEST
    if longest_stride < 2 or not np.any(y) or not np.all(np.isfinite(signal[: LONGEST * longest_stride])):
        return y, 1
    z, c, _ = _fit(y / float(np.max(np.abs(y))), order, tolerance)
    turns = np.angle(z) * (z.imag > 1e-9)
    strongest = float(turns[np.argmax(np.abs(c) * (turns > 0))]) if np.any(turns > 0) else 0.0
    thin = max(1, min(longest_stride, int(TURN / strongest))) if strongest > 0 else 1
    y = signal[: LONGEST * thin]
    return y if thin == 1 else _low_pass(y, thin), thin


def _low_pass(signal: Array, thin: int) -> Array:
    """Return every k-th sample of a signal, its powers up to `TURN` between these kept and those beyond pi gone."""
    from scipy.signal import fftconvolve, firwin, kaiserord

    passes = TURN / np.pi  # of pi between two of the samples that are left
    stops = 1.0  # the same
    taps, beta = kaiserord(STOPPED, (stops - passes) / thin)
    low = firwin(taps | 1, (passes + stops) / 2 / thin, window=("kaiser", beta))
    return np.asarray(fftconvolve(signal, low, mode="valid")[::thin])


def _fit(y: Array, order: int | None, tolerance: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128], float]:
    """Return powers z, coefficients c and the largest misfit."""
    half = len(y) // 2
    u, s, _ = np.linalg.svd(np.lib.stride_tricks.sliding_window_view(y, half), full_matrices=False)
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
