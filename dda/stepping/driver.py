"""The one loop over steps: what has no single answer is cut, what was spent is counted, what was reached is kept.

A step whose contacts have no single state is repeated, shorter, from the state in which it began; the rest of the
interval follows, so that every interval ends at its own time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.kernel import FAILURES, FOUND, zeros
from dda.model.load import BaseMotion

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

SHORTEST = 0.01  # shortest step that a cut may leave, over the scheme's step
OVERFLOW = 3  # outcome besides those of the contacts
COMPLETED = "completed"
OUTCOMES = {FOUND: COMPLETED, OVERFLOW: "overflow", **FAILURES}
LOSSES = 5  # by the algorithm, by gg, by switching, by friction, and what the base's motion gives [J]


class Counts(NamedTuple):
    """What is kept of every step, whatever makes it; losses are sums from t = 0 on."""

    solves: Integers  # (steps,) of the open-close iteration, the confirming one, repeated and cut steps included
    cuts: Integers  # (steps,) times that the step was cut
    losses: Array  # (steps, LOSSES) [J]; (0, LOSSES) if they are not asked for


def counts_of(steps: int, energies: bool) -> Counts:
    """Return room for what is kept of so many steps."""
    solves, cuts = zeros(steps, steps, dtype=np.int64)
    return Counts(solves, cuts, np.zeros((steps if energies else 0, LOSSES)))


def reached_rows(history: tuple[Any, ...], reached: int) -> list[Any]:
    """Return the arrays of a history without the steps that were not reached."""
    return [part[:reached] for part in history]


class BaseRecord(NamedTuple):
    """Displacement of the base, linear between the instants of a record and constant beyond them."""

    instants: Any  # (n,) [s]
    displacement: Any  # (n, 2) in x and y of the block's coordinates [m]


def base_record(motion: BaseMotion | None) -> BaseRecord:
    """Return the record of a base that moves, or of one at rest."""
    own = motion or BaseMotion([0.0], [[0.0, 0.0]])
    return BaseRecord(np.array(own.time, dtype=float), np.array(own.displacement, dtype=float, order="C"))


def base_at(base: BaseRecord, axis: int, time: float) -> float:
    """Return the displacement of the base at a time [m]."""
    instants = base.instants
    moved = base.displacement
    last = len(instants) - 1
    if time <= instants[0]:
        return moved[0][axis]  # type: ignore[no-any-return]
    if time >= instants[last]:
        return moved[last][axis]  # type: ignore[no-any-return]
    low = 0
    high = last
    while high - low > 1:
        middle = (low + high) // 2
        if instants[middle] <= time:
            low = middle
        else:
            high = middle
    slope = (moved[high][axis] - moved[low][axis]) / (instants[high] - instants[low])
    return slope * (time - instants[low]) + moved[low][axis]  # type: ignore[no-any-return]


def driver(
    advance: Callable[..., tuple[int, int]],
    account: Callable[..., None],
    keep: Callable[..., bool],
) -> Callable[..., tuple[int, int]]:
    """Return the loop over the steps of a body.

    Parameters
    ----------
    advance
        Makes a step, or a part of one: (body, state, after, base, begun, ratio) -> outcome and solves, with where it
        begins and how long it is, in steps. It writes `after` and leaves `state` as it is.
    account
        Adds what an accepted part of step `number` slips and loses: (body, state, after, base, begun, ratio,
        history, counts, number).
    keep
        Writes the state at the end of step `number` into the history, and tells whether it is finite.
    """

    def make_steps(
        body: Any, state: Any, after: Any, base: Any, history: Any, counts: Any, steps: int, cut: float
    ) -> tuple[int, int]:
        """Make the steps that are reached; return how many, and how it ended."""
        for number in range(steps):
            left = 1.0
            ratio = 1.0
            solves = 0
            cuts = 0
            if len(counts.losses) > 0 and number > 0:
                for k in range(LOSSES):
                    counts.losses[number, k] = counts.losses[number - 1, k]
            while True:
                outcome, spent = advance(body, state, after, base, number + (1.0 - left), ratio)
                solves += spent
                if outcome != FOUND:
                    if ratio <= SHORTEST:
                        return number, outcome
                    ratio = max(cut * ratio, SHORTEST)
                    cuts += 1
                    continue
                account(body, state, after, base, number + (1.0 - left), ratio, history, counts, number)
                state, after = after, state
                if ratio == left:
                    break
                left -= ratio
                ratio = left
            if not keep(body, state, history, number):
                return number, OVERFLOW
            counts.solves[number] = solves
            counts.cuts[number] = cuts
        return steps, FOUND

    return make_steps
