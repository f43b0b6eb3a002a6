"""Newmark's sliding block: a rigid mass on a base that moves along its slope, exact from stick to slip.

With b the slope, Y = g cos(b) tan(phi) + C what friction and cohesion resist per mass, a(t) the acceleration of the
base towards +x (down the slope) and s the slide of the mass over the base::

    at rest on the base   |g sin b - a| <= Y
    sliding               s'' = g sin b - a - Y sign(s')

Between the changes of a(t) the slide is a polynomial; the instants at which the mass sticks and slips are the roots of
its rate. It is what a block on ever stiffer springs tends to.

Source: N. M. Newmark, Effects of earthquakes on dams and embankments, Geotechnique 15 (1965); a rectangular pulse of
acceleration A g on level ground that gives the base the velocity V moves the mass by V^2 / (2 g N) (1 - N / A).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.instants import by_pieces, instants
from fem_reference.problem.problem import Array

NOISE = 1e-12
"""Share of an acceleration, or of a time, that counts as rounding."""
ROUNDING = 4 * np.finfo(float).eps
"""Relative width of a root's bracket."""


@dataclass(frozen=True)
class SlidingBlock:
    """A rigid mass on a slope.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    slope: float  # angle b of the base, down towards +x [deg]
    friction: float  # angle phi of friction [deg]
    gravity: float = 9.81  # acceleration of gravity [m/s2]
    cohesion: float = 0.0  # C, cohesive force over mass [m/s2]

    def __post_init__(self) -> None:
        require_numbers(self, unsigned=("gravity", "cohesion"))
        require(-90 < self.slope < 90, "slope", "must be between -90 and 90", self.slope)
        require(0 <= self.friction < 90, "friction", "must be at least 0 and below 90", self.friction)

    @property
    def driving(self) -> float:
        """G sin b [m/s2]."""
        return self.gravity * math.sin(math.radians(self.slope))

    @property
    def resistance(self) -> float:
        """Y = g cos(b) tan(phi) + C [m/s2]."""
        return self.gravity * math.cos(math.radians(self.slope)) * math.tan(math.radians(self.friction)) + self.cohesion

    def push(self, direction: int) -> float:
        """Acceleration towards +x of a mass that slides towards +x (1) or -x (-1) over a base at rest [m/s2]."""
        return self.driving - direction * self.resistance


@dataclass(frozen=True)
class Segment:
    """The base's acceleration over a time, a0 + a1 s, after a jump of its velocity."""

    start: float  # first instant [s]
    end: float  # last instant [s]
    jump: float = 0.0  # jump of the base's velocity at the first instant [m/s]
    a0: float = 0.0  # acceleration at the first instant [m/s2]
    a1: float = 0.0  # its rate [m/s3]

    def acceleration(self, s: float) -> float:
        """Acceleration a time s after the start [m/s2]."""
        return self.a0 + self.a1 * s

    def velocity(self, s: ArrayLike) -> Array:
        """Velocity gained since just after the start [m/s]."""
        t = np.asarray(s, dtype=float)
        return np.asarray(self.a0 * t + self.a1 * t**2 / 2)

    def displacement(self, s: ArrayLike) -> Array:
        """Displacement since the start, of a base that is at rest just after it [m]."""
        t = np.asarray(s, dtype=float)
        return np.asarray(self.a0 * t**2 / 2 + self.a1 * t**3 / 6)

    def after(self, s: float) -> Segment:
        """What is left of the segment a time s later."""
        return replace(self, start=self.start + s, jump=0.0, a0=self.acceleration(s))

    def reaches(self, value: float) -> list[float]:
        """Times after the start at which the acceleration is a value [s], none or one, without the start."""
        length = self.end - self.start
        crossings = [(value - self.a0) / self.a1] if self.a1 else []
        return [s for s in crossings if NOISE * min(length, 1.0) < s <= length]


def recorded(time: ArrayLike, acceleration: ArrayLike) -> tuple[Segment, ...]:
    """A record of the acceleration from t = 0 on, linear between its rows; a repeated instant is a jump, then zero.

    Parameters
    ----------
    time
        Instants [s], not falling, shape (rows,).
    acceleration
        Accelerations towards +x [m/s2], shape (rows,).
    """
    t, a = _rows("recorded", time, acceleration)
    rises = [
        Segment(p, q, a0=x, a1=(y - x) / (q - p))
        for (p, q), (x, y) in zip(pairwise(t), pairwise(a), strict=True)
        if q > p
    ]
    return (*rises, Segment(t[-1], math.inf))


def moved(time: ArrayLike, displacement: ArrayLike) -> tuple[Segment, ...]:
    """A record of the displacement from t = 0 on, linear between its rows: the base's velocity jumps, and ends at zero.

    Parameters
    ----------
    time
        Instants [s], rising, shape (rows,).
    displacement
        Displacements towards +x [m], shape (rows,).
    """
    t, x = _rows("moved", time, displacement)
    if np.any(np.diff(t) <= 0):
        raise ValueError("moved: instants must rise, got some that do not")
    speeds = [0.0, *(np.diff(x) / np.diff(t)).tolist(), 0.0]
    ends = [*t[1:], math.inf]
    return tuple(Segment(p, q, jump=w - v) for p, q, (v, w) in zip(t, ends, pairwise(speeds), strict=True))


