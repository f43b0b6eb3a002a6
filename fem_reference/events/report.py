"""The motion between its nodes: the steps that instants lie in, and their series."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from flint import arb

from fem_reference.events.column_drive import Piece
from fem_reference.events.march import Node
from fem_reference.events.series import REPORT_ANGLE, Segment, Start, System, expand, step_length
from fem_reference.problem.problem import Array


class Part(NamedTuple):
    """A part of a step over which floats sum its series without loss."""

    node: int  # number of its node
    segment: Segment
    start: Start
    begun: float  # time from the node to its beginning [s]
    columns: Array  # numbers of the instants in it
    shares: Array  # and where in it they lie


def parts_of(model: System, nodes: Sequence[Node], drives: Sequence[Sequence[Piece]], t: Array) -> Iterator[Part]:
    """Yield the parts of steps that instants lie in; the drives are those of each node."""
    begun = np.searchsorted([float(node.start.time) for node in nodes], t, side="right") - 1
    for index in np.unique(begun).tolist():
        node = nodes[index]
        start = node.start
        columns = np.flatnonzero(begun == index)
        passed = np.array([float(arb(moment) - start.time) for moment in t[columns].tolist()])
        step = step_length(model, node.states, drives[index])
        length = step * REPORT_ANGLE / model.angle
        numbers = np.maximum(0, np.floor(passed / length)).astype(int)
        whole = expand(model, node.states, start, drives[index], step) if numbers.any() else None
        for number in np.unique(numbers).tolist():
            begun_at = number * length
            if whole is not None:
                u, v = whole.state(arb(begun_at) / arb(step))
                start = Start(node.start.time + arb(begun_at), u.mid(), v.mid(), node.start.references)
            inside = numbers == number
            segment = expand(model, node.states, start, drives[index], length)
            yield Part(index, segment, start, begun_at, columns[inside], passed[inside] / length - number)
