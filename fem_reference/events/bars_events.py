"""Elastic bars on each other, exact in space and time while their joints open, close, stick and slip.

The waves in the bars and the forces in the joints are pieces of exponentials times polynomials (`bars_march`). They are
computed twice, in more digits the second time, until both agree on every switch; where rounding and switches cost all
digits, or the pieces grow too many, the motion ends at a named horizon.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb
from numpy.typing import ArrayLike

from fem_reference.events.bars_march import CLOSED, OPEN, Joint, Wave, nodes_of, start_of
from fem_reference.events.bars_model import BarsProblem
from fem_reference.events.enclosure import bits_of, check_request, precision
from fem_reference.events.exponential_sum import ORDER, STRETCH
from fem_reference.events.switches import (
    LostDigitsError,
    Switch,
    TooManySwitchesError,
    Work,
)
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array

DIGITS = 40  # decimal digits of the first computation; the second one has twice as many
MOST_DIGITS = 320  # decimal digits of the last one
# Part of the limit of work for the first computation; the second, in more digits, takes a little more.
FIRST_PART = 0.45
PROMISED = 1e-15  # part of the end of the motion by which the instants of the switches of two computations may differ
KINDS = {OPEN: "opens", CLOSED: "closes"}


@dataclass(frozen=True)
class BarsHistory:
    """The motion at given instants, arrays of shape (bars, times)."""

    time: Array  # instants [s], shape (times,)
    mean_velocity: Array  # of each bar [m/s]
    force: Array  # N of each joint, or T on what is above; 0 where nothing is below [Pa]
    gap: Array  # gap y, negative where a spring is pressed, 0 of a joint that does not open [m]
    slip: Array  # slip r, 0 of a joint that does not slip [m]


@dataclass(frozen=True)
class JointHistory:
    """A joint at given instants, arrays of shape (times,)."""

    force: Array  # N, or T on what is above [Pa]
    gap: Array  # y [m]
    slip: Array  # r [m]


@dataclass(frozen=True)
class PointHistory:
    """A point of a bar at given instants, arrays of shape (times,)."""

    displacement: Array  # u [m]
    velocity: Array  # rate of u [m/s]
    stress: Array  # compression positive, of the shear the stress on what is above [Pa]


@dataclass(frozen=True)
class BarsMotion:
    """Exact motion of bars from t = 0 to `end`."""

    problem: BarsProblem
    end: float  # last instant [s]
    digits: int  # decimal digits of the computation
    switches: tuple[Switch, ...]  # of all joints in the order of time, ``corner`` being the number of the joint
    joints: tuple[Joint | None, ...]
    up: tuple[Wave, ...]  # p of each bar, from its foot
    down: tuple[Wave, ...]  # d of each bar, from its top

    def at(self, times: ArrayLike) -> BarsHistory:
        """The motion at instants from 0 to the end, in any order."""
        bars = range(len(self.problem.bars))
        velocity = self._rows(times, lambda time: [self._mean_velocity(i, time) for i in bars])
        joints = [self.joint(number, times) for number in bars]
        rows = [np.array([getattr(joint, part) for joint in joints]) for part in ("force", "gap", "slip")]
        return BarsHistory(instants(times, self.end), velocity, *rows)

    def _rows(self, times: ArrayLike, row: Callable[[arb], Sequence[float]]) -> Array:
        """Numbers of an instant at instants until `end`, shape (numbers, times)."""
        t = instants(times, self.end)
        with precision(bits_of(self.digits)):
            return np.array([row(arb(s)) for s in t.tolist() or [0.0]]).T[:, : len(t)]

    def joint(self, number: int, times: ArrayLike) -> JointHistory:
        """One joint at instants from 0 to `end`, in any order."""
        joint = self.joints[number]

        def row(time: arb) -> list[float]:
            if joint is None:
                return [0.0, 0.0, 0.0]
            piece = joint.pieces[bisect_right(joint.pieces, time.mid(), key=start_of) - 1]
            force = float(piece.force(time - piece.start))
            opening = float(piece.opening(time - piece.start))
            return [force, opening, 0.0] if joint.law.law == "unilateral" else [force, 0.0, opening]

        return JointHistory(*self._rows(times, row))

    def impulse(self, number: int, times: ArrayLike) -> Array:
        """Integral of the force of a joint from t = 0 to instants until `end` [Pa s], shape (times,)."""
        joint = self.joints[number]
        data = self.problem.bars[number]

        def row(time: arb) -> list[float]:
            if joint is None:
                return [0.0]
            # N = static + z (p - d) of the waves that leave the foot of the bar and arrive there
            leaving = self.up[number].at(time)[1] - self.up[number].at(arb(0))[1]
            arriving = self.down[number].at(time - data.travel)[1] - self.down[number].at(-data.travel)[1]
            return [float(joint.static * time + (leaving - arriving) * data.impedance)]

        return np.asarray(self._rows(times, row)[0])

    def point(self, bar: int, height: float, times: ArrayLike) -> PointHistory:
        """A point of a bar, its height above the foot of the bar [m], at instants from 0 to `end`.

        A `ValueError` for an instant or a height elsewhere.
        """
        data = self.problem.bars[bar]
        if not 0 <= height <= data.length:
            raise ValueError(f"height: must be from 0 to {data.length!r}, got {height!r}")
        gravity = self.problem.fall
        with precision(bits_of(self.digits)):
            x = data.travel * arb(height) / arb(data.length)
            rest, static_stress = self.problem.static_point(bar, arb(height))
            waves = [(self.up[bar], x), (self.down[bar], data.travel - x)]
            rest -= sum((wave.at(-delay)[1] for wave, delay in waves), arb(0))

        def row(time: arb) -> list[float]:
            displacement = rest - gravity * time * time / 2
            stress = static_stress
            velocities = []
            for wave, delay in waves:
                velocity, moved = wave.at(time - delay)
                displacement += moved
                velocities.append(velocity)
            up, down = velocities
            stress += (up - down) * data.impedance
            return [float(displacement), float(up + down - gravity * time), float(stress)]

        return PointHistory(*self._rows(times, row))

    def _mean_velocity(self, bar: int, time: arb) -> float:
        data = self.problem.bars[bar]
        T = data.travel
        mean = arb(0)
        for wave in (self.up[bar], self.down[bar]):
            mean += (wave.at(time)[1] - wave.at(time - T)[1]) / T
        return float(mean - self.problem.fall * time)


def least_terms(problem: BarsProblem, end: float) -> float:
    """How many terms of series a motion takes at least, in two computations, with its springs closed.

    A joint goes on at least once in the time of a wave along a bar beside it, and looks for a fall in intervals over
    which the decay of its spring is a power series.
    """
    terms = 0.0
    with precision(bits_of(DIGITS)):
        for number, joint in enumerate(problem.joints):
            if joint is None:
                continue
            travel = max(float(bar.travel) for bar in problem.bars[max(number - 1, 0) : number + 1])
            decay = joint.stiffness * float(problem.mobility(number)) if math.isfinite(joint.stiffness) else 0.0
            terms += 2 * ORDER * end * max(1 / travel, decay / STRETCH)
    return terms


def solve(
    problem: BarsProblem, end: float, digits: int = DIGITS, limit: int = 10_000, work: Work | None = None
) -> BarsMotion:
    """The exact motion of bars from t = 0 to `end` [s], of at most `limit` switches; `work` bounds terms of series.

    Parameters
    ----------
    digits
        Decimal digits of the first computation, at least 30. Twice as many are taken, up to `MOST_DIGITS`, until two
        computations agree on all switches to `PROMISED`; the last one is returned.

    Raises
    ------
    ValueError
        If `end` is not positive and finite or `digits` is below 30.
    TooManySwitchesError, LostDigitsError, TooMuchWorkError
        If the motion cannot be followed to its end, as `switches` has it.

    Examples
    --------
    >>> from fem_reference.events.bars_model import Bar, BarJoint, BarsProblem
    >>> bars = (Bar(1.0, 1.0, 1.0, velocity=1.0), Bar(1.0, 1.0, 1.0))
    >>> motion = solve(BarsProblem(bars, (None, BarJoint("unilateral"))), 3.0)
    >>> [abs(round(float(v), 9)) for v in motion.at([3.0]).mean_velocity[:, 0]]
    [0.0, 1.0]
    """
    check_request(end, digits)
    until = 0.0
    work = work or Work()
    work.part = FIRST_PART
    motion = _solved(problem, float(end), digits, limit, work)
    work.part = 1.0
    while motion.digits < MOST_DIGITS:
        finer = _solved(problem, float(end), 2 * motion.digits, limit, work)
        differing = _agree_until(motion, finer)
        if differing is None:
            return finer
        until = differing
        motion = finer
    raise LostDigitsError(until, f"{len(motion.switches)} switches have cost the digits")


def _agree_until(motion: BarsMotion, finer: BarsMotion) -> float | None:
    """None, or the instant of the first switch in which two motions differ by more than is promised [s]."""
    for switch, other in zip(motion.switches, finer.switches, strict=False):
        alike = (switch.corner, switch.kind) == (other.corner, other.kind)
        with precision(bits_of(finer.digits)):
            difference = abs(arb(switch.midpoint) - arb(other.midpoint))
        if not alike or difference > PROMISED * finer.end:
            return min(switch.time, other.time)
    counts = len(motion.switches), len(finer.switches)
    if counts[0] != counts[1]:
        return max(motion.switches, finer.switches, key=len)[min(counts)].time
    return None


def _solved(problem: BarsProblem, end: float, digits: int, limit: int, work: Work) -> BarsMotion:
    with precision(bits_of(digits)):
        nodes, up, down = nodes_of(problem, end, work)
        joints = [node for node in nodes if isinstance(node, Joint)]
        last = arb(end)
        advances = 0
        while True:
            node = min(nodes, key=lambda node: node.time.mid())
            finished = node.time.mid() >= last
            if (finished or advances % 100 == 0) and sum(len(joint.switches) for joint in joints) > limit:
                raise TooManySwitchesError(float(node.time), f"more than {limit} switches")
            if finished:
                break
            work.reach(float(node.time))
            work.add(1)
            node.advance(last)
            advances += 1
        switches: list[Switch] = []
        for joint in joints:
            for time, state in joint.switches:
                midpoint = time.mid().str(40, radius=False)
                switches.append(Switch(float(time), str(joint.number), KINDS.get(state, state), midpoint))
        feet = [node if isinstance(node, Joint) else None for node in nodes[:-1]]
        return BarsMotion(
            problem=problem,
            end=end,
            digits=digits,
            switches=tuple(sorted(switches, key=lambda switch: (switch.time, int(switch.corner)))),
            joints=tuple(feet),
            up=tuple(up),
            down=tuple(down),
        )
