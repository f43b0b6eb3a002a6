"""Why a history in the plane ends early: the contacts whose states come and go, or the corner that is too deep."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dda.contact.rows import FOUND, NONE, OUTCOMES, TOO_DEEP, rows_of, solve, update
from dda.march.step import History, March
from dda.plane.many import solve_states, update_all
from dda.plane.model import PlaneModel
from dda.plane.taken import laws_for

LONGEST = 1000  # solves in which a search that goes round is to come back to states that it had
NAMED = 6  # contacts that a sentence has


class PlaneContact(NamedTuple):
    """A corner of a block and the edge of another that it may touch, by numbers; -1, -1 of an end of glue."""

    block: int
    corner: int
    on: int
    edge: int


def unsettled_contacts(
    model: PlaneModel, march: March, history: History, reached: int, outcome: int
) -> tuple[PlaneContact, ...]:
    """Return the contacts that ended a history, by the march as the failed step left it, and the cuts of that step."""
    found = march.method.detection.contacts
    if outcome == TOO_DEEP:
        return (found_contact(march, found.corner[0], found.edge[0]),)
    if outcome != NONE:
        return ()
    is_cut = history.cuts[reached + 1] > 0
    present = stated_contacts(model)
    present += [found_contact(march, *pair) for pair in zip(found.corner, found.edge, strict=True)]
    return tuple(present[k] for k in flipping_contacts(march, is_cut))


def stated_contacts(model: PlaneModel) -> list[PlaneContact]:
    """Return the contacts that are stated, then both ends of every bond."""
    stated = [PlaneContact(part.block, part.corner, part.on, part.edge) for part in model.contacts]
    return stated + [PlaneContact(bond.first, -1, bond.second, -1) for bond in model.bonds for _ in range(2)]


def found_contact(march: March, corner: int, edge: int) -> PlaneContact:
    """Return a contact that was found, by numbers among all corners, with those of its blocks."""
    corners = march.method.detection.corners
    block = int(corners.block[corner])
    on = int(corners.block[edge])
    return PlaneContact(block, int(corner - corners.start[corner]), on, int(edge - corners.start[edge]))


def flipping_contacts(march: March, is_cut: bool) -> list[int]:
    """Return the contacts whose states change as the search of the stage that failed goes round, by their numbers.

    The search goes on from the states in which it was given up until it comes back to states that it had: those in
    between are gone through for ever. `is_cut`: that step was shorter than dt.
    """
    plane = march.method
    work = march.work
    contacts = plane.places.count[0]
    laws = laws_for(march.laws, contacts)
    is_second = plane.made[0] > 0
    before = (march.between if is_second else plane.begun).rows
    stage = march.last if is_second or march.scheme.stages == 1 else march.first
    length = stage.part if is_cut else stage.whole
    after = rows_of(np.zeros(len(before.force)), np.zeros(len(before.force)))
    first_met: dict[tuple[int, ...], int] = {}
    states: list[tuple[int, ...]] = []
    for number in range(LONGEST):
        tried = tuple(int(work.tried[r]) for r in range(2 * contacts))
        if tried in first_met:
            circle = states[first_met[tried] :]
            return [k for k in range(contacts) if len({(state[k], state[contacts + k]) for state in circle}) > 1]
        first_met[tried] = number
        states.append(tried)
        if contacts > plane.dense:
            solve_states(plane.many, laws, before, length, after, work)
            update_all(plane.many, laws, after, work)
        else:
            solve(laws, before, length.flexible, after, work)
            update(laws, length.flexible, after, work, 1)
    return []


def sentence(model: PlaneModel, reached: int, outcome: int, contacts: Sequence[PlaneContact]) -> str:
    """Return how a history ended, in words: of one that ends early at which step and by which contacts."""
    if outcome == FOUND:
        return OUTCOMES[outcome]
    names = [contact_name(model, contact) for contact in contacts[:NAMED]]
    more = [f"{len(contacts) - NAMED} more"] if len(contacts) > NAMED else []
    listed = ", ".join(names + more)
    return f"{OUTCOMES[outcome]} at step {reached + 1}{f': {listed}' if listed else ''}"


def contact_name(model: PlaneModel, contact: PlaneContact) -> str:
    """Return a contact by the names of its blocks."""
    block = model.name_of(contact.block)
    on = model.name_of(contact.on)
    if contact.corner < 0:
        return f"glue of {block} and {on}"
    return f"corner {contact.corner} of {block} on edge {contact.edge} of {on}"
