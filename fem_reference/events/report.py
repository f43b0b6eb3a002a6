"""Motions whose switches are proven: in as many digits as they need, and where they are at instants.

Between its nodes a motion is summed in balls, so that floats round it once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeVar

import numpy as np
from flint import arb
from numpy.typing import ArrayLike

from fem_reference.events.enclosure import bits_of, check_request, precision
from fem_reference.events.march import Node
from fem_reference.events.series import Start, System, expand, step_length
from fem_reference.events.switches import LostDigitsError, Switch
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array

MARGIN = 1.25  # times the digits that are expected to do which are taken next
MOST_FOLD = 4  # times the digits that are taken next at most, but for the margin
MOST_DIGITS = 240  # decimal digits of the last computation, where switches cost those of the ones before
# Part of the end of the motion to which the instant of each switch is enclosed; more digits are taken for it.
PROMISED = 1e-20
ROUNDING = 4 * np.finfo(float).eps  # part of a displacement by which floats round it


class Instant(NamedTuple):
    """A motion at an instant."""

    number: int  # of the node before it
    node: Node
    start: Start  # where it is, with the references of the node
    rows: list[arb]  # of the contacts
    forces: list[arb]  # along the rows
    radius: Array  # how far the unknowns may be off


@dataclass(frozen=True)
class ProvenMotion:
    """A motion from t = 0 to `end` whose switches are enclosed."""

    end: float  # last instant [s]
    digits: int  # decimal digits of the computation
    switches: tuple[Switch, ...]  # changes of the contacts in the order of time; together: in that of their numbers
    touches: tuple[float, ...]  # instants at which a switch was neither proven nor excluded, and none was taken [s]
    nodes: tuple[Node, ...] = field(repr=False)  # beginnings of the steps in the order of time

    @property
    def radius(self) -> float:
        """Greatest proven radius of the instant of a switch, 0 without one [s]."""
        return max((switch.radius for switch in self.switches), default=0.0)

    @property
    def simultaneous(self) -> tuple[float, ...]:
        """Instants at which several contacts switch within one ball [s]."""
        contacts: dict[str, set[str]] = {}
        for switch in self.switches:
            contacts.setdefault(switch.midpoint, set()).add(switch.corner)
        return tuple(float(time) for time, together in contacts.items() if len(together) > 1)

    def _at(self, instant: Instant) -> dict[str, Any]:
        """All columns but the time at an instant."""
        raise NotImplementedError

    def columns(self, model: System, times: ArrayLike, digits: int) -> dict[str, Array]:
        """All columns at instants from 0 to `end`, in any order, summed in so many digits; the last axis is theirs."""
        t = instants(times, self.end)
        beginnings = [float(node.start.time) for node in self.nodes]
        last = -1
        columns = []
        with precision(bits_of(min(self.digits, digits))):
            for time in t.tolist() or [0.0]:  # without an instant one gives the columns their shapes
                number = int(np.searchsorted(beginnings, time, side="right")) - 1
                node = self.nodes[number]
                if number != last:
                    step = step_length(model, node.states, node.pieces)
                    segment = expand(model, node.states, node.start, node.pieces, step)
                    first_radius = model.growth(node.states, node.error, 0.0)
                    rate = model.rate(node.states)
                    last = number
                elapsed = arb(time) - node.start.time
                u, v = segment.state(elapsed / arb(step))
                start = Start(arb(time), u, v, node.start.references)
                rows, forces = model.forces(node.states, start, node.pieces)
                radius = first_radius * math.exp(rate * float(elapsed))
                columns.append(self._at(Instant(number, node, start, rows, forces, radius)))
        return {"time": t} | {
            name: np.array([column[name] for column in columns]).T[..., : len(t)] for name in columns[0]
        }


Motion = TypeVar("Motion", bound=ProvenMotion)


def with_enough_digits(motion_in: Callable[[int], Motion], end: float, digits: int) -> Motion:
    """The motion to an `end` [s], first in `digits`, then in as many as it needs, up to `MOST_DIGITS`.

    `motion_in` is called in the precision of the digits that it gets. Raises `LostDigitsError` if the most do not do.
    """
    check_request(end, digits)
    promised = PROMISED * end
    while True:
        try:
            with precision(bits_of(digits)):
                motion = motion_in(digits)
            if motion.radius <= promised:
                return motion
            times = [switch.time for switch in motion.switches if switch.radius <= promised]
            lost = LostDigitsError(times[-1] if times else 0.0, f"{len(motion.switches)} switches have cost the digits")
        except LostDigitsError as error:
            lost = error
        if digits >= MOST_DIGITS:
            raise lost
        # Digits are lost evenly, so that the time they lasted for tells how many are needed.
        needed = MARGIN * digits * end / max(lost.time, end / MOST_FOLD)
        digits = min(MOST_DIGITS, math.ceil(needed))
