r"""Contact that opens: the law of one corner and the state that it carries from step to step.

A closed corner presses on the block with N = -p w, w its gap (negative when pressed), and holds it in
shear with T = -p_s (s - r), s its tangential displacement and r the reference, which is where it was when
it closed. An open corner carries nothing. Everything is total: no force is a sum of increments, so that a
contact cannot remember tension. With the gap w_n > 0 before and w_{n+1} < 0 after the step in which it closes,

    r = s_n + theta (s_{n+1} - s_n),    theta = w_n / (w_n - w_{n+1})

is the tangential displacement at the crossing. What is carried is the stretch s - r, not s and r, whose
difference would lose digits.

With friction a closed corner holds no more than Coulomb's limit, |T| <= tan(phi) N + c. Beyond it slips, in the
direction sigma = +-1, against T:

    T = -sigma (tan(phi) N + c),    r = s + T/p_s at the end of the step,    sigma (r_{n+1} - r_n) >= 0.

Cohesion c acts on every closed corner, on one that closes again too; an open one has none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

CONSISTENT, LAGGED = "consistent", "lagged"
OPEN, STICK, SLIP = 0, 1, 2  # of a corner with friction; SLIP towards M to N, -SLIP against it


@dataclass(frozen=True)
class Unilateral:
    """No-tension corners: a penalty spring each, or a rigid stop; frictionless, glued in shear, or with friction.

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
    friction: float | None = None  # tan(phi) [-]; None is glued
    cohesion: float = 0.0  # c of each closed corner, beside the friction [N]
    rules: str = CONSISTENT  # or "lagged": friction of the iteration before, as common programs have it

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
        self._check_friction()

    def _check_friction(self) -> None:
        if not (math.isfinite(self.cohesion) and self.cohesion >= 0):
            raise ValueError(f"cohesion: must be finite and not negative, got {self.cohesion!r}")
        if self.rules not in (CONSISTENT, LAGGED):
            raise ValueError(f"rules: must be {CONSISTENT} or {LAGGED}, got {self.rules!r}")
        if self.friction is None:
            if self.cohesion or self.rules == LAGGED:
                raise ValueError(f"friction: must be given with cohesion or {LAGGED} rules, got None")
            return
        if not (math.isfinite(self.friction) and self.friction >= 0):
            raise ValueError(f"friction: must be finite and not negative, got {self.friction!r}")
        if self.shear == 0:
            raise ValueError("shear: must be positive with friction, got 0")
        if self.band[1] > 0 and self.rules == CONSISTENT:
            raise ValueError(f"band: a corner that pulls rubs under {LAGGED} rules only, got {self.band!r}")

    def limit(self, N: float) -> float:
        """Greatest shear force tan(phi) N + c under the normal force N [N]; of a glued corner there is none."""
        return math.inf if self.friction is None else self.friction * max(N, 0.0) + self.cohesion

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
    state: tuple[int, ...] = ()  # with friction: OPEN, STICK, or SLIP in its direction; empty: sticks where closed
    slipped: tuple[float, ...] = ()  # change of r by slip in the step [m]; empty: none


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
