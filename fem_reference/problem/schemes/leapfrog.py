r"""The leapfrog, or central differences: explicit, v at the middle of the steps.

    v(n + 1/2) = gg v(n - 1/2) + dt M^-1 (F_n - K x_n),   x(n + 1) = x_n + dt v(n + 1/2)

from v(1/2) = v_0 + dt a_0 / 2. It is stable for w dt up to (2 (1 + gg))^(1/2).
"""

from __future__ import annotations

from fem_reference.problem.stages import Stage, StageTable


def leapfrog(rho_inf: float | None, split: float | None) -> StageTable:
    """The leapfrog, which has no parameter."""
    for field, value in (("rho_inf", rho_inf), ("split", split)):
        if value is not None:
            raise ValueError(f"{field}: must be absent for 'leapfrog', which has no parameter, got {value!r}")
    return StageTable("leapfrog", (Stage(beta=0.0, gamma=0.0, e_0=1.0, g_0=1.0),), staggered=True)
