r"""Generalised-alpha schemes: balance of forces between the ends of a step (Chung and Hulbert 1993).

With gamma = 1/2 - am + af and beta = (1 - am + af)^2 / 4, of second order and unconditionally stable, the three known
one-parameter choices of am and af by rho_inf, the spectral radius at infinite frequency:

    Chung-Hulbert                am = (2 rho - 1)/(rho + 1),   af = rho/(rho + 1)
    Hilber-Hughes-Taylor (1977)  am = 0,                       af = (1 - rho)/(1 + rho)
    Wood-Bossak-Zienkiewicz (1980)  am = (rho - 1)/(rho + 1),  af = 0

am and af weigh the start of the step, as in Chung and Hulbert's paper; OpenSees writes 1 - am and 1 - af for them.
"""

from __future__ import annotations

from dda.scheme.stage import Stage, Table


def generalised_alpha(am: float, af: float) -> Table:
    """Return the stage of second order and greatest damping of high frequencies for am and af."""
    beta = (1 - am + af) ** 2 / 4
    gamma = 0.5 - am + af
    return Table((Stage(beta, gamma, e_0=(1 - 2 * beta) / 2, g_0=1 - gamma, am=am, af=af),))


def chung_hulbert(rho_inf: float) -> Table:
    """Return Chung and Hulbert's scheme."""
    check_radius(rho_inf, 0.0)
    return generalised_alpha((2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1))


def hilber_hughes_taylor(rho_inf: float) -> Table:
    """Return Hilber, Hughes and Taylor's scheme, whose alpha is -(1 - rho)/(1 + rho) in papers."""
    check_radius(rho_inf, 0.5)
    return generalised_alpha(0.0, (1 - rho_inf) / (1 + rho_inf))


def wood_bossak_zienkiewicz(rho_inf: float) -> Table:
    """Return Wood, Bossak and Zienkiewicz' scheme."""
    check_radius(rho_inf, 0.0)
    return generalised_alpha((rho_inf - 1) / (rho_inf + 1), 0.0)


def check_radius(rho_inf: float, least: float) -> None:
    """Raise ValueError where rho_inf is out of range."""
    if not least <= rho_inf <= 1:
        raise ValueError(f"rho_inf: must be between {least:g} and 1, got {rho_inf!r}")
