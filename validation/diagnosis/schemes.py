"""The time schemes of candidate changes, each by its family and one number: names, tables and other names.

The stages are those of `dda.scheme`. Newmark 1959; Hilber, Hughes and Taylor 1977; Wood, Bossak and
Zienkiewicz 1980; Chung and Hulbert 1993; Bathe and Baig 2005, with rho_inf Noh and Bathe 2019.
"""

from __future__ import annotations

import math
from typing import Any

from dda.scheme.composite import composite, same_matrix
from dda.scheme.generalised_alpha import chung_hulbert, generalised_alpha, wood_bossak_zienkiewicz
from dda.scheme.leapfrog import leapfrog
from dda.scheme.stage import Stage, newmark_stage
from validation.diagnosis.variant import Family, Variant

LARGEST_ALPHA_F = 1 / 3  # of HHT: beyond it the spectral radius at high frequency rises again
EXPLICIT: tuple[Family, ...] = ("leapfrog", "symplectic-euler")
SHARED: dict[Family, tuple[float, ...]] = {  # numbers at which a family is a scheme of another name
    "hht": (0.0, 1 / 3),  # average acceleration; Chung and Hulbert's at rho_inf = 1/2
    "chung-hulbert": (0.0, 0.5, 1.0),  # WBZ 0; HHT 1/3; average acceleration
    "wbz": (0.0, 1.0),
    "theta": (0.5, 1.0),  # average acceleration; implicit Euler
}
FAMILIES: dict[str, str] = {
    "hht": "HHT (Hilber-Hughes-Taylor)",
    "chung-hulbert": "generalised-alpha (Chung-Hulbert)",
    "wbz": "WBZ (Wood-Bossak-Zienkiewicz)",
    "theta": "the theta scheme",
    "leapfrog": "leapfrog",
    "symplectic-euler": "symplectic Euler",
    "composite": "the composite scheme (Bathe)",
}


def stages(v: Variant) -> tuple[Stage, ...]:
    """Return the stages of a step of a variant, those of `dda`."""
    r = v.spectral
    match v.family:
        case "newmark":
            return (newmark_stage(v.alpha, v.delta),)
        case "hht":
            return generalised_alpha(0.0, r).stages
        case "wbz":
            return wood_bossak_zienkiewicz(r).stages
        case "chung-hulbert":
            return chung_hulbert(r).stages
        case "theta":
            return (Stage(alpha=r**2, delta=r, e_0=r * (1 - r), g_0=1 - r),)
        case "composite":
            return composite(r, split_of(v)).stages
    return leapfrog().stages  # whose U is that of the half step before


def discounts(v: Variant) -> tuple[float, float]:
    """Return the shares of the velocity that enter the displacement and the velocity at the end of a step.

    By the increment d, (6) is A1 = d / (alpha dt^2) - gg V / (alpha dt) - ... and (7) V1 = delta d / (alpha dt)
    + gg (1 - delta / alpha) V + ...: with gg in one of them V1 has another share of V.
    """
    gg = v.gg
    ratio = v.delta / v.alpha if v.alpha else math.inf
    match v.discounted:
        case "velocity":
            return 1.0, gg
        case "displacement":
            return gg, 1.0
        case "(6)":
            return gg, 1 - ratio * (1 - gg)
        case "(7)":
            return 1.0, gg + ratio * (1 - gg)
    return gg, gg


def split_of(v: Variant) -> float:
    """Return the share of the step at which a composite scheme is split; without one, that of equal matrices."""
    return v.split or same_matrix(v.spectral)


def scheme_numbers(v: Variant) -> dict[str, Any]:
    """Return a scheme's numbers; alpha and delta are None where it is no pair of them, and `name` says which it is."""
    if v.family == "newmark":
        return {"alpha": v.alpha, "delta": v.delta, "gg": v.gg}
    numbers: dict[str, Any] = {"alpha": None, "delta": None, "gg": v.gg, "name": v.family}
    if v.family == "theta":
        return numbers | {"theta": v.spectral}
    if v.family not in EXPLICIT:
        numbers["rho_inf"] = (1 - v.spectral) / (1 + v.spectral) if v.family == "hht" else v.spectral
    if v.family == "composite":
        numbers["split"] = split_of(v)
    return numbers


def companion_split(v: Variant) -> float:
    """Return the other split with which a composite scheme is the same in linear motion, 2 q2.

    Its amplification has the factors 1 - q2 z and 1 - split z / 2 below, which a split of 2 q2 exchanges; at the usual
    split they are one.
    """
    share = split_of(v)
    return 1 - 2 * share * (v.spectral + 1) / (2 * share * (v.spectral - 1) + 4)


def other_names(v: Variant) -> str:
    """Return by what other names a scheme is known, as the end of a sentence."""
    if v.contact not in ("springs", "mean gap"):
        return ""
    if v.family == "newmark":
        known = NEWMARK_NAMES.get((v.alpha, v.delta, v.start), "")
        return known if v.gg == 1 or v.alpha == 0.25 else ""
    for family, spectral, split, words in FAMILY_NAMES:
        same_split = family != "composite" or math.isclose(split_of(v), split, abs_tol=SAME_NUMBER)
        if v.family == family and math.isclose(v.spectral, spectral, abs_tol=SAME_NUMBER) and same_split:
            return words
    if v.family == "leapfrog" and v.gg == 1:
        return ": central differences, Newmark (0, 1/2)"
    return ""


SAME_NUMBER = 1e-6
NEWMARK_NAMES = {
    (0.25, 0.5, "consistent"): ": the trapezoidal and the midpoint rule",
    (1.0, 1.5, "zero"): ": implicit Euler",
}
FAMILY_NAMES: tuple[tuple[Family, float, float, str], ...] = (  # rho_inf, alpha_f or theta; split
    ("chung-hulbert", 0.0, 0.0, ": WBZ at rho_inf = 0, and Houbolt's recursion but for its start"),
    ("chung-hulbert", 0.5, 0.0, ": HHT at alpha_f = 1/3"),
    ("composite", 0.0, 2 - math.sqrt(2), ": TR-BDF2"),
    ("composite", 0.0, 0.5, ": trapezoidal rule, then backward differences"),
    ("theta", 1.0, 0.0, ": implicit Euler"),
)
