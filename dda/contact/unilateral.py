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
from dataclasses import dataclass

from dda.model.checks import check_among, check_not_negative

CONSISTENT = "consistent"
LAGGED = "lagged"
# of a corner with friction; SLIP towards M to N, -SLIP against it
OPEN = 0
STICK = 1
SLIP = 2


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
    damping: float = 0.0  # c of a dashpot beside each spring, clipped: N >= 0 (`dda.contact.rows`) [N s/m]

    def __post_init__(self) -> None:
        """Check the ranges."""
        if not self.stiffness > 0:
            raise ValueError(f"stiffness: must be positive, got {self.stiffness!r}")
        check_not_negative(shear=self.shear, gap=self.gap)
        if len(self.band) != 2 or not all(math.isfinite(width) and width >= 0 for width in self.band):
            raise ValueError(f"band: must be two finite lengths that are not negative, got {self.band!r}")
        if math.isinf(self.stiffness) and self.band[1] > 0:
            raise ValueError(f"band: a rigid stop must open at once (band[1] = 0), got {self.band!r}")
        check_not_negative(cohesion=self.cohesion, damping=self.damping)
        if self.damping:
            if math.isinf(self.stiffness):
                raise ValueError("damping: a dashpot needs a finite stiffness beside it, got stiffness = inf")
            if self.friction is not None or self.cohesion or self.rules != CONSISTENT:
                friction = f"friction = {self.friction!r}, cohesion = {self.cohesion!r}, rules = {self.rules!r}"
                raise ValueError(f"damping: a dashpot goes with frictionless contact only, got {friction}")
            if any(self.band):
                raise ValueError(f"damping: a dashpot goes with no dead band, got band = {self.band!r}")
        check_among((CONSISTENT, LAGGED), rules=self.rules)
        if self.friction is None:
            if self.cohesion or self.rules == LAGGED:
                what = f"cohesion = {self.cohesion!r}" if self.cohesion else f"{LAGGED} rules"
                raise ValueError(f"friction: must be given with {what}, got None")
            return
        check_not_negative(friction=self.friction)
        if self.shear == 0:
            raise ValueError("shear: must be positive with friction, got 0")
        if self.band[1] > 0 and self.rules == CONSISTENT:
            raise ValueError(f"band: a corner that pulls rubs under {LAGGED} rules only, got {self.band!r}")

    @property
    def compliance(self) -> float:
        """1/p [m/N]; 0 for a rigid stop."""
        return 1 / self.stiffness

    @property
    def softness(self) -> float:
        """1/p_s [m/N]; 0 without shear."""
        return 1 / self.shear if self.shear else 0.0

    @property
    def pull(self) -> float:
        """Greatest tension p band[1] of a closed corner [N]."""
        return self.stiffness * self.band[1] if self.band[1] else 0.0
