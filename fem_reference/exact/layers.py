r"""The exact motion of a layered column, by Thomson's and Haskell's transfer matrices, with joints and a half-space.

In a layer of modulus E* and density rho, with k = w (rho / E*)^(1/2) and sigma = E* u' (tension), going down by d:

    u     -> u cos(kd) - sigma sin(kd) / (E* k)
    sigma -> sigma cos(kd) + E* k u sin(kd)

and across a joint of stiffness kj, u -> u - sigma / kj. On the surface sigma = -p; at the bottom u is that of the base,
or sigma = z (V - 2 v) above a half-space of impedance z from which a wave of velocity v comes up. The kinetic discount
gg counts as its rate c = -ln(gg) / dt: w^2 - i c w for w^2 (the half-space has none).

In time: the drive is sampled, weighted by e^{-st}, transformed, multiplied by the transfer function at w - is and
transformed back. What comes round after the transform's period is e^{-sT} small, so that an undamped column, whose
motion never ends, needs no padding beyond its window; the spacing of the samples is halved until nothing changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fem_reference.column.problem import DISPLACEMENT, NEAR, PRESSURE, Excitation, Ground
from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.result import Result, just_ended

Complex = NDArray[np.complex128]
State = tuple[Complex, Complex]  # u and sigma
ROUND = 1e-10  # e^{-sT}: what comes round from the end of a period
PERIODS = 2.0  # period of the transform over the window
TOLERANCE = 1e-6  # of a column's maximum: change by the last halving at which the samples are dense enough
LARGEST = 200.0  # s times the way's time: the weight's growth through the column stays within the range of numbers
MOST_SAMPLES = 2**17  # a drive with kinks needs more; its error is then what the last halving changed


def applicable(scheme: Scheme) -> str | None:
    """Return None, or why there is no motion in continuous time."""
    return "gg = 0 has no rate -ln(gg) / dt" if scheme.gg == 0 else None


def amplitudes(
    ground: Ground,
    omega: ArrayLike,
    columns: Sequence[str],
    heights: Sequence[float] = (),
    squared: ArrayLike | None = None,
) -> tuple[dict[str, Complex], dict[str, Complex]]:
    """The complex amplitudes of columns for a unit velocity at the base, and for a unit pressure on the top.

    The angular frequencies, real or complex, are not zero [rad/s]; `squared` stands for w^2 [1/s2] where layers are
    damped.
    """
    w = np.asarray(omega, complex)
    w2 = np.asarray(w * w if squared is None else squared, complex)
    one = np.ones_like(w)
    zero = np.zeros_like(w)
    free = dict(_descend(ground, heights, w2, (one, zero)))
    pressed = dict(_descend(ground, heights, w2, (zero, -one)))
    z = ground.impedance
    excitation = 1 / (1j * w) if z is None else -2 * z * one
    of_free, of_pressed = (u if z is None else sigma - z * 1j * w * u for u, sigma in (free[-1], pressed[-1]))
    by_base = excitation / of_free
    by_top = -of_pressed / of_free
    moved = {name: by_base * _part(free, name) for name in columns}
    return moved, {name: by_top * _part(free, name) + _part(pressed, name) for name in columns}


def _part(states: dict[int, State], name: str) -> Complex:
    """A column's part of the states: of the base -1, of the surface -2, else of a height by its number."""
    if name == PRESSURE:
        return -states[-1][1]
    if name == DISPLACEMENT:
        return states[-2][0]
    kind, _, number = name.rpartition("_")
    u, sigma = states[int(number) - 1]
    return u if kind == DISPLACEMENT else -sigma


