r"""A scheme on single modes: what one step makes of them, whether they stay bounded, and all their steps at once.

With W = w dt and lengths in dt a stage (`fem_reference.scheme.stage`) of the mode A + c V + w^2 D = w^2 f has M = 1,
C = c dt, K = W^2 and h = 1.

A step is an affine map of (x, v, a). Its powers are made in extended precision; step i + jB is the product of a row of
i steps and a column of jB steps, so that a history is a few matrix products.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.stages import Stage
from fem_reference.scheme.harmonic import Complex
from fem_reference.scheme.stage import Body, Motion, step_change

Extended = NDArray[np.longdouble]
ROUNDING = 16 * np.finfo(float).eps
"""Of a sum over modes, over the sum of their moduli."""
SLACK = 1e-4
"""Of a root's modulus, beyond one: where three roots meet, as for infinitely fast modes, rounding takes 1e-5."""
NEWMARK_SLACK = 1e-12
"""Of what must not be negative where Newmark's scheme is stable."""
FASTEST = 1e8
"""w dt of a mode that stands for infinitely fast ones."""
CHUNK = 1024
"""Modes that are summed at a time."""


def modes_body(scheme: Scheme, stage: Stage, square: Array) -> Body:
    """Modes of W^2 = `square` in a stage, lengths in dt: M = 1, C = c dt of the rate c = a0 + a1 w^2, K = W^2."""
    damping = scheme.mass_damping * scheme.step + scheme.stiffness_damping / scheme.step * square
    S = 1 + stage.damping_weight * damping + stage.stiffness_weight * square
    return Body(1.0, damping if scheme.damped else None, square, 1 / S)


def step_increment(scheme: Scheme, x: Array, u: Array, a: Array, loads: Sequence[float], square: Array) -> Motion:
    """All stages of a step of modes from (x, u, a), under the loads f W^2 at its start and at the end of each stage."""
    bodies = [modes_body(scheme, stage, square) for stage in scheme.stages]
    return step_change(scheme, 1.0, 1.0, bodies, Motion(x, u, a), [f * square for f in loads])


def step_matrices(omega: Array, scheme: Scheme) -> Array:
    """Step less one of free modes of w dt = `omega`, on (x, v / W, a / W^2), shape (modes, 3, 3)."""
    square = omega * omega
    loads = [0.0] * (len(scheme.stages) + 1)
    x, v, a = np.eye(3)[:, :, None] * np.ones_like(omega)  # of each unit state, shape (3, modes)
    end = step_increment(scheme, x, scheme.gg * v * omega, a * square, loads, square)
    return np.array([end.D, end.V / omega - v, end.A / square - a]).transpose(2, 0, 1)


def roots(omega: float, scheme: Scheme) -> Complex:
    """The three roots of one mode of w dt = `omega`, in the order of `principal_first`; one of Newmark's is zero."""
    # The distances from one keep the digits of slow modes.
    distances = np.linalg.eigvals(step_matrices(np.array([omega]), scheme)[0])
    return principal_first(1 + distances.astype(complex))


def principal_first(eigenvalues: Complex) -> Complex:
    """Eigenvalues of a mode's step, the complex pair first and the real ones after it, each by falling modulus."""
    return eigenvalues[np.lexsort((-np.abs(eigenvalues), eigenvalues.imag == 0))]


def radii(omega: Array, scheme: Scheme) -> Array:
    """Greatest modulus of the roots of each mode."""
    step = np.eye(3) + step_matrices(omega, scheme)
    return np.asarray(np.abs(np.linalg.eigvals(step)).max(axis=1))


def applicable(scheme: Scheme) -> str | None:
    """Why a scheme cannot step a continuum, in words; None if it can.

    A continuum has modes of every frequency: the roots must stay in the unit disk for all of them.
    """
    if scheme.explicit:
        cause = "alpha is 0, and an explicit step is" if scheme.table is None else f"{scheme.name!r} is explicit, and"
        return f"{cause} unstable for the high frequencies of a continuum"
    if scheme.table is None:
        if _newmark_bounded(scheme):
            return None
        numbers = f"alpha = {scheme.alpha!r}, delta = {scheme.delta!r}, gg = {scheme.gg!r}"
        damped = " with viscous damping" if scheme.damped else ""
        return f"{numbers}{damped} is unstable for the high frequencies of a continuum"
    if np.max(radii(np.append(np.geomspace(1e-3, 1e6, 400), FASTEST), scheme)) <= 1 + SLACK:
        return None
    return f"{scheme.name!r} with gg = {scheme.gg!r} is unstable for some frequencies of a continuum"


