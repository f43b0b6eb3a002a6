r"""A time scheme as a table of numbers: the stages of one step.

With u = gg v of the start (x, v, a) of a step and the end (xg, vg, ag) of the stage before, a stage that ends at the
share `end` of the step dt is

    x1 = x + dt (d_u u + d_g vg) + dt^2 (e_0 a + e_g ag + beta a1)
    v1 = u + dt (g_0 a + g_g ag + gamma a1)
    M ((1 - am) a1 + am a) + K ((1 - af) x1 + af x) = (1 - af) F1 + af F0

The last stage ends the step. The discount gg is taken once a step, before its first stage.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


class Stage(NamedTuple):
    """One solution of a step; the numbers are the weights in the formulas above."""

    beta: float  # of the new acceleration in the displacement [-]; 0: the stage is explicit
    gamma: float  # of it in the velocity [-]
    e_0: float  # of the step's first acceleration in the displacement [-]
    g_0: float  # of it in the velocity [-]
    d_u: float = 1.0  # of the step's first velocity in the displacement [-]
    d_g: float = 0.0  # of the stage before [-]
    e_g: float = 0.0
    g_g: float = 0.0
    am: float = 0.0  # share of the step's start in the inertia [-]
    af: float = 0.0  # share of it in stiffness, load and contact forces [-]
    end: float = 1.0  # where the stage ends, over the step [-]

    @property
    def compliance(self) -> float:
        """The b = beta / (1 - am): dt^2 b M^-1 is what a force at the stage's end does to x1 where K is nothing."""
        return self.beta / (1 - self.am)

    @property
    def stiffness_weight(self) -> float:
        """Of K in the stage's matrix S = M + gamma' dt C + beta' dt^2 K: beta' = beta (1 - af) / (1 - am)."""
        return self.compliance * (1 - self.af)

    @property
    def damping_weight(self) -> float:
        """Of C there: gamma' = gamma (1 - af) / (1 - am)."""
        return self.gamma / (1 - self.am) * (1 - self.af)


@dataclass(frozen=True)
class StageTable:
    """A scheme other than Newmark's."""

    name: str
    stages: tuple[Stage, ...]
    staggered: bool = False  # whether v is that of the half step before: it starts from v_0 - dt a_0 / 2, without gg


def newmark_stage(alpha: float, delta: float) -> Stage:
    """Newmark's only stage.

    x1 = x + dt u + dt^2 ((1/2 - alpha) a + alpha a1) and v1 = u + dt ((1 - delta) a + delta a1).
    """
    return Stage(beta=float(alpha), gamma=float(delta), e_0=0.5 - alpha, g_0=1.0 - delta)
