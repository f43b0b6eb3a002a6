"""The states of the block's corners that agree with the motion, from its first derivatives at an instant.

A watched function (`Corner.watched`) that is zero goes the way of its first derivative that is not: an open corner
needs a gap that rises, a corner that slips a reference that moves with it, and so on. Forces depend on displacements
alone, and what a corner does right after an instant shows in the derivative in which stick and slip first differ.
"""

from __future__ import annotations

from itertools import product

from flint import arb, arb_mat

from fem_reference.events.block_flow import Corner, Flow, Row
from fem_reference.events.block_model import LEFT, OPEN, RIGHT, STICKS, BlockModel, States, sigma
from fem_reference.events.enclosure import is_blank
from fem_reference.events.switches import NoContactStateError

DERIVATIVES = 10
"""Terms of a function's series after which it counts as zero for ever."""
FEW = 4
"""Terms that are looked at first."""


class Flows(dict[States, Flow]):
    """The flows of one block, each made when it is first asked for."""

    def __init__(self, model: BlockModel) -> None:
        super().__init__()
        self.model = model

    def __missing__(self, states: States) -> Flow:
        self[states] = Flow(self.model, states)
        return self[states]


def functions(rows: list[Row], terms: list[arb_mat], references: arb_mat, length: arb) -> list[list[arb]]:
    """Coefficients of the powers of time / length of some rows, from those of the unknowns.

    Unknowns of two columns are a midpoint and what it may be off; both are added.
    """
    columns = terms[0].ncols()
    flat: list[arb] = []
    for term in terms:
        entries = term.entries()
        for j in range(columns):
            flat += entries[j::columns]
    weights = arb_mat(6, len(rows), [row.weights[i] for i in range(6) for row in rows])
    sums = (arb_mat(columns * len(terms), 6, flat) * weights).entries()
    result = []
    for i, row in enumerate(rows):
        c = sums[i :: len(rows)]
        if columns == 2:
            c = [middle + radius for middle, radius in zip(c[::2], c[1::2], strict=True)]
        if row.of_rates:
            c = [c[k] * k / length for k in range(1, len(c))]
        c[0] += row.constant + row.references[0] * references[0, 0] + row.references[1] * references[1, 0]
        result.append(c)
    return result


def lead(coefficients: list[arb]) -> int | None:
    """Place of the first coefficient that is not zero; None if the function rests at zero."""
    return next((k for k, c in enumerate(coefficients[:DERIVATIVES]) if not is_blank(c)), None)


def value(row: Row, x: arb_mat, references: arb_mat) -> arb:
    """Value of a function."""
    sides = row.references[0] * references[0, 0] + row.references[1] * references[1, 0]
    return (arb_mat([row.weights]) * x)[0, 0] + row.constant + sides


def settled(
    flows: Flows, states: States, x: arb_mat, v: arb_mat, references: arb_mat, time: float
) -> tuple[States, list[int | None]]:
    """The states of both corners as they agree with the motion from now on.

    Closed corners that stick are tried first: what rests does so in this state.

    Parameters
    ----------
    flows
        The block.
    states
        The states until now.
    x, v, references
        Balls for the unknowns, their rates and both references; those of corners that do not stick are up to date.
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
    first, second = (_choices(flows.model, c, states[c], x, references) for c in (0, 1))
    for choice in product(first, second):
        leads = agreeing(flows[choice], x, v, references)
        if leads is not None:
            return choice, leads
    raise NoContactStateError(f"no state of the corners agrees with the motion at {time!r} s")


def agreeing(flow: Flow, x: arb_mat, v: arb_mat, references: arb_mat) -> list[int | None] | None:
    """How many first terms of each watched function are zero, None if one of them falls from now on."""
    length = arb(1 / flow.rate)
    a = flow.acceleration(x, references)
    leads: list[int | None] = []
    for count in (FEW, DERIVATIVES + 1):  # most functions show at once where they go
        terms = flow.terms(x, v, a, length, count)
        coefficients = functions(flow.watched, terms, references, length)
        leads = [lead(c) for c in coefficients]
        for c, first in zip(coefficients, leads, strict=True):
            if first is not None and not c[first] > 0:
                return None
        if None not in leads:
            break
    return leads


def _choices(model: BlockModel, index: int, state: int, x: arb_mat, references: arb_mat) -> list[int]:
    """States that a corner may take without a jump of its forces other than those that opening releases."""
    corner = Corner(model, index, STICKS)
    touching = is_blank(value(corner.gap, x, references))
    if state == OPEN and not touching:
        return [OPEN]
    closed = [STICKS]
    if model.tan is not None:
        closed += [way for way in (RIGHT, LEFT) if is_blank(value(corner.reserves[sigma(way)], x, references))]
    return [*closed, OPEN] if touching else closed