def _descend(ground: Ground, heights: Sequence[float], w2: Complex, state: State) -> Iterator[tuple[int, State]]:
    """Go down from the surface; yield the states of the heights, of the surface and of the base by their numbers."""
    total = ground.height
    yield -2, state
    level = total
    joints = sorted(ground.joints, reverse=True)
    requested = sorted(((height, number) for number, height in enumerate(heights)), reverse=True)
    bottoms = [float(top) - stratum.thickness for top, stratum in zip(ground.tops, ground.strata, strict=True)]
    for stratum, bottom in zip(reversed(ground.strata), reversed(bottoms), strict=True):
        end = bottom if bottom > NEAR * total else 0.0
        while True:
            stop = max([end, *(joint[0] for joint in joints[:1]), *(height for height, _ in requested[:1])])
            state = through(stratum.modulus(ground.motion), stratum.density, max(level - stop, 0.0), w2, state)
            level = min(level, stop)
            crossing = joints and joints[0][0] >= level - NEAR * total and level > NEAR * total
            if crossing:
                state = across(joints.pop(0)[1], state)
            elif requested and requested[0][0] >= level - NEAR * total:
                yield requested.pop(0)[1], state
            else:
                break  # the layer's bottom is reached
    if joints:
        state = across(joints.pop(0)[1], state)
    yield -1, state


def through(modulus: float, density: float, depth: float, w2: Complex, state: State) -> State:
    """The state deeper in a layer by some depth [m]."""
    k = np.sqrt(density * w2 / modulus)
    cosine = np.cos(k * depth)
    sine = np.sin(k * depth)
    u, sigma = state
    return u * cosine - sigma * sine / (modulus * k), sigma * cosine + modulus * k * u * sine


def across(stiffness: float, state: State) -> State:
    """The state below a joint."""
    u, sigma = state
    return u - sigma / stiffness, sigma


def solve_layers(
    ground: Ground,
    scheme: Scheme,
    steps: int,
    drive: Callable[[Array], Excitation],
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
) -> Result:
    """The exact history at the steps, with the change by the last halving of the samples as its error.

    Of the scheme step and gg count, gg as a rate; `drive` is the excitation at any instants [s]. A `ValueError` for an
    unknown column, a height outside, or gg = 0.
    """
    ground.check_request(columns, heights)
    if reason := applicable(scheme):
        raise ValueError(f"gg: {reason}")
    from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

    began = perf_counter()
    travel = sum(x.thickness * math.sqrt(x.density / x.modulus(ground.motion)) for x in ground.strata)
    period = max(PERIODS * steps * scheme.step, -math.log(ROUND) * travel / LARGEST)
    picked = np.arange(1, steps + 1)

    def synthesis(count: int) -> Array:
        """The columns at the steps from `count` samples a step, shape (columns, steps)."""
        spacing = scheme.step / count
        samples = next_fast_len(math.ceil(period / spacing), real=True)
        shift = -math.log(ROUND) / (samples * spacing)
        time = spacing * np.arange(samples)
        weight = np.exp(-shift * time)
        w = 2 * np.pi * rfftfreq(samples, spacing) - 1j * shift
        excitation = drive(time)
        w2 = w * w + 1j * math.log(scheme.gg) / scheme.step * w
        moved, pressed = amplitudes(ground, w, columns, heights, w2)
        velocity = rfft(weight * excitation.velocity)
        pressure = rfft(weight * excitation.pressure)
        histories = [irfft(velocity * moved[name] + pressure * pressed[name], samples) for name in columns]
        return np.asarray((np.array(histories) / weight)[:, count * picked])

    count = 1
    histories = synthesis(count)
    error = math.inf
    while error > TOLERANCE and PERIODS * steps * 2 * count <= max(MOST_SAMPLES, 2 * PERIODS * steps):
        count *= 2
        finer = synthesis(count)
        largest = np.abs(finer).max(axis=1)
        error = float(np.max(np.abs(finer - histories).max(axis=1) / np.where(largest > 0, largest, 1.0)))
        histories = finer
    return Result(
        **just_ended(scheme.step, steps, began, began),
        columns=dict(zip(columns, histories, strict=True)),
        unknowns=0,
        notes=(f"{int(PERIODS * steps * count)} samples",),
        estimate=error,
    )
