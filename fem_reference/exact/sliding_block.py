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
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PPoly
from scipy.optimize import brentq

from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array

NOISE = 1e-12
"""Share of an acceleration, or of a time, that counts as rounding."""
ROUNDING = 4 * np.finfo(float).eps
"""Relative width of a root's bracket."""


@dataclass(frozen=True)
class SlidingBlock:
    """A rigid mass on a slope."""

    slope: float  # b of the base, down towards +x [deg]
    friction: float  # angle phi [deg]
    gravity: float = 9.81  # g [m/s2]
    cohesion: float = 0.0  # C, cohesive force over mass [m/s2]

    def __post_init__(self) -> None:
        require_numbers(self, unsigned=("gravity", "cohesion"))
        require(-90 < self.slope < 90, "slope", "must be between -90 and 90", self.slope)
        require(0 <= self.friction < 90, "friction", "must be at least 0 and below 90", self.friction)

    @property
    def driving(self) -> float:
        """Acceleration g sin b [m/s2]."""
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

    start: float  # [s]
    end: float  # [s]
    jump: float = 0.0  # at the first instant [m/s]
    a0: float = 0.0  # [m/s2]
    a1: float = 0.0  # [m/s3]

    def acceleration(self, s: float) -> float:
        """Acceleration a time s after the start [m/s2]."""
        return self.a0 + self.a1 * s


def recorded(time: ArrayLike, acceleration: ArrayLike) -> tuple[Segment, ...]:
    """A record of the acceleration from t = 0 on, linear between its rows; a repeated instant is a jump, then zero.

    Parameters
    ----------
    time
        [s], not falling, shape (rows,).
    acceleration
        Towards +x [m/s2], shape (rows,).
    """
    t, a = _rows("recorded", time, acceleration)
    ends = pairwise(zip(t, a, strict=True))
    rises = [Segment(p, q, a0=x, a1=(y - x) / (q - p)) for (p, x), (q, y) in ends if q > p]
    return (*rises, Segment(t[-1], math.inf))


def moved(time: ArrayLike, displacement: ArrayLike) -> tuple[Segment, ...]:
    """A record of the displacement from t = 0 on, linear between its rows: the base's velocity jumps, and ends at zero.

    Parameters
    ----------
    time
        [s], rising, shape (rows,).
    displacement
        Towards +x [m], shape (rows,).
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
class SlidingMotion:
    """Exact motion of a mass from t = 0 to `end`."""

    block: SlidingBlock
    end: float  # last instant [s]
    slide: PPoly  # over the base [m], a cubic from each change to the next
    ways: tuple[int, ...]  # of each of them: 1 sliding towards +x, -1 towards -x, 0 at rest on the base

    def at(self, times: ArrayLike) -> tuple[Array, Array]:
        """Slide over the base towards +x [m] and its rate [m/s] at instants from 0 to `end`, each of shape (times,)."""
        t = instants(times, self.end)
        return self.slide(t), self.slide(t, 1)

    @property
    def switches(self) -> tuple[tuple[float, int], ...]:
        """Instants [s] at which the mass begins to slide (1, -1: the way) or comes to rest on the base (0)."""
        begun = zip(self.slide.x.tolist(), self.ways, strict=False)
        return tuple(after for before, after in pairwise([(0.0, 0), *begun]) if before[1] != after[1])

    @property
    def slip(self) -> float:
        """Length of the way over the base, both directions added [m]."""
        return math.fsum(np.abs(np.diff(self.slide(self.slide.x))))


def solve(block: SlidingBlock, base: tuple[Segment, ...], end: float) -> SlidingMotion:
    """The exact motion to `end` [s] of a mass at rest before t = 0 with its base, which is `recorded` or `moved`.

    A `ValueError` unless `end` is positive and finite.
    """
    require(0 < end < math.inf, "end", "must be positive and finite", end)
    slide = 0.0
    velocity = 0.0
    times = []
    ways = []
    cubics = []
    for segment in base:
        time = segment.start
        last = min(segment.end, end)
        velocity -= segment.jump
        while time < last:
            acceleration = segment.acceleration(time - segment.start)
            way = int(np.sign(velocity)) or _yields(block, acceleration, segment.a1)
            a = block.push(way) - acceleration
            b = -segment.a1 / 2
            change = _sticks(way, velocity, a, b, last - time) if way else 0.0
            if change == 0:  # at rest, also where rounding alone would let it slide
                way = 0
                velocity = 0.0
                a = 0.0
                b = 0.0
                change = _slips(block, acceleration, segment.a1, last - time)
            s = last - time if change is None else change
            times.append(time)
            ways.append(way)
            cubics.append((b / 3, a / 2, velocity, slide))
            slide += ((b / 3 * s + a / 2) * s + velocity) * s
            velocity = (b * s + a) * s + velocity if change is None else 0.0
            # At least to the next float: a change that rounding puts at the present instant would come for ever.
            time = last if change is None else max(time + s, math.nextafter(time, math.inf))
    return SlidingMotion(block, float(end), PPoly(np.transpose(cubics), [*times, end]), tuple(ways))


def _yields(block: SlidingBlock, acceleration: float, growth: float) -> int:
    """The way in which a mass at rest on its base begins to slide, 0 if it stays."""
    size = block.gravity + abs(acceleration)
    for way in (1, -1):
        excess = way * (block.push(way) - acceleration)
        if excess > NOISE * size or (abs(excess) <= NOISE * size and way * growth < 0):
            return way
    return 0


def _slips(block: SlidingBlock, acceleration: float, growth: float, length: float) -> float | None:
    """Time after which a mass at rest on its base begins to slide, None if it does not within a length of time."""
    ways = [way for way in (1, -1) if way * growth < 0]
    crossings = [(block.push(way) - acceleration) / growth for way in ways]
    return min((s for s in crossings if NOISE * min(length, 1.0) < s <= length), default=None)


def _sticks(way: int, velocity: float, a: float, b: float, length: float) -> float | None:
    """The first root of velocity + a s + b s^2 within a length of time, monotone before and after its extreme value."""

    def forwards(s: float) -> float:
        return way * ((b * s + a) * s + velocity)

    turn = -a / (2 * b) if b else 0.0
    bounds = [0.0, turn, length] if NOISE * min(length, 1.0) < turn <= length else [0.0, length]
    for low, high in pairwise(bounds):
        if forwards(high) < 0:
            return float(brentq(forwards, low, high, xtol=1e-300, rtol=ROUNDING)) if forwards(low) > 0 else low
    return None
