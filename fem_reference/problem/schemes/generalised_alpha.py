r"""Generalised-alpha schemes by their radius rho_inf for infinitely fast modes.

gamma = 1/2 - am + af and beta = (1 - am + af)^2 / 4 make all of them second-order accurate and unconditionally stable.
The sources differ in which part of the equation of motion lags behind:

    Chung and Hulbert, J. Appl. Mech. 60 (1993)     am = (2 r - 1) / (r + 1),  af = r / (r + 1)
    Hilber, Hughes and Taylor, EESD 5 (1977)        am = 0,  af = (1 - r) / (1 + r),  1/2 <= r <= 1
    Wood, Bossak and Zienkiewicz, IJNME 15 (1980)   am = (r - 1) / (r + 1),  af = 0

Papers write HHT's alpha as -af; some programs write 1 - am and 1 - af.
"""

from __future__ import annotations

from collections.abc import Callable

from fem_reference.problem.stages import Stage, StageTable

LAGS: dict[str, tuple[float, Callable[[float], tuple[float, float]]]] = {
    "chung-hulbert": (0.0, lambda r: ((2 * r - 1) / (r + 1), r / (r + 1))),
    "hht": (0.5, lambda r: (0.0, (1 - r) / (1 + r))),
    "wbz": (0.0, lambda r: ((r - 1) / (r + 1), 0.0)),
}
"""Least radius, and am and af of a radius, by the name."""


def generalised_alpha(name: str, rho_inf: float | None, split: float | None) -> StageTable:
    """One of these schemes for a radius rho_inf of the fastest modes."""
    if split is not None:
        raise ValueError(f"split: belongs to the composite scheme, must be absent for {name!r}, got {split!r}")
    least, lags = LAGS[name]
    if rho_inf is None or not least <= rho_inf <= 1:
        raise ValueError(f"rho_inf: must be from {least:g} to 1 for {name!r}, got {rho_inf!r}")
    am, af = lags(float(rho_inf))
    beta = (1 - am + af) ** 2 / 4
    gamma = 0.5 - am + af
    return StageTable(name, (Stage(beta=beta, gamma=gamma, e_0=0.5 - beta, g_0=1 - gamma, am=am, af=af),))
