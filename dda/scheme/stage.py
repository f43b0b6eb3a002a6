r"""What a scheme is made of: one stage or more, each a row of numbers.

With the start (x, v, a) of a step of length dt, u = gg v and the end (xg, vg, ag) of the stage before, a stage that
ends at a share of the step brings a mass M with forces R(x) = F - K x + contact to

    x1 = xg + dt (d_u u + d_g vg) + dt^2 (e_0 a + e_g ag + alpha a1)
    v1 = u + dt (g_0 a + g_g ag + delta a1)
    (1 - am) M a1 + am M a = (1 - af) R1 + af R0

A step carries the displacement D, the momentum P = dt M V and the inertia force f = dt^2 M A, by these formulas, for
numbers and for arrays: what is known of a stage before its forces (`predictor`), and its end under them
(`inertia_force`, `velocity_corrector`). They stand here alone; every body calls them.

Displacements count from the end of the stage before (from the start in the first stage, where xg is x), so that what
contacts remember goes on from stage to stage; velocities count from the start, and so gg enters once in a step.
Eliminating a1 leaves S (x1 - xg) = ... with S = M + alpha (1 - af)/(1 - am) dt^2 K in every stage.
"""

from __future__ import annotations

from typing import NamedTuple, TypeVar

from dda.model.arrays import Array

Real = TypeVar("Real", float, Array)  # one unknown, or all at once; `dda.scheme.blocked` puts in decimal numbers


class Stage(NamedTuple):
    """The numbers of one stage, all without unit but the step; whole ones go with doubles and with decimal numbers."""

    alpha: float  # of the acceleration at its end, in the displacement
    delta: float  # the same in the velocity
    e_0: float  # of the acceleration at the start of the step, in the displacement
    g_0: float  # the same in the velocity
    d_u: float = 1  # of the velocity at the start of the step
    d_g: float = 0  # of that at the end of the stage before
    e_g: float = 0  # of the acceleration there, in the displacement
    g_g: float = 0  # the same in the velocity
    am: float = 0  # share of the inertia at the start in the balance of forces
    af: float = 0  # share of the other forces at the start
    begin: float = 0  # where it begins, over the step
    end: float = 1  # where it ends
    gg: float = 1  # share of the velocity that the step starts with
    step: float = 1  # dt [s]


class Table(NamedTuple):
    """A scheme by its stages."""

    stages: tuple[Stage, ...]
    lag: float = 0.0  # by how much of a step the velocities are older than the displacements


def newmark_stage(alpha: float, delta: float) -> Stage:
    """Return the only stage of Newmark's scheme, eq. (6) and (7)."""
    return Stage(alpha, delta, e_0=(1 - 2 * alpha) / 2, g_0=1 - delta)


def plain_stage(stage: Stage) -> Stage:
    """Return the numbers of a stage alone, for a momentum that is discounted already and a step of length one."""
    numbers = Stage(*(float(number) for number in stage))
    return numbers._replace(gg=1.0, step=1.0)


def predictor(stage: Stage, P: Real, f: Real, P_g: Real, f_g: Real) -> Real:
    """Return M (D* - Dg), what is known of the displacement at the end of a stage, the right-hand side of eq. (9).

    Parameters
    ----------
    P, f
        Momentum, before the discount, and inertia force at the start of the step.
    P_g, f_g
        Those at the end of the stage before.
    """
    return stage.d_u * (stage.gg * P) + stage.e_0 * f + stage.d_g * P_g + stage.e_g * f_g


def inertia_force(stage: Stage, force: Real, force_0: Real, f: Real) -> Real:
    """Return the inertia force f1 at the end of a stage: (1 - am) f1 + am f = (1 - af) force + af force_0.

    Parameters
    ----------
    force, force_0
        dt^2 times all other forces at the end and at the start of the step.
    f
        The inertia force at the start.
    """
    if stage.am == 0 and stage.af == 0:
        return force
    return ((1 - stage.af) * force + stage.af * force_0 - stage.am * f) / (1 - stage.am)


def velocity_corrector(stage: Stage, P: Real, f: Real, f_g: Real, f1: Real) -> Real:
    """Return dt M V1 at the end of a stage, eq. (7), from what `predictor` takes and the inertia force there."""
    return stage.gg * P + stage.g_0 * f + stage.g_g * f_g + stage.delta * f1


def implicit_weight(stage: Stage) -> float:
    """Return the weight of dt^2 K beside M in the matrix of a stage, alpha of Newmark's."""
    return stage.alpha * (1 - stage.af) / (1 - stage.am)


def effective_matrix(stage: Stage, M: Real, k: Real) -> Real:
    """Return S = M + weight dt^2 K, alpha dt^2 times the matrix of eq. (9)."""
    return M + implicit_weight(stage) * k
