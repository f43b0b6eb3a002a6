r"""What a scheme makes of a load that vibrates, F e^{iwt}, once transients have gone.

With z = e^{iw dt} a step that has begun with x, v, a ends with z times them, and the ends of its stages before, X_g and
A_g, are further unknowns. With X = (X_g, x), A = (A_g, a) and u = gg v the stages (`fem_reference.problem.stages`) say

    X_j - x = dt c_j u + dt^2 Q_j A,      v_j = u + dt R_j A,      (z - gg) u = gg dt R A for the last one,

where c_j is the end of stage j. Without u these are P X = dt^2 Q A, and the equations of motion of all stages are

    (inertia M + damping C + stiffness K) X = load F,

matrices of as many rows as there are stages. One stage answers as (K - W2 M) D = F. More answer as a sum of such
answers, one for each eigenvalue W2 of -inertia over stiffness.
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


def step_system(frequencies: Array, scheme: Scheme) -> StepSystem:
    """Equations of the stages of one step at frequencies in Hz."""
    dt = scheme.step
    turn = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float)) * dt
    # z - 1 = (cos - 1) + i sin, the real part as a square: no digit of a slow load is lost
    away = (-2 * np.sin(turn / 2) ** 2 + 1j * np.sin(turn))[:, None]
    velocity_difference = away + (1 - scheme.gg)
    count = len(scheme.stages)
    start: Complex = np.zeros((len(turn), count), complex)
    start[:, -1] = 1.0

    # rows of each stage on A (on X where it stands for displacements), the end of the last one being z times the start
    ends: list[Complex] = []
    velocities: list[Complex] = []
    displacements: list[Complex] = []
    for number, stage in enumerate(scheme.stages):
        end: Complex = np.zeros_like(start)
        end[:, number] = 1.0
        if number == count - 1:
            end = end + away * start
        velocity: Complex = stage.g_0 * start + stage.gamma * end
        displacement: Complex = stage.e_0 * start + stage.beta * end
        if number:
            velocity = velocity + stage.g_g * ends[-1]
            displacement = displacement + stage.e_g * ends[-1] + stage.d_g * velocities[-1]
        ends.append(end)
        velocities.append(velocity)
        displacements.append(displacement)

    # The last stage gives u; without it the others keep all digits of slow loads.
    P = [ends[j] - start - scheme.stages[j].end * (away * start) for j in range(count - 1)]
    Q = [displacements[j] - scheme.stages[j].end * displacements[-1] for j in range(count - 1)]
    P.append(velocity_difference * away * start)
    Q.append(scheme.gg * velocities[-1] + velocity_difference * displacements[-1])
    A: Complex = np.asarray(np.linalg.solve(_regular(np.stack(Q, axis=1)), np.stack(P, axis=1)) / dt**2)  # a of X
    u: Complex = away * start / dt - dt * _on(displacements[-1], A)

    inertia = []
    damping = []
    stiffness = []
    for stage, stage_end, stage_velocity in zip(scheme.stages, ends, velocities, strict=True):
        stiffness.append((1 - stage.af) * stage_end + stage.af * start)
        damping.append(u + (1 - stage.af) * dt * _on(stage_velocity, A))
        inertia.append(_on((1 - stage.am) * stage_end + stage.am * start, A))
    matrix = _regular(np.stack(stiffness, axis=1))
    sampled = np.stack([np.exp(1j * turn * stage.end) for stage in scheme.stages], axis=1)
    sampled[:, -1] = 1.0
    return StepSystem(
        inertia=np.stack(inertia, axis=1),
        damping=np.stack(damping, axis=1),
        stiffness=matrix,
        load=np.einsum("fij,fj->fi", matrix, sampled),
        acceleration=A[:, -1],
        velocity=(u + dt * _on(velocities[-1], A)) / (1 + away),
    )


def _on(row: Complex, matrix: Complex) -> Complex:
    """Row of each frequency times its matrix."""
    return np.asarray(np.einsum("fi,fij->fj", row, matrix))


def _regular(matrix: Complex) -> Complex:
    """Matrices whose last pivot is kept off zero, where the load moves nothing at all or anything."""
    size = matrix.shape[1]
    singular = np.abs(np.linalg.det(matrix)) < LEAST
    shifted = matrix.copy()
    shifted[singular, size - 1, size - 1] += LEAST
    return shifted


def squares(frequencies: Array, scheme: Scheme, exact: bool = False) -> Complex:
    """W2 at frequencies in Hz [1/s2]: as stepped in one stage, or of the motion that is exact in time.

    The latter is w^2 - i c w, with the rate c = -ln(gg) / dt of kinetic damping.

    Raises
    ------
    ValueError
        If gg is zero where the exact motion is asked for: it has no rate.
    """
    w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    if not exact:
        system = step_system(frequencies, scheme)
        return np.asarray(-system.inertia[:, 0, 0] / system.stiffness[:, 0, 0])
    if scheme.gg == 0:
        raise ValueError("gg: must be positive for a damping rate -ln(gg) / dt, got 0")
    return np.asarray(w * (w + 1j * np.log(scheme.gg) / scheme.step))


def rates(frequencies: Array, scheme: Scheme, exact: bool = False) -> Complex:
    """V / D at frequencies in Hz [1/s]: as stepped in one stage, or i w."""
    if exact:
        return np.asarray(2j * np.pi * np.atleast_1d(np.asarray(frequencies, float)))
    return step_system(frequencies, scheme).velocity[:, 0]


def answering(frequencies: Array, scheme: Scheme, exact: bool = False) -> list[tuple[Complex, Complex]]:
    """Parts of an answer: W2 [1/s2] at which the undamped model answers, and the factor on that answer.

    With viscous damping, C = a0 M + a1 K and the scheme's rate S, (K + S C - W2 M) D = F is
    (1 + a1 S) (K - W2' M) D = F.
    """
    if exact or len(scheme.stages) == 1:
        W2 = squares(frequencies, scheme, exact)
        if not scheme.damped:
            return [(W2, np.ones_like(W2))]
        S = rates(frequencies, scheme, exact)
        factor = 1 / (1 + scheme.stiffness_damping * S)
        return [(np.asarray(factor * (W2 - scheme.mass_damping * S)), np.asarray(factor))]

    system = step_system(frequencies, scheme)
    G = np.linalg.solve(system.stiffness, system.inertia)
    load = np.linalg.solve(system.stiffness, system.load[:, :, None])[:, :, 0]
    values, vectors = np.linalg.eig(G)
    shares = np.linalg.solve(vectors, load[:, :, None])[:, :, 0]
    # The least eigenvalue, that of the motion itself, loses its digits beside 1 / dt^2, the product of all does not.
    order = np.argsort(-np.abs(values), axis=1)
    values = np.take_along_axis(values, order, axis=1)
    factors = np.take_along_axis(vectors[:, -1] * shares, order, axis=1)
    values[:, -1] = np.linalg.det(G) / np.prod(values[:, :-1], axis=1)
    return [(-values[:, i], factors[:, i]) for i in range(values.shape[1])]
