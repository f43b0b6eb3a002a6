r"""One stage of a scheme: for numbers, for modes, for the unknowns of a mesh (Newmark's: paper, equations (4) to (9)).

With the numbers of a stage (`fem_reference.problem.stages`), u = gg V, b = beta / (1 - am), gamma' = gamma (1 - af) /
(1 - am), beta' = b (1 - af) and S = M + gamma' h C + beta' h^2 K, a stage of M A + C V + K D = F goes from the start
(D, V, A) of a step and the end (Dg, Vg, Ag) of the stage before to (D + dD, V1, A1)::

    dD* = h (d_u u + d_g Vg) + h^2 (e_0 A + e_g Ag),      V* = u + h (g_0 A + g_g Ag)
    R   = F* - am M A - C [(1 - af) V* + af u],     F* = (1 - af) F1 + af F0
    dD  = S^-1 [(M + gamma' h C) dD* + b h^2 (R - K D)],     A1 = (dD - dD*) / (beta h^2)
    V1  = V* + gamma h A1

Nothing is divided by beta in dD, and a stiff spring meets no difference of nearly equal numbers. Where the stage is
explicit, and for a body that no spring of K holds, the same is

    e = S^-1 [R - K (D + (1 - af) dD*)],     dD = dD* + b h^2 e,     A1 = e / (1 - am)

in which a rigid motion has no forces.

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


class Motion(NamedTuple):
    """Displacement, velocity and acceleration at the end of a step or a stage."""

    D: Any  # displacement [m], or its change since the start of the step
    V: Any  # velocity [m/s], of a staggered scheme half a step before
    A: Any  # acceleration [m/s2]


def predicted_change(stage: Stage, h: float, gg: float, start: Motion, before: Motion) -> Any:
    """Return dD*, the displacement in a stage without its own acceleration."""
    change = (h * stage.d_u * gg) * start.V + (h**2 * stage.e_0) * start.A
    if stage.d_g == 0 and stage.e_g == 0:
        return change
    return change + (h * stage.d_g) * before.V + (h**2 * stage.e_g) * before.A


def velocity_at_end(stage: Stage, h: float, gg: float, start: Motion, before: Motion, A: Any) -> Any:
    """Return V1 for the acceleration A at the end of the stage, V* for none."""
    velocity = gg * start.V + (h * stage.g_0) * start.A + (h * stage.gamma) * A
    return velocity if stage.g_g == 0 else velocity + (h * stage.g_g) * before.A


def undamped_load(stage: Stage, h: float, gg: float, M: Any, C: Any, start: Motion, before: Motion, F: Any) -> Any:
    """The R above."""
    if stage.am != 0:
        F = F - stage.am * (M * start.A)
    if C is None:
        return F
    known = velocity_at_end(stage, h, gg, start, before, 0.0)
    return F - C * ((1 - stage.af) * known + (stage.af * gg) * start.V)


def free_acceleration(
    stage: Stage, h: float, gg: float, body: Body, start: Motion, before: Motion, predicted: Any, F: Any
) -> Any:
    """Return e = (1 - am) A1 under the load F* of a stage, from the predicted dD*.

    Its forces are those of the predicted place: a rigid motion of a body that no spring holds has none at all.
    """
    load = undamped_load(stage, h, gg, body.M, body.C, start, before, F)
    return body.inverse * (load - body.K * (start.D + (1 - stage.af) * predicted))


def end_of_stage(
    stage: Stage, h: float, gg: float, start: Motion, before: Motion, predicted: Any, e: Any, origin: Any
) -> Motion:
    """The end of a stage with the acceleration e; its displacement is counted from an origin, D or zero."""
    b = stage.beta / (1 - stage.am) * h**2
    A = e if stage.am == 0 else e / (1 - stage.am)
    return Motion(origin + (predicted + b * e), velocity_at_end(stage, h, gg, start, before, A), A)


def held_change(
    stage: Stage, h: float, gg: float, body: Body, start: Motion, before: Motion, predicted: Any, F: Any
) -> Any:
    """Return dD under the load F* of a stage, of a body that stiff springs may hold."""
    b = stage.beta / (1 - stage.am) * h**2
    inertia = body.M * predicted
    if body.C is not None:
        inertia = inertia + (stage.gamma / (1 - stage.am) * (1 - stage.af) * h) * (body.C * predicted)
    return body.inverse * (
        inertia + b * (undamped_load(stage, h, gg, body.M, body.C, start, before, F) - body.K * start.D)
    )


def mean_load(stage: Stage, first: Any, last: Any) -> Any:
    """Return F* of the loads at the start of a step and at the end of a stage."""
    return (1 - stage.af) * last + stage.af * first if stage.af else last


def step_change(scheme: Any, gg: float, h: float, bodies: Any, start: Motion, loads: Any) -> Motion:
    """The end of a step as a change of the displacement, under the loads at its start and at the stages' ends.

    Each stage has a body of its own.
    """
    before = start
    for stage, body, load in zip(scheme.stages, bodies, loads[1:], strict=True):
        F = mean_load(stage, loads[0], load)
        predicted = predicted_change(stage, h, gg, start, before)
        if stage.beta == 0:
            e = free_acceleration(stage, h, gg, body, start, before, predicted, F)
            before = end_of_stage(stage, h, gg, start, before, predicted, e, 0.0)
            continue
        change = held_change(stage, h, gg, body, start, before, predicted, F)
        A = (change - predicted) / (stage.beta * h**2)
        before = Motion(change, velocity_at_end(stage, h, gg, start, before, A), A)
    return before