def _newmark_bounded(scheme: Scheme) -> bool:
    """Whether no mode of Newmark's scheme grows.

    With s = W^2 and e = c dt the roots of a step are zero and those of p z^2 + q z + r = 0,

        p = 1 + alpha s + delta e
        q = s (1/2 - alpha + gg (delta - alpha)) + e (1 - 2 delta) - 1 - gg
        r = gg + gg s (1/2 - delta + alpha) - e (1 - delta)

    which lie in the unit disk where |r| <= p and |q| <= p + r. All are linear in s, and so hold for every s if they do
    at s = 0 and in the slopes.
    """
    alpha = scheme.alpha
    delta = scheme.delta
    gg = scheme.gg
    one = np.array([1.0, 0.0])
    s = np.array([0.0, 1.0])
    e = np.array([scheme.mass_damping * scheme.step, scheme.stiffness_damping / scheme.step])
    p = one + alpha * s + delta * e
    q = s * (0.5 - alpha + gg * (delta - alpha)) + e * (1 - 2 * delta) - one * (1 + gg)
    r = one * gg + gg * s * (0.5 - delta + alpha) - e * (1 - delta)
    slack = NEWMARK_SLACK * p
    return bool(np.all((abs(r) <= p + slack) & (abs(q) <= p + r + slack)))


def weighted_response(omega: Array, weights: Array, scheme: Scheme, steps: int) -> Array:
    """Sum over modes of weights times w^2 D under a unit load from rest, at steps 1 to `steps`, (quantities, steps).

    `omega` has W = w dt of each mode, `weights` a row for each quantity.
    """
    total = np.zeros((len(weights), steps))
    for begin in range(0, len(omega), CHUNK):
        part = slice(begin, begin + CHUNK)
        square = np.square(omega[part].astype(np.longdouble))
        bodies = [modes_body(scheme, stage, square) for stage in scheme.stages]
        total += power_histories(*affine_step(scheme, bodies, square), weights[:, part], steps)
    return total


def affine_step(scheme: Scheme, bodies: Sequence[Body], load: Array) -> tuple[Extended, Array]:
    """Map of one step of modes on (x, v, a, 1) in lengths of dt, (modes, 4, 4), and that state at t = 0, (modes, 4).

    The bodies are the modes in each stage, in extended precision; each has a load.
    """
    units = np.eye(4)[:, :, None] * np.ones_like(load)
    x, v, a, acting = units  # of each unit state, shape (4, modes)
    end = step_change(scheme, scheme.gg, 1.0, bodies, Motion(x, v, a), [acting * load] * (len(scheme.stages) + 1))
    step = np.array([x + end.D, end.V, end.A, acting]).transpose(2, 0, 1)
    start = np.zeros((len(load), 4))
    if scheme.start == "consistent":
        start[:, 2] = load / bodies[0].M
    start[:, 3] = 1.0
    return step, start


def ramped_response(omega: Array, weights: Array, scheme: Scheme, steps: int, shares: Array) -> Array:
    """As `weighted_response`, step by step under the `shares` of a unit load at the scheme's `stage_times`."""
    square = omega * omega
    stages = len(scheme.stages)
    y = np.zeros_like(omega)
    v = np.zeros_like(omega)
    a = shares[0] * square if scheme.start == "consistent" else np.zeros_like(omega)
    responses = np.empty((len(weights), steps))
    for n in range(steps):
        loads = shares[n * stages : (n + 1) * stages + 1].tolist()
        end = step_increment(scheme, y, scheme.gg * v, a, loads, square)
        y = y + end.D
        v = end.V
        a = end.A
        total = weights @ y
        rounding = ROUNDING * (np.abs(weights) @ np.abs(y))
        responses[:, n] = np.where(np.abs(total) <= rounding, 0.0, total)  # before a wave has come there is nothing
    return responses


def power_histories(step: Extended, start: Array, weights: Array, steps: int) -> Array:
    """Weighted sums of the first entry of modes at every step, shape (quantities, steps).

    They come from the map of one step, (modes, 4, 4), and the states at t = 0, (modes, 4). Step 1 + i + j B is the row
    of 1 + i steps times the state after j B: about the root of the steps of each are made, one after the other in
    extended precision.
    """
    block = math.isqrt(steps - 1) + 1
    rows = np.empty((block, *start.shape))
    row = step[:, 0]
    for i in range(block):
        rows[i] = row
        row = np.einsum("mk,mkl->ml", row, step)
    jump = np.linalg.matrix_power(step, block)
    states = np.empty((-(-steps // block), *start.shape))
    state = start.astype(np.longdouble)
    for j in range(len(states)):
        states[j] = state
        state = np.einsum("mkl,ml->mk", jump, state)
    of_states = states.reshape(len(states), -1).T
    histories = [((weight[:, None] * rows).reshape(block, -1) @ of_states).T.ravel()[:steps] for weight in weights]
    return np.array(histories).reshape(len(weights), steps)
