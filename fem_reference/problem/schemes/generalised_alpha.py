r"""Generalised-alpha schemes by their radius rho_inf for infinitely fast modes.

gamma = 1/2 - am + af and beta = (1 - am + af)^2 / 4 make all of them second-order accurate and unconditionally stable.
The sources differ in which part of the equation of motion lags behind:

    Chung and Hulbert, J. Appl. Mech. 60 (1993)     am = (2 r - 1) / (r + 1),  af = r / (r + 1)
    Hilber, Hughes and Taylor, EESD 5 (1977)        am = 0,  af = (1 - r) / (1 + r),  1/2 <= r <= 1
    Wood, Bossak and Zienkiewicz, IJNME 15 (1980)   am = (r - 1) / (r + 1),  af = 0

Papers write HHT's alpha as -af; some programs write 1 - am and 1 - af.
"""

from __future__ import annotations

from fem_reference.problem.stages import Stage, StageTable


def chung_hulbert(rho_inf: float | None, split: float | None) -> StageTable:
    """Return the scheme of Chung and Hulbert: least damping of slow modes for a radius rho_inf of fast ones."""
    r = _radius(rho_inf, split, 0.0, "chung-hulbert")
    return _table("chung-hulbert", (2 * r - 1) / (r + 1), r / (r + 1))


def hilber_hughes_taylor(rho_inf: float | None, split: float | None) -> StageTable:
    """Return the scheme of Hilber, Hughes and Taylor: the inertia is taken at the end of the step."""
    r = _radius(rho_inf, split, 0.5, "hht")
    return _table("hht", 0.0, (1 - r) / (1 + r))


def wood_bossak_zienkiewicz(rho_inf: float | None, split: float | None) -> StageTable:
    """Return the scheme of Wood, Bossak and Zienkiewicz: forces are taken at the end of the step."""
    r = _radius(rho_inf, split, 0.0, "wbz")
    return _table("wbz", (r - 1) / (r + 1), 0.0)


def _radius(rho_inf: float | None, split: float | None, least: float, name: str) -> float:
    if split is not None:
        raise ValueError(f"split: belongs to the composite scheme, must be absent for {name!r}, got {split!r}")
    if rho_inf is None or not least <= rho_inf <= 1:
        raise ValueError(f"rho_inf: must be from {least:g} to 1 for {name!r}, got {rho_inf!r}")
    return float(rho_inf)


def _table(name: str, am: float, af: float) -> StageTable:
    beta = (1 - am + af) ** 2 / 4
    gamma = 0.5 - am + af
    return StageTable(name, (Stage(beta=beta, gamma=gamma, e_0=0.5 - beta, g_0=1 - gamma, am=am, af=af),))
