"""What event-driven motions report of their contacts: switches, and the ways in which a motion cannot go on."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Switch:
    """A change of one contact."""

    time: float  # instant [s]
    corner: str  # ``"M"`` at (0, 0) or ``"N"`` at (a, 0) of a block, ``"base"`` of a bar
    kind: str  # ``"opens"``, ``"closes"``, and with friction ``"sticks"`` or ``"slips"``


class NoContactStateError(ArithmeticError):
    """No choice of open and closed contacts agrees with the motion that follows from it."""


class TooManySwitchesError(ArithmeticError):
    """The contacts switch more often than was allowed."""