def _rows(what: str, time: ArrayLike, values: ArrayLike) -> tuple[list[float], list[float]]:
    t = np.asarray(time, dtype=float)
    x = np.asarray(values, dtype=float)
    if t.ndim != 1 or t.shape != x.shape or not len(t) or not np.all(np.isfinite([t, x])):
        raise ValueError(f"{what}: must be finite numbers at as many instants, got shapes {t.shape} and {x.shape}")
    if t[0] != 0 or np.any(np.diff(t) < 0):
        raise ValueError(f"{what}: instants must begin at 0 and not fall, got the first {float(t[0])!r}")
    return t.tolist(), x.tolist()


@dataclass(frozen=True)
class Stretch:
    """The mass between two changes."""

    base: Segment  # the base from the beginning of the stretch on
    way: int  # 1 sliding towards +x, -1 towards -x, 0 at rest on the base
    slide: float  # slide at the beginning [m]
    velocity: float  # its rate [m/s]
    push: float  # acceleration over a base at rest [m/s2]

    def at(self, time: ArrayLike) -> tuple[Array, Array]:
        """Slide [m] and its rate [m/s] at instants."""
        s = np.asarray(time, dtype=float) - self.base.start
        if self.way == 0:
            return np.full_like(s, self.slide), np.zeros_like(s)
        slide = self.slide + self.velocity * s + self.push * s**2 / 2 - self.base.displacement(s)
        return slide, self.velocity + self.push * s - self.base.velocity(s)


@dataclass(frozen=True)
class SlidingMotion:
    """Exact motion of a mass from t = 0 to `end`."""

    block: SlidingBlock
    end: float  # last instant [s]
    stretches: tuple[Stretch, ...]  # the motion in the order of time

    def at(self, times: ArrayLike) -> tuple[Array, Array]:
        """Slide over the base towards +x [m], and its rate [m/s], each of shape (times,).

        Raises
        ------
        ValueError
            If an instant is not from 0 to `end`.
        """
        t = instants(times, self.end)
        motion = np.empty((2, len(t)))
        for i, here in by_pieces(t, [one.base.start for one in self.stretches]):
            motion[:, here] = self.stretches[i].at(t[here])
        return motion[0], motion[1]

    @property
    def switches(self) -> tuple[tuple[float, int], ...]:
        """Instants [s] at which the mass begins to slide (1, -1: the way) or comes to rest on the base (0)."""
        ways = [(0.0, 0), *((one.base.start, one.way) for one in self.stretches)]
        return tuple(after for before, after in pairwise(ways) if before[1] != after[1])

    @property
    def slip(self) -> float:
        """Length of the way over the base, both directions added [m]."""
        ends = [*(one.slide for one in self.stretches), float(self.at([self.end])[0][0])]
        return math.fsum(abs(after - before) for before, after in pairwise(ends))


def solve(block: SlidingBlock, base: tuple[Segment, ...], end: float) -> SlidingMotion:
    """The exact motion of a mass that is at rest with its base before t = 0.

    Parameters
    ----------
    block
        The mass and its slope.
    base
        The base, by `recorded` or `moved`.
    end
        Last instant [s].

    Raises
    ------
    ValueError
        If `end` is not positive and finite.
    """
    require(0 < end < math.inf, "end", "must be positive and finite", end)
    slide = 0.0
    velocity = 0.0
    stretches = list[Stretch]()
    for segment in base:
        remainder: Segment | None = replace(segment, end=min(segment.end, end))
        while remainder is not None and remainder.start < remainder.end:
            stretch = _begin(block, remainder, slide, velocity - remainder.jump)
            stretches.append(stretch)
            after = _change(block, stretch)
            s = remainder.end - remainder.start if after is None else after
            slide, velocity = (float(x) for x in stretch.at(stretch.base.start + s))
            velocity = velocity if after is None else 0.0
            remainder = None if after is None else remainder.after(s)
    return SlidingMotion(block, float(end), tuple(stretches))


def _begin(block: SlidingBlock, base: Segment, slide: float, velocity: float) -> Stretch:
    """The mass from an instant on."""
    direction = int(np.sign(velocity)) or _yields(block, base)
    return Stretch(base, direction, slide, velocity if direction else 0.0, block.push(direction))


def _yields(block: SlidingBlock, base: Segment) -> int:
    """The way in which a mass at rest on its base begins to slide, 0 if it stays."""
    size = block.gravity + abs(base.a0)
    for direction in (1, -1):
        excess = direction * (block.push(direction) - base.a0)
        if excess > NOISE * size or (abs(excess) <= NOISE * size and direction * base.a1 < 0):
            return direction
    return 0


def _change(block: SlidingBlock, stretch: Stretch) -> float | None:
    """Time after the beginning at which the mass sticks or slips, None if it does not within the segment."""
    if stretch.way:
        return _sticks(stretch)
    base = stretch.base
    crossings: list[float] = []
    for direction in (1, -1):
        if direction * base.a1 < 0:
            crossings += base.reaches(block.push(direction))
    return min(crossings, default=None)


def _sticks(stretch: Stretch) -> float | None:
    """The first root of the rate of the slide, which is monotone between the roots of its own rate."""
    base = stretch.base
    direction = stretch.way

    def rate(s: float) -> float:
        return direction * (stretch.velocity + stretch.push * s - float(base.velocity(s)))

    bounds = [0.0, *base.reaches(stretch.push), base.end - base.start]
    for low, high in pairwise(bounds):
        if rate(high) < 0:
            return float(brentq(rate, low, high, xtol=1e-300, rtol=ROUNDING)) if rate(low) > 0 else low
    return None
