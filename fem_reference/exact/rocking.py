"""A rigid block that rocks on a rigid base about its lower corners.

With a and h width and height, R half of the diagonal, alpha = atan(a / h), p^2 = 3 g / (4 R) and theta the rotation,
positive about the right corner and towards +x::

    theta'' = -p^2 sin(alpha s - theta),    s = sign(theta)

nothing being small. Each time it comes down on the other corner its rate is multiplied by a restitution, Housner's
1 - 3/2 sin^2(alpha) where no other is given: the moment of momentum about the new corner is kept. Sliding and bouncing
are left out.

Sources: G. W. Housner, The behavior of inverted pendulum structures during earthquakes, Bulletin of the Seismological
Society of America 53 (1963); the quarter period is the incomplete elliptic integral of an inverted pendulum.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp
from scipy.special import ellipkinc

from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.instants import by_pieces, instants
from fem_reference.problem.problem import Array

ACCURACY = 1e-13
"""Relative tolerance of the integration."""
STILL = 1e-9
"""Rate below which the block has come to rest, over p."""
SWINGS = 10_000
"""Most swings."""
FALLEN = math.pi / 2
"""Rotation at which the block lies on its side and the motion ends [rad]."""


@dataclass(frozen=True)
class RockingBlock:
    """A rigid rectangle on a rigid base."""

    width: float  # a [m]
    height: float  # h [m]
    gravity: float = 9.81  # g [m/s2]
    restitution: float | None = None  # rate after over rate before an impact [-]; None: Housner's

    def __post_init__(self) -> None:
        require_numbers(self, positive=("width", "height", "gravity"))
        ratio = self.restitution
        require(ratio is None or 0 <= ratio <= 1, "restitution", "must be from 0 to 1", ratio)

    @property
    def alpha(self) -> float:
        """Rotation at which the centre stands above the corner, atan(a / h) [rad]; also the slope that topples it."""
        return math.atan2(self.width, self.height)

    @property
    def p(self) -> float:
        """sqrt(3 g / (4 R)), the rate of the upright pendulum of this inertia [1/s]."""
        return math.sqrt(1.5 * self.gravity / math.hypot(self.width, self.height))

    @property
    def ratio(self) -> float:
        """Rate after over rate before an impact [-]; its square is the share of energy that is left."""
        return 1 - 1.5 * math.sin(self.alpha) ** 2 if self.restitution is None else self.restitution

    def quarter_period(self, tilt: float) -> float:
        """Time in which the block comes down, released at rest from a tilt [s]; infinite at alpha, where it balances.

        With psi = alpha - tilt it is F(x, k) / p, k = cos(psi / 2) and
        tan(x) = sqrt(sin(alpha - tilt / 2) sin(tilt / 2)) / (cos(alpha / 2) sin(psi / 2)).
        """
        require(0 <= tilt <= self.alpha, "tilt", f"must be from 0 to alpha = {self.alpha:g} rad", tilt)
        if tilt == self.alpha:
            return math.inf
        psi = self.alpha - tilt
        rise = math.sqrt(math.sin(self.alpha - tilt / 2) * math.sin(tilt / 2))
        angle = math.atan2(rise, math.cos(self.alpha / 2) * math.sin(psi / 2))
        return float(ellipkinc(angle, math.cos(psi / 2) ** 2)) / self.p


@dataclass(frozen=True)
class Swing:
    """The block on one of its corners."""

    start: float  # first instant [s]
    values: Callable[[Array], Array]  # rotation [rad] and its rate [rad/s] at instants, shape (2, times)


@dataclass(frozen=True)
class RockingMotion:
    """Motion of a block from t = 0 to `end`."""

    end: float  # last instant [s]
    swings: tuple[Swing, ...]  # in the order of time
    impacts: tuple[float, ...]  # instants at which it came down on the other corner [s]
    overturned: bool  # whether it fell on its side

    def at(self, times: ArrayLike) -> tuple[Array, Array]:
        """Rotation [rad] and its rate [rad/s] at instants from 0 to `end`, after an impact at it."""
        t = instants(times, self.end)
        motion = np.empty((2, len(t)))
        for i, here in by_pieces(t, [swing.start for swing in self.swings]):
            motion[:, here] = self.swings[i].values(t[here])
        return motion[0], motion[1]


def solve(block: RockingBlock, end: float, tilt: float) -> RockingMotion:
    """The motion of a block that is released at rest from a tilt [rad], positive about the right corner.

    It goes from impact to impact until `end` [s], or until the block falls on its side.

    Raises
    ------
    ValueError
        If `end` is not positive and finite or the tilt not below a right angle.
    ArithmeticError
        If the block comes down more than 10000 times.
    """
    require(0 < end < math.inf, "end", "must be positive and finite", end)
    require(abs(tilt) < FALLEN, "tilt", "must be below a right angle", tilt)
    time = 0.0
    angle = tilt
    rate = 0.0
    fallen = False
    swings: list[Swing] = []
    impacts = []
    while time < end and not fallen:
        if len(swings) > SWINGS:
            raise ArithmeticError(f"more than {SWINGS} swings by {time:g} s")
        if angle == 0 and abs(rate) < STILL * block.p:
            swings.append(Swing(time, lambda t: np.zeros((2, len(t)))))
            time = end
            break
        side = 1 if (angle or rate) > 0 else -1
        swing = _swing(block, side, (time, end), (angle, rate))
        swings.append(Swing(time, swing.sol))
        time = float(swing.t[-1])
        angle = float(swing.y[0, -1])
        rate = float(swing.y[1, -1])
        fallen = swing.status == 1 and abs(angle) > FALLEN / 2
        if swing.status == 1 and not fallen:
            impacts.append(time)
            angle = 0.0
            rate = rate * block.ratio
    return RockingMotion(min(time, end), tuple(swings), tuple(impacts), fallen)


def _swing(block: RockingBlock, side: int, span: tuple[float, float], start: tuple[float, float]) -> Any:
    """The block on a corner until it comes down or falls, or to the end of a span."""
    alpha = block.alpha * side
    square = block.p**2

    def motion(t: float, y: Array) -> list[float]:
        return [y[1], -square * math.sin(alpha - y[0])]

    def stands(t: float, y: Array) -> float:
        return min(side * float(y[0]), FALLEN - side * float(y[0]))

    stands.terminal = True  # type: ignore[attr-defined]
    stands.direction = -1  # type: ignore[attr-defined]
    return solve_ivp(motion, span, start, "DOP853", rtol=ACCURACY, atol=1e-15, events=stands, dense_output=True)
