r"""The composite scheme of Bathe and Baig (2005), with the radius of Noh and Bathe (2019): two solutions a step.

Average acceleration over the share s of the step, then

    v1 = u + dt (q0 a + q1 ag + q2 a1),   x1 = x + dt (q0 u + q1 vg + q2 v1)
    q1 = (r + 1) / (2 s (r - 1) + 4),     q0 = (s - 1) q1 + 1/2,     q2 = 1/2 - s q1

At r = 0 and s = 1/2 the second stage is the three-point backward Euler formula, at s = 2 - sqrt 2 the scheme is
TR-BDF2. The default s = (2 - sqrt(2 + 2 r)) / (1 - r) gives both stages one matrix.
"""

from __future__ import annotations

import math

from fem_reference.problem.stages import Stage, StageTable


def composite(rho_inf: float | None, split: float | None) -> StageTable:
    """The composite scheme for a radius (0 where it is absent) and the end of its first stage."""
    r = 0.0 if rho_inf is None else float(rho_inf)
    if not 0 <= r <= 1:
        raise ValueError(f"rho_inf: must be from 0 to 1 for 'composite', got {rho_inf!r}")
    # (2 - sqrt(2 + 2 r)) / (1 - r) without 0 / 0 at r = 1
    s = 2 / (2 + math.sqrt(2 + 2 * r)) if split is None else float(split)
    if not 0 < s < 1:
        raise ValueError(f"split: must be above 0 and below 1 for 'composite', got {split!r}")
    q1 = (r + 1) / (2 * s * (r - 1) + 4)
    q0 = (s - 1) * q1 + 0.5
    q2 = 0.5 - s * q1
    first = Stage(beta=s * s / 4, gamma=s / 2, e_0=s * s / 4, g_0=s / 2, d_u=s, end=s)
    second = Stage(beta=q2 * q2, gamma=q2, e_0=q2 * q0, g_0=q0, d_u=q0 + q2, d_g=q1, e_g=q2 * q1, g_g=q1)
    return StageTable("composite", (first, second))
