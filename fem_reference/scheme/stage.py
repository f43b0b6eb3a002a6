r"""One stage of a scheme: for numbers, for modes, for the unknowns of a mesh (Newmark's: paper, equations (4) to (9)).

With the numbers of a stage (`fem_reference.problem.stages`), u = gg V, b = beta / (1 - am), gamma' = gamma (1 - af) /
(1 - am), beta' = b (1 - af) and S = M + gamma' h C + beta' h^2 K, a stage of M A + C V + K D = F goes from the start
(D, V, A) of a step and the end (Dg, Vg, Ag) of the stage before to (D + dD, V1, A1)::

    dD* = h (d_u u + d_g Vg) + h^2 (e_0 A + e_g Ag),      V* = u + h (g_0 A + g_g Ag)
    R   = F* - K D - am M A - C [(1 - af) V* + af u],     F* = (1 - af) F1 + af F0
    dD  = S^-1 [(M + gamma' h C) dD* + b h^2 R]
    A1  = (dD - dD*) / (beta h^2)      or, for beta = 0,      S^-1 [R - (1 - af) K dD*] / (1 - am)
    V1  = V* + gamma h A1

Nothing is divided by beta in dD, and a stiff spring meets no difference of nearly equal numbers. A body that no spring
of K holds takes dD = dD* + b h^2 S^-1 [R - (1 - af) K dD*] instead, in which a rigid motion has no forces. Newmark's
only stage has d_u = 1, e_0 = 1/2 - alpha, beta = alpha, g_0 = 1 - delta, gamma = delta, am = af = 0.

M, C, K and S^-1 are numbers, diagonals or operators (`fem_reference.scheme.newmark.Operator`): all that is asked of
them is the product with a vector, written as that of numbers. The functions run as they stand, or compiled by numba.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from fem_reference.problem.stages import Stage


class Body(NamedTuple):
    """What moves, and its matrix in one stage of one length of step."""

    M: Any  # mass [kg]
    C: Any  # viscous damping [N s/m]; None without
    K: Any  # stiffness [N/m]
    inverse: Any  # S^-1 [1/kg]
    is_free: bool = False  # whether K holds no springs of a support


class Motion(NamedTuple):
    """Displacement, velocity and acceleration at the end of a step or a stage."""

    D: Any  # displacement [m], or its change since the start of the step
    V: Any  # velocity [m/s], of a staggered scheme half a step before
    A: Any  # acceleration [m/s2]


def predicted_change(stage: Stage, h: float, gg: float, start: Motion, before: Motion) -> Any:
    """Return dD*, the displacement in a stage without its own acceleration."""
    return h * (stage.d_u * (gg * start.V) + stage.d_g * before.V) + h**2 * (stage.e_0 * start.A + stage.e_g * before.A)


def velocity_at_end(stage: Stage, h: float, gg: float, start: Motion, before: Motion, A: Any) -> Any:
    """Return V1 for the acceleration A at the end of the stage, V* for none."""
    return gg * start.V + h * (stage.g_0 * start.A + stage.g_g * before.A + stage.gamma * A)


def damping_force(stage: Stage, h: float, gg: float, start: Motion, before: Motion, C: Any) -> Any:
    """Return C [(1 - af) V* + af u], zero without damping."""
    if C is None:
        return 0.0
    known = velocity_at_end(stage, h, gg, start, before, 0.0)
    return C * ((1 - stage.af) * known + (stage.af * gg) * start.V)


def damped_inertia(stage: Stage, h: float, M: Any, C: Any, change: Any) -> Any:
    """Return (M + gamma' h C) dD."""
    if C is None:
        return M * change
    return M * change + (stage.gamma / (1 - stage.am) * (1 - stage.af) * h) * (C * change)


def free_response(
    stage: Stage, h: float, gg: float, body: Body, start: Motion, before: Motion, predicted: Any, F: Any
) -> Any:
    """Return dD under the load F* of a stage, or (1 - am) A1 where the stage is explicit, from the predicted dD*."""
    force = F - damping_force(stage, h, gg, start, before, body.C) - body.K * start.D
    if stage.am != 0:
        force = force - stage.am * (body.M * start.A)
    b = response_weight(stage, h)
    if stage.beta != 0 and not body.is_free:
        return body.inverse * (damped_inertia(stage, h, body.M, body.C, predicted) + b * force)
    # Forces of the predicted place: none of a rigid motion of a free body, to the last bit.
    e = body.inverse * (force - (1 - stage.af) * (body.K * predicted))
    return predicted + b * e if stage.beta != 0 else e


def response_weight(stage: Stage, h: float) -> float:
    """Return what S^-1 times a force of the equation of motion counts in the response: b h^2, or one."""
    return stage.beta / (1 - stage.am) * h**2 if stage.beta != 0 else 1.0


def stage_end(
    stage: Stage, h: float, gg: float, start: Motion, before: Motion, predicted: Any, response: Any
) -> Motion:
    """Return the end of a stage, as a change dD of the displacement since the start of the step."""
    if stage.beta == 0:
        D = predicted
        A = response / (1 - stage.am)
    else:
        D = response
        A = (response - predicted) / (stage.beta * h**2)
    return Motion(D, velocity_at_end(stage, h, gg, start, before, A), A)


def mean_load(stage: Stage, first: Any, last: Any) -> Any:
    """Return F* of the loads at the start of a step and at the end of a stage."""
    return (1 - stage.af) * last + stage.af * first if stage.af else last


def step_change(scheme: Any, gg: float, h: float, bodies: Any, start: Motion, loads: Any) -> Motion:
    """Return the end of a step as a change of the displacement, under the loads at its start and at the stages' ends.

    Parameters
    ----------
    scheme : Scheme
        Whose stages are made.
    bodies : sequence of Body
        One for each stage.
    """
    before = start
    for stage, body, load in zip(scheme.stages, bodies, loads[1:], strict=True):
        F = mean_load(stage, loads[0], load)
        predicted = predicted_change(stage, h, gg, start, before)
        response = free_response(stage, h, gg, body, start, before, predicted, F)
        before = stage_end(stage, h, gg, start, before, predicted, response)
    return before
