"""Bars on each other by characteristics: every joint advances by itself, as far as the waves on their way are known.

With T = L / c of a bar and z = rho c, the wave p leaves its foot and d its top::

    foot of bar j      p_j(t) = d_j(t - T_j) + N_j / z_j
    top of bar j - 1   d_{j-1}(t) = p_{j-1}(t - T_{j-1}) - N_j / z_{j-1}
    gap of joint j     y_j' = K + mobility N_j,   K = 2 d_j(t - T_j) - 2 p_{j-1}(t - T_{j-1})

A base takes part as a wave of its own: half of its velocity where that is prescribed, the wave that comes up where it
is a half-space, and in both cases g t / 2, by which the bars fall away from it. Where the bars begin at rest under
their weight, the waves are those of the motion beyond that state, in which the joints carry their static forces.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from flint import arb, ctx

from fem_reference.events.bars_model import BarJoint, BarsProblem, function_of
from fem_reference.events.column_drive import Drive
from fem_reference.events.enclosure import ZERO
from fem_reference.events.exponential_sum import ExponentialSum, Rates
from fem_reference.events.switches import Work

# States of a joint; it slips forwards where its upper face moves towards + over the lower one.
OPEN = "open"
CLOSED = "closed"
STICKS = "sticks"
FORWARDS = "slips forwards"
BACKWARDS = "slips backwards"
DIRECTION = {BACKWARDS: 1, FORWARDS: -1}  # of the force, against which a joint slips


class WavePiece(NamedTuple):
    """A wave from an instant on."""

    start: arb  # [s]
    velocity: ExponentialSum  # of the time since then [m/s]
    displacement: ExponentialSum  # its integral from the first piece on [m]


@dataclass
class Wave:
    """The wave that leaves one end of a bar, or a drive: what is known of it."""

    pieces: list[WavePiece]
    known_until: arb  # [s]

    def at(self, time: arb) -> tuple[arb, arb]:
        """Velocity [m/s] and its integral from the first piece on [m]."""
        piece = self.pieces[max(bisect_right(self.pieces, time.mid(), key=start_of) - 1, 0)]
        return piece.velocity(time - piece.start), piece.displacement(time - piece.start)

    def append(self, start: arb, velocity: ExponentialSum) -> None:
        """Go on with another function, unless it is the one before."""
        last = self.pieces[-1]
        if (velocity - last.velocity.shifted(start - last.start)).without_noise():
            self.pieces.append(WavePiece(start, velocity, velocity.integral(last.displacement(start - last.start))))


@dataclass
class Arrival:
    """A wave at the joint that it arrives at."""

    wave: Wave
    delay: arb  # [s]
    piece: int = -1  # number of the piece that has arrived last

    def until(self) -> arb:
        """The instant up to which its function is known and stays the same [s]."""
        if self.piece + 1 < len(self.wave.pieces):
            return self.wave.pieces[self.piece + 1].start + self.delay
        return self.wave.known_until + self.delay

    def advance(self, time: arb) -> bool:
        """Take the pieces that have arrived by an instant; return whether there are any."""
        arrived = False
        finest = abs(time).mid() * arb(2) ** (-ctx.prec // 2)
        while self.piece + 1 < len(self.wave.pieces):
            ahead = self.wave.pieces[self.piece + 1].start + self.delay - time
            if ahead.mid() > finest:
                break
            self.piece += 1
            arrived = True
        return arrived

    def function(self, time: arb) -> ExponentialSum:
        """The wave as a function of the time since an instant."""
        piece = self.wave.pieces[self.piece]
        return piece.velocity.shifted(time - piece.start - self.delay)


class JointPiece(NamedTuple):
    """A joint from an instant on; functions of the time since then."""

    start: arb  # [s]
    state: str
    force: ExponentialSum  # N, or T on what is above [Pa]
    opening: ExponentialSum  # gap y of a unilateral joint, slip r of another one [m]


@dataclass
class Node:
    """An end of the column, where the force is given: the top under its pressure, or a foot above nothing."""

    arrivals: tuple[Arrival, ...]  # the wave in the bar, and the force N [Pa] that is given at the top
    leaving: Wave
    admittance: arb  # N to what leaves: 1 / z, negative at the top [m/(Pa s)]
    time: arb = field(default_factory=lambda: ZERO)

    def advance(self, end: arb) -> None:
        """Go on as far as the arrivals are known and stay the same, or to `end`."""
        arrived = [arrival.advance(self.time) for arrival in self.arrivals]
        if any(arrived):
            wave, *force = (arrival.function(self.time) for arrival in self.arrivals)
            for N in force:
                wave += N * self.admittance
            self.leaving.append(self.time, wave.without_noise())
        self.time = earliest(self.arrivals, end)
        self.leaving.known_until = self.time


@dataclass
class Joint:
    """A joint between two bars, or between the lowest bar and a base."""

    number: int
    law: BarJoint
    above: Arrival
    below: Arrival
    leaving_up: Wave
    leaving_down: Wave | None  # None: into the base
    admittance_above: arb  # 1 / z [m/(Pa s)]
    admittance_below: arb
    static: arb  # force in which the waves have no part [Pa]
    opening: arb  # y or r at its time [m]
    force: arb  # T at its time, of a frictional spring [Pa]
    time: arb = field(default_factory=lambda: ZERO)
    pieces: list[JointPiece] = field(default_factory=list)
    switches: list[tuple[arb, str]] = field(default_factory=list)  # instant and new state

    @property
    def mobility(self) -> arb:
        """Relative velocity of the faces over the force [m/(Pa s)]."""
        return self.admittance_above + self.admittance_below

    @property
    def rigid(self) -> bool:
        """Whether the closed or sticking faces move alike."""
        return math.isinf(self.law.stiffness)

    @property
    def stiffness(self) -> arb:
        """Stiffness k of one that is not rigid [Pa/m]."""
        return arb(self.law.stiffness)

    def advance(self, end: arb) -> None:
        """Go on to the next switch, as far as the arrivals are known and stay the same, or to `end`."""
        arrived = [self.above.advance(self.time), self.below.advance(self.time)]
        above = self.above.function(self.time)
        below = self.below.function(self.time)
        relative = ((above - below) * 2).plus(-self.mobility * self.static).without_noise()
        unilateral = self.law.law == "unilateral"
        state = self._contact_state(relative) if unilateral else self._friction_state(relative)
        piece = self._piece(state, relative)
        for function in (relative, piece.force, piece.opening):
            function.count_terms()
        before = self.pieces[-1].state if self.pieces else None
        if any(arrived) or state != before:
            self.pieces.append(piece)
            change = piece.force.plus(-self.static)
            self.leaving_up.append(self.time, (above + change * self.admittance_above).without_noise())
            if self.leaving_down is not None:
                self.leaving_down.append(self.time, (below - change * self.admittance_below).without_noise())
        if before is not None and state != before:
            self.switches.append((self.time, state))
        # on to the first fall of a watched function, if there is one
        elapsed = (earliest((self.above, self.below), end) - self.time).mid()
        of_gap = state == OPEN or (state == CLOSED and not self.rigid)
        switching = -1
        for number, function in enumerate(self._watched(piece, relative)):
            fall = function.first_fall(elapsed, of_gap)
            if fall is not None:
                switching = number
                elapsed = min(elapsed, fall)
        self.time = (self.time + elapsed).mid()
        self.opening = piece.opening(elapsed).mid()
        if state in (OPEN, CLOSED):
            none = switching >= 0 or abs(self.opening) < piece.force.rates.negligible_length
            if none or bool(self.opening < 0) != (state == CLOSED):
                self.opening = ZERO
        elif not self.rigid:
            self.force = piece.force(elapsed).mid()
            if state == STICKS and switching >= 0:
                self.force = arb(self.law.strength) * (1, -1)[switching]
        self.leaving_up.known_until = self.time
        if self.leaving_down is not None:
            self.leaving_down.known_until = self.time

    def _contact_state(self, relative: ExponentialSum) -> str:
        """Closed or open just after now; where nothing moves it stays as it was, at first open."""
        if self.opening != 0:
            return CLOSED if self.opening < 0 else OPEN
        sign = relative.first_sign()
        if sign == 0:
            return self.pieces[-1].state if self.pieces else OPEN
        return CLOSED if sign < 0 else OPEN

    def _friction_state(self, relative: ExponentialSum) -> str:
        """Sticking or slipping just after now."""
        if math.isinf(self.law.strength):
            return STICKS
        strength = arb(self.law.strength)
        for state, direction in DIRECTION.items():
            if not self.rigid and self.force * direction < strength:
                continue
            slip_rate = relative.plus(self.mobility * strength * direction) * -direction
            sign = slip_rate.without_noise().first_sign()
            if sign > 0 or (sign == 0 and self.pieces and self.pieces[-1].state == state):
                return state
        return STICKS

    def _piece(self, state: str, relative: ExponentialSum) -> JointPiece:
        """The functions of a state, of the relative velocity K that the arriving waves would have without a force."""
        nothing = ExponentialSum(relative.rates)
        if state == OPEN:
            return JointPiece(self.time, state, nothing, relative.integral(self.opening).without_noise(True))
        if state in (CLOSED, STICKS) and self.rigid:
            return JointPiece(self.time, state, relative * (-1 / self.mobility), nothing.plus(self.opening))
        if state == CLOSED:
            gap = relative.relaxed(self.stiffness * self.mobility, self.opening).without_noise(True)
            return JointPiece(self.time, state, gap * -self.stiffness, gap)
        if state == STICKS:
            force = (relative * -self.stiffness).relaxed(self.stiffness * self.mobility, self.force)
            return JointPiece(self.time, state, force, nothing.plus(self.opening))
        force = nothing.plus(arb(self.law.strength) * DIRECTION[state])
        slip_rate = (relative + force * self.mobility).without_noise()
        return JointPiece(self.time, state, force, slip_rate.integral(self.opening))

    def _watched(self, piece: JointPiece, relative: ExponentialSum) -> list[ExponentialSum]:
        """The functions, of the size of velocities or for a gap of lengths, of which one falls where the state ends."""
        if piece.state == OPEN:
            return [piece.opening]
        if piece.state == CLOSED:
            return [relative * -1 if self.rigid else piece.opening * -1]
        strength = arb(self.law.strength)
        if piece.state == STICKS:
            if math.isinf(self.law.strength):
                return []
            return [((piece.force * sign).plus(strength) * self.mobility).without_noise() for sign in (-1, 1)]
        direction = DIRECTION[piece.state]
        return [(relative.plus(self.mobility * strength * direction) * -direction).without_noise()]


def start_of(piece: JointPiece | WavePiece) -> arb:
    """Beginning of a piece, without a radius."""
    return piece.start.mid()


def earliest(arrivals: Sequence[Arrival], end: arb) -> arb:
    """The first instant at which an arrival changes or is not known, `end` at most."""
    time = end
    for arrival in arrivals:
        until = arrival.until()
        if until.mid() < time.mid():
            time = until
    return time


def driven(rates: Rates, drive: Drive, factor: arb, fall: arb = ZERO) -> Arrival:
    """A drive times a factor as a wave; with half the acceleration of gravity, plus that times t."""
    pieces = []
    for time, part in drive().parts():
        start = arb(time)
        velocity = (function_of(part, start, rates) * factor).plus(fall * start, fall)
        pieces.append(WavePiece(start, velocity, velocity.integral(ZERO)))
    return Arrival(Wave(pieces, arb("inf")), ZERO)


def nodes_of(problem: BarsProblem, end: float, work: Work) -> tuple[list[Node | Joint], list[Wave], list[Wave]]:
    """Nodes from the base upwards, and the waves that leave foot and top of each bar."""
    rates = problem.rates(end, work)
    bars = problem.bars
    up: list[Wave] = []
    down: list[Wave] = []
    for bar in bars:
        start = ExponentialSum.polynomial(rates, [arb(bar.velocity) / 2])
        for waves in (up, down):
            waves.append(Wave([WavePiece(-bar.travel.mid(), start, start.integral(ZERO))], ZERO))
    nodes: list[Node | Joint] = []
    for j, (bar, law) in enumerate(zip(bars, problem.joints, strict=True)):
        above = Arrival(down[j], bar.travel.mid())
        if law is None:
            nodes.append(Node((above,), up[j], ZERO))
            continue
        if j:
            below = Arrival(up[j - 1], bars[j - 1].travel.mid())
        else:
            half_space = math.isfinite(problem.base_impedance)
            below = driven(rates, problem.base, arb(1 if half_space else 0.5), problem.fall / 2)
        admittance = 1 / bar.impedance
        lower = down[j - 1] if j else None
        static = problem.static_force(j)
        opening = ZERO
        if law.law == "unilateral" and not problem.settled:
            opening = arb(law.gap)
        elif law.law == "unilateral" and math.isfinite(law.stiffness):
            opening = -static / arb(law.stiffness)
        across = problem.mobility(j) - admittance
        nodes.append(Joint(j, law, above, below, up[j], lower, admittance, across, static, opening, static))
    pressure = driven(rates, problem.top, arb(1))
    nodes.append(Node((Arrival(up[-1], bars[-1].travel.mid()), pressure), down[-1], -1 / bars[-1].impedance))
    return nodes, up, down
