"""The motion between its nodes: where it is at instants, summed in balls, so that floats round it once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from flint import arb

from fem_reference.events.march import Node
from fem_reference.events.series import Start, System, expand, step_length
from fem_reference.problem.problem import Array

ROUNDING = 4 * np.finfo(float).eps  # part of a displacement by which floats round it


class Instant(NamedTuple):
    """A motion at an instant."""

    number: int  # of the node before it
    node: Node
    start: Start  # where it is, with the references of the node
    rows: list[arb]  # of the contacts
    forces: list[arb]  # along the rows
    radius: Array  # how far the unknowns may be off


def instants_of(model: System, nodes: Sequence[Node], t: Array) -> Iterator[Instant]:
    """Yield a motion at instants [s], in the precision of the current context; without one, at t = 0."""
    times = [float(node.start.time) for node in nodes]
    last = -1
    for time in t.tolist() or [0.0]:
        number = int(np.searchsorted(times, time, side="right")) - 1
        node = nodes[number]
        if number != last:
            step = step_length(model, node.states, node.pieces)
            segment = expand(model, node.states, node.start, node.pieces, step)
            last = number
        elapsed = arb(time) - node.start.time
        u, v = segment.state(elapsed / arb(step))
        start = Start(arb(time), u, v, node.start.references)
        rows, forces = model.forces(node.states, start, node.pieces)
        radius = model.growth(node.states, node.error, float(elapsed))
        yield Instant(number, node, start, rows, forces, radius)


def stacked(columns: Sequence[dict[str, Any]], count: int) -> dict[str, Array]:
    """Return columns of as many instants, the last axis being that of these."""
    return {name: np.array([column[name] for column in columns]).T[..., :count] for name in columns[0]}
