"""What programs in space need beside those in the plane: angles that are not folded."""

from __future__ import annotations

import math


class Rotation:
    """An angle that goes on beyond half a turn, of a program that folds it.

    Between two looks at it a box must turn by less than half a turn.
    """

    def __init__(self, start: float) -> None:
        self.angle = start

    def follow(self, folded: float) -> float:
        """Return the angle nearest to the last one that differs from a folded one by full turns [rad]."""
        self.angle += math.remainder(folded - self.angle, 2 * math.pi)
        return self.angle
