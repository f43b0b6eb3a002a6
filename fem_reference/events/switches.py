"""What event-driven motions report of their contacts: switches, and the ways in which a motion cannot go on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Switch:
    """A change of one contact, its instant enclosed: it lies within `radius` of `midpoint`."""

    time: float  # the midpoint as a float [s]
    corner: str  # ``"M"`` at (0, 0) or ``"N"`` at (a, 0) of a block, ``"base"`` or the joint of bars and columns
    kind: str  # ``"opens"``, ``"closes"``, and with friction ``"sticks"`` or ``"slips"``
    midpoint: str = field(default="", compare=False)  # decimal digits of the midpoint [s]
    radius: float = field(default=0.0, compare=False)  # proven distance of the instant from the midpoint, at most [s]
    joint: int = 0  # number of the block above a joint of a column, of a corner of a block
    sign: int = 0  # of the rate of slip where it slips, else 0


@dataclass(frozen=True)
class Impact:
    """An impact of a block on a rigid contact, at the instant of the switches that go with it."""

    time: float  # [s]
    approach: float  # speed at which the gap closed [m/s]; it opens at e times this
    impulse: float  # of both corners together, upwards [N s]


@dataclass(frozen=True)
class Cascade:
    """Infinitely many impacts that are proven to accumulate at an instant, after which the contact rests."""

    start: float  # the last impact that is listed one by one; it is of all after it that accumulation is proven [s]
    time: float  # the instant of accumulation, the midpoint as a float [s]
    impulse: float  # of both corners together, of all impacts after `start`, upwards [N s]
    radius: float  # proven distance of the instant from the midpoint, at most [s]


class NoContactStateError(ArithmeticError):
    """No choice of open and closed contacts agrees with the motion that follows from it."""


class HorizonError(ArithmeticError):
    """The motion is known up to an instant only, its horizon."""

    def __init__(self, time: float, reason: str) -> None:
        super().__init__(f"exact up to {time:.6g} s only: {reason}")
        self.time = time  # the horizon [s]


class TooManySwitchesError(HorizonError):
    """The contacts switch more often than was allowed."""


class TooMuchWorkError(HorizonError):
    """The motion takes more work than was allowed."""


@dataclass
class Work:
    """What the search of a motion has cost, counted in terms of series, so that its bound is no processor's."""

    limit: float = math.inf  # terms
    report: Callable[[float], None] | None = None  # takes the instant that has been reached [s]
    part: float = 1.0  # of the limit that the present computation may reach, so that one after it has as much
    terms: float = 0.0  # so far, those of computations in fewer digits included
    reached: float = 0.0  # instant [s]

    def reach(self, time: float) -> None:
        """Take note of the instant that the motion has reached [s]."""
        self.reached = time
        if self.report is not None:
            self.report(time)

    def add(self, terms: float) -> None:
        """Count further terms; raises `TooMuchWorkError` if they are more than the limit in all."""
        self.terms += terms
        most = self.limit * self.part
        if self.terms > most:
            raise TooMuchWorkError(self.reached, f"its series have more than {most:.3g} terms")


class AccumulationError(HorizonError):
    """Impacts follow each other ever faster, and whether they accumulate is not proven."""


class LostDigitsError(HorizonError):
    """The switches have amplified the enclosure of the motion until nothing can be decided."""
