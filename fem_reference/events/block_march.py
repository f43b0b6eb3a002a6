"""The block's motion from switch to switch on balls, and how far it may be off.

The centre of the motion is computed in so many digits, without radii; `Spread` holds what separates it from the true
motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from flint import arb, arb_mat, ctx

from fem_reference.events.block_flow import ANGLE, CLOSE, REACH, Flow, Row, Step
from fem_reference.events.block_model import CORNERS, OPEN, STICKS, BlockModel, Course, States
from fem_reference.events.block_switching import Flows, functions, lead, settled, value
from fem_reference.events.enclosure import Fall, Polynomial, ball, exact_sums, first_fall, radius_of
from fem_reference.events.spread import INFLATION, Spread
from fem_reference.events.switches import (
    LostDigitsError,
    NoContactStateError,
    Switch,
    TooManySwitchesError,
    TooMuchWorkError,
)
from fem_reference.problem.problem import Array

STEPS = 100_000
"""Greatest number of steps of `ANGLE` radians, about twenty seconds and 200 MB."""
IDLE = 1000
"""Steps without a switch after which a motion that would take too many steps is given up."""


@dataclass
class State:
    """The motion at an instant."""

    time: arb  # exact [s]
    x: arb_mat  # unknowns (u, v, ux, uy, vx, vy) as seen from the base, midpoints [m, -]
    v: arb_mat  # their rates, midpoints [m/s, 1/s]
    states: States  # of the corners M and N from now on
    references: arb_mat  # r of each corner: the slide at which its shear force is zero [m]
    spread: Spread  # what x, v and the references may be off
    released: arb = field(default_factory=arb)  # energy of the shear springs lost by opening until now [J]
    slipped: list[arb] = field(default_factory=lambda: [arb(0), arb(0)])  # movement of each reference by slipping [m]


@dataclass(frozen=True)
class Node:
    """The beginning of a step, in floats."""

    start: tuple[float, float]  # the instant as the sum of two floats [s]
    states: States
    values: Array  # ten functions (`Flow.outputs`), their rates and accelerations as seen from the base, shape (30,)
    radius: Array  # how far unknowns, rates and references may be off, shape (14,)
    base: tuple[float, float, float, float]  # of the base: x and y less the gap at t = 0 [m], and their rates [m/s]
    references: tuple[float, float]  # [m]
    slipped: tuple[float, float]  # [m]
    released: float  # [J]


class March:
    """The motion of a block from t = 0 on, node by node."""

    def __init__(self, model: BlockModel, course: Course, gap: float, end: float, limit: int) -> None:
        self.model, self.course, self.gap, self.end, self.limit = model, course, arb(gap), end, limit
        self.flows = Flows(model)
        self.nodes: list[Node] = []
        self.switches: list[Switch] = []
        self.leads: list[int | None] = []  # zeros with which the watched functions begin, see `Step.clear`
        self.last_switch = 0  # nodes before the last switch
        self.near = False  # whether floats have seen a fall just ahead
        self.touches: list[float] = []  # instants at which a crossing is neither proven nor excluded [s]

    def run(self, velocity: float) -> None:
        """Find the motion.

        Raises
        ------
        HorizonError, NoContactStateError
            If it cannot go on.
        """
        row, self.base = self.course.at_start()
        self.row_time = arb(0)
        x = arb_mat(6, 1, [-self.base.x, self.gap - self.base.y, 0, 0, 0, 0])
        v = arb_mat(6, 1, [-self.base.vx, arb(velocity) - self.base.vy, 0, 0, 0, 0])
        spread = Spread(self.flows)
        spread.box[:12] = [radius_of(entry) for part in (x, v) for entry in part.entries()]
        first = (OPEN, OPEN) if x[1, 0] > 0 else (STICKS, STICKS)
        slide = -self.base.x
        self.state = State(arb(0), x.mid(), v.mid(), first, arb_mat(2, 1, [slide, slide]).mid(), spread)
        self.state.spread.box[12:] = radius_of(slide)
        if self.model.locked and self._steps_left() > STEPS:
            self._stop_for_work()  # before the first step: corners that never change cannot shorten the work
        if not self.model.locked:
            self._settle()
        self.switches.clear()
        self.closed_at_start = tuple(state != OPEN for state in self.state.states)
        times = self.course.motion.time
        while True:
            following = row + 1
            last = following >= len(times) or times[following] >= self.end
            row_end = self.end if last else times[following]
            self._cross(arb(row_end), row_end - float(self.row_time))
            if last:
                return
            before, self.base = self.base, self.course.from_row(following)
            row, self.row_time = following, arb(row_end)
            still = [arb(0)] * 4
            moved = self.state.v - arb_mat(6, 1, [self.base.vx - before.vx, self.base.vy - before.vy, *still])
            self.state.v = moved.mid()
            self.state.spread.box[6:12] += radii_of(moved)

    def _cross(self, row_end: arb, span: float) -> None:
        """Go on to the end of a row of the base's record."""
        while self.state.time < row_end:
            idle = len(self.nodes) - self.last_switch > IDLE
            if len(self.nodes) >= STEPS or (idle and self._steps_left() > STEPS):
                self._stop_for_work()
            self.step(row_end, span)

    def _steps_left(self) -> float:
        """Steps to the end if no corner switches any more."""
        return (self.end - float(self.state.time)) * self.flows[self.state.states].rate / ANGLE

    def _stop_for_work(self) -> None:
        reason = f"{STEPS} steps of {ANGLE:g} radians are the limit, and {self._steps_left():.3g} more would be needed"
        rate = self.flows[self.state.states].rate
        within = float(self.state.time) + (STEPS - len(self.nodes)) * ANGLE / rate
        raise TooMuchWorkError(within, f"{reason}, since the block oscillates at {rate:.3g} rad/s")

    def step(self, row_end: arb, span: float) -> None:
        """One step, up to a switch at most."""
        state = self.state
        flow = self.flows[state.states]
        left = _difference(row_end, state.time)
        step = flow.step(span)
        full = bool(left > step.length / REACH)
        length = left if left < step.length * REACH else arb(step.length)
        a = flow.acceleration(state.x, state.references)
        values = flow.values(state.x, state.v, a, state.references)
        radius = state.spread.hull()
        sizes = flow.reading_sizes @ radius
        values[np.abs(values) <= sizes] = 0.0  # what is not known to differ from zero, as where a load is centred
        self._add_node(values, radius)
        if self.near:  # floats have seen a fall just ahead
            length = _least(left, arb(step.length * CLOSE))
            share, doubtful = 0.0, list(range(len(flow.watched)))
        elif flow.watched:
            share, doubtful = step.clear(values, sizes, self.leads)
        else:
            share, doubtful = 1.0, []
        self.near = False
        if doubtful and share > CLOSE:
            ahead = arb(share * step.length * REACH)
            if ahead < length:
                self.near = True
                length = ahead
        elif doubtful:
            fall = self.first_fall(flow, a, length, [flow.watched[i] for i in doubtful], radius)
            if fall is not None:
                self._switch(flow, a, length, *fall)
                return
        whole = full and (length is left or length == arb(step.length))
        self._advance(flow, a, length, step if whole else None)
        self.leads = [0] * len(flow.watched)
        state.time = row_end if length is left else _sum(state.time, length)

    def _add_node(self, values: Array, radius: Array) -> None:
        state = self.state
        passed = float(_difference(state.time, self.row_time))
        vx, vy = float(self.base.vx), float(self.base.vy)
        base = float(self.base.x) + vx * passed, float(self.base.y - self.gap) + vy * passed, vx, vy
        high = float(state.time)
        r = float(state.references[0, 0]), float(state.references[1, 0])
        slipped = float(state.slipped[0]), float(state.slipped[1])
        start = high, float(_difference(state.time, arb(high)))
        self.nodes.append(Node(start, state.states, values, radius, base, r, slipped, float(state.released)))

    def _advance(self, flow: Flow, a: arb_mat, length: arb, step: Step | None) -> None:
        """Move the state by a time, for which a step's matrix may be at hand."""
        state = self.state
        J = step.jacobian if step else flow.jacobian(float(length))
        x, v = state.x, state.v
        if step:
            moved = (step.matrix * arb_mat(18, 1, [*x.entries(), *v.entries(), *a.entries()])).entries()
            x, v = arb_mat(6, 1, moved[:6]), arb_mat(6, 1, moved[6:])
            length = length - step.length
        if length != 0:
            if step:
                a = flow.acceleration(x, state.references)
            x, v = _at(flow.series(x, v, a, length), length, arb(1))
        added = np.concatenate([radii_of(x), radii_of(v), np.zeros(2)])
        state.x, state.v = x.mid(), v.mid()
        state.spread.transport(J, added)

    def first_fall(
        self, flow: Flow, a: arb_mat, length: arb, rows: list[Row], radius: Array
    ) -> tuple[Fall | None, Row] | None:
        """The first fall of some watched functions, in units of the step; None instead of it: at once."""
        terms = flow.series(*self._with_radius(flow, a, radius), length, 12)
        references = self._balls(radius)[2]
        first: tuple[Fall, Row] | None = None
        for row, c in zip(rows, functions(rows, terms, references, length), strict=True):
            # as large as the function would be over a whole step
            size = max(float(c[0].abs_upper()), float(c[1].abs_upper()) * max(1.0, ANGLE / (flow.rate * float(length))))
            if radius_of(c[0]) > size * 2.0 ** (-ctx.prec // 2):
                time = float(self.state.time)
                raise LostDigitsError(time, f"{len(self.switches)} switches have cost half of the digits")
            place = lead(c)
            if place is None:
                continue
            if not c[place] > 0:
                return None, row
            end = first[0].at.mid() if first else arb(1)
            touches: list[arb] = []
            fall = first_fall(Polynomial(c[place:], end), end, touches)
            self.touches += [float(_sum(self.state.time, touch * length)) for touch in touches]
            if fall is not None:
                first = fall, row
        return first

    def _balls(self, radius: Array) -> tuple[arb_mat, arb_mat, arb_mat]:
        """Unknowns, rates and references with their radii."""
        state = self.state
        x = arb_mat(6, 1, [c + ball(r) for c, r in zip(state.x.entries(), radius[:6].tolist(), strict=True)])
        v = arb_mat(6, 1, [c + ball(r) for c, r in zip(state.v.entries(), radius[6:12].tolist(), strict=True)])
        r = arb_mat(2, 1, [c + ball(r) for c, r in zip(state.references.entries(), radius[12:].tolist(), strict=True)])
        return x, v, r

    def _with_radius(self, flow: Flow, a: arb_mat, radius: Array) -> tuple[arb_mat, arb_mat, arb_mat]:
        """Unknowns, rates and accelerations as two columns, midpoint and radius, so that neither blurs the other."""
        state = self.state
        x, v = radius[:6].tolist(), radius[6:12].tolist()
        bend = (np.abs(flow.B_floats) @ radius[:6] + np.abs(flow.R_floats) @ radius[12:]) * INFLATION
        parts = ((state.x, x), (state.v, v), (a, bend.tolist()))
        columns = [arb_mat(6, 2, [y for i in range(6) for y in (part[i, 0], ball(r[i]))]) for part, r in parts]
        return columns[0], columns[1], columns[2]

    def _switch(self, flow: Flow, a: arb_mat, length: arb, fall: Fall | None, row: Row) -> None:
        """Move to the first fall of a watched function, and let the corners take the states that agree."""
        state = self.state
        offset, slope = 0.0, None
        s, finest = arb(0), self.end * 2.0 ** (-ctx.prec // 2)
        if fall is not None:
            with exact_sums():
                enclosure = state.time + fall.at * length
            time = enclosure.mid()
            offset = radius_of(enclosure)
            if fall.grazing:
                self.touches.append(float(time))
            s = _difference(time, state.time)
            self._advance(flow, a, s, None)
            state.time = time
            a = flow.acceleration(state.x, state.references)
            slope = self._slope(flow, row, a)
        before = state.states
        self._arrive(flow, row, a, slope, offset)
        self._settle(offset)
        if state.states == before and (fall is None or s < finest):
            raise NoContactStateError(f"the state of the corners contradicts the motion at {float(state.time)!r} s")
        if offset > 0:
            changed = self.flows[state.states].acceleration(state.x, state.references) - a
            self._blur(flow, changed, offset)

    def _slope(self, flow: Flow, row: Row, a: arb_mat) -> arb:
        """Rate of a watched function at the state."""
        weights = arb_mat([row.weights])
        return (weights * (a if row.of_rates else self.state.v))[0, 0]

    def _arrive(self, flow: Flow, row: Row, a: arb_mat, slope: arb | None, offset: float) -> None:
        """Put the references where slipping, or an open corner's slide, has taken them.

        Where the state is at the middle of the ball of the switch's instant, the reference is that of the instant
        itself: it depends on the state by the function that falls then, too.
        """
        state = self.state
        M = np.eye(14)
        added = np.zeros(14)
        references = state.references.entries()
        for c in (0, 1):
            corner = flow.corners[c]
            if state.states[c] == STICKS:
                continue
            reference = value(corner.reference, state.x, state.references)
            rate = (arb_mat([corner.reference.weights]) * state.v)[0, 0]
            own = np.array([float(w) for w in corner.reference.weights])
            M[12 + c] = 0.0
            M[12 + c, :6] = own
            if slope is not None and slope != 0:
                share = float(rate / slope) if not (rate / slope).contains(0) else 0.0
                fallen = np.array([float(w) for w in row.weights])
                first = 6 if row.of_rates else 0
                M[12 + c, first : first + 6] -= share * fallen
                reference -= share * self._fallen(row)
                added[12 + c] = self._curvature(flow, a) * offset**2 + 1e-12 * abs(float(rate)) * offset
            added[12 + c] += radius_of(reference)
            if state.states[c] != OPEN:
                state.slipped[c] = (state.slipped[c] + reference - references[c]).mid()
            references[c] = reference.mid()
        state.references = arb_mat(2, 1, references)
        state.spread.transport(M, added)

    def _fallen(self, row: Row) -> arb:
        """Value of a watched function at the state, which is zero but for rounding where it has just fallen."""
        return value(row, self.state.v if row.of_rates else self.state.x, self.state.references)

    def _curvature(self, flow: Flow, a: arb_mat) -> float:
        """Size of the accelerations and of their rates over the greatest rate, for terms of second order."""
        sizes = [float(x.abs_upper()) for x in a.entries()]
        rates = [float(x.abs_upper()) for x in (flow.B * self.state.v).entries()]
        return 1e3 * (sum(sizes) + sum(rates) / flow.rate) * max(1.0, float(self.model.height))

    def _blur(self, flow: Flow, change: arb_mat, offset: float) -> None:
        """Add what the motion may be off because the switch was at another instant of its ball.

        Between that instant and the middle of the ball the accelerations were those of the other state.
        """
        change_size = np.array([float(x.abs_upper()) for x in change.entries()])
        second = self._curvature(flow, change) * max(flow.rate, 1.0) * offset**2
        box = self.state.spread.box
        box[6:12] += change_size * offset * INFLATION + second
        box[:6] += change_size * offset**2 + second * offset

    def _settle(self, offset: float = 0.0) -> None:
        """Let the corners take the states that agree with the motion."""
        state = self.state
        radius = state.spread.hull()
        now, self.leads = settled(self.flows, state.states, *self._balls(radius), float(state.time))
        for c in (0, 1):
            was = state.states[c]
            if was == now[c]:
                continue
            if now[c] == OPEN:
                stretch = value(self.flows[state.states].corners[c].stretch, state.x, state.references)
                state.released = (state.released + self.model.ps * stretch * stretch / 2).mid()
            kind = "sticks" if now[c] == STICKS else "slips"
            if OPEN in (was, now[c]):
                kind = "opens" if now[c] == OPEN else "closes"
            midpoint = state.time.str(40, radius=False)
            self.switches.append(Switch(float(state.time), CORNERS[c], kind, midpoint, offset))
        state.states = now
        self.last_switch = len(self.nodes)
        if len(self.switches) > self.limit:
            raise TooManySwitchesError(float(state.time), f"more than {self.limit} switches")


def _least(one: arb, other: arb) -> arb:
    return one if one < other else other


def radii_of(vector: arb_mat) -> Array:
    """Radii of the entries."""
    return np.array([radius_of(entry) for entry in vector.entries()])


def _difference(one: arb, other: arb) -> arb:
    with exact_sums():
        return (one - other).mid()


def _sum(one: arb, other: arb) -> arb:
    with exact_sums():
        total = one + other
    return total.mid()


def _at(terms: list[arb_mat], length: arb, z: arb) -> tuple[arb_mat, arb_mat]:
    """Unknowns and rates from their series."""
    x, v = terms[0] + terms[1] * z, terms[1]
    power = z
    for k in range(2, len(terms)):
        v = v + terms[k] * (power * k)
        power = power * z
        x = x + terms[k] * power
    return x, v * (1 / length)
