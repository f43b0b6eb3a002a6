"""The first fall of a watched function in a step, that it is the first being proven.

Floats prove for most of a step that nothing falls: Bernstein's forms of the watched functions bound them from below.
Where they do not, balls look closer, with Taylor's formula and a bound on the third derivative (`first_fall`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, arb_poly, ctx

from fem_reference.events.contacts import States, Watch
from fem_reference.events.enclosure import Fall, ball, first_fall, polynomial, radius_of
from fem_reference.events.series import INFLATION, Segment, Start
from fem_reference.events.switches import LostDigitsError
from fem_reference.problem.problem import Array

FLOAT_TERMS = 64  # terms of a series in floats; further ones count as what they may be wrong by
FIRST_CELLS = 4  # parts of a step whose Bernstein forms are looked at first
CELLS = 8  # parts into which the first part that cannot be proven is cut, time and again
CUTS = 5  # times that it is cut: a fall is left in 1/32768 of a step
# Part of its terms by which a Bernstein form of `FLOAT_TERMS` terms may be wrong after all cuts.
ROUNDING = 400 * np.finfo(float).eps
LEAST_MARGIN = 1e-300  # what a radius may be that floats round to zero
# Evaluations of a function in one step; one that stays as near to zero as half of the digits takes more.
MOST_LOOKS = 5000
NEWTON_STEPS = 4  # steps from the ball of a fall to the root of the series itself


class Reach(NamedTuple):
    """How far each term of a watched function may be off."""

    size: arb
    parts: Array  # of the size

    def terms(self) -> list[arb]:
        """Bounds of the terms."""
        return [(self.size * arb(part)).upper() for part in self.parts.tolist()]

    def total(self) -> float:
        """Bound of the function over the step."""
        return float(self.size.upper()) * float(self.parts.sum()) * INFLATION


class Change(NamedTuple):
    """A switch, for what carries the error over it."""

    before: Start  # with the references until then
    after: Start
    was: States
    now: States
    watch: Watch | None  # whose function falls; None: it is not at a fall
    value: arb  # of this function at the centre of the instant
    slope: arb  # and its rate there [1/s]
    grazing: bool  # whether it falls so flatly that its root is not proven to be one
    offset: float  # what the instant may be off [s]
    radii: list[arb]  # of the references that were taken along
    impact: arb_mat | None  # by which rates jump


class Watched(NamedTuple):
    """The watched functions of a step."""

    time: float  # at its beginning [s]
    segment: Segment
    watches: Sequence[Watch]
    reach: Callable[[Watch, bool], Reach]  # what terms of a function may be off by, also where its start is a switch

    def clear(self) -> tuple[float, float, list[Watch]]:
        """Where floats prove all functions to be positive: share, width and the doubtful ones, as of `first_doubt`."""
        watches = [watch for watch in self.watches if watch.lead is not None]
        if not watches:
            return 1.0, 0.0, []
        terms = np.zeros((len(watches), FLOAT_TERMS))
        margin = np.zeros(len(watches))
        for i, watch in enumerate(watches):
            series = np.array([float(c) for c in self.segment.function(watch)])
            off = self.reach(watch, bool(watch.lead)).total()
            beyond = np.abs(series[FLOAT_TERMS:]).sum() + float(self.segment.function_tail(watch))
            margin[i] = ROUNDING * np.abs(series).sum() + beyond + off + LEAST_MARGIN
            series = series[watch.lead :][:FLOAT_TERMS]
            terms[i, : len(series)] = series
        share, width, doubtful = first_doubt(terms, margin)
        return share, width, [watches[i] for i in doubtful]

    def first_fall(
        self, low: float, high: arb, watches: Sequence[Watch], touches: list[arb]
    ) -> tuple[Fall, Watch] | None:
        """The first fall of some functions between two shares of the step, and which function falls.

        Raises `LostDigitsError` if what the motion may be off hides one, or it stays too near to zero for too long.
        """
        first = None
        begin = arb(low)
        end = high - begin
        for watch in watches:
            # Only at its start a function has terms that are zero at the true instant of the last switch; from where
            # floats leave it to balls on, all its terms count, and that instant does not.
            lead = 0 if low else watch.lead or 0
            terms = self.segment.function(watch)
            size = max(float(c.abs_upper()) for c in terms)
            terms = [c + ball(off) for c, off in zip(terms, self.reach(watch, lead > 0).terms(), strict=True)]
            if radius_of(terms[0]) > size * 2.0 ** (-ctx.prec // 3):
                raise LostDigitsError(self.time, "switches have cost most of the digits")
            function = polynomial(terms[lead:], arb(1), begin, self.segment.function_tail(watch), MOST_LOOKS)
            try:
                fall = first_fall(function, end, touches)
            except RuntimeError as error:
                raise LostDigitsError(self.time, "a contact is so near to a switch for so long") from error
            if fall is not None:
                end = fall.at.mid()
                first = Fall(begin + fall.at, fall.grazing), watch
        return first

    def root_near(self, watch: Watch, share: arb) -> arb:
        """The root of the series itself next to the fall of a function, by Newton's method."""
        value = arb_poly([c.mid() for c in self.segment.function(watch)])
        slope = value.derivative()
        x = share.mid()
        for _ in range(NEWTON_STEPS):
            x = (x - value(x) / slope(x)).mid()
        return x


def first_doubt(terms: Array, margin: Array) -> tuple[float, float, list[int]]:
    """Where Bernstein's forms prove polynomials on [0, 1] to be positive.

    `terms` are coefficients of their powers, shape (functions, `FLOAT_TERMS`), `margin` what each may be wrong by.
    Returns the end of the part throughout which all are positive; the length of the next part, in which that cannot be
    proven, 0 where there is none; and the numbers of the functions that may fall in or after it.
    """
    forms = (terms @ bernstein(FIRST_CELLS)).min(axis=1)
    doubtful = np.flatnonzero(~(forms > margin))
    if not len(doubtful):
        return 1.0, 0.0, []
    terms = terms[doubtful]
    margins = margin[doubtful, None]
    low = 0.0
    width = 1.0
    for _ in range(CUTS):
        forms = (terms @ bernstein(CELLS)).reshape(len(terms), CELLS, FLOAT_TERMS).min(axis=2)
        failing = np.flatnonzero(~(forms > margins).all(axis=0))
        if not len(failing):
            return low + width, 0.0, []
        width /= CELLS
        low += failing[0] * width
        terms = terms @ cell_shift(CELLS, int(failing[0]))
    return low, width, doubtful.tolist()


@cache
def cell_shift(cells: int, cell: int) -> Array:
    """From coefficients of powers on [0, 1] to those on one of its equal parts, shape (terms, terms)."""
    # z = (cell + t) / cells: z^j = sum of C(j, k) cell^(j - k) t^k / cells^j
    shift = np.zeros((FLOAT_TERMS, FLOAT_TERMS))
    for j in range(FLOAT_TERMS):
        for k in range(j + 1):
            shift[j, k] = math.comb(j, k) * cell ** (j - k) / cells**j
    return shift


@cache
def bernstein(cells: int) -> Array:
    """From the coefficients of powers on [0, 1] to those of Bernstein's forms on equal parts of it, (terms, forms)."""
    n = FLOAT_TERMS - 1
    # t^k has the form C(i, k) / C(n, k)
    form = np.array([[math.comb(i, k) / math.comb(n, k) for i in range(n + 1)] for k in range(n + 1)])
    return np.hstack([cell_shift(cells, cell) @ form for cell in range(cells)])
