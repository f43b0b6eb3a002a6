"""The time schemes of candidate changes, each by its family and one number.

The tables are those of `validation.theory.stages`. Newmark 1959; Hilber, Hughes and Taylor 1977; Wood, Bossak and
Zienkiewicz 1980; Chung and Hulbert 1993; Bathe and Baig 2005, with rho_inf Noh and Bathe 2019.
"""

from __future__ import annotations

import math
from typing import Any

from validation.diagnosis.variant import Family, Variant
from validation.metrics.contact import AGREED
from validation.theory import stages as tables
from validation.theory.stages import Stage, Stages

LARGEST_ALPHA_F = 1 / 3  # given: of HHT: beyond it the spectral radius at high frequency rises again
EXPLICIT: tuple[Family, ...] = ("leapfrog", "symplectic-euler")
SHARED: dict[Family, tuple[float, ...]] = {  # given: numbers at which a family is a scheme of another name
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


def stages(v: Variant) -> Stages:
    """Return the stages of a step of a variant."""
    r = v.spectral
    match v.family:
        case "newmark":
            return tables.newmark(v.alpha, v.delta)
        case "hht":
            return tables.generalised_alpha(0.0, r)
        case "wbz":
            return tables.wbz(r)
        case "chung-hulbert":
            return tables.chung_hulbert(r)
        case "theta":
            return (Stage(e_0=r * (1 - r), beta=r**2, g_0=1 - r, gamma=r),)
        case "composite":
            return tables.composite(r, split_of(v))
    return tables.LEAPFROG  # whose U is that of the half step before


def split_of(v: Variant) -> float:
    """Return the share of the step at which a composite scheme is split, by default that of equal matrices."""
    return v.split or tables.equal_split(v.spectral)


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

    Its amplification has the factors 1 - q2 z and 1 - split z / 2 below, which are one at the usual split.
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
        same_split = family != "composite" or math.isclose(split_of(v), split, abs_tol=AGREED)
        if v.family == family and math.isclose(v.spectral, spectral, abs_tol=AGREED) and same_split:
            return words
    if v.family == "leapfrog" and v.gg == 1:
        return ": central differences, Newmark (0, 1/2)"
    return ""


NEWMARK_NAMES = {
    (0.25, 0.5, "consistent"): ": the trapezoidal and the midpoint rule",
    (1.0, 1.5, "zero"): ": implicit Euler",
}
FAMILY_NAMES: tuple[tuple[Family, float, float, str], ...] = (  # given: rho_inf, alpha_f or theta; split
    ("chung-hulbert", 0.0, 0.0, ": WBZ at rho_inf = 0, and Houbolt's recursion but for its start"),
    ("chung-hulbert", 0.5, 0.0, ": HHT at alpha_f = 1/3"),
    ("composite", 0.0, 2 - math.sqrt(2), ": TR-BDF2"),
    ("composite", 0.0, 0.5, ": trapezoidal rule, then backward differences"),
    ("theta", 1.0, 0.0, ": implicit Euler"),
)
