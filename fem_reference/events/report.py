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
        length = step_length(model, node.states, drives[index]) * REPORT_ANGLE / model.angle
        numbers = np.maximum(0, np.floor(passed / length)).astype(int)
        for number in range(int(numbers.max()) + 1):
            segment = expand(model, node.states, start, drives[index], length)
            inside = numbers == number
            if inside.any():
                yield Part(index, segment, start, number * length, columns[inside], passed[inside] / length - number)
            u, v = segment.state(arb(1))
            start = Start(start.time + arb(length), u.mid(), v.mid(), start.references)
