"""The states of the block's corners that agree with the motion, from its first derivatives at an instant.

A watched function (`Flow.watched`) that is zero goes the way of its first derivative that is not: an open corner
needs a gap that rises, a corner that slips a reference that moves with it, and so on. Forces depend on displacements
alone, and what a corner does right after an instant shows in the derivative in which stick and slip first differ.
Forces of dashpots depend on rates too, and jump where a gap closes: that its rate falls then decides at once.
"""

from __future__ import annotations

from itertools import product

from flint import arb, arb_mat

from fem_reference.events.block_flow import DERIVATIVES, FEW, Flow
from fem_reference.events.block_model import LEFT, OPEN, RELEASED, RIGHT, STICKS, BlockModel, States, sigma
from fem_reference.events.enclosure import is_blank
from fem_reference.events.switches import NoContactStateError


class Flows(dict[States, Flow]):
    """The flows of one block, each made when it is first asked for."""

    def __init__(self, model: BlockModel) -> None:
        super().__init__()
        self.model = model

    def __missing__(self, states: States) -> Flow:
        self[states] = Flow(self.model, states)
        return self[states]


def lead(coefficients: list[arb]) -> int | None:
    """Place of the first coefficient that is not zero; None if the function rests at zero."""
    return next((k for k, c in enumerate(coefficients[:DERIVATIVES]) if not is_blank(c)), None)


def settled(flows: Flows, states: States, z: arb_mat, time: float) -> tuple[States, list[int | None]]:
    """The states of both corners as they agree with the motion from now on.

    Closed corners that stick are tried first: what rests does so in this state.

    Parameters
    ----------
    flows
        The block.
    states
        The states until now.
    z
        Balls for the state; the references of corners that do not stick are up to date.
    time
        The instant, for the message [s].

    Returns
    -------
    states, leads
        The states, and of each watched function how many of its first terms are zero; None: it rests at zero.

    Raises
    ------
    NoContactStateError
        If no choice agrees.
    """
    for choice in _choices(flows.model, states, z):
        leads = agreeing(flows[choice], z)
        if leads is not None:
            return choice, leads
    raise NoContactStateError(f"no state of the corners agrees with the motion at {time!r} s")


def agreeing(flow: Flow, z: arb_mat) -> list[int | None] | None:
    """How many first terms of each watched function are zero, None if one of them falls from now on."""
    leads: list[int | None] = []
    for count in (FEW, DERIVATIVES):
        coefficients = flow.leading(z, count)
        leads = [lead(c) for c in coefficients]
        for c, first in zip(coefficients, leads, strict=True):
            if first is not None and not c[first] > 0:
                return None
        if None not in leads:
            break
    return leads


def _choices(model: BlockModel, states: States, z: arb_mat) -> list[States]:
    """States that both corners may take without a jump of what an instant cannot change."""
    if model.contact is None:
        return list(product(_corner_choices(model, 0, states[0], z), _corner_choices(model, 1, states[1], z)))
    touching = is_blank((model.contact.gap * z)[0, 0])
    resting = touching and is_blank((model.contact.rate * z)[0, 0])
    return [(STICKS, STICKS), (OPEN, OPEN)] if resting else [(OPEN, OPEN)]


def _corner_choices(model: BlockModel, c: int, state: int, z: arb_mat) -> list[int]:
    """States that a corner may take; of its forces only shear may jump where it opens, and a dashpot's where it closes.

    A dashpot that is not open has no choice but by the sign of its force, and it is open as soon as its gap rises.
    """
    touching = is_blank((model.gaps[c] * z)[0, 0])
    if state == OPEN and not touching:
        return [OPEN]
    closed = [STICKS]
    if model.damping != 0 and not touching:
        closed.append(RELEASED)
    if model.tan is not None:
        closed += [
            direction for direction in (RIGHT, LEFT) if is_blank((model.reserves[c, sigma(direction)] * z)[0, 0])
        ]
    return [*closed, OPEN] if touching else closed
