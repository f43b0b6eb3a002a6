"""The loop over the steps of a history on contacts: in pieces of many steps, and of a step that has no contact."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_reference.contact.iteration import CONVERGED, OVERFLOW
from fem_reference.contact.march import ContactState, Record, part_of
from fem_reference.contact.stepper import ContactStepper, Marched

OUTCOMES = ("completed", "no consistent contact state", "several consistent contact states", "overflow")
"""How a history ends, by the numbers of `fem_reference.contact.iteration`."""
PIECE = 4096
"""Steps whose rows are recorded at a time."""


@dataclass(frozen=True)
class Cut:
    """How a step that has no contact is cut."""

    factor: float  # on the piece that has none [-], between 0 and 1
    shortest: float  # piece over the step [-]


def histories(
    stepper: ContactStepper, state: ContactState, steps: int, cut: Cut | None, kept: Callable[[Record], dict[str, Any]]
) -> tuple[dict[str, Any], Marched]:
    """Make all steps; return what is kept of the records, joined, and how the last piece has ended."""
    pieces = [kept(stepper.record(0))]
    marched = Marched(state, 0, 0, CONVERGED)
    for record, marched in make_steps(stepper, state, steps, cut):  # noqa: B007
        pieces.append(kept(record))
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}, marched


def make_steps(
    stepper: ContactStepper, state: ContactState, steps: int, cut: Cut | None
) -> Iterator[tuple[Record, Marched]]:
    """Yield what was kept of the steps piece by piece, and how each piece has ended; the last may be cut short.

    A step without a contact is repeated as `cut` says; it ends the history if None.
    """
    completed = 0
    outcome = CONVERGED
    # A scheme beyond its limit grows until it overflows; the outcome says so.
    with np.errstate(all="ignore"):
        while completed < steps and outcome == CONVERGED:
            record = stepper.record(min(PIECE, steps - completed))
            marched = stepper.march(state, record)
            made = marched.steps
            if marched.outcome != CONVERGED and cut is not None:
                marched = cut_step(stepper, marched, cut, part_of(record, slice(made, made + 1)))
                made += marched.outcome == CONVERGED
            completed += made
            state = marched.state
            outcome = marched.outcome
            yield part_of(record, slice(made)), marched


def cut_step(stepper: ContactStepper, marched: Marched, cut: Cut, row: Record) -> Marched:
    """Make a step that has failed in one piece in shorter pieces, and fill its `row`.

    A piece without a contact is repeated shorter, as are those after it; where the shortest has none the state is that
    before it. The next step is tried in one piece again.
    """
    solves = marched.solves
    cuts = 0
    remainder = 1.0
    trial = 1.0
    while remainder > 0 and marched.outcome != OVERFLOW:
        if marched.outcome != CONVERGED:
            cuts += 1
            if trial <= cut.shortest:
                return marched
            trial = max(cut.factor * trial, cut.shortest)
        marched = stepper.march(marched.state, row, trial)
        solves += marched.solves
        if marched.outcome == CONVERGED:
            # What rounding leaves over is no piece.
            remainder = remainder - trial if remainder - trial > 1e-9 else 0.0
            trial = min(trial, remainder)
    row.solves[0] = solves
    row.cuts[0] = cuts
    return marched
