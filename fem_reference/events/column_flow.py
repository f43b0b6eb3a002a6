"""The motion of a column while its contacts keep their states: Taylor series of a step, and the first fall in it.

All series are in the share of a step, t = start + share * length, so that their terms are displacements and fall like
those of an exponential. The recurrence takes the forces of the struts and contacts from the differences of faces, so
that stiff contacts lose no digits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from flint import arb, arb_poly

from fem_reference.events.block_flow import FLOAT_TERMS, ROUNDING, first_doubt, term_count
from fem_reference.events.column_drive import ANGLE, Piece, tail_sum
from fem_reference.events.column_model import BASE, ColumnModel
from fem_reference.events.enclosure import Fall, Local, ball, first_fall
from fem_reference.events.switches import LostDigitsError
from fem_reference.problem.problem import Array

OPEN = 0
CLOSED = 1
STICKS = 1
SLIPS = 2
"""States of a contact; `SLIPS` towards +, -`SLIPS` towards -."""
MOST_LOOKS = 5000
"""Evaluations of a function in one step; one that stays as near to zero as half of the digits takes more."""


class Forces(NamedTuple):
    """The pieces of the drives in a step."""

    base: Piece  # displacement of the base, or of the wave that comes up
    pressure: Piece


class Start(NamedTuple):
    """Where the motion is, exactly."""

    time: arb  # [s]
    u: list[arb]  # displacements of the unknowns [m]
    v: list[arb]  # their rates [m/s]
    references: list[arb]  # r of each contact, for those that stick [m]


@dataclass(frozen=True)
class Segment:
    """Series of a step, term by term."""

    length: float  # of the step [s]
    terms: list[list[arb]]  # of the unknowns, one list a term
    stretches: list[list[arb]]  # y of each contact [m]
    base: list[arb]  # displacement of the base [m]
    pressure: list[arb]  # on the top [Pa]
    tail: arb  # bounds all further terms of an unknown, and three derivatives of them in the share of the step
    drive_tails: tuple[arb, arb]  # the same of the base's displacement and of the pressure

    def polynomial(self, unknown: int) -> arb_poly:
        """Series of an unknown."""
        return arb_poly([term[unknown] for term in self.terms])


def active(states: Sequence[int]) -> Array:
    """Which contacts have a spring that acts."""
    return np.array([state == CLOSED for state in states], dtype=bool)


def rate_of(model: ColumnModel, states: Sequence[int]) -> float:
    """Return a bound of the rates of the motion while the contacts keep their states [rad/s]."""
    return math.sqrt(model.bounds.squared_rate(active(states))) + model.bounds.damping


def step_length(model: ColumnModel, states: Sequence[int], forces: Forces) -> float:
    """Return the longest step; infinite where nothing bounds it [s]."""
    # A column in flight has no rate; the metric of the error, which grows with `soft`, bounds its steps.
    rate = max(rate_of(model, states), model.bounds.soft)
    return min(ANGLE / rate, forces.base.longest_step(), forces.pressure.longest_step())


def expand(
    model: ColumnModel, states: Sequence[int], start: Start, forces: Forces, length: float, count: int | None = None
) -> Segment:
    """Return the series of a step.

    Parameters
    ----------
    model, states, start, forces
        The column, the states of its contacts, where it is and what drives it.
    length
        Of the step [s].
    count
        Terms; None: as many as the digits need.
    """
    angle = rate_of(model, states) * length
    full = count is None
    if count is None:
        of_motion = term_count(min(max(angle, 1.0), 2 * ANGLE)) + 6
        count = max(28, of_motion, *(piece.term_count(length) + 2 for piece in forces))
    zero = arb(0)
    # The last two terms of a drive belong to its tail, so that further terms of the motion follow from the last two.
    known = count - 2 if full else count
    base = forces.base.series(start.time, length, known) + [zero] * (count - known)
    pressure = forces.pressure.series(start.time, length, known) + [zero] * (count - known)
    span = arb(length)
    impedance = model.impedance
    has_foot_on_base = model.problem.base == "rigid"
    terms = [start.u, [v * span for v in start.v]]
    stretches: list[list[arb]] = [[] for _ in model.contacts]
    contacts = list(zip(model.contacts, states, start.references, stretches, strict=True))
    for k in range(count):
        here = terms[k]
        force = list(model.weights) if k == 0 else [zero] * model.size
        for contact, state, reference, stretch in contacts:
            y = here[contact.above] - (base[k] if contact.below == BASE else here[contact.below])
            if k == 0:
                y = y + contact.gap
            stretch.append(y)
            if state == CLOSED:
                push = (y - reference if k == 0 else y) * contact.stiffness
            elif k == 0 and state != OPEN and contact.strength is not None:
                push = contact.strength if state == SLIPS else -contact.strength
            else:
                continue
            force[contact.above] -= push
            if contact.below != BASE:
                force[contact.below] += push
        if k >= count - 2:
            continue
        for strut in model.struts:
            if strut.below == BASE:
                force[strut.above] -= (here[strut.above] - base[k]) * strut.stiffness
            else:
                tension = (here[strut.above] - here[strut.below]) * strut.stiffness
                force[strut.above] -= tension
                force[strut.below] += tension
        if model.top != BASE:
            force[model.top] -= pressure[k]
        if impedance is not None:
            force[0] += impedance * (k + 1) * (2 * base[k + 1] - terms[k + 1][0]) / span
        if model.base_coupling is not None and has_foot_on_base:
            force[0] -= model.base_coupling * ((k + 1) * (k + 2)) * base[k + 2] / (span * span)
        factor = span * span / ((k + 1) * (k + 2))
        terms.append([a * factor for a in model.accelerations(force)])
    if not full:
        return Segment(length, terms, stretches, base, pressure, arb("inf"), (arb("inf"), arb("inf")))
    tails = [piece.tail(start.time, length, count - 2) for piece in forces]
    # From here on the drives add nothing. With w of the springs and d of the half-space, x = (w + d) length = angle,
    # |C_(k+2)| <= (w^2 |C_k| + d (k+1) |C_(k+1)|) length^2 / ((k+1)(k+2)): terms below M x^k / k! stay so, for
    # w^2 + d (w + d) <= (w + d)^2. M is that of the last two.
    ratio = arb(angle) / count
    last = max((abs(c).upper() for c in terms[-1]), default=zero)
    before = max((abs(c).upper() for c in terms[-2]), default=zero)
    largest = max((last * ratio).upper(), (before * ratio * ratio * 1.1).upper())
    tail = (tail_sum(ratio) * arb(count) ** 3 * largest).upper()
    return Segment(length, terms, stretches, base, pressure, tail, (tails[0].upper(), tails[1].upper()))


class Watch(NamedTuple):
    """A function that is positive, or zero for ever, as long as a contact keeps its state."""

    contact: int
    rate: bool  # whether it is the rate of y times the length of the step, else made of y
    sign: int  # of y in it
    offset: arb | None  # added to sign * y [m]
    lead: int | None  # terms at its start that are zero; None: all are


class Watched:
    """The watched functions of a step."""

    def __init__(
        self,
        model: ColumnModel,
        time: float,
        segment: Segment,
        watches: Sequence[Watch],
        rate: float,
        error: arb,
        error_at_switch: arb,
    ) -> None:
        self.model = model
        self.time = time  # at its beginning [s]
        self.segment = segment
        self.watches = [watch for watch in watches if watch.lead is not None]
        self.error = error  # norm of the error in the step, see `Bounds`
        self.error_at_switch = error_at_switch  # with the instants of the last switch put together
        self.growth = max((rate + model.bounds.soft) * segment.length, 1.0)  # of each derivative of the error

    def _tail(self, contact: int) -> arb:
        tail = 2 * self.segment.tail
        return tail + self.segment.drive_tails[0] if self.model.contacts[contact].below == BASE else tail

    def _reaches(self, watch: Watch) -> tuple[arb, arb]:
        """Bounds of a function's error at the start, and of what its further terms are built of [m]."""
        bounds = self.model.bounds
        error = self.error_at_switch if watch.lead else self.error
        speed = bounds.compliance[watch.contact] ** 0.5
        following = error * arb(speed * self.segment.length)
        if watch.rate:
            return following, following * arb(self.growth)
        position = speed / bounds.soft
        if watch.sign < 0 or not self.model.unilateral:
            position = min(position, bounds.stiffness[watch.contact] ** -0.5)
        if not self.model.unilateral:
            position = bounds.stiffness[watch.contact] ** -0.5
        return error * arb(position), following

    def coefficients(self, watch: Watch) -> list[arb]:
        """Terms of a function without those that are zero at its start."""
        stretch = self.segment.stretches[watch.contact]
        if watch.rate:
            terms = [k * c * watch.sign for k, c in enumerate(stretch)][1:]
        else:
            terms = [c if watch.sign > 0 else -c for c in stretch]
            if watch.offset is not None:
                terms[0] = terms[0] + watch.offset
        first, power = self._reaches(watch)
        radius = first
        for k in range(len(terms)):
            terms[k] = terms[k] + ball(radius.upper())
            power = power * arb(self.growth if k else 1.0) / (k + 1)
            radius = power
        return terms[watch.lead :]

    def clear(self) -> tuple[float, float, list[Watch]]:
        """Where floats prove all functions to be positive.

        Returns
        -------
        share, width, doubtful
            The part of the step throughout which they are; the length of the next part, in which that cannot be proven,
            0 where there is none; and the functions that may fall in or after it.
        """
        if not self.watches:
            return 1.0, 0.0, []
        floats: dict[int, Array] = {}
        for contact in {watch.contact for watch in self.watches}:
            floats[contact] = np.array([float(c) for c in self.segment.stretches[contact]])
        count = len(self.segment.terms)
        terms = np.zeros((len(self.watches), FLOAT_TERMS))
        margin = np.zeros(len(self.watches))
        for i, watch in enumerate(self.watches):
            series = floats[watch.contact] * watch.sign
            if watch.rate:
                series = series[1:] * np.arange(1, count)
            elif watch.offset is not None:
                series = series.copy()
                series[0] = float(self._exact_start(watch))
            size = np.abs(series)
            series = series[watch.lead :]
            short = series[:FLOAT_TERMS]
            terms[i, : len(short)] = short
            first, power = self._reaches(watch)
            spread = float(first.upper()) + float(power.upper()) * np.exp(self.growth)
            beyond = size[FLOAT_TERMS:].sum() + float(self._tail(watch.contact).upper())
            margin[i] = ROUNDING * size.sum() + beyond + spread + 1e-300
        share, width, doubtful = first_doubt(terms, margin)
        return share, width, [self.watches[i] for i in doubtful]

    def _exact_start(self, watch: Watch) -> arb:
        start = self.segment.stretches[watch.contact][0] * watch.sign
        return start if watch.offset is None else start + watch.offset

    def first_fall(
        self, low: float, high: arb, watches: Sequence[Watch], touches: list[arb]
    ) -> tuple[Fall, Watch] | None:
        """Return the first fall of some functions between two shares of the step, and which function falls."""
        first: tuple[Fall, Watch] | None = None
        begin = arb(low)
        end = high - begin
        for watch in watches:
            looks = [0]
            value = arb_poly(self.coefficients(watch))
            slope = value.derivative()
            bend = slope.derivative()
            third = arb_poly([abs(c) for c in bend.derivative().coeffs()])(arb(1))
            tail = ball(self._tail(watch.contact).upper())

            def local(
                middle: arb,
                half: arb,
                parts: tuple[arb_poly, arb_poly, arb_poly] = (value, slope, bend),
                third: arb = third,
                tail: arb = tail,
                looks: list[int] = looks,
            ) -> Local:
                looks[0] += 1
                if looks[0] > MOST_LOOKS:
                    raise LostDigitsError(self.time, "a contact is so near to a switch for so long")
                x = begin + middle
                about = parts[2](x) + tail
                if half:
                    about = about + ball((third * half).upper())
                return Local(parts[0](x) + tail, parts[1](x) + tail, about)

            fall = first_fall(local, end, touches)
            if fall is not None:
                end = fall.at.mid()
                first = Fall(begin + fall.at, fall.grazing), watch
        return first

    def root_near(self, watch: Watch, share: arb) -> arb:
        """Return the root of the series itself next to the fall of a function, by Newton's method."""
        terms = [c.mid() for c in self.segment.stretches[watch.contact]]
        if watch.rate:
            terms = [k * c for k, c in enumerate(terms)][1:]
        elif watch.offset is not None:
            terms[0] = terms[0] + watch.offset * watch.sign
        value = arb_poly(terms)
        slope = value.derivative()
        x = share.mid()
        for _ in range(4):
            x = (x - value(x) / slope(x)).mid()
        return x
