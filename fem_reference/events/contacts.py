"""The laws of contacts that open, close, stick and slip, between two switches, for blocks and columns alike.

A contact has a row w, its gap, or a row s, its slide, or both: displacements over the unknowns (`Rows`). With the
springs p and p_s, the dashpot c and the reference r it acts with

    N = -p w - c w'        on what is above, away from the other face, while it is closed, else 0
    T = -p_s (s - r)       while it sticks,        T = -+(tan(phi) N + C)        while it slips towards +-.

One that slips takes its reference along, r = s + T / p_s. A released one has let go of its dashpot before its gap has
come back to zero, and carries as little as an open one.

As long as a contact keeps its state, some functions stay positive (`watches`); which one falls says what follows. Each
is made of rows and of their rates alone, so that its power series follows from theirs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from flint import arb, arb_mat

from fem_reference.events.enclosure import ZERO

# States of a contact: `STICKS` is closed too where nothing slides; `RIGHT` and `LEFT` slip towards + and -.
OPEN = 0
STICKS = 1
RIGHT = 2
LEFT = -2
RELEASED = 3
# Sides of watched functions: the gap, the force on a dashpot; those of slip have the sign of its direction.
CARRIES_NOTHING = (OPEN, RELEASED)
NORMAL = 0
FORCE = 3
States = tuple[int, ...]


def direction(state: int) -> int:
    """The direction of slip of a contact, 0 where it does not slip."""
    return {RIGHT: 1, LEFT: -1}.get(state, 0)


class Contact(NamedTuple):
    """A contact, and its numbers in the unit of the forces of its model."""

    number: int  # of its joint or corner
    name: str  # the same in words
    gap: int | None = None  # number of the row w; None: it never opens
    slide: int | None = None  # number of the row s; None: nothing slides
    stiffness: arb = ZERO  # p
    damping: arb = ZERO  # c of the dashpot beside it
    shear_stiffness: arb = ZERO  # p_s
    friction: arb = ZERO  # tan(phi)
    cohesion: arb | None = None  # C; None: it never slips
    force: int | None = None  # number of the row of N of both corners of a rigid contact, which has no springs

    @property
    def row(self) -> int:
        """Number of the row s, of w where nothing slides."""
        return (self.gap or 0) if self.slide is None else self.slide

    def reference(self, state: int, rows: Sequence[Any]) -> Any:
        """The r = s + T / p_s that one takes along that does not stick, from all rows, numbers or series."""
        slide = rows[self.slide or 0]
        if not direction(state) or self.cohesion is None:
            return slide
        limit = self.cohesion
        if self.gap is not None:
            limit -= rows[self.gap] * (self.friction * self.stiffness)
        return slide - limit * (direction(state) / self.shear_stiffness)


class Laws(NamedTuple):
    """The forces along all rows y while the contacts keep their states, rows y + rates y' + references r + constant."""

    rows: arb_mat  # shape (rows, rows)
    rates: arb_mat  # the same
    references: arb_mat  # shape (rows, contacts)
    constant: arb_mat  # shape (rows, 1)


def laws(contacts: Sequence[Contact], states: Sequence[int], count: int) -> Laws:
    """The forces along so many rows."""
    of = Laws(arb_mat(count, count), arb_mat(count, count), arb_mat(count, len(contacts)), arb_mat(count, 1))
    for c, (contact, state) in enumerate(zip(contacts, states, strict=True)):
        if state in CARRIES_NOTHING:
            continue
        gap = contact.gap
        slide = contact.slide
        side = direction(state)
        if gap is not None and contact.force is not None:
            of.rows[gap, contact.force] = arb(1) / 2
        elif gap is not None:
            of.rows[gap, gap] = -contact.stiffness
            of.rates[gap, gap] = -contact.damping
        if slide is None:
            continue
        if not side:
            of.rows[slide, slide] = -contact.shear_stiffness
            of.references[slide, c] = contact.shear_stiffness
        elif contact.cohesion is not None:
            of.constant[slide, 0] = -side * contact.cohesion
            if gap is not None:
                of.rows[slide, gap] = side * contact.friction * contact.stiffness
    return of


class Part(NamedTuple):
    """What a row adds to a watched function."""

    row: int
    factor: arb  # of its displacement, or of its rate in a function of rates
    dashpot: arb | None = None  # of its rate, beside its displacement


class Watch(NamedTuple):
    """A function that is positive, or zero for ever, as long as a contact keeps its state."""

    contact: int
    side: int  # `NORMAL`, `FORCE`, or the direction of the slip that begins or ends where it falls
    parts: tuple[Part, ...]
    becomes: int  # state of the contact after its fall
    offset: arb = ZERO  # added to the parts
    pull: arb = ZERO  # of the reference in the offset
    rates: bool = False  # whether its parts are rates
    order: int = 0  # derivatives of the displacements at its start
    lead: int | None = 0  # terms of its power series that are zero at the start; None: all are


def watches(contacts: Sequence[Contact], states: Sequence[int], references: Sequence[arb]) -> Iterator[Watch]:
    """Yield the functions that are positive as long as the contacts keep their states."""
    for c, (contact, state, reference) in enumerate(zip(contacts, states, references, strict=True)):
        gap = contact.gap
        slide = contact.slide
        damped = contact.damping != 0
        if gap is not None and state == OPEN:
            yield Watch(c, NORMAL, (Part(gap, arb(1)),), STICKS)
        elif gap is not None:
            if state == RELEASED or not damped:
                yield Watch(c, NORMAL, (Part(gap, arb(-1)),), OPEN)
            if damped:
                side, becomes = (1, STICKS) if state == RELEASED else (-1, RELEASED)
                force = Part(gap, contact.stiffness * side, contact.damping * side)
                yield Watch(c, FORCE, (force,), becomes, order=1)
        if slide is None or contact.cohesion is None or state in CARRIES_NOTHING:
            continue
        limit = [] if gap is None else [Part(gap, -contact.friction * contact.stiffness)]
        if state == STICKS:  # the shear force that it has left
            for side, becomes in ((1, RIGHT), (-1, LEFT)):
                pull = contact.shear_stiffness * side
                offset = contact.cohesion + pull * reference
                yield Watch(c, side, (*limit, Part(slide, -pull)), becomes, offset, pull)
        else:  # the rate at which it moves its reference r = s + T / p_s in the direction of the slip
            side = direction(state)
            rates = [Part(row, -factor) for row, factor, _ in limit]
            yield Watch(c, side, (*rates, Part(slide, contact.shear_stiffness * side)), STICKS, rates=True, order=1)
