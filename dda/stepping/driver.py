"""The one loop over steps: what has no single answer is cut, what was spent is counted, what was reached is kept.

A step whose contacts have no single state is repeated, shorter, from the state in which it began; the rest of the
interval follows, so that every interval ends at its own time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.dense import Vector, zeros
from dda.contact.kernel import FAILURES, FOUND, NONE, UNREACHED, Contacts, Shear
from dda.model.arrays import Array
from dda.model.load import BaseMotion
from dda.stepping.energy import SUMS

Integers = NDArray[np.int64]

SHORTEST = 0.01  # shortest step that a cut may leave, over the scheme's step
OVERFLOW = 3  # outcome besides those of the contacts
COMPLETED = "completed"
OUTCOMES = {FOUND: COMPLETED, OVERFLOW: "overflow", **FAILURES}


class History(NamedTuple):
    """What is kept of every step, whatever makes it; row 0 is the state at t = 0, from which the sums go on."""

    motion: Array  # (steps + 1, m) what the body keeps of itself
    normal: Array  # (steps + 1, contacts)
    shear: Array
    gap: Array
    slipped: Array  # summed over the parts of a step
    state: NDArray[np.int8]
    solves: Integers  # (steps + 1,) of the open-close iteration, the confirming one, repeated and cut steps included
    cuts: Integers  # (steps + 1,) times that the step was cut
    sums: Array  # (steps + 1, SUMS) of `dda.stepping.energy`; (0, SUMS) if the energies are not asked for


def history_of(steps: int, motion: int, contacts: int, energies: bool) -> History:
    """Return room for so many steps, of bodies with so many numbers and contacts of their own."""
    rows = zeros((steps + 1, motion), *[(steps + 1, contacts)] * 4)
    rows.append(np.zeros((steps + 1, contacts), dtype=np.int8))
    rows += zeros(steps + 1, steps + 1, dtype=np.int64)
    rows.append(np.zeros((steps + 1 if energies else 0, SUMS)))
    return History(*rows)


def reached_history(history: History, reached: int) -> History:
    """Return the history without the steps that were not reached."""
    rows: list[Any] = [part[: reached + 1] for part in history]
    return History(*rows)


class Part(NamedTuple):
    """A whole step, or a part of one."""

    begun: float  # where it begins, in steps from t = 0
    ratio: float  # how long it is, in steps


class BaseRecord(NamedTuple):
    """Displacement of the base, linear between the instants of a record and constant beyond them."""

    instants: Any  # (n,) [s]
    displacement: Any  # (n, 2) along and away from itself [m]
    latest: Any  # (1,) number of the instant before the time that was looked up last


def base_record(motion: BaseMotion | None) -> BaseRecord | None:
    """Return the record of a base that moves, None of one at rest."""
    if motion is None:
        return None
    displacement = np.array(motion.displacement, dtype=float, order="C")
    return BaseRecord(np.array(motion.time, dtype=float), displacement, np.zeros(1, dtype=np.int64))


def base_displacement(base: BaseRecord, step: float, part: Part, start: Vector, out: Vector) -> None:
    """Write how far the base moves in a part of a step [m], where a whole one takes `step` [s].

    Parameters
    ----------
    start
        Where its displacement at the beginning is written [m].
    """
    base_at(base, part.begun * step, start)
    base_at(base, (part.begun + part.ratio) * step, out)
    for axis in range(2):
        out[axis] -= start[axis]


def base_at(base: BaseRecord, time: float, out: Vector) -> None:
    """Write the displacement of the base at a time [m]."""
    instants = base.instants
    last = len(instants) - 1
    low = base.latest[0]  # times follow each other: the instants before and after are near those of the last look-up
    while low > 0 and instants[low] > time:
        low -= 1
    while low < last and instants[low + 1] <= time:
        low += 1
    base.latest[0] = low
    for axis in range(2):
        out[axis] = base.displacement[low][axis]
        if instants[low] < time and low < last:
            rise = base.displacement[low + 1][axis] - out[axis]
            slope = rise / (instants[low + 1] - instants[low])
            out[axis] = slope * (time - instants[low]) + out[axis]


def staged(make_stage: Callable[..., tuple[int, int]]) -> Callable[..., tuple[int, int]]:
    """Return what makes a part of a step, stage by stage, as `driver` takes it.

    Parameters
    ----------
    make_stage
        Makes a stage from `before`, the end of the stage before, to `after`, where the step began at `state`:
        (body, shear_law, stage, state, before, after, base, part) -> outcome and number of solves. The body has
        `stages`, one or two of them, `first` and `last`, and `between`, room for the end of the first one.
    """

    def advance(
        body: Any, shear_law: Shear, state: Any, after: Any, base: BaseRecord | None, part: Part
    ) -> tuple[int, int]:
        """Make a part of a step from `state` to `after`; return the outcome and the number of solves."""
        if body.lag != 0 and part.ratio != 1.0:  # the velocity of half a step before goes on in equal steps only
            return NONE, 0
        total = 0
        before = state
        for number in range(1, body.stages + 1):
            stage = body.last if number == body.stages else body.first
            target = after if number == body.stages else body.between
            outcome, solves = make_stage(body, shear_law, stage, state, before, target, base, part)
            total += solves
            if outcome != FOUND:
                return outcome, total
            before = target
        if body.stages == 2:
            for i in range(len(after.contacts.slipped)):
                after.contacts.slipped[i] += body.between.contacts.slipped[i]
        return FOUND, total

    return advance


def driver(
    advance: Callable[..., tuple[int, int]], account: Callable[..., None], keep: Callable[..., bool]
) -> Callable[..., tuple[int, int]]:
    """Return the loop over the steps of a body.

    Parameters
    ----------
    advance
        Makes a part of a step from `state` to `after`: (body, shear_law, state, after, base, part) -> outcome and
        number of solves. It writes `after` and leaves `state` as it is.
    account
        Adds what the part of a step that was made last loses to the sums: (body, shear_law, state, after, part, sums).
    keep
        Writes the state at the end of a step into a row, (body, state, rows, number), and tells whether it is finite.
    """

    def make_steps(
        body: Any,
        shear_law: Shear,
        state: Any,
        after: Any,
        base: BaseRecord | None,
        history: History,
        steps: int,
        cut: float,
    ) -> tuple[int, int]:
        """Make the steps that are reached; return how many, and how it ended."""
        keep(body, state, history.motion, 0)
        keep_contacts(state.contacts, history, 0)
        for number in range(steps):
            remainder = 1.0
            ratio = 1.0
            row = number + 1
            if len(history.sums) > 0:
                for k in range(SUMS):
                    history.sums[row, k] = history.sums[number, k]
            while True:
                part = Part(number + (1.0 - remainder), ratio)
                outcome, solves = advance(body, shear_law, state, after, base, part)
                history.solves[row] += solves
                if outcome != FOUND:
                    if ratio <= SHORTEST or outcome == UNREACHED:
                        return number, outcome
                    ratio = max(cut * ratio, SHORTEST)
                    history.cuts[row] += 1
                    continue
                if len(history.sums) > 0:
                    account(body, shear_law, state, after, part, history.sums[row])
                for i in range(len(after.contacts.gap)):
                    history.slipped[row, i] += after.contacts.slipped[i]
                state, after = after, state
                if ratio == remainder:
                    break
                remainder -= ratio
                ratio = remainder
            if not keep(body, state, history.motion, row):
                return number, OVERFLOW
            keep_contacts(state.contacts, history, row)
        return steps, FOUND

    return make_steps


def keep_contacts(contacts: Contacts, history: History, number: int) -> None:
    """Write the contacts at the end of a step."""
    for i in range(len(contacts.gap)):
        history.normal[number, i] = contacts.normal[i]
        history.shear[number, i] = contacts.shear[i]
        history.gap[number, i] = contacts.gap[i]
        history.state[number, i] = contacts.state[i]
