r"""Schemes of stages (`fem_reference.problem.stages`) on single modes: what one step makes of them.

With W = w dt and lengths in dt, one stage of the mode A + w^2 D = f goes from (x, v, a) by the increment

    dx* = d_u u + d_g vg + e_0 a + e_g ag
    dx  = [dx* + b (W^2 (f* - x) - am a)] / (1 + beta' W^2),     b = beta / (1 - am),  beta' = (1 - af) b

to x1 = x + dx, a1 = (dx - dx*) / beta and v1 = u + g_0 a + g_g ag + gamma a1, f* = (1 - af) f1 + af f0.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.stages import Stage

ROUNDING = 16 * np.finfo(float).eps
"""Of a sum over modes, over the sum of their moduli."""
SLACK = 1e-4
"""Of a root's modulus, beyond one: where three roots meet, as for infinitely fast modes, rounding takes 1e-5."""
FASTEST = 1e8
"""w dt of a mode that stands for infinitely fast ones."""


class Increment(NamedTuple):
    """What a stage makes of modes; lengths in dt."""

    x: Array  # change of the displacement since the start of the step
    v: Array  # velocity at its end
    a: Array  # acceleration at its end


def stage_increment(
    stage: Stage, before: Increment | None, x: Array, u: Array, a: Array, load: Array | float, square: Array
) -> Increment:
    """One stage of modes of W^2 = `square` under the `load` f* W^2, from x, u and a at the start of the step."""
    predicted = stage.d_u * u + stage.e_0 * a
    if before is not None:
        predicted = predicted + stage.d_g * before.v + stage.e_g * before.a
    resistance = 1 + stage.stiffness_weight * square
    drive = load - square * x - stage.am * a
    if stage.beta > 0:
        change = (predicted + stage.compliance * drive) / resistance
        acceleration = (change - predicted) / stage.beta
    else:
        change = predicted
        acceleration = (drive - (1 - stage.af) * square * change) / (1 - stage.am)
    velocity = u + stage.g_0 * a + stage.gamma * acceleration
    if before is not None:
        velocity = velocity + stage.g_g * before.a
    return Increment(change, velocity, acceleration)


def step_increment(scheme: Scheme, x: Array, u: Array, a: Array, loads: Sequence[float], square: Array) -> Increment:
    """All stages of a step under the loads f at its start and at the end of each stage."""
    ends: list[Increment] = []
    for stage, f in zip(scheme.stages, loads[1:], strict=True):
        load = ((1 - stage.af) * f + stage.af * loads[0]) * square
        ends.append(stage_increment(stage, ends[-1] if ends else None, x, u, a, load, square))
    return ends[-1]


def step_matrices(omega: Array, scheme: Scheme) -> Array:
    """Step less one of free modes of w dt = `omega`, on (x, v / W, a / W^2), shape (modes, 3, 3)."""
    square = omega * omega
    unit = np.ones_like(omega)
    loads = [0.0] * (len(scheme.stages) + 1)
    columns = []
    for x, v, a in np.eye(3):
        end = step_increment(scheme, x * unit, scheme.gg * v * omega, a * square, loads, square)
        columns.append(np.array([end.x, end.v / omega - v, end.a / square - a]))
    return np.asarray(np.array(columns).transpose(2, 1, 0))


def roots(omega: float, scheme: Scheme) -> NDArray[np.complex128]:
    """The three roots of one mode of w dt = `omega`, in the order of `principal_first`."""
    # The distances from one keep the digits of slow modes.
    distances = np.linalg.eigvals(step_matrices(np.array([omega]), scheme)[0])
    return principal_first(1 + distances.astype(complex))


def principal_first(eigenvalues: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Eigenvalues of a mode's step, the complex pair first and the real ones after it, each by falling modulus."""
    return eigenvalues[np.lexsort((-np.abs(eigenvalues), eigenvalues.imag == 0))]


def radii(omega: Array, scheme: Scheme) -> Array:
    """Greatest modulus of the roots of each mode."""
    step = np.eye(3) + step_matrices(np.asarray(omega, float), scheme)
    return np.asarray(np.abs(np.linalg.eigvals(step)).max(axis=1))


def applicable(scheme: Scheme) -> str | None:
    """Why a scheme cannot step a continuum, in words; None if its roots stay bounded at all frequencies."""
    if scheme.explicit:
        return f"{scheme.name!r} is explicit, and unstable for the high frequencies of a continuum"
    if np.max(radii(np.append(np.geomspace(1e-3, 1e6, 400), FASTEST), scheme)) <= 1 + SLACK:
        return None
    return f"{scheme.name!r} with gg = {scheme.gg!r} is unstable for some frequencies of a continuum"


def weighted_response(omega: Array, weights: Array, scheme: Scheme, steps: int, shares: Array | None = None) -> Array:
    """Sum over modes of weights times w^2 D under a load, at steps 1 to `steps`, shape (quantities, steps).

    The load is a unit one, or its `shares` at the scheme's `stage_times`.
    """
    square = omega * omega
    stages = len(scheme.stages)
    shares = np.ones(steps * stages + 1) if shares is None else shares
    y = np.zeros_like(omega)
    v = np.zeros_like(omega)
    a = shares[0] * square if scheme.start == "consistent" else np.zeros_like(omega)
    responses = np.empty((len(weights), steps))
    for n in range(steps):
        loads = shares[n * stages : (n + 1) * stages + 1].tolist()
        end = step_increment(scheme, y, scheme.gg * v, a, loads, square)
        y = y + end.x
        v = end.v
        a = end.a
        total = weights @ y
        rounding = ROUNDING * (np.abs(weights) @ np.abs(y))
        responses[:, n] = np.where(np.abs(total) <= rounding, 0.0, total)  # before a wave has come there is nothing
    return responses
