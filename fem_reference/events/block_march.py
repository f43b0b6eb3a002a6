"""The block's motion from switch to switch on balls, and how far it may be off.

The centre of the motion is computed in so many digits, without radii; `Spread` holds what separates it from the true
motion: rounding, and the radii of the instants of the switches.

An impact on a rigid contact is a linear map of the state, `RigidContact.impact`, at an instant that is enclosed like
that of a switch. Where impacts follow each other as short hops they are followed in balls, without `Spread`, until they
are over or until infinitely many of them are proven to accumulate (`block_impacts`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat, ctx

from fem_reference.events.block_flow import ANGLE, CELLS, CUTS, SIZE, UNIT, Flow, to_floats
from fem_reference.events.block_impacts import Accumulation, Hops, box, norm
from fem_reference.events.block_model import (
    CARRIES_NOTHING,
    CORNERS,
    OPEN,
    RELEASED,
    STICKS,
    Base,
    BlockModel,
    Course,
    RigidContact,
    States,
)
from fem_reference.events.block_switching import Flows, agreeing, lead, settled
from fem_reference.events.enclosure import Fall, ball, first_fall, is_blank, polynomial, precision, radius_of
from fem_reference.events.switches import (
    AccumulationError,
    Cascade,
    Impact,
    LostDigitsError,
    NoContactStateError,
    Switch,
    TooManySwitchesError,
    TooMuchWorkError,
)
from fem_reference.problem.problem import Array

STEPS = 60_000
"""Greatest number of steps of `ANGLE` radians; as many of a block at rest on p = 1e18 N/m took 18 s and 90 MB."""
IDLE = 500
"""Steps without a switch after which a motion that would take too many steps is given up."""
REGULAR = 8
"""Moves after which the axes of the box of a `Spread` are made orthogonal again."""
REACH = 1 + 1e-6
"""Part of a step over which no further one is begun: the last step to a row is longer than others by rounding."""
TAIL_BITS = 0.3
"""Part of the working bits to which hops are followed before the rest of them is enclosed at once."""
INSTANT = 1e-18
"""Part of the end of the motion below which a hop has no node of its own: no float tells its instants apart."""
INFLATION = 1 + 1e-9
"""What covers the rounding of the floats that bound radii."""


class Spread:
    """A set that holds z less its centre: axes times a box, plus a box, Lohner's method.

    Each move turns the axes of the box by its own matrix, so that the box does not grow by being wrapped into the axes
    of z move after move.
    """

    def __init__(self, flows: Flows) -> None:
        # In the metric of the energy of the closed block the motion of most states is nearly a rotation.
        model = flows.model
        closed = flows[STICKS, STICKS]
        mass = np.array([float(m) for m in model.mass])
        normal = np.array(model.normal, dtype=float)
        shear = np.array(model.shear, dtype=float)
        stiffness = to_floats(arb_mat(model.elastic)) + 1e-4 * closed.rate**2 * np.diag(mass)
        stiffness += float(model.p) * normal.T @ normal + float(model.ps) * shear.T @ shear
        self.metric = np.eye(SIZE)
        self.metric[:6, :6] = np.linalg.cholesky((stiffness + stiffness.T) / 2).T
        self.metric[6:12, 6:12] = np.diag(np.sqrt(mass))
        self.metric[12:14, 12:14] *= np.sqrt(float(model.ps) + float(model.p) * 1e-4) or 1.0
        self.inverse = np.linalg.inv(self.metric)
        self.axes = self.inverse.copy()
        self.radii = np.zeros(SIZE)
        self.box = np.zeros(SIZE)
        self.count = 0

    def hull(self) -> Array:
        """Greatest distances from the centre, shape (15,)."""
        return np.asarray((np.abs(self.axes) @ self.radii + self.box) * INFLATION)

    def radius(self, row: Array) -> float:
        """Greatest value of a row over z, less that at the centre."""
        return float((np.abs(row @ self.axes) @ self.radii + np.abs(row) @ self.box) * INFLATION)

    def restart(self, radii: Array) -> None:
        """Make the set a box."""
        self.axes = UNIT.copy()
        self.radii = radii
        self.box = np.zeros(SIZE)

    def transport(self, J: Array, added: Array) -> None:
        """Turn the set by a matrix, and add a box that holds what its floats may be wrong by."""
        self.box = (np.abs(J) @ self.box + added) * INFLATION
        self.axes = J @ self.axes
        self.count += 1
        if self.count % REGULAR == 0:
            self._make_orthogonal()

    def _make_orthogonal(self) -> None:
        """Put the box into the axes, and make these orthogonal, the longest one first."""
        scaled = self.metric @ self.axes * self.radii
        lengths = np.sqrt((scaled**2).sum(axis=0))
        largest = lengths.max()
        Q = UNIT
        R = np.zeros((SIZE, SIZE))
        if largest > 0:
            Q, R = np.linalg.qr(scaled[:, np.argsort(-lengths)] / largest)
        radii = np.abs(R).sum(axis=1) * largest + np.abs(Q.T) @ (np.abs(self.metric) @ self.box)
        self.radii = radii * INFLATION + 1e-11 * radii.sum()
        self.axes = self.inverse @ Q
        self.box = np.zeros(SIZE)


@dataclass(frozen=True)
class Node:
    """The beginning of a step."""

    start: arb  # exact [s]
    states: States  # of the corners M and N from now on
    z: arb_mat  # the state as seen from the base, see `Flow`, midpoints
    radius: Array  # how far it may be off, shape (15,)
    base: Base  # the base at the last row of its record
    row_time: arb  # and the instant of that row [s]
    slipped: tuple[arb, arb]  # movement of each reference by slipping until now [m]
    released: arb  # energy of the shear springs lost by opening until now [J]
    dissipated: arb  # energy lost by friction, in dashpots or by impacts until now [J]
    work: arb  # work of the base until now [J]


class March:
    """The motion of a block from t = 0 on, node by node."""

    def __init__(self, model: BlockModel, course: Course, gap: float, end: float, limit: int) -> None:
        self.model = model
        self.course = course
        self.gap = arb(gap)
        self.end = end
        self.limit = limit
        self.flows = Flows(model)
        self.nodes: list[Node] = []
        self.switches: list[Switch] = []
        self.impacts: list[Impact] = []
        self.cascades: list[Cascade] = []
        self.leads: list[int | None] = []  # zeros with which the watched functions begin, see `Step.clear`
        self.last_switch = 0  # nodes before the last switch
        self.touches: list[float] = []  # instants at which a crossing is neither proven nor excluded [s]
        self.misses = 0  # times in succession that a fall was looked for in vain
        self.time = arb(0)
        self.slipped = [arb(0), arb(0)]
        self.released = arb(0)
        self.dissipated = arb(0)
        self.work = arb(0)

    def run(self, velocity: float | arb) -> None:
        """Find the motion from a velocity of the block at t = 0 [m/s], which may be a ball.

        Raises
        ------
        HorizonError, NoContactStateError
            If it cannot go on.
        """
        row, self.base = self.course.at_start()
        self.row_time = arb(0)
        still = [arb(0)] * 4
        slide = -self.base.x
        x = [slide, self.gap - self.base.y, *still]
        v = [-self.base.vx, arb(velocity) - self.base.vy, *still]
        self.spread = Spread(self.flows)
        self._place(arb_mat(SIZE, 1, [*x, *v, slide, slide, arb(1)]))
        is_open = x[1] > 0 and not self.model.locked  # a base that begins below the block pulls at a locked one
        self.states: States = (OPEN, OPEN) if is_open or self.model.contact else (STICKS, STICKS)
        if self.model.locked and self._steps_left() > STEPS:
            self._stop_for_work()  # before the first step: corners that never change cannot shorten the work
        if self._strikes(self._balls(self.spread.hull())):
            self._switch(self.flows[self.states], None)
        elif not self.model.locked:
            self._settle(self.flows[self.states], self.spread.hull(), 0.0)
        self.switches = [switch for switch in self.switches if switch.time > 0]
        first_states = self.nodes[0].states if self.nodes else self.states  # impacts at t = 0 may have led on by hops
        self.closed_at_start = tuple(state != OPEN for state in first_states)
        times = self.course.motion.time
        while True:
            following = row + 1
            last = following >= len(times) or times[following] >= self.end
            row_end = self.end if last else times[following]
            self._cross(arb(row_end), row_end - float(self.row_time))
            if last:
                return
            before = self.base
            self.base = self.course.from_row(following)
            row = following
            self.row_time = arb(row_end)
            change = [arb(0)] * SIZE
            change[6:8] = before.vx - self.base.vx, before.vy - self.base.vy
            self._place(self.z + arb_mat(SIZE, 1, change))

    def _place(self, z: arb_mat) -> None:
        """Take a state; its radii go into the spread."""
        self.spread.box = self.spread.box + radii_of(z)
        self.z = z.mid()

    def _cross(self, row_end: arb, span: float) -> None:
        """Go on to the end of a row of the base's record."""
        while self.time < row_end:
            idle = len(self.nodes) - self.last_switch > IDLE
            if len(self.nodes) >= STEPS or (idle and self._steps_left() > STEPS):
                self._stop_for_work()
            self.step(row_end, span)

    def _steps_left(self) -> float:
        """Steps to the end if no corner switches any more."""
        return (self.end - float(self.time)) * self.flows[self.states].rate / ANGLE

    def _stop_for_work(self) -> None:
        reason = f"{STEPS} steps of {ANGLE:g} radians are the limit, and {self._steps_left():.3g} more would be needed"
        rate = self.flows[self.states].rate
        within = float(self.time) + (STEPS - len(self.nodes)) * ANGLE / rate
        raise TooMuchWorkError(within, f"{reason}, since the block oscillates at {rate:.3g} rad/s")

    def step(self, row_end: arb, span: float) -> None:
        """One step, up to a switch at most."""
        flow = self.flows[self.states]
        length = flow.step_length(span)
        end = exact_sum(self.time, arb(length))
        if difference(row_end, self.time) < length * REACH:
            end = row_end
        length = float(difference(end, self.time))
        radius = self.spread.hull()
        self._add_node(radius)
        share, width, doubtful = flow.clear(self.z, radius, self.leads, length)
        if not doubtful:
            self.misses = 0
            self._advance(flow, end if share == 1 else exact_sum(self.time, arb(share * length)))
            return
        if share == 0 and agreeing(flow, self._balls(radius)) is None:
            self._switch(flow, None)
            return
        # Balls look at a part that is longer than the one in doubt, and where they have looked in vain at a longer one.
        reach = share + width * CELLS ** min(1 + self.misses, CUTS)
        if reach < 1:
            end = exact_sum(self.time, arb(reach * length))
        if share > 0:
            self._advance(flow, exact_sum(self.time, arb(share * length)))
        fall = self.first_fall(flow, end, doubtful)
        if fall is None:
            self.misses += 1
            self._advance(flow, end)
        else:
            self._switch(flow, fall)

    def _add_node(self, radius: Array) -> None:
        slipped = self.slipped[0], self.slipped[1]
        losses = self.released, self.dissipated, self.work
        self.nodes.append(Node(self.time, self.states, self.z, radius, self.base, self.row_time, slipped, *losses))

    def _advance(self, flow: Flow, end: arb) -> None:
        """Move to an instant."""
        length = difference(end, self.time)
        moved = flow.advance(self.z, length)
        self.work = (self.work + self.model.base_work(self.base, self.z, moved, length)).mid()
        if flow.dissipates:
            self.dissipated = (self.dissipated + flow.energy(self.z) - flow.energy(moved)).mid()
        J = flow.sensitivity(length)
        self.spread.transport(J, radii_of(moved) + flow.exponential_error(J, self.spread.hull()))
        self.z = moved.mid()
        self.time = end
        self.leads = [0] * len(flow.watched)

    def _balls(self, radius: Array) -> arb_mat:
        """The state with what it may be off."""
        return arb_mat(SIZE, 1, [c + ball(r) for c, r in zip(self.z.entries(), radius.tolist(), strict=True)])

    def first_fall(self, flow: Flow, end: arb, doubtful: list[int]) -> tuple[Fall, arb_mat] | None:
        """The first fall of some watched functions that do not fall at once, in units of 1 / rate, and the function."""
        radii = arb_mat(SIZE, 1, [ball(r) for r in self.spread.hull().tolist()])
        angle = (difference(end, self.time) * flow.rate).upper()
        first: tuple[Fall, arb_mat] | None = None
        for i in doubtful:
            c = flow.coefficients(i, self.z, radii, float(angle))
            # as large as the function would be over a whole step
            size = max(float(c[0].abs_upper()), ANGLE * float(c[1].abs_upper()))
            if radius_of(c[0]) > size * 2.0 ** (-ctx.prec // 3):
                raise LostDigitsError(float(self.time), f"{len(self.switches)} switches have cost most of the digits")
            place = lead(c)
            if place is None:
                continue
            touches: list[arb] = []
            fall = first_fall(polynomial(c[place:], angle), angle, touches)
            self.touches += [float(exact_sum(self.time, touch / flow.rate)) for touch in touches]
            if fall is not None:
                angle = fall.at.mid()
                first = fall, flow.watched[i]
        return first

    def _switch(self, flow: Flow, first: tuple[Fall, arb_mat] | None) -> None:
        """Move to the first fall of a watched function, and let the corners take the states that agree.

        Parameters
        ----------
        flow
            Of the states until now.
        first
            What `first_fall` returns; None: a function falls from now on.
        """
        self.misses = 0
        offset = 0.0
        moved = arb(0)
        timing = None
        if first is not None:
            fall, function = first
            with precision(4 * ctx.prec):
                enclosure = self.time + fall.at / flow.rate
            offset = radius_of(enclosure)
            if fall.grazing:
                self.touches.append(float(enclosure))
            moved = difference(enclosure.mid(), self.time)
            self._advance(flow, enclosure.mid())
            rate = (function * (flow.G * self.z))[0, 0]
            if not (fall.grazing or rate.contains(0)):
                timing = function * (1 / rate.mid())
        # Slipping, or an open corner's slide, has taken the references along.
        P = UNIT.copy()
        entries = self.z.entries()
        for c, reference in enumerate(flow.references):
            if self.states[c] != STICKS:
                entries[12 + c] = (reference * self.z)[0, 0]
                P[12 + c] = to_floats(reference)
                if self.states[c] != OPEN:
                    self.slipped[c] = (self.slipped[c] + entries[12 + c] - self.z[12 + c, 0]).mid()
        before = self.z
        states = self.states
        hull = self.spread.hull()
        rates = np.array([float(x.abs_upper()) for x in (flow.G * before).entries()])
        uncertain = hull + rates * offset * INFLATION
        z = arb_mat(SIZE, 1, entries)
        contact = self.model.contact
        strikes = self._strikes(self._balls(uncertain))
        if strikes and contact is not None:
            self._add_impact(contact, -(contact.rate * z)[0, 0], offset)
            impact = contact.impact()
            z = impact * z
            P = to_floats(impact) @ P
        self._place(z)
        self._settle(flow, np.abs(P) @ uncertain + self.spread.box, offset)
        if strikes:
            if self.states == (OPEN, OPEN):
                self._add_rebound(offset)
        elif self.states == states and (first is None or moved < self.end * 2.0 ** (-ctx.prec // 2)):
            raise NoContactStateError(f"the state of the corners contradicts the motion at {float(self.time)!r} s")
        if all(was != now for was, now in zip(states, self.states, strict=True)):
            timing = None  # the two need not switch at one instant of the ball
        change = P @ np.array([float(x) for x in (flow.G * before).entries()])
        change -= np.array([float(x) for x in (self.flows[self.states].G * self.z).entries()])
        self._blur(flow, P, timing, change, offset, np.abs([float(x) for x in before.entries()]) + hull)
        if strikes and contact is not None and 0 < contact.restitution < 1:
            self._follow_hops(contact, offset)

    def _blur(self, flow: Flow, P: Array, timing: arb_mat | None, change: Array, offset: float, size: Array) -> None:
        """Move the spread over a switch, whose instant depends on where in it the motion is.

        The function that falls does so after -g z, `timing` being the row g, and until then z' is that of the former
        flow, which changes z by `change` times this time; terms of second order in the time are bounded by the sizes
        of z. P is what the switch itself makes of z.
        """
        before = np.abs(flow.G_floats)
        after = np.abs(self.flows[self.states].G_floats)
        into = np.abs(P)
        fast = before @ size
        turned = into @ before + after @ into
        second = (into @ (before @ fast) + 2 * after @ (into @ fast) + after @ (after @ (into @ size))) * offset**2
        jump = np.abs(change)
        hull = self.spread.hull()
        M = P
        if timing is None:
            second += 2 * jump * offset
        else:
            g = to_floats(timing)[0]
            M = P - np.outer(change, g)
            late = np.abs(g) @ (before @ fast * offset**2 + 2 * before @ hull * offset)
            late += float(abs((timing * self.z)[0, 0]).upper())
            second += jump * late + turned @ hull * offset
        self.spread.transport(M, second * INFLATION)

    def _settle(self, flow: Flow, radius: Array, offset: float) -> None:
        """Let the corners take the states that agree with the motion, which may be off by a radius."""
        now, self.leads = settled(self.flows, self.states, self._balls(radius), float(self.time))
        for c in (0, 1):
            was = self.states[c]
            if was == now[c]:
                continue
            if {was, now[c]} == {OPEN, RELEASED}:
                continue  # a released corner carries as little as an open one
            if now[c] in CARRIES_NOTHING:
                stretch = (flow.stretches[c] * self.z)[0, 0]
                self.released = (self.released + self.model.ps * stretch * stretch / 2).mid()
            kind = "sticks" if now[c] == STICKS else "slips"
            if was in CARRIES_NOTHING:
                kind = "closes"
            elif now[c] in CARRIES_NOTHING:
                kind = "opens"
            self._add_switch(CORNERS[c], kind, offset)
        self.states = now
        self.last_switch = len(self.nodes)

    def _add_switch(self, corner: str, kind: str, offset: float) -> None:
        midpoint = self.time.str(40, radius=False)
        self.switches.append(Switch(float(self.time), corner, kind, midpoint, offset))
        if len(self.switches) > self.limit:
            raise TooManySwitchesError(float(self.time), f"more than {self.limit} switches")

    def _strikes(self, z: arb_mat) -> bool:
        """Whether the gap of a rigid contact is zero and closes."""
        contact = self.model.contact
        if contact is None or self.states != (OPEN, OPEN) or not is_blank((contact.gap * z)[0, 0]):
            return False
        rate = (contact.rate * z)[0, 0]
        return bool(rate < 0) and not is_blank(rate)

    def _add_impact(self, contact: RigidContact, approach: arb, offset: float) -> None:
        """Record an impact at this instant, and what it loses."""
        midpoint = self.time.str(40, radius=False)
        impulse = float(contact.impulse(approach))
        self.impacts.append(Impact(float(self.time), float(approach), impulse, midpoint, offset))
        self.dissipated = (self.dissipated + contact.loss(approach)).mid()

    def _add_rebound(self, offset: float) -> None:
        """Record that both corners touch for an instant."""
        for kind in ("closes", "opens"):
            for corner in CORNERS:
                self._add_switch(corner, kind, offset)

    def _follow_hops(self, contact: RigidContact, offset: float) -> None:
        """Follow impacts that hops lie between, from right after one on.

        It ends where a hop is long, or not proven to be concave, or leads beyond the end, or where all hops that are
        left are shorter together than the digits can tell: these are enclosed, and the contact rests after them.
        """
        flow = self.flows[OPEN, OPEN]
        hops = Hops(flow, contact)
        e = contact.restitution
        time = self.time + ball(offset)
        z = self._balls(self.spread.hull())
        speed = (contact.rate * self.z)[0, 0] + ball(self.spread.radius(to_floats(contact.rate)[0]))
        speed = speed + (contact.rate * flow.G * z)[0, 0] * ball(offset)
        cascade_start: float | None = None
        impulse = arb(0)
        finest = arb(2) ** (-TAIL_BITS * ctx.prec) / flow.rate
        length = arb(self.end)
        while True:
            if is_blank(speed):
                raise LostDigitsError(float(time), "impacts have cost most of the digits")
            landed = z + flow.G * z * ball(radius_of(time))  # at the instant of the impact, no longer at its midpoint
            if cascade_start is None or length < finest:
                rest = hops.find_accumulation(landed, speed)
                if rest is not None and time + rest.length < self.end:
                    if cascade_start is None:
                        cascade_start = float(time)
                    if rest.length < finest:
                        impulse = impulse + contact.impulse(rest.speeds)
                        self._rest_after(hops, rest, z, time)
                        midpoint = self.time.str(40, radius=False)
                        enclosure = midpoint, self.switches[-1].radius
                        self.cascades.append(Cascade(cascade_start, float(self.time), float(impulse), *enclosure))
                        return
            hop = hops.find_hop(landed, speed)
            if hop is None or not time + hop.length < self.end:
                return
            length = hop.length
            if cascade_start is None and length < self.end * 2.0 ** (-ctx.prec // 2):
                reason = "impacts follow each other ever faster, and that they accumulate is not proven"
                raise AccumulationError(float(time), f"{reason}; another restitution or load, however near, may do")
            if length > self.end * INSTANT:
                self._add_node(self.spread.hull())
            time = time + length
            moved = flow.series(z, difference(time.mid(), self.time))
            z = hops.pushed(moved, hop.approach, time.rad())
            speed = e * hop.approach
            self.spread.restart(radii_of(z))
            self.z = z.mid()
            self.time = time.mid()
            self.leads = [1]
            self.last_switch = len(self.nodes)
            if cascade_start is None:
                self._add_impact(contact, hop.approach, radius_of(time))
                self._add_rebound(radius_of(time))
            else:
                impulse = impulse + contact.impulse(hop.approach)
                self.dissipated = (self.dissipated + contact.loss(hop.approach)).mid()

    def _rest_after(self, hops: Hops, rest: Accumulation, z: arb_mat, time: arb) -> None:
        """Take the state in which the impacts that are left accumulate, and let the contact rest.

        Parameters
        ----------
        hops, rest
            What they come to.
        z
            Balls for the state after the last impact that was followed, at the present midpoint of its instant.
        time
            That instant [s].
        """
        flow = hops.flow
        self._add_node(self.spread.hull() + radii_of(box(flow, rest.reach)) * INFLATION)
        time = time + rest.length
        offset = radius_of(time)
        z = flow.series(z, difference(time.mid(), self.time))
        z = hops.pushed(z, rest.speeds, rest.length.upper() + 2 * time.rad())
        second_order = 2 * (hops.rate * time.rad()) ** 2 * norm(flow, flow.G * z) / hops.rate
        z = z + box(flow, second_order.upper())
        entries = z.entries()
        for c, reference in enumerate(flow.references):  # springs aside begin where the corners are
            entries[12 + c] = (reference * z)[0, 0]
        z = arb_mat(SIZE, 1, entries)
        self.spread.restart(radii_of(z))
        projection = hops.contact.rest()
        self.z = z.mid()
        self.spread.transport(to_floats(projection), np.zeros(SIZE))
        self._place(projection * self.z)
        self.time = time.mid()
        self._settle(flow, self.spread.hull(), offset)
        if self.states != (STICKS, STICKS):
            raise NoContactStateError(f"the contact does not rest after the impacts at {float(self.time)!r} s")


def radii_of(vector: arb_mat) -> Array:
    """Radii of the entries."""
    return np.array([radius_of(entry) for entry in vector.entries()])


def difference(one: arb, other: arb) -> arb:
    """An exact difference of instants."""
    with precision(4 * ctx.prec):
        return (one - other).mid()


def exact_sum(one: arb, other: arb) -> arb:
    """An exact sum of instants."""
    with precision(4 * ctx.prec):
        total = one + other
    return total.mid()
