"""The time schemes of candidate changes as tables of numbers: one or two stages to a step, one entry to a scheme.

With U = dt V and W = dt^2 A, u = gg U of the start of a step, and the end (Ug, Wg) of the stage before where there is
one, a stage ends at

    x1 - x = d_u u + d_g Ug + e_0 W + e_g Wg + beta W1,     U1 = u + g_0 W + g_g Wg + gamma W1,

where M ((1 - a_m) W1 + a_m W) + dt^2 f((1 - a_f) x1 + a_f x) = dt^2 F gives W1. Newmark 1959; Hilber, Hughes and Taylor
1977; Wood, Bossak and Zienkiewicz 1980; Chung and Hulbert 1993; Bathe and Baig 2005, with rho_inf Noh and Bathe 2019.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

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


class Stage(NamedTuple):
    """The numbers of a stage [-], or arrays of those of many variants."""

    d_u: Any
    d_g: Any
    e_0: Any
    e_g: Any
    beta: Any
    g_0: Any
    g_g: Any
    gamma: Any
    mean_mass: Any  # a_m
    mean_force: Any  # a_f


def stages(v: Variant) -> tuple[Stage, ...]:
    """Return the stages of a step of a variant."""
    r = v.spectral
    match v.family:
        case "newmark":
            return (newmark_stage(v.alpha, v.delta),)
        case "hht":
            return (_weighted(0.0, r),)
        case "wbz":
            return (_weighted((r - 1) / (r + 1), 0.0),)
        case "chung-hulbert":
            return (_weighted((2 * r - 1) / (r + 1), r / (r + 1)),)
        case "theta":
            return (Stage(1.0, 0.0, r * (1 - r), 0.0, r**2, 1 - r, 0.0, r, 0.0, 0.0),)
        case "composite":  # the trapezoidal rule up to a share of the step, then a rule through start, middle and end
            share = split_of(v)
            q1 = (r + 1) / (2 * share * (r - 1) + 4)
            q0 = (share - 1) * q1 + 0.5
            q2 = 0.5 - share * q1
            first = Stage(share, 0.0, share**2 / 4, 0.0, share**2 / 4, share / 2, 0.0, share / 2, 0.0, 0.0)
            return first, Stage(q0 + q2, q1, q2 * q0, q2 * q1, q2 * q2, q0, q1, q2, 0.0, 0.0)
    # leapfrog, whose U is that of the half step before
    return (Stage(1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0),)


def newmark_stage(beta: float, gamma: float, mean_mass: float = 0.0, mean_force: float = 0.0) -> Stage:
    """Return the stage of Newmark's formulas."""
    return Stage(1.0, 0.0, 0.5 - beta, 0.0, beta, 1 - gamma, 0.0, gamma, mean_mass, mean_force)


def _weighted(mean_mass: float, mean_force: float) -> Stage:
    """Return generalised alpha of second order with the most damping of high frequencies."""
    beta = (1 - mean_mass + mean_force) ** 2 / 4
    return newmark_stage(beta, 0.5 - mean_mass + mean_force, mean_mass, mean_force)


def split_of(v: Variant) -> float:
    """Return the share of the step at which a composite scheme is split; without one, that of equal matrices."""
    return v.split or usual_split(v.spectral)


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


def usual_split(rho_inf: float) -> float:
    """Return (2 - sqrt(2 + 2 r)) / (1 - r), without its 0/0 at r = 1."""
    return 2 / (2 + math.sqrt(2 + 2 * rho_inf))


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
