"""The motion of a column from switch to switch on balls, and how far it may be off.

The centre of the motion is computed in so many digits without radii. One number bounds its distance e from the true
motion in the metric

    e' M e' + e (K + soft^2 M) e,    K of the blocks and of the contacts that are closed,

of which e' M e' + e K e is conserved or lost while no contact changes: in shear also where contacts slip, since
friction is monotone (the distance of two motions never grows in it); in pressure it grows only as a contact closes.
The rest grows at most by exp(soft t / 2). Forces are continuous at a switch, so that what its instant may be off moves
the motion by a term of second order only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, ctx

from fem_reference.events.block_flow import CELLS, CUTS
from fem_reference.events.column_drive import Course
from fem_reference.events.column_flow import (
    CLOSED,
    OPEN,
    SLIPS,
    STICKS,
    Forces,
    Segment,
    Start,
    Watch,
    Watched,
    expand,
    rate_of,
    step_length,
)
from fem_reference.events.column_model import BASE, ColumnModel
from fem_reference.events.enclosure import ball, radius_of
from fem_reference.events.switches import (
    LostDigitsError,
    NoContactStateError,
    Switch,
    TooManySwitchesError,
    Work,
)

FEW = 4
"""Terms that are looked at first where contacts begin at zero: most show at once where they go."""


@dataclass(frozen=True)
class JointSwitch(Switch):
    """A change of a joint; `corner` is its number in words."""

    joint: int = 0  # number of the block above it
    sign: int = 0  # of the rate of slip where it slips, else 0


@dataclass(frozen=True)
class Node:
    """The beginning of a step."""

    start: Start
    states: tuple[int, ...]
    forces: Forces
    error: arb  # norm of the distance from the true motion
    travels: tuple[arb, ...]  # length of the slip of each contact until now [m]


class March:
    """The motion of a column from t = 0 on, node by node."""

    def __init__(self, model: ColumnModel, base: Course, pressure: Course, end: float, limit: int, work: Work) -> None:
        self.model = model
        self.work = work
        self.courses = base, pressure
        self.end = end
        self.limit = limit
        contacts = model.contacts
        zero = arb(0)
        self.start = Start(zero, [zero] * model.size, [zero] * model.size, [zero] * len(contacts))
        self.states = [OPEN if model.unilateral else STICKS for _ in contacts]
        self.travels = [zero for _ in contacts]
        self.slip_starts = [zero for _ in contacts]  # reference where the present slip began
        self.error = zero
        self.offset = zero  # what the instant of the last switch may be off, while the motion stands at it [s]
        self.watches: list[Watch] = []
        self.nodes: list[Node] = []
        self.switches: list[JointSwitch] = []
        self.touches: list[float] = []
        self.resting: set[int] = set()  # joints found at zero gap without force in all derivatives
        self.misses = 0
        self.size = 0.0  # greatest stretch or displacement so far [m]
        self.states_at_start: tuple[int, ...] = ()

    @property
    def _now(self) -> float:
        return float(self.start.time)

    def run(self) -> None:
        """Find the motion.

        Raises
        ------
        HorizonError, NoContactStateError
            If it cannot go on.
        """
        breaks = sorted({t for course in self.courses for t in course.breaks if 0 < t < self.end})
        self.forces = self._forces_from(0.0)
        u = self.model.displacements(self._base(0))
        self._place(arb(0), u, self.model.velocities(self._base(1)))
        self._settle(set(), recording=False)
        self.states_at_start = tuple(self.states)
        for border in [*breaks, self.end]:
            limit = arb(border)
            while self.start.time < limit:
                self._step(limit)
            if border < self.end:
                before = self.forces.base
                self.forces = self._forces_from(border)
                self._kick(before)
                self._settle(set())

    def _forces_from(self, moment: float) -> Forces:
        base, pressure = (course.piece_at(moment)[0] for course in self.courses)
        return Forces(base, pressure)

    def _kick(self, before: object) -> None:
        """A base to which the lowest block is welded passes on a jump of its velocity."""
        coupling = self.model.base_coupling
        if coupling is None or before is self.forces.base:
            return
        time = self.start.time
        old, new = (piece.series(time, 1.0, 2)[1] for piece in (before, self.forces.base))  # type: ignore[attr-defined]
        force = [arb(0)] * self.model.size
        force[0] = coupling * (old - new)
        change = self.model.accelerations(force)
        self._place(time, self.start.u, [v + a for v, a in zip(self.start.v, change, strict=True)])

    def _place(self, time: arb, u: Sequence[arb], v: Sequence[arb], references: Sequence[arb] | None = None) -> None:
        """Stand at a state; the radii of its balls go into the error."""
        bounds = self.model.bounds
        radius = max(radius.upper() for radius in (x.rad() for x in u))
        rate_radius = max(radius.upper() for radius in (x.rad() for x in v))
        self.error = (
            self.error + radius * arb(bounds.displacement_norm) + rate_radius * arb(bounds.velocity_norm)
        ).upper()
        references = self.start.references if references is None else references
        self.start = Start(time, [x.mid() for x in u], [x.mid() for x in v], list(references))

    def _step(self, limit: arb) -> None:
        """One step, up to a switch at most."""
        model = self.model
        start = self.start
        remaining = (limit - start.time).upper()
        length = min(step_length(model, self.states, self.forces), float(remaining) * (1 + 1e-9))
        segment = expand(model, self.states, start, self.forces, length)
        self.work.reach(self._now)
        self.work.add(len(segment.terms) * model.size)
        self.nodes.append(Node(start, tuple(self.states), self.forces, self.error, tuple(self._travels_now())))
        self._measure(segment)
        self._grow(segment)
        acceleration = max((abs(c).upper() for c in segment.terms[2]), default=arb(0)) * 2 / arb(length) ** 2
        rate = rate_of(model, self.states)
        error_at_switch = self._error_at_switch(acceleration)
        watched = Watched(model, self._now, segment, self.watches, rate, self.error, error_at_switch)
        self.offset = arb(0)
        share, width, doubtful = watched.clear()
        whole = ((limit - start.time) / arb(length)).mid()
        if not doubtful:
            self.misses = 0
            self._advance(segment, arb(share), whole, limit)
            self._settle(set())
            return
        high = arb(share + width * CELLS ** min(1 + self.misses, CUTS))
        if high > 1:
            high = arb(1)
        if high > whole:
            high = whole
        touches: list[arb] = []
        falling = None
        if high > share:
            self.work.add(len(segment.terms) * len(doubtful))
            falling = watched.first_fall(share, high, doubtful, touches)
        self.touches += [float(start.time + (arb(share) + touch) * arb(length)) for touch in touches]
        if falling is None:
            self.misses += 1
            self._advance(segment, high, whole, limit)
            self._settle(set())
            return
        self.misses = 0
        fall, watch = falling
        time = start.time + fall.at * arb(length)
        if fall.grazing:
            self.touches.append(float(time))
            centre = fall.at.mid()
        else:
            centre = watched.root_near(watch, fall.at)
        self.offset = arb(radius_of(time)) + abs(time - (start.time + centre * arb(length))).upper()
        self._advance(segment, centre, whole, limit)
        self._blur(watch)
        self._settle({watch.contact})

    def _measure(self, segment: Segment) -> None:
        """Keep the size that displacements have had, and stop where the error is no longer small beside it."""
        sizes = [abs(float(c)) for row in (segment.terms[0], segment.terms[1]) for c in row]
        sizes += [abs(float(stretch[0])) for stretch in segment.stretches]
        self.size = max(self.size, *sizes)
        reach = float((self.error * arb(float(self.model.bounds.displacement_reach().max()))).upper())
        if reach > self.size * 2.0 ** (-ctx.prec // 4):
            raise LostDigitsError(self._now, f"{len(self.switches)} switches have cost most of the digits")

    def _error_at_switch(self, acceleration: arb) -> arb:
        """Error of the motion seen from the switch that it stands at, whose instant may be off as well."""
        bounds = self.model.bounds
        speed = max((abs(v).upper() for v in self.start.v), default=arb(0))
        rate = speed * arb(bounds.displacement_norm) + acceleration * arb(bounds.velocity_norm)
        return (self.error + 2 * rate * self.offset).upper()

    def _grow(self, segment: Segment) -> None:
        """Let the error grow over a step, by itself and by what the series of the drives leaves out."""
        model = self.model
        bounds = self.model.bounds
        span = arb(segment.length)
        base, pressure = segment.drive_tails
        push = arb(0)
        if base > 0:
            stiffness = arb(0)
            for contact in model.contacts:
                if contact.below == BASE:
                    stiffness += contact.stiffness
            for strut in model.struts:
                if strut.below == BASE:
                    stiffness += strut.stiffness + strut.mass / (span * span)
            if model.impedance is not None:
                stiffness += 2 * model.impedance / span
            push += base * stiffness * arb(float(bounds.mobility[0]) ** 0.5)
        if pressure > 0 and model.top != BASE:
            push += pressure * arb(float(bounds.mobility[model.top]) ** 0.5)
        self.error = (self.error * arb(bounds.soft * segment.length / 2).exp() + push * span).upper()

    def _advance(self, segment: Segment, share: arb, whole: arb, limit: arb) -> None:
        """Move to a share of a step, or to its border where the share reaches it."""
        start = self.start
        span = arb(segment.length)
        time = limit if share >= whole else (start.time + share * span).mid()
        at = (time - start.time) / span
        rest = ball(segment.tail)
        u = []
        v = []
        for i in range(self.model.size):
            series = segment.polynomial(i)
            u.append(series(at) + rest)
            v.append((series.derivative()(at) + rest) / span)
        if not time > start.time:
            raise NoContactStateError(f"the states of the joints contradict the motion at {self._now!r} s")
        self._place(time, u, v)

    def _blur(self, watch: Watch) -> None:
        """Put into the error what the centre misses its switch by, and the time in which states may differ."""
        model = self.model
        bounds = self.model.bounds
        contact = model.contacts[watch.contact]
        compliance = arb(float(bounds.compliance[watch.contact]))
        if watch.rate:
            miss = abs(self._rate(watch.contact)).upper() * self.offset
            self.error = (self.error + contact.stiffness.sqrt() * miss).upper()
            return
        miss = abs(self._stretch(watch.contact) * watch.sign + (watch.offset or 0)).upper()
        if not model.unilateral:
            self.error = (self.error + contact.stiffness.sqrt() * miss).upper()
            return
        speed = abs(self._rate(watch.contact)).upper()
        late = contact.stiffness * compliance.sqrt() * (miss + speed * self.offset) * self.offset * 2
        spread = (contact.stiffness * compliance / arb(bounds.soft) * 2 * self.offset).exp()
        self.error = ((self.error + late) * spread).upper()

    def _base(self, order: int) -> arb:
        """Displacement of the base, or its rate."""
        return self.forces.base.series(self.start.time, 1.0, 2)[order]

    def _stretch(self, c: int) -> arb:
        contact = self.model.contacts[c]
        u = self.start.u
        below = self._base(0) if contact.below == BASE else u[contact.below]
        return u[contact.above] - below + contact.gap

    def _rate(self, c: int) -> arb:
        contact = self.model.contacts[c]
        v = self.start.v
        below = self._base(1) if contact.below == BASE else v[contact.below]
        return v[contact.above] - below

    def _travels_now(self) -> list[arb]:
        """Length of all slips until now [m]."""
        travels = []
        for c, contact in enumerate(self.model.contacts):
            travel = self.travels[c]
            if abs(self.states[c]) == SLIPS:
                sign = 1 if self.states[c] > 0 else -1
                travel = travel + abs(self._stretch(c) - sign * contact.reach - self.slip_starts[c]).mid()
            travels.append(travel.mid())
        return travels

    def _at_zero(self, switching: set[int]) -> dict[int, int]:
        """Contacts that may switch now, with the direction of their slip, 0 where they open or close."""
        model = self.model
        bounds = self.model.bounds
        error = self.error
        undecided: dict[int, int] = {}
        for c, contact in enumerate(model.contacts):
            state = self.states[c]
            if model.unilateral:
                y = self._stretch(c)
                reach = bounds.compliance[c] ** 0.5 / bounds.soft
                if c in switching or not abs(y) > error * arb(reach):
                    undecided[c] = 0
                else:
                    self._take(c, OPEN if y > 0 else CLOSED)
            elif contact.strength is None:
                continue
            elif state == STICKS:
                e = self._stretch(c) - self.start.references[c]
                for sign in (1, -1):
                    reserve = contact.reach - sign * e
                    if not reserve > error * arb(bounds.stiffness[c] ** -0.5):
                        undecided[c] = sign
            else:
                sign = 1 if state > 0 else -1
                if c in switching or not sign * self._rate(c) > error * arb(bounds.compliance[c] ** 0.5):
                    undecided[c] = sign
        return undecided

    def _take(self, c: int, state: int) -> None:
        self.next_states[c] = state

    def _settle(self, switching: set[int], recording: bool = True) -> None:
        """Let the contacts take the states that agree with the motion from now on.

        Parameters
        ----------
        switching
            Contacts whose watched function has just fallen to zero.
        recording
            Whether changes are switches; they are not at t = 0.
        """
        model = self.model
        before = list(self.states)
        self.next_states = list(self.states)
        undecided = self._at_zero(switching)
        at_zero = dict(undecided)
        leads: dict[int, int | None] = {}
        count = FEW
        while undecided:
            trial = list(self.next_states)
            for c, sign in undecided.items():
                trial[c] = SLIPS * sign if sign else OPEN
            length = 1.0 / (model.bounds.rate or 1.0)
            segment = expand(model, trial, self.start, self.forces, length, count)
            self.work.add(count * model.size)
            decided = self._directions(segment, undecided)
            if decided:
                for c, (order, sign) in decided.items():
                    self._decide(c, undecided.pop(c), order, sign, leads)
            elif count == FEW:
                count = 2 * model.size + 8
            else:
                # All derivatives that a motion of so many unknowns has are zero: the contact stays as it is.
                for c in undecided:
                    leads[c] = None
                    self._take(c, OPEN if model.unilateral else STICKS)
                    self.resting.add(model.contacts[c].joint)
                break
        self._follow(before, at_zero)
        self._close(before)
        self.states = self.next_states
        self._watch(at_zero, leads)
        if recording:
            self._record(before)

    def _directions(self, segment: Segment, undecided: dict[int, int]) -> dict[int, tuple[int, int]]:
        """Return order and sign of the first derivative in which one of the contacts moves, with all that do in it."""
        acceleration = max((abs(c).upper() for c in segment.terms[2]), default=arb(0)) * 2 / arb(segment.length) ** 2
        error = self._error_at_switch(acceleration) * arb(segment.length)
        growth = arb(1)
        for k in range(1, len(segment.terms)):
            decided: dict[int, tuple[int, int]] = {}
            for c in undecided:
                radius = (error * growth * arb(self.model.bounds.compliance[c] ** 0.5)).upper()
                term = segment.stretches[c][k]
                if abs(term) > radius:
                    decided[c] = k, 1 if term > 0 else -1
            if decided:
                return decided
            growth = growth * 2 / (k + 1)  # (rate + soft) times the length is below 2
        return {}

    def _decide(self, c: int, direction: int, order: int, sign: int, leads: dict[int, int | None]) -> None:
        leads[c] = order
        if self.model.unilateral:
            self._take(c, OPEN if sign > 0 else CLOSED)
        elif sign == direction:
            self._take(c, SLIPS * direction)
        elif self.model.contacts[c].strength == 0:
            self._take(c, -SLIPS * direction)
        else:
            self._take(c, STICKS)

    def _follow(self, before: Sequence[int], at_zero: dict[int, int]) -> None:
        """Take the references of contacts that have slipped along, and begin those of contacts that start to slip."""
        if self.model.unilateral:
            return
        references = list(self.start.references)
        for c, contact in enumerate(self.model.contacts):
            was = before[c]
            now = self.next_states[c]
            if abs(was) == SLIPS and was != now:
                sign = 1 if was > 0 else -1
                reference = self._stretch(c) - sign * contact.reach
                self.error = (self.error + contact.stiffness.sqrt() * reference.rad()).upper()
                references[c] = reference.mid()
                self.travels[c] = (self.travels[c] + abs(references[c] - self.slip_starts[c])).mid()
            if abs(now) == SLIPS and was != now:
                self.slip_starts[c] = references[c]
        self.start = self.start._replace(references=references)

    def _close(self, before: Sequence[int]) -> None:
        """Let the metric of the error take in the springs of contacts that close."""
        if not self.model.unilateral:
            return
        bounds = self.model.bounds
        gain = 1.0
        for c, was in enumerate(before):
            if was == OPEN and self.next_states[c] == CLOSED:
                gain += bounds.stiffness[c] * bounds.compliance[c] / bounds.soft**2 * (1 + 1e-9)
        if gain > 1:
            self.error = (self.error * arb(gain).sqrt()).upper()

    def _watch(self, at_zero: dict[int, int], leads: dict[int, int | None]) -> None:
        """Choose what is watched until the next switch."""
        self.watches = []
        for c, contact in enumerate(self.model.contacts):
            state = self.states[c]
            lead = leads.get(c, 0)
            if self.model.unilateral:
                self.watches.append(Watch(c, False, 1 if state == OPEN else -1, None, lead))
            elif contact.strength is None:
                continue
            elif state == STICKS:
                reference = self.start.references[c]
                for sign in (1, -1):
                    place = lead if at_zero.get(c) == sign or (c in at_zero and contact.strength == 0) else 0
                    self.watches.append(Watch(c, False, -sign, contact.reach + sign * reference, place))
            else:
                sign = 1 if state > 0 else -1
                place = lead - 1 if lead else lead
                self.watches.append(Watch(c, True, sign, None, place))

    def _record(self, before: Sequence[int]) -> None:
        """Add the changes of states to the switches."""
        for c, contact in enumerate(self.model.contacts):
            was = before[c]
            now = self.states[c]
            if was == now:
                continue
            if self.model.unilateral:
                kind = "opens" if now == OPEN else "closes"
            else:
                kind = "sticks" if now == STICKS else "slips"
            sign = 0
            if kind == "slips":
                sign = 1 if now > 0 else -1
            time = self.start.time
            radius = float(self.offset.upper())
            name = "base" if contact.joint == 0 else f"joint {contact.joint}"
            digits = time.str(40, radius=False)
            self.switches.append(JointSwitch(self._now, name, kind, digits, radius, contact.joint, sign))
        if len(self.switches) > self.limit:
            raise TooManySwitchesError(self._now, f"more than {self.limit} switches")
