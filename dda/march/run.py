"""A history of any body on its contacts: room for it, the loop over its steps, and how it ended."""

from __future__ import annotations

from typing import Any, NamedTuple

from dda.march.compiled import Loop, run_loop
from dda.march.methods import make_steps
from dda.march.step import AnyState, Course, History, March, history_of, reached_history


class Ran(NamedTuple):
    """A history that was made."""

    history: History
    outcome: int  # how it ended, among `dda.contact.rows.OUTCOMES`
    lengths: int  # how many lengths of a stage were set up
    how: str  # "compiled" or "plain Python"


def run(
    march: March,
    start: AnyState,
    course: Course,
    steps: int,
    loop: Loop = make_steps,
    kept: int | None = None,
    energies: bool = False,
    cut: float = 0.3,
) -> Ran:
    """Make the steps of a body from a state on.

    Parameters
    ----------
    march
        Body, laws and scheme, as `dda.march.step.march_of` returns them.
    start
        The state at t = 0.
    course
        What is prescribed.
    loop
        What makes the steps, as `dda.march.step.steps_by` returns it.
    kept
        Numbers that it keeps of a state beside the rows of contact; those of the modes and their velocities by default.
    energies
        Keep what the energies are made of.
    cut
        Length of a cut step over that of the failed one.
    """
    rows = len(start.path)
    contacts = rows // 2 if march.laws.contacts < len(march.room.free) else rows
    history = history_of(steps, 2 * len(march.body.k) if kept is None else kept, contacts, rows, energies)
    records: tuple[Any, ...] = march, start, start
    (reached, outcome), left, how = run_loop(loop, records, (course,), (history, steps, cut), steps)
    return Ran(reached_history(history, reached), outcome, int(left[0].lengths[0]), how)
