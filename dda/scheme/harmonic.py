r"""Steady vibrations of the scheme: what a step makes of a frequency.

Let all quantities go as z^n with z = e^{iw dt}. Velocity and displacement of a scheme of one stage
(`dda.scheme.stage`; of Newmark's these are the velocity corrector (7) and the displacement that (6) gives) are

    (z - gg) V = dt (g_0 + delta z) A
    (z - 1) D  = gg dt V + dt^2 (e_0 + alpha z) A

so that A = -W2 D with one complex number W2 for each frequency, whatever the model: the stepped system answers a
steady load, M A + K D = F e^{iwt}, as (K - W2 M) D = F. Where the forces are balanced between the ends of a step,
((1 - am) z + am) M A + ((1 - af) z + af) (K D - F) = 0, W2 takes the ratio of the two.

A scheme of two stages samples loads between its steps: its modes are answered one by one (`staged_amplitude`).
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dda.model.arrays import Array
from dda.scheme.newmark import Scheme, staged_step, step_matrices
from dda.scheme.stage import Stage

Complex = NDArray[np.complex128]


def squared_frequency(scheme: Scheme, omega: ArrayLike) -> Complex:
    """Return W2 = -A / D at frequencies w of the load [rad/s], stepped [1/s^2]; W2 -> w^2 as dt -> 0 at gg = 1."""
    forward, velocity_difference, moved = _parts(scheme, omega)
    W2 = -(forward / scheme.step) * (velocity_difference / scheme.step) / moved
    return W2 / acceleration_share(scheme, omega) if scheme.averages else W2


def one_stage(scheme: Scheme) -> Stage:
    """The only stage of a scheme; a ValueError if it has two."""
    if len(scheme.stages) > 1:
        raise ValueError(f"scheme: must be of one stage for a response of the whole system, got {scheme.name!r}")
    return scheme.stages[0]


def acceleration_share(scheme: Scheme, omega: ArrayLike) -> Complex:
    """Return -A / (W2 D): one, unless the forces are balanced between the ends of a step."""
    stage = one_stage(scheme)
    forward, _, _ = _parts(scheme, omega)
    return (1 + (1 - stage.af) * forward) / (1 + (1 - stage.am) * forward)


def staged_amplitude(scheme: Scheme, omega: Array, k: float, load: float, base: float) -> Complex:
    """Return the amplitudes of D, from the base, of a mode under dt^2 F = load and a base motion, at frequencies w.

    Parameters
    ----------
    omega : (n,) array
        Angular frequencies of load and base [rad/s].
    k : float
        (w dt)^2 of the mode.
    load, base
        Amplitudes of dt^2 F, and of the displacement of the base as the mode sees it.
    """
    matrices = step_matrices(scheme, 1.0, k)
    instants: list[Complex] = [np.exp(1j * omega * instant) for instant in scheme.instants(1)]
    loads: list[Any] = [load * turned for turned in instants]
    pushes: list[Any] = [base * (later - earlier) for earlier, later in pairwise(instants)]
    still: list[Any] = [0.0 for _ in matrices]
    rest: Any = loads[0]
    zero: Any = 0 * loads[0]
    forced = staged_step(scheme, matrices, k, loads[1:], pushes, (zero, zero, rest, rest))
    moved = staged_step(scheme, matrices, k, still, still, (1.0, 0.0, -k, -k))
    kicked = staged_step(scheme, matrices, k, still, still, (0.0, 1.0, 0.0, 0.0))
    z = instants[-1]
    determinant = (z - moved[0]) * (z - kicked[1]) - kicked[0] * moved[1]
    return np.asarray(((z - kicked[1]) * forced[0] + kicked[0] * forced[1]) / determinant)


def _parts(scheme: Scheme, omega: ArrayLike) -> tuple[Complex, Complex, Complex]:
    """Return z - 1 and z - gg, and (z - 1)(z - gg) D / (dt^2 A), which the two lines give."""
    half = np.asarray(omega, float) * (scheme.step / 2)
    forward: Complex = 2j * np.sin(half) * np.exp(1j * half)  # all digits of a slow load
    velocity_difference: Complex = forward + (1 - scheme.gg)
    stage = one_stage(scheme)  # where the weights of A add up to one in V, and to half and the lag in D
    mean = 0.5 + scheme.lag + stage.alpha * forward
    moved: Complex = scheme.gg * (1 + stage.delta * forward) + mean * velocity_difference
    eps = np.finfo(float).eps
    return (
        forward,
        velocity_difference,
        np.where(np.abs(moved) > eps, moved, eps),
    )  # a load that turns every step may move nothing


def velocity_factor(scheme: Scheme, omega: ArrayLike) -> Complex:
    """Return S = V / D of the stepped system [1/s]; it tends to i w as dt does to zero."""
    forward, _, moved = _parts(scheme, omega)
    stage = one_stage(scheme)
    return forward * (1 + stage.delta * forward) / (scheme.step * moved)


def chosen(scheme: Scheme, frequencies: ArrayLike, exact: bool) -> tuple[Complex, Complex]:
    """Return W2 and S at frequencies in Hz, as stepped or what they tend to with dt.

    The limit is w^2 - i c w if kinetic damping keeps its rate c = -ln(gg) / dt, and S = i w. Without a rate, gg = 0, it
    is a ValueError.
    """
    w = 2 * np.pi * np.atleast_1d(frequencies)
    if not exact:
        return squared_frequency(scheme, w), velocity_factor(scheme, w)
    if scheme.gg == 0:
        raise ValueError("gg: must be positive for a damping rate -ln(gg) / dt, got 0")
    rate = -math.log(scheme.gg) / scheme.step
    return w * w - 1j * rate * w, np.asarray(1j * w, complex)


def answering(scheme: Scheme, frequencies: ArrayLike, exact: bool) -> tuple[Complex, Complex]:
    """Return the squared frequency at which the undamped system answers, and the factor on its answer.

    With C = a0 M + a1 K, (K + S C - W2 M) D = F is (1 + a1 S) (K - W2' M) D = F, W2' = (W2 - a0 S) / (1 + a1 S).
    """
    W2, S = chosen(scheme, frequencies, exact)
    if not scheme.damped:
        return W2, np.ones_like(W2)
    stiffer = 1 + scheme.stiffness_damping * S
    return (W2 - scheme.mass_damping * S) / stiffer, 1 / stiffer
