"""The time schemes by name: what each is good and bad for, and which names stand for the same scheme.

Aliases are exact for linear motion: the same roots, histories that differ by their start at most. alpha_M = 1 - am and
alpha_F = 1 - af are OpenSees' parameters, whose HHT has alpha = 1 - e between 2/3 and 1 where papers have -e.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from validation.theory.stages import equal_split
from validation.theory.stepping import Stepping

SAME = 1e-9  # relative difference of two parameters that are meant to be equal


@dataclass(frozen=True)
class SchemeCard:
    """What there is to know of a scheme before it is chosen."""

    name: str
    parameters: str
    order: str
    solves: int  # linear solves of a step without open-close iteration
    good: str
    bad: str
    aliases: str


CARDS = (
    SchemeCard(
        "newmark",
        "alpha, delta",
        "2 at delta = 1/2, else 1",
        1,
        "(1/4, 1/2): no damping, half the error of a composite scheme for the same solves; (1/2, 1), DDA's own: no "
        "energy from contact that opens and closes",
        "(1/4, 1/2): gains energy from stiff contact that opens; (1/2, 1): damps with w dt / 4, of first order",
        "(1/4, 1/2): average acceleration, midpoint and trapezoidal rule, Armero and Petocz's while closed; (1, 3/2): "
        "implicit Euler and the soft constraints of physics engines; (theta^2, 2 theta - 1/2): Moreau and Jean's "
        "theta; (0, 1/2): central differences",
    ),
    SchemeCard(
        "chung-hulbert",
        "rho_inf 0..1",
        "2",
        1,
        "locked contact: keeps low modes, damps the contact mode; rho_inf = 0 gains nothing where contact opens either",
        "from rho_inf = 0.2 on it gains energy from stiff contact that opens, up to 2.97 times the speed of a landing",
        "rho_inf = 0: Houbolt's, but for its start, and wbz at 0; 1/2: hht at 1/2; 1: the midpoint rule. am = (2 r - "
        "1)/(r + 1), af = r/(r + 1); OpenSees' GeneralizedAlpha: alpha_M = 1 - am, alpha_F = 1 - af",
    ),
    SchemeCard(
        "hht",
        "rho_inf 1/2..1",
        "2",
        1,
        "locked contact: as chung-hulbert, with less choice",
        "gains energy from stiff contact that opens; damps stiff modes hardly more than soft ones",
        "rho_inf = (1 - e)/(1 + e): alpha = -e, -1/3..0, of papers, alpha = 1 - e, 2/3..1, of OpenSees' HHT; 1: "
        "average acceleration",
    ),
    SchemeCard(
        "wbz",
        "rho_inf 0..1",
        "2",
        1,
        "locked contact: as chung-hulbert, with more damping of middle modes",
        "gains energy from stiff contact that opens, but at 0",
        "Bossak's; rho_inf = 0: chung-hulbert at 0; 1: average acceleration. am = (r - 1)/(r + 1)",
    ),
    SchemeCard(
        "leapfrog",
        "-",
        "2",
        0,
        "soft contact: the least work for its error up to w dt = 0.6, no iteration",
        "limit w dt = 2; above it contact opens and throws the block, and the history stays finite and wrong",
        "explicit DDA, central differences, Verlet; symplectic (semi-implicit) Euler from half a step later",
    ),
    SchemeCard(
        "composite",
        "rho_inf 0..1, split",
        "2",
        2,
        "damps the contact mode of locked contact at any step",
        "two solves a step: at equal work average acceleration has half its error; gains energy from stiff contact "
        "that opens",
        "split 2 - sqrt 2, rho_inf 0: TR-BDF2 and Bathe's; split 1/2, rho_inf 0: trapezoidal rule and three-point "
        "backward Euler, DDA's CITI",
    ),
)


def card(name: str) -> SchemeCard:
    """Return the card of a scheme."""
    return next(one for one in CARDS if one.name == name)


def aliases(stepping: Stepping) -> tuple[str, ...]:
    """Return what else a scheme with its numbers is called, in sentences; none where it has one name."""
    if stepping.scheme == "newmark":
        return tuple(_of_newmark(stepping.alpha, stepping.delta))
    if stepping.scheme == "leapfrog":
        return ("this is explicit DDA: central differences, and symplectic Euler from half a step later",)
    radius = stepping.rho_inf or 0.0
    if stepping.scheme == "composite":
        return tuple(_of_composite(radius, stepping.split))
    numbers = stepping.one_stage
    names = []
    if _equal(radius, 1.0):
        midpoint = "the midpoint rule, " if stepping.scheme == "chung-hulbert" else ""
        names.append(f"this is {midpoint}Newmark (1/4, 1/2)")
    elif radius == 0:
        other = "wbz" if stepping.scheme == "chung-hulbert" else "chung-hulbert"
        names.append(f"this is Houbolt's scheme but for its start, and {other} with rho_inf = 0")
    elif _equal(radius, 0.5) and stepping.scheme in ("chung-hulbert", "hht"):
        other = "hht" if stepping.scheme == "chung-hulbert" else "chung-hulbert"
        names.append(f"this is {other} with rho_inf = 1/2, HHT's alpha = -1/3")
    if numbers is not None:
        if stepping.scheme == "hht":
            names.append(f"HHT's alpha is {-numbers.af:.6g} in papers and {1 - numbers.af:.6g} in OpenSees")
        else:
            names.append(
                f"am = {numbers.am:.6g}, af = {numbers.af:.6g}; OpenSees: alpha_M = {1 - numbers.am:.6g}, "
                f"alpha_F = {1 - numbers.af:.6g}"
            )
    return tuple(names)


def _of_newmark(alpha: float, delta: float) -> list[str]:
    if (alpha, delta) == (0.25, 0.5):
        return ["this is average acceleration: the midpoint and the trapezoidal rule, Moreau's theta = 1/2"]
    if (alpha, delta) == (1.0, 1.5):
        return ["this is implicit Euler, Moreau's theta = 1, and the soft constraints of physics engines"]
    if (alpha, delta) == (0.0, 0.5):
        return ["this is central differences, which the leapfrog steps without a solve"]
    theta = (delta + 0.5) / 2
    if 0 < theta <= 1 and _equal(alpha, theta**2):
        return [f"this is Moreau's theta = {theta:.6g}: alpha = theta^2, delta = 2 theta - 1/2"]
    return []


def _of_composite(rho_inf: float, split: float | None) -> list[str]:
    share = equal_split(rho_inf) if split is None else split
    if rho_inf == 0 and _equal(share, 2 - math.sqrt(2)):
        return ["this is TR-BDF2 and Bathe's scheme: split = 2 - sqrt 2, two solves a step"]
    if rho_inf == 0 and share == 0.5:
        return ["this is the trapezoidal rule and three-point backward Euler, two solves a step"]
    return []


def _equal(first: float, second: float) -> bool:
    return math.isclose(first, second, rel_tol=SAME)
