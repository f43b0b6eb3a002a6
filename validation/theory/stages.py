r"""The time schemes as tables of numbers.

A step is one stage, or two in a row. With the start (x, v, a) of the step and u = gg v, and the end (x_g, v_g, a_g)
of the stage before, a stage makes in units of the step

    x1 = x + d_u u + d_g v_g + e_0 a + e_g a_g + beta a1
    v1 = u + g_0 a + g_g a_g + gamma a1
    (1 - am) M a1 + am M a + K [(1 - af) x1 + af x] = (1 - af) N1 + af N0

with the contact force N of both ends ("force" form). Schemes that share a table are one scheme: CH at rho_inf = 0 is
WBZ at 0, CH at 1/2 is HHT at 1/2, the composite at its own split is TR-BDF2, leapfrog is symplectic Euler but for the
first half step.

Sources: generalised alpha, Chung and Hulbert 1993; composite, Bathe and Baig 2005, Noh and Bathe 2019.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple


class Stage(NamedTuple):
    """The numbers of one stage, in units of the whole step."""

    d_u: float = 1.0  # of u in the displacement
    d_g: float = 0.0  # of v_g
    e_0: float = 0.0  # of a
    e_g: float = 0.0  # of a_g
    beta: float = 0.0  # of a1
    g_0: float = 0.0  # of a in the velocity
    g_g: float = 0.0  # of a_g
    gamma: float = 0.0  # of a1
    am: float = 0.0  # of a in the equation of motion
    af: float = 0.0  # of the forces at the start

    def ahead(self, x: Any, u: Any, a: Any, v_g: Any, a_g: Any) -> tuple[Any, Any]:
        """Return x1 and v1 without a1, from the start of the step and the end of the stage before."""
        return x + self.d_u * u + self.d_g * v_g + self.e_0 * a + self.e_g * a_g, u + self.g_0 * a + self.g_g * a_g

    @property
    def equilibrium_weight(self) -> float:
        """(1 - af) / (1 - am), by which a force at the end enters the acceleration there."""
        return (1 - self.af) / (1 - self.am)


Stages = tuple[Stage, ...]


def step_end(stages: Stages, x: Any, u: Any, a: Any, square: Any = 0.0, load: Any = 0.0) -> tuple[Any, Any, Any]:
    """Return x, v and a at the end of a step of x'' + W^2 x = load, in units of the step; any may be arrays of modes.

    x, u, a are displacement, discounted velocity and acceleration at its start, `square` is W^2 = (w dt)^2, 0 of a free
    body, and `load` that over the mass times dt^2.
    """
    end = (x, u, a)
    for stage in stages:
        x_g, v_g, a_g = end
        x_free, v_free = stage.ahead(x, u, a, v_g, a_g)
        force = load - square * ((1 - stage.af) * x_free + stage.af * x_g) - stage.am * a_g
        a_end = force / (1 - stage.am + (1 - stage.af) * square * stage.beta)
        end = (x_free + stage.beta * a_end, v_free + stage.gamma * a_end, a_end)
    return end


LEAPFROG: Stages = (Stage(e_0=1.0, g_0=1.0),)  # of v half a step before: the force is that of the start
EXPLICIT_EULER: Stages = (Stage(g_0=1.0),)  # x1 = x + dt v, v1 = v + dt a


def newmark(alpha: float, delta: float) -> Stages:
    """Return Newmark's scheme."""
    return (Stage(e_0=0.5 - alpha, beta=alpha, g_0=1 - delta, gamma=delta),)


def generalised_alpha(am: float, af: float) -> Stages:
    """Return the second-order scheme of the largest damping at given am, af: gamma = 1/2 - am + af, beta by it."""
    gamma = 0.5 - am + af
    beta = (1 - am + af) ** 2 / 4
    return (Stage(e_0=0.5 - beta, beta=beta, g_0=1 - gamma, gamma=gamma, am=am, af=af),)


def chung_hulbert(rho_inf: float) -> Stages:
    """Return the scheme of Chung and Hulbert."""
    check_rho(rho_inf)
    return generalised_alpha((2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1))


def hht(rho_inf: float) -> Stages:
    """Return the scheme of Hilber, Hughes and Taylor, rho_inf = (1 - e)/(1 + e) with 0 <= e <= 1/3."""
    check_rho(rho_inf, least=0.5)
    return generalised_alpha(0.0, (1 - rho_inf) / (1 + rho_inf))


def wbz(rho_inf: float) -> Stages:
    """Return the scheme of Wood, Bossak and Zienkiewicz."""
    check_rho(rho_inf)
    return generalised_alpha((rho_inf - 1) / (rho_inf + 1), 0.0)


def composite(rho_inf: float, split: float | None = None) -> Stages:
    """Return the two stages of Noh and Bathe; `split` is gamma, by default that of equal matrices in both."""
    check_rho(rho_inf)
    if split is None:
        split = equal_split(rho_inf)
    if not 0 < split < 1:
        raise ValueError(f"split: must be between 0 and 1, got {split!r}")
    q1 = (rho_inf + 1) / (2 * split * (rho_inf - 1) + 4)
    q0 = (split - 1) * q1 + 0.5
    q2 = 0.5 - split * q1
    first = Stage(d_u=split, e_0=split * split / 4, beta=split * split / 4, g_0=split / 2, gamma=split / 2)
    second = Stage(q0 + q2, q1, q2 * q0, q2 * q1, q2 * q2, q0, q1, q2)
    return first, second


def equal_split(rho_inf: float) -> float:
    """Return the split at which both stages have one matrix; 2 - sqrt 2 at rho_inf = 0, 1/2 at 1."""
    return 2 / (2 + math.sqrt(2 + 2 * rho_inf))  # (2 - sqrt(2 + 2 r)) / (1 - r) without its 0/0 at r = 1


def check_rho(rho_inf: float, least: float = 0.0) -> None:
    """Raise ValueError where rho_inf is out of its range."""
    if not least <= rho_inf <= 1:
        raise ValueError(f"rho_inf: must be from {least:g} to 1, got {rho_inf!r}")
