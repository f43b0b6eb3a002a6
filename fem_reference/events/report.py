"""The motion between its nodes: the steps that instants lie in, and what floats see of their series."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from flint import arb, arb_poly
from numpy.typing import NDArray

from fem_reference.events.enclosure import bits_of, precision
from fem_reference.events.march import Node
from fem_reference.events.series import REPORT_ANGLE, Segment, Start, System, expand, step_length, summed
from fem_reference.problem.problem import Array

ROUNDING = 4 * np.finfo(float).eps
"""Part of a displacement by which floats round it."""


class Part(NamedTuple):
    """A part of a step over which floats sum its series without loss."""

    node: Node
    segment: Segment
    start: Start
    rows: list[arb_poly]  # series of the rows of the contacts over the share of the part


class Sampled(NamedTuple):
    """What floats see of a motion at instants."""

    node: NDArray[np.intp]  # number of the node before each instant, shape (times,)
    passed: Array  # time since it [s], shape (times,)
    states: NDArray[np.int64]  # of the contacts, shape (contacts, times)
    series: Array  # values, rates and second derivatives of the series that were asked for, shape (3, series, times)
    rows: Array  # the same of the rows, shape (3, rows, times)
    held: Array  # row of each contact less its reference at the node, or that of a slide, shape (contacts, times)
    radius: Array  # how far the unknowns may be off, shape (unknowns, times)


def sampled(
    model: System, nodes: Sequence[Node], t: Array, digits: int, series_of: Callable[[Part], Sequence[arb_poly]]
) -> Sampled:
    """Return what floats see of a motion.

    Parameters
    ----------
    model, nodes
        What moves, and the beginnings of its steps.
    t
        Instants [s].
    digits
        In which the series are made.
    series_of
        Series that are reported, as many of each part, over the share of the part.
    """
    if not len(t):
        return Sampled._make(part[..., :0] for part in sampled(model, nodes, np.zeros(1), digits, series_of))
    with precision(bits_of(digits)):
        begun = np.searchsorted([float(node.start.time) for node in nodes], t, side="right") - 1
        passed = np.array(
            [float(arb(s) - nodes[i].start.time) for i, s in zip(begun.tolist(), t.tolist(), strict=True)]
        )
        states = np.array([nodes[i].states for i in begun.tolist()], dtype=int).reshape(len(t), len(model.contacts)).T
        values: Array = np.zeros((0, 0, 0))
        radius = np.empty((model.size, len(t)))
        for index in np.unique(begun).tolist():
            node = nodes[index]
            columns = np.flatnonzero(begun == index)
            start = node.start
            radius[:, columns] = model.growth(node.states, node.error, passed[columns])
            step = step_length(model, node.states, node.pieces)
            length = step * REPORT_ANGLE / model.angle
            numbers = np.maximum(0, np.floor(passed[columns] / length)).astype(int)
            whole = expand(model, node.states, start, node.pieces, step) if numbers.any() else None
            for number in np.unique(numbers).tolist():
                begun_at = number * length
                if whole is not None:
                    u, v = whole.state(arb(begun_at) / arb(step))
                    start = Start(node.start.time + arb(begun_at), u.mid(), v.mid(), node.start.references)
                segment = expand(model, node.states, start, node.pieces, length)
                rows = [arb_poly(terms) for terms in segment.rows]
                held = [
                    rows[contact.row] - reference
                    for contact, reference in zip(model.contacts, node.start.references, strict=True)
                ]
                series = [*series_of(Part(node, segment, start, rows)), *rows, *held]
                inside = columns[numbers == number]
                if not values.size:
                    values = np.empty((3, len(series), len(t)))
                values[:, :, inside] = summed(series, passed[inside] / length - number, length)
    contacts = len(model.contacts)
    count = values.shape[1] - contacts
    of_rows = slice(count - len(model.row_sizes), count)
    return Sampled(begun, passed, states, values[:, : of_rows.start], values[:, of_rows], values[0, count:], radius)
