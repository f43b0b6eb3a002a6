r"""What a scheme makes of a load that vibrates, F e^{iwt}, once transients have gone.

With z = e^{iw dt} a step that has begun with x, v, a ends with z times them, and the ends of its stages before, X_g and
A_g, are further unknowns. With X = (X_g, x), A = (A_g, a) and u = gg v the stages (`fem_reference.problem.stages`) say

    X_j - x = dt c_j u + dt^2 Q_j A,      v_j = u + dt R_j A,      (z - gg) u = gg dt R A for the last one,

where c_j is the end of stage j. Without u these are P X = dt^2 Q A, and the equations of motion of all stages are

    (inertia M + damping C + stiffness K) X = load F,

matrices of as many rows as there are stages. They answer as a sum of answers of (K - W2 M) D = F, one for each
eigenvalue W2 of -inertia over stiffness.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.problem import Array, Scheme

Complex = NDArray[np.complex128]

LEAST = float(np.finfo(float).eps)
"""Least modulus of a number that is divided by."""


class StepSystem(NamedTuple):
    """Equations of the stages at some frequencies, on the unknowns X."""

    inertia: Complex  # [1/s2], shape (frequencies, stages, stages)
    damping: Complex  # [1/s], of u + ..., the velocities of the stages
    stiffness: Complex  # [-]
    load: Complex  # of a load that is one at t = 0 [-], shape (frequencies, stages)
    acceleration: Complex  # row that gives a [1/s2], shape (frequencies, stages)
    velocity: Complex  # row that gives v [1/s]


def step_system(frequencies: Array, scheme: Scheme, exact: bool) -> StepSystem:
    """Equations of the stages of one step at frequencies in Hz, or of the motion that is exact in time.

    The latter is one stage with v = i w x and a = -W2 x; W2 = w^2 - i c w with the rate c = -ln(gg) / dt of gg. A gg of
    zero has no rate, and is a `ValueError` there.
    """
    dt = scheme.step
    w = 2 * np.pi * np.array(frequencies, float, ndmin=1)[:, None]
    if exact:
        if scheme.gg == 0:
            raise ValueError("gg: must be positive for a damping rate -ln(gg) / dt, got 0")
        one = np.ones(w.shape, complex)
        square: Complex = -w * (w + 1j * np.log(scheme.gg) / dt)
        rate: Complex = np.asarray(1j * w)
        return StepSystem(square[:, None], rate[:, None], one[:, None], one, square, rate)

    # z - 1 = (cos - 1) + i sin, the real part as a square: no digit of a slow load is lost
    away = (-2 * np.sin(w * dt / 2) ** 2 + 1j * np.sin(w * dt))[:, :, None]
    count = len(scheme.stages)
    beta, gamma, e_0, g_0, _, d_g, e_g, g_g, am, af, end = np.array(scheme.stages, float).T[:, :, None]

    # Rows of each stage on A (on X where it stands for displacements), the end of the last one being z times the start.
    start = np.tile(np.eye(1, count, count - 1), (count, 1))
    ends: Complex = np.eye(count) + away * np.diag(start[-1])
    before = np.eye(count, k=-1)
    velocities: Complex = g_0 * start + gamma * ends + g_g * (before @ ends)
    displacements: Complex = e_0 * start + beta * ends + e_g * (before @ ends) + d_g * (before @ velocities)

    # The last stage gives u; without it the others keep all digits of slow loads.
    velocity_difference = away + (1 - scheme.gg)
    last = displacements[:, -1:]
    P: Complex = ends - start - end * (away * start)
    Q: Complex = displacements - end * last
    P[:, -1:] = velocity_difference * away * start[-1:]
    Q[:, -1:] = scheme.gg * velocities[:, -1:] + velocity_difference * last
    A: Complex = np.asarray(np.linalg.solve(_regular(Q), P) / dt**2)  # a of X
    u: Complex = away * start[-1:] / dt - dt * (last @ A)
    stiffness = _regular((1 - af) * ends + af * start)
    sampled = np.exp(1j * w * dt * end[:, 0])
    sampled[:, -1] = 1.0
    return StepSystem(
        inertia=((1 - am) * ends + am * start) @ A,
        damping=u + (1 - af) * dt * (velocities @ A),
        stiffness=stiffness,
        load=(stiffness @ sampled[:, :, None])[:, :, 0],
        acceleration=A[:, -1],
        velocity=((u + dt * (velocities[:, -1:] @ A)) / (1 + away))[:, 0],
    )


def _regular(matrix: Complex) -> Complex:
    """Matrices whose last pivot is kept off zero, where the load moves nothing at all or anything."""
    shifted = matrix.copy()
    shifted[np.abs(np.linalg.det(matrix)) < LEAST, -1, -1] += LEAST
    return shifted


def answering(frequencies: Array, scheme: Scheme, exact: bool = False) -> list[tuple[Complex, Complex]]:
    """Parts of an answer: W2 [1/s2] at which the undamped model answers, and the factor on that answer.

    With viscous damping C = a0 M + a1 K the equations are those of inertia + a0 damping and stiffness + a1 damping.
    """
    system = step_system(frequencies, scheme, exact)
    stiffness = system.stiffness + scheme.stiffness_damping * system.damping
    G = np.linalg.solve(stiffness, system.inertia + scheme.mass_damping * system.damping)
    load = np.linalg.solve(stiffness, system.load[:, :, None])
    values, vectors = np.linalg.eig(G)
    shares = np.linalg.solve(vectors, load)[:, :, 0]
    # The least eigenvalue, that of the motion itself, loses its digits beside 1 / dt^2, the product of all does not.
    order = np.argsort(-np.abs(values), axis=1)
    values = np.take_along_axis(values, order, axis=1)
    factors = np.take_along_axis(vectors[:, -1] * shares, order, axis=1)
    values[:, -1] = np.linalg.det(G) / np.prod(values[:, :-1], axis=1)
    return [(-values[:, i], factors[:, i]) for i in range(values.shape[1])]
