"""What event-driven motions report of their contacts: switches, and the ways in which a motion cannot go on."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Switch:
    """A change of one contact, its instant enclosed: it lies within `radius` of `midpoint`."""

    time: float  # the midpoint as a float [s]
    corner: str  # ``"M"`` at (0, 0) or ``"N"`` at (a, 0) of a block, ``"base"`` of a bar
    kind: str  # ``"opens"``, ``"closes"``, and with friction ``"sticks"`` or ``"slips"``
    midpoint: str = field(default="", compare=False)  # decimal digits of the midpoint [s]
    radius: float = field(default=0.0, compare=False)  # proven distance of the instant from the midpoint, at most [s]


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
    """The motion takes more steps or pieces than was allowed."""


class LostDigitsError(HorizonError):
    """The switches have amplified the enclosure of the motion until nothing can be decided."""
