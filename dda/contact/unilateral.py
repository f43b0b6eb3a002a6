r"""Contact that opens: the law of one corner and the state that it carries from step to step.

A closed corner presses on the block with N = -p w, w its gap (negative when pressed), and holds it in
shear with T = -p_s (s - r), s its tangential displacement and r the reference, which is where it was when
it closed. An open corner carries nothing. Everything is total: no force is a sum of increments, so that a
contact cannot remember tension. With the gap w_n > 0 before and w_{n+1} < 0 after the step in which it closes,

    r = s_n + theta (s_{n+1} - s_n),    theta = w_n / (w_n - w_{n+1})

is the tangential displacement at the crossing. What is carried is the stretch s - r, not s and r, whose
difference would lose digits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True)
class Unilateral:
    """No-tension corners: a penalty spring each, or a rigid stop; frictionless, or glued in shear while closed.

    An open corner closes if its gap falls below -band[0]; a closed one opens if its gap exceeds band[1], so
    that with a band a closed corner may pull with up to p band[1]. Other programs have such bands; here
    they are zero unless asked for.

    Raises
    ------
    ValueError
        If a number is out of its range, naming field, rule and value.
    """

    stiffness: float  # p of each corner [N/m]; inf is a rigid stop
    shear: float = 0.0  # p_s of each closed corner [N/m]; 0 is frictionless
    gap: float = 0.0  # g0 under both corners at t = 0 [m]
    band: tuple[float, float] = (0.0, 0.0)  # dead band of closing and of opening [m]

    def __post_init__(self) -> None:
        """Check the ranges."""
        if not self.stiffness > 0:
            raise ValueError(f"stiffness: must be positive, got {self.stiffness!r}")
        for field in ("shear", "gap"):
            value = getattr(self, field)
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"{field}: must be finite and not negative, got {value!r}")
        if len(self.band) != 2 or not all(math.isfinite(width) and width >= 0 for width in self.band):
            raise ValueError(f"band: must be two finite lengths that are not negative, got {self.band!r}")
        if math.isinf(self.stiffness) and self.band[1] > 0:
            raise ValueError(f"band: a rigid stop must open at once (band[1] = 0), got {self.band!r}")

    @property
    def compliance(self) -> float:
        """1/p [m/N]; 0 for a rigid stop."""
        return 1 / self.stiffness

    @property
    def pull(self) -> float:
        """Greatest tension p band[1] of a closed corner [N]."""
        return self.stiffness * self.band[1] if self.band[1] else 0.0

    def stays_closed(self, N: float) -> bool:
        """Tell whether a closed corner with the normal force N [N] stays closed."""
        return -self.pull <= N

    def closes(self, w: float) -> bool:
        """Tell whether an open corner with the gap w [m] closes."""
        return w < -self.band[0]


# Tangential displacement s of each contact in the coordinates of the block: of one contact its own, of two corners
# the mean U and the difference d = s_N - s_M. In a long step a rigid motion of 1e9 m may hide a difference that is
# elastic; so the forces are found in H = T_M + T_N and G = (T_N - T_M)/2, which belong to U and d.
SLIDES = {1: ((1.0,),), 2: ((1.0, -0.5), (1.0, 0.5))}


class Corners(NamedTuple):
    """State of the contacts, one entry each: two corners, or one that stands for both in a symmetric motion."""

    closed: tuple[bool, ...]
    gap: tuple[float, ...]  # w [m]
    stretch: tuple[float, ...]  # s - r of the closed ones [m]; 0 where open
    reference: tuple[float, ...]  # r [m]; of an open one s itself
    normal: tuple[float, ...]  # N [N], on the block, away from the base
    shear: tuple[float, ...]  # T [N], on the block, along the base


def at_rest(law: Unilateral, contacts: int) -> Corners:
    """Return the corners at t = 0: without force, closed where they touch."""
    nothing = (0.0,) * contacts
    return Corners((law.gap == 0,) * contacts, (law.gap,) * contacts, nothing, nothing, nothing, nothing)


def slide_forces(shear: Sequence[float]) -> tuple[float, ...]:
    """Return the forces that belong to the coordinates of `SLIDES`: T, or (H, G) of T_M and T_N."""
    return (shear[0],) if len(shear) == 1 else (shear[0] + shear[1], (shear[1] - shear[0]) / 2)


def slipped_share(law: Unilateral, before: float, N: float) -> tuple[float, float]:
    """Return 1 - theta of a corner that closes in a step, and its derivative by N [1/N].

    With w_{n+1} = -N/p the share of the step's tangential displacement behind the crossing is

        1 - theta = (N/p) / (w_n + N/p).

    Parameters
    ----------
    before : float
        The gap w_n before the step [m]; one that is not positive has crossed already.
    N : float
        The normal force after the step [N]; a tension has not crossed.
    """
    if before <= 0:
        return 1.0, 0.0
    if N <= 0:
        return 0.0, 0.0
    into = N * law.compliance
    return into / (before + into), law.compliance * before / (before + into) / (before + into)
