r"""What a scheme is made of: one stage or more, each a row of numbers.

With the start (x, v, a) of a step of length dt, u = gg v and the end (xg, vg, ag) of the stage before, a stage that
ends at a share of the step brings a mass M with forces R(x) = F - K x + contact to

    x1 = xg + dt (d_u u + d_g vg) + dt^2 (e_0 a + e_g ag + alpha a1)
    v1 = u + dt (g_0 a + g_g ag + delta a1)
    (1 - am) M a1 + am M a = (1 - af) R1 + af R0

Displacements count from the end of the stage before (from the start in the first stage, where xg is x), so that what
contacts remember goes on from stage to stage; velocities count from the start, and so gg enters once in a step.
Eliminating a1 leaves S (x1 - xg) = ... with S = M + alpha (1 - af)/(1 - am) dt^2 K in every stage.
"""

from __future__ import annotations

from typing import NamedTuple


class Stage(NamedTuple):
    """The numbers of one stage, all without unit but the step."""

    alpha: float  # of the acceleration at its end, in the displacement
    delta: float  # the same in the velocity
    e_0: float  # of the acceleration at the start of the step, in the displacement
    g_0: float  # the same in the velocity
    d_u: float = 1.0  # of the velocity at the start of the step
    d_g: float = 0.0  # of that at the end of the stage before
    e_g: float = 0.0  # of the acceleration there, in the displacement
    g_g: float = 0.0  # the same in the velocity
    am: float = 0.0  # share of the inertia at the start in the balance of forces
    af: float = 0.0  # share of the other forces at the start
    begin: float = 0.0  # where it begins, over the step
    end: float = 1.0  # where it ends
    gg: float = 1.0  # share of the velocity that the step starts with
    step: float = 1.0  # dt [s]


class Table(NamedTuple):
    """A scheme by its stages."""

    stages: tuple[Stage, ...]
    lag: float = 0.0  # by how much of a step the velocities are older than the displacements
