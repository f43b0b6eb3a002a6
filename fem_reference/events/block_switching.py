"""The states of the block's corners that agree with the motion, from its first derivatives at an instant.

A watched function (`Corner.watched`) that is zero goes the way of its first derivative that is not: an open corner
needs a gap that rises, a corner that slips a reference that moves with it, and so on. Forces depend on displacements
alone, and what a corner does right after an instant shows in the derivative in which stick and slip first differ.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from decimal import Decimal, getcontext
from functools import cached_property
from itertools import product

import numpy as np

from fem_reference.events.block_model import CORNERS, LEFT, OPEN, RIGHT, STICKS, BlockModel, States, sigma
from fem_reference.events.block_pieces import Pieces
from fem_reference.events.block_rows import Corner, Row, State
from fem_reference.events.decimals import ZERO, Matrix, Vector, dot
from fem_reference.events.series import Stepper
from fem_reference.events.switches import NoContactStateError, Switch
from fem_reference.problem.problem import Array

DERIVATIVES = 8
"""Derivatives of a function after which it counts as zero for ever."""
BOUNDED = 16
"""Derivatives that bound those left out, which fall as 1 / k! in units of the fastest rate."""


def settled(pieces: Pieces, state: State) -> State:
    """The state with its corners as they agree with the motion from now on.

    Raises
    ------
    NoContactStateError
        If no choice agrees.
    """
    choices = [_choices(Corner(pieces.model, state, c)) for c in (0, 1)]
    for first, second in product(*choices):
        tried = _switched(pieces.model, state, (first, second))
        if agrees(pieces, tried):
            return tried
    raise NoContactStateError(f"no state of the corners agrees with the motion at {float(state.time)!r} s")


def agrees(pieces: Pieces, state: State) -> bool:
    """Whether every watched function of both corners is positive from now on, or rests at zero.

    Closed corners that stick are tried first: what rests does so in this state.
    """
    start = Beginning(pieces, state)
    corners = [Corner(pieces.model, state, c) for c in (0, 1)]
    return all(start.lead(row).sign >= 0 for corner in corners for row in corner.watched())


def changes(before: State, after: State) -> list[Switch]:
    """The switches from one state to the next; a corner that closes may slip at once."""
    pairs = zip(CORNERS, zip(before.states, after.states, strict=True), strict=True)
    return [Switch(float(after.time), corner, _kind(*pair)) for corner, pair in pairs if pair[0] != pair[1]]


def _kind(before: int, after: int) -> str:
    if OPEN in (before, after):
        return "opens" if after == OPEN else "closes"
    return "sticks" if after == STICKS else "slips"


def arrived(model: BlockModel, state: State) -> State:
    """The state with the references where slipping, or an open corner's slide, has taken them."""
    references, slipped = list(state.references), list(state.slipped)
    for c in (0, 1):
        corner = Corner(model, state, c)
        if corner.is_in != STICKS:
            references[c] = corner.value(corner.slide) - corner.value(corner.stretch)
        if corner.is_in in (RIGHT, LEFT):
            slipped[c] += references[c] - state.references[c]
    return replace(state, references=(references[0], references[1]), slipped=(slipped[0], slipped[1]))


def _choices(corner: Corner) -> list[int]:
    """States that a corner may take without a jump of its forces other than those that opening releases."""
    touching = _vanishes(corner, corner.gap)
    if corner.is_in == OPEN and not touching:
        return [OPEN]
    closed = [STICKS]
    if corner.model.tan is not None:
        stuck = corner.as_if(STICKS)
        closed += [way for way in (RIGHT, LEFT) if _vanishes(stuck, stuck.reserve(sigma(way)))]
    return [*closed, OPEN] if touching else closed


def _vanishes(corner: Corner, row: Row) -> bool:
    """Whether a function is zero but for rounding."""
    size = abs(row.constant) + dot(map(abs, row.weights), map(abs, corner.state.displacement))
    return abs(corner.value(row)) <= _tolerance() * size


def _tolerance() -> Decimal:
    return Decimal(10) ** (-getcontext().prec // 2)


def _switched(model: BlockModel, state: State, states: States) -> State:
    """The state with its corners as given, and the energy lost where they open."""
    released = state.released
    for c, (was, now) in enumerate(zip(state.states, states, strict=True)):
        if now == OPEN != was:
            corner = Corner(model, state, c)
            released += model.ps * corner.value(corner.stretch) ** 2 / 2
    return replace(state, states=states, released=released)


@dataclass(frozen=True)
class Lead:
    """How a function begins."""

    sign: int  # of its first derivative that is not zero, the function itself included; 0 if there is none
    clear: Decimal = ZERO  # time until which it keeps this sign, where value and rate begin at zero [s]


class Beginning:
    """The first terms of the motion's power series after a state, with what bounds the others."""

    def __init__(self, pieces: Pieces, state: State) -> None:
        self.pieces, self.state = pieces, state

    def lead(self, row: Row) -> Lead:
        """How a watched function begins."""
        absolute = [abs(w) for w in row.weights]
        for x, constant in self._known(row):
            value = dot(row.weights, x) + constant
            if abs(value) > _tolerance() * (dot(absolute, map(abs, x)) + abs(constant)):
                return Lead(1 if value > 0 else -1)
        terms, bounds = self._of(row)
        own = enumerate(zip(terms, bounds[: len(terms)], strict=True))
        first = next((k for k, (x, bound) in own if abs(x) > _tolerance() * Decimal(bound)), None)
        if first is None:
            return Lead(0)
        rest = np.array([abs(float(x)) for x in terms[first + 1 :]] + [2 * sum(bounds[len(terms) :])])
        share = min(1.0, abs(float(terms[first])) / 2 / max(rest.sum(), 1e-300))
        return Lead(1 if terms[first] > 0 else -1, self._scale * Decimal(share))

    def _known(self, row: Row) -> list[tuple[Vector, Decimal]]:
        """What a function is of, with its constant; and the same of its rate, unless that takes accelerations."""
        x, rate = self.state.displacement, self.state.velocity
        return [(rate, row.constant)] if row.of_rates else [(x, row.constant), (rate, row.drift)]

    @cached_property
    def _stepper(self) -> Stepper:
        return self.pieces.stepper(self.state.states)

    @cached_property
    def _scale(self) -> Decimal:
        return 1 / Decimal(self._stepper.rate)

    @cached_property
    def _terms(self) -> tuple[Matrix, Array]:
        """Coefficients of the unknowns, and bounds of these and of more."""
        state = self.state
        start = state.displacement, state.velocity
        forces = self.pieces.model.forces(state.states, state.references, state.base)
        terms = self._stepper.coefficients(start, forces, self._scale, DERIVATIVES + 2)
        return terms, self._stepper.bounds(start, forces, self._scale, BOUNDED + 2)

    def _of(self, row: Row) -> tuple[list[Decimal], Array]:
        """Terms of a function, and bounds of their size."""
        own, sizes = self._terms
        terms, bounds = [dot(row.weights, x) for x in own], sizes @ np.abs([float(w) for w in row.weights])
        if row.of_rates:
            terms = [k * x / self._scale for k, x in enumerate(terms)][1:]
            bounds = (np.arange(len(bounds)) * bounds / float(self._scale))[1:]
        for k, x in enumerate((row.constant, row.drift * self._scale)):
            terms[k] += x
            bounds[k] += abs(float(x))
        return terms, bounds
