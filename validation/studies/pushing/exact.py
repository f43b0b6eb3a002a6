"""Two blocks that slide down a slope and push each other through one spring: their motion in closed pieces.

Down the slope, with N_i = m_i g cos b of block i, the compression y = s1 - s2 - gap of the spring k between them, and
F = k y while y > 0:

    m1 s1'' = m1 g sin b - sgn(s1') tan(phi1) N1 - F,      m2 s2'' = m2 g sin b - sgn(s2') tan(phi2) N2 + F

A block at rest stays while what pulls it does not exceed tan(phi_i) N_i. Between two events (the spring closes or
opens, a block stops or starts) every piece is a parabola, or a sine about one: y'' = c - k y (1/m1 + 1/m2), the sum
over the blocks that move. Events are found on the closed pieces. Blocks and slope are rigid, friction has no springs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from scipy.optimize import brentq

SAMPLES = 64  # of a piece's span, between which an event is looked for: a quarter of a period has 16 at least
LONGEST = 0.05  # s, of a span without an oscillation


@dataclass(frozen=True)
class Pushing:
    """Two blocks on a slope, the upper one first."""

    masses: tuple[float, float]  # kg
    friction: tuple[float, float]  # tan(phi) on the slope
    slope: float  # b [rad]
    stiffness: float  # of the spring between them [N/m]
    gap: float  # m, at t = 0
    speeds: tuple[float, float] = (0.0, 0.0)  # at t = 0, down the slope [m/s]
    gravity: float = 9.81

    @property
    def drive(self) -> tuple[float, float]:
        """Weight along the slope [N]."""
        first, second = (m * self.gravity * math.sin(self.slope) for m in self.masses)
        return first, second

    @property
    def resistance(self) -> tuple[float, float]:
        """Friction of a block that slides [N]."""
        cosine = math.cos(self.slope)
        first, second = (mu * m * self.gravity * cosine for mu, m in zip(self.friction, self.masses, strict=True))
        return first, second


@dataclass(frozen=True)
class Moment:
    """The state at the start of a piece."""

    time: float  # s
    ways: tuple[float, float]  # s1, s2 [m]
    speeds: tuple[float, float]  # m/s
    signs: tuple[int, int]  # of the slides; 0: at rest
    closed: bool


State = Callable[[float], tuple[float, float, float, float]]  # s1, s2 [m], s1', s2' [m/s], at a time after a moment


@dataclass(frozen=True)
class Piece:
    """A part of the motion between two events."""

    start: Moment
    duration: float  # s
    state: State
    event: str  # that ends it: "opens", "closes", "upper stops", "lower starts" ...; "" where none does


def pieces(problem: Pushing, until: float) -> Iterator[Piece]:
    """Yield the pieces of a motion up to a time [s]."""
    moment = Moment(0.0, (0.0, 0.0), problem.speeds, (0, 0), problem.gap <= 0)
    moment = replace(moment, signs=(_sign(problem, moment, 0), _sign(problem, moment, 1)))
    while moment.time < until:
        state, span = _closed_form(problem, moment)
        elapsed, event = _first_event(problem, moment, state, min(span, until - moment.time))
        yield Piece(moment, elapsed, state, event)
        s1, s2, v1, v2 = state(elapsed)
        moment = replace(moment, time=moment.time + elapsed, ways=(s1, s2), speeds=(v1, v2))
        moment = _after(problem, moment, event)


def at(problem: Pushing, time: float) -> tuple[float, float, float, float]:
    """Return s1, s2 [m] and s1', s2' [m/s] at a time."""
    *_, last = pieces(problem, time)
    return last.state(last.duration)


def events(problem: Pushing, until: float) -> list[tuple[float, str]]:
    """Return instants [s] and names of the events up to a time."""
    return [(piece.start.time + piece.duration, piece.event) for piece in pieces(problem, until) if piece.event]


def _force(problem: Pushing, moment: Moment) -> float:
    """Force of the spring [N]."""
    compression = moment.ways[0] - moment.ways[1] - problem.gap
    return problem.stiffness * max(0.0, compression) if moment.closed else 0.0


def _sign(problem: Pushing, moment: Moment, block: int) -> int:
    """Direction in which a block slides, or begins to; 0 where it rests."""
    speed = moment.speeds[block]
    if speed:
        return 1 if speed > 0 else -1
    pull = problem.drive[block] + (2 * block - 1) * _force(problem, moment)
    if abs(pull) <= problem.resistance[block]:
        return 0
    return 1 if pull > 0 else -1


def _closed_form(problem: Pushing, moment: Moment) -> tuple[State, float]:
    """Return the motion from a moment until an event, and the span in which to look for one [s]."""
    free = [
        (problem.drive[i] - moment.signs[i] * problem.resistance[i]) / problem.masses[i] if moment.signs[i] else 0.0
        for i in (0, 1)
    ]
    inverse = [1 / problem.masses[i] if moment.signs[i] else 0.0 for i in (0, 1)]
    (s1, s2), (v1, v2) = moment.ways, moment.speeds
    y0, rate, c, compliance = s1 - s2 - problem.gap, v1 - v2, free[0] - free[1], sum(inverse)

    def state(t: float) -> tuple[float, float, float, float]:
        impulse = way = 0.0  # of the spring's force, integrated once [N s] and twice [N s2]
        if moment.closed and compliance:
            frequency = math.sqrt(problem.stiffness * compliance)
            middle = c / frequency**2
            cosine, sine = math.cos(frequency * t), math.sin(frequency * t)
            y = middle + (y0 - middle) * cosine + rate / frequency * sine
            velocity = (middle - y0) * frequency * sine + rate * cosine
            impulse = (rate + c * t - velocity) / compliance
            way = (y0 + rate * t + c * t**2 / 2 - y) / compliance
        return (
            s1 + v1 * t + free[0] * t**2 / 2 - inverse[0] * way,
            s2 + v2 * t + free[1] * t**2 / 2 + inverse[1] * way,
            v1 + free[0] * t - inverse[0] * impulse,
            v2 + free[1] * t + inverse[1] * impulse,
        )

    quarter = math.pi / 2 / math.sqrt(problem.stiffness * compliance) if moment.closed and compliance else LONGEST
    return state, quarter


def _conditions(problem: Pushing, moment: Moment) -> Iterator[tuple[str, Callable[[tuple[float, ...]], float]]]:
    """Yield what ends a piece, each with a function of the state that is positive until then."""
    side = 1 if moment.closed else -1
    yield "opens" if moment.closed else "closes", lambda z: side * (z[0] - z[1] - problem.gap)
    for block, name in enumerate(("upper", "lower")):
        sign = moment.signs[block]
        if sign:
            yield f"{name} stops", lambda z, block=block, sign=sign: sign * z[2 + block]  # type: ignore[misc]
        elif moment.closed:
            push = problem.stiffness * (2 * block - 1)
            drive, most = problem.drive[block], problem.resistance[block]
            yield (
                f"{name} starts",
                lambda z, push=push, drive=drive, most=most: most - abs(drive + push * (z[0] - z[1] - problem.gap)),  # type: ignore[misc]
            )


def _first_event(problem: Pushing, moment: Moment, state: State, span: float) -> tuple[float, str]:
    """Return when the first event ends a piece [s], and its name; the span and nothing without one."""
    first = span, ""
    for name, condition in _conditions(problem, moment):
        instant = _first_zero(lambda t, condition=condition: condition(state(t)), span)  # type: ignore[misc]
        if instant is not None:
            first = min(first, (instant, name))
    return first


def _first_zero(function: Callable[[float], float], span: float) -> float | None:
    """Return where a function that begins positive, or at zero upwards, becomes negative, or None."""
    before = 0.0
    for k in range(1, SAMPLES + 1):
        t = span * k / SAMPLES
        if function(t) < 0:
            return brentq(function, before, t, xtol=1e-16, rtol=1e-14) if function(before) > 0 else before
        before = t
    return None


def _after(problem: Pushing, moment: Moment, event: str) -> Moment:
    """Return the moment after an event, what has become zero being zero."""
    if event in ("opens", "closes"):
        return replace(moment, closed=event == "closes")
    if not event:
        return moment
    block = 0 if event.startswith("upper") else 1
    speeds = tuple(0.0 if i == block else speed for i, speed in enumerate(moment.speeds))
    rested = replace(moment, speeds=(speeds[0], speeds[1]))
    signs = [*moment.signs]
    signs[block] = _sign(problem, rested, block)
    if event.endswith("starts") and not signs[block]:  # at the very limit, to rounding
        signs[block] = 1 if problem.drive[block] + (2 * block - 1) * _force(problem, rested) > 0 else -1
    return replace(rested, signs=(signs[0], signs[1]))
