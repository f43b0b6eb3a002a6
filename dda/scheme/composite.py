r"""Composite schemes: average acceleration to a share gamma of the step, then a formula of three points (two solves).

The second stage, with the velocities and accelerations at 0, gamma dt and dt (Bathe and Baig 2005; by rho_inf Noh and
Bathe 2019),

    v1 = u + dt (q0 a + q1 ag + q2 a1),        x1 = x + dt (q0 u + q1 vg + q2 v1)
    q1 = (rho + 1) / (2 gamma (rho - 1) + 4),  q0 = (gamma - 1) q1 + 1/2,  q2 = 1/2 - gamma q1,

is here from the end of the first one, xg = x + dt gamma u + (gamma dt)^2 (a + ag)/4. At rho_inf = 0 and
gamma = 2 - sqrt 2 it is TR-BDF2; at gamma = 1/2 the second stage is the three-point backward Euler formula.
"""

from __future__ import annotations

import math

from dda.scheme.generalised_alpha import check_radius
from dda.scheme.stage import Stage, Table


def composite(rho_inf: float = 0.0, split: float | None = None) -> Table:
    """Return the two stages; by default the split at which both have one matrix.

    Raises
    ------
    ValueError
        If rho_inf is not between 0 and 1, or the split gamma not inside the step.
    """
    check_radius(rho_inf, 0.0)
    gamma = same_matrix(rho_inf) if split is None else split
    if not 0 < gamma < 1:
        raise ValueError(f"split: must be between 0 and 1, got {split!r}")
    q1 = (rho_inf + 1) / (2 * gamma * (rho_inf - 1) + 4)
    q0 = (gamma - 1) * q1 + 0.5
    q2 = 0.5 - gamma * q1
    quarter = gamma * gamma / 4
    first = Stage(quarter, gamma / 2, e_0=quarter, g_0=gamma / 2, d_u=gamma, end=gamma)
    second = Stage(
        alpha=q2 * q2,
        delta=q2,
        e_0=q2 * q0 - quarter,
        g_0=q0,
        d_u=q0 + q2 - gamma,
        d_g=q1,
        e_g=q2 * q1 - quarter,
        g_g=q1,
        begin=gamma,
    )
    return Table((first, second))


def same_matrix(rho_inf: float) -> float:
    """Return gamma = (2 - sqrt(2 + 2 rho))/(1 - rho), at which q2 is gamma/2 and both stages have the same matrix."""
    return 2 / (2 + math.sqrt(2 + 2 * rho_inf))  # the same without 0/0 at rho = 1
