"""Steps that are cut: what has no single answer is repeated, shorter, and the rest of its interval follows.

A shorter step begins from the state in which the failed one began, and every interval ends at its own time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, NamedTuple, Protocol, TypeVar

FLOOR = 0.01  # shortest step that a cut may leave, over the scheme's step

S = TypeVar("S")
L = TypeVar("L")


class Solved(Protocol):
    """What an attempt at a step took, and why there is no answer, in words."""

    @property
    def solves(self) -> int:
        """Small systems that were solved."""

    @property
    def failure(self) -> str | None:
        """Why there is no answer."""


class Interval(NamedTuple, Generic[S]):
    """One step of the scheme, whole or in parts."""

    parts: list[tuple[float, S, S]]  # length over the scheme's step, state before and after
    solves: int
    cuts: int
    failure: str | None = None  # of the shortest part, in words


def in_parts(
    attempt: Callable[[S, float, float], tuple[S | None, Solved]], state: S, cut: float, floor: float = FLOOR
) -> Interval[S]:
    """Make one step, in parts where it has to be cut.

    Parameters
    ----------
    attempt
        Makes a part from a state, given where in the step it begins and how long it is, in steps; None if it fails.
    state
        Where the step begins; it must stay as it is.
    cut, floor
        Length of a part over that of the one that failed, and the least length.
    """
    parts: list[tuple[float, S, S]] = []
    left = ratio = 1.0
    solves = cuts = 0
    while True:
        after, found = attempt(state, 1 - left, ratio)
        solves += found.solves
        if after is None:
            if ratio <= floor:
                return Interval(parts, solves, cuts, str(found.failure))
            ratio, cuts = max(cut * ratio, floor), cuts + 1
            continue
        parts.append((ratio, state, after))
        state = after
        if ratio == left:
            return Interval(parts, solves, cuts)
        left -= ratio
        ratio = left


class Lengths(Generic[L]):
    """What depends on a step's length alone, made once for each; that of the whole step is always kept."""

    def __init__(self, make: Callable[[float], L], most: int) -> None:
        self.make, self.most, self.made = make, most, 0
        self.kept: dict[float, L] = {}

    def __call__(self, ratio: float) -> L:
        """Return what belongs to a length, over the scheme's step."""
        if ratio not in self.kept:
            if len(self.kept) >= self.most:
                self.kept = {1.0: self.kept[1.0]}
            self.kept[ratio] = self.make(ratio)
            self.made += 1
        return self.kept[ratio]
