"""The motion from switch to switch, of a block or a column: steps, settling and recording.

The centre of the motion is computed without radii; how far it may be off is a set that is carried along (`ellipsoid`).

**Switches.** Between two of them the motion is linear, and its Taylor series is summed in balls (`series`). The next
switch is the first instant at which a gap or a normal force falls through zero, the shear force of a contact that
sticks reaches its limit, or the reference of one that slips comes to rest (`contacts`). That it is the first is proven
(`watching`), and that one root lies in the ball of its instant (`enclosure`). What switches in one ball switches
together. Where a function comes so near to zero that a crossing is neither proven nor excluded, its instant is in
`touches`.

**Settling.** At an instant some watched functions are zero, and go the way of their first derivative that is not. What
the state of a contact changes in the motion begins two derivatives above that in which its own function moves. So the
lowest derivative in which any of them falls says which contact does not keep its state, whatever the others do; it
takes the state that this function names, and the next derivative is looked at.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from flint import arb, arb_mat

from fem_reference.events.column_drive import Course, Piece
from fem_reference.events.contacts import CARRIES_NOTHING, NORMAL, OPEN, RELEASED, STICKS, States, Watch
from fem_reference.events.ellipsoid import Ellipsoid
from fem_reference.events.enclosure import ZERO, radius_of
from fem_reference.events.series import Segment, Start, System, expand, step_length
from fem_reference.events.switches import (
    NoContactStateError,
    Switch,
    TooManySwitchesError,
    Work,
)
from fem_reference.events.watching import CELLS, CUTS, Change, Reach, Watched
from fem_reference.problem.problem import Array

FEW = 4  # terms that are looked at first where functions begin at zero: most show at once where they go


class Node(NamedTuple):
    """The beginning of a step."""

    start: Start
    states: States
    drives: Sequence[Piece]  # what moves the base, or drives the motion, until the next break
    pieces: Sequence[Piece]  # those of them that the model knows
    error: Array  # how far unknowns, rates and references may be off


class March:
    """The motion from t = 0 on, node by node."""

    seen_from_base = False  # whether what moves is counted from its base, so that its model knows of no drives

    def __init__(self, model: System, end: float, limit: int, work: Work) -> None:
        self.model = model
        self.transport = Ellipsoid(model)
        self.end = end
        self.limit = limit
        self.work = work
        self.states: States = ()
        self.courses: Sequence[Course] = ()  # of the base and of the pressure, or of the base in two directions
        self.drives: Sequence[Piece] = ()  # their present pieces
        self.pieces: Sequence[Piece] = ()  # those that the model knows: all, or none of what is seen from its base
        self.offset = 0.0  # what the instant of the last switch may be off, while the motion stands at it [s]
        self.watches: list[Watch] = []
        self.nodes: list[Node] = []
        self.switches: list[Switch] = []
        self.touches: list[float] = []  # instants at which a crossing is neither proven nor excluded [s]
        self.resting: set[int] = set()  # contacts found at zero without force in all derivatives
        self.misses = 0  # times in succession that a fall was looked for in vain

    # ---- what a block or a column says of itself ----

    def initial(self) -> tuple[Start, States]:
        """Where the motion begins, and the states of contacts whose functions rest there."""
        raise NotImplementedError

    def jump(self, rates: Sequence[arb]) -> arb_mat:
        """What the rates of the unknowns jump by where those of the drives fall."""
        raise NotImplementedError

    def check_work(self) -> None:
        """Stop before a step where the motion takes too many."""

    def strike(self, touches: bool) -> arb_mat | None:
        """Let the rates jump by an impact, if there is one now; return the matrix by which they do."""
        return None

    def follow_impact(self) -> None:
        """Go on from an impact."""

    # ---- the march ----

    @property
    def now(self) -> float:
        """The present instant [s]."""
        return float(self.start.time)

    def run(self) -> None:
        """Find the motion; raises a `HorizonError` or `NoContactStateError` where it cannot go on."""
        self.take_drives(0.0)
        start, self.states = self.initial()
        self.start = start
        self.place(start.time, start.u, start.v)
        impact = self.strike(touches=False)
        self.settle({}, recording=False)
        if impact is not None:
            self.follow_impact()
        self.switches = [switch for switch in self.switches if switch.time > 0]
        borders = sorted({time for course in self.courses for time in course.breaks if 0 < time < self.end})
        for border in [*borders, self.end]:
            limit = arb(border)
            while self.start.time < limit:
                self.check_work()
                self.step(limit)
            if border < self.end:
                self.take_drives(border)
                self.switch()

    def take_drives(self, moment: float) -> None:
        """Take the drives from an instant on, and what velocities jump with them."""
        before = self.drives
        self.drives = tuple(course.piece_at(moment) for course in self.courses)
        self.pieces = () if self.seen_from_base else self.drives
        if before:
            time = self.start.time
            old, new = ([piece.series(time, 1.0, 2)[1] for piece in drives] for drives in (before, self.drives))
            falls = [old_rate - new_rate for old_rate, new_rate in zip(old, new, strict=True)]
            self.place(time, self.start.u, self.start.v + self.jump(falls))

    def place(self, time: arb, u: arb_mat, v: arb_mat) -> None:
        """Stand at a state; the radii of its balls go into what it may be off."""
        radii = [x.rad() for part in (u, v) for x in part.entries()]
        self.transport.take([*radii, *[ZERO] * len(self.model.contacts)])
        self.start = Start(time, u.mid(), v.mid(), self.start.references)

    def add_node(self) -> None:
        """Keep the state as the beginning of a step."""
        self.nodes.append(Node(self.start, self.states, self.drives, self.pieces, self.transport.record()))

    def step(self, limit: arb) -> None:
        """One step, up to a switch at most."""
        self.follow()  # so that a node has the reference of each contact as it is
        start = self.start
        remaining = (limit - start.time).upper()
        length = min(step_length(self.model, self.states, self.pieces), float(remaining) * (1 + 1e-9))
        segment = expand(self.model, self.states, start, self.pieces, length)
        self.work.reach(self.now)
        self.work.add(segment.count * self.model.size)
        self.add_node()
        offset = self.offset
        states = self.states

        def reach(watch: Watch, at_switch: bool) -> Reach:
            return self.transport.reach(watch, states, segment, offset if at_switch else 0.0)

        watched = Watched(self.now, segment, self.watches, reach)
        self.offset = 0.0
        share, width, doubtful = watched.clear()
        whole = ((limit - start.time) / arb(length)).mid()
        if not doubtful:
            self.misses = 0
            self.advance(segment, arb(share), whole, limit)
            if any(watch.lead is None for watch in self.watches):
                self.switch()
            else:
                self.watches = [watch._replace(lead=0) for watch in self.watches]  # all are proven to be positive
            return
        # Balls look at a part that is longer than the one in doubt, and where they have looked in vain at a longer one.
        high = min(arb(share + width * CELLS ** min(1 + self.misses, CUTS)), arb(1), whole)
        touches: list[arb] = []
        falling = None
        if high > share:
            self.work.add(segment.count * len(doubtful))
            falling = watched.first_fall(share, high, doubtful, touches)
        self.touches += [float(start.time + (arb(share) + touch) * arb(length)) for touch in touches]
        if falling is None:
            self.misses += 1
            self.advance(segment, high, whole, limit)
            self.switch()
            return
        self.misses = 0
        fall, watch = falling
        time = start.time + fall.at * arb(length)
        centre = fall.at.mid()
        if fall.grazing:
            self.touches.append(float(time))
        else:
            centre = watched.root_near(watch, fall.at)
        self.offset = radius_of(time) + float(abs(time - (start.time + centre * arb(length))).upper())
        value, slope = segment.value_and_slope(watch, centre)
        self.advance(segment, centre, whole, limit)
        self.switch(watch, value, slope, fall.grazing)

    def advance(self, segment: Segment, share: arb, whole: arb, limit: arb) -> None:
        """Move to a share of a step, or to its border where the share reaches it."""
        start = self.start
        span = arb(segment.length)
        time = limit if share >= whole else (start.time + share * span).mid()
        at = (time - start.time) / span
        if not time > start.time:
            raise NoContactStateError(f"the states of the contacts contradict the motion at {self.now!r} s")
        u, v = segment.state(at)
        self.transport.advance(self.states, time - start.time)
        self.place(time, u, v)

    def switch(self, watch: Watch | None = None, value: arb = ZERO, slope: arb = ZERO, grazing: bool = False) -> None:
        """Let the contacts take the states that agree with the motion, after a fall or where there may be one."""
        before = self.start
        was = self.states
        radii = self.follow()
        impact = self.strike(touches=watch is not None)
        self.settle({} if watch is None else {(watch.contact, watch.side): 1 + watch.order})
        if watch is None and was == self.states and impact is None:
            return
        change = Change(before, self.start, was, self.states, watch, value, slope, grazing, self.offset, radii, impact)
        self.transport.switch(change, self.pieces)
        if impact is not None:
            self.follow_impact()

    def follow(self) -> list[arb]:
        """Take the references of contacts along that do not stick; return the radii that they leave out."""
        radii = [ZERO] * len(self.states)
        moving = [
            c for c, state in enumerate(self.states) if state != STICKS and self.model.contacts[c].slide is not None
        ]
        if not moving:
            return radii
        references = list(self.start.references)
        rows = self.model.values(self.start, self.pieces)
        for c in moving:
            reference = self.model.contacts[c].reference(self.states[c], rows)
            radii[c] = reference.rad()
            references[c] = reference.mid()
        self.start = self.start._replace(references=references)
        return radii

    # ---- settling ----

    def settle(self, zeros: Mapping[tuple[int, int], int], recording: bool = True) -> None:
        """Let the contacts take the states that agree with the motion from now on, or raise `NoContactStateError`.

        The changes are switches if `recording`, which they are not at t = 0.

        Parameters
        ----------
        zeros
            Of contact and side of a watched function how many derivatives of displacements are zero in it.
        """
        model = self.model
        was = self.states
        known = dict(zeros)
        length = 1.0 / model.rate((STICKS,) * len(model.contacts))
        most = 2 * model.size + 8
        count = 3 if self.offset else 2  # what the instant is off counts with the accelerations
        changes = 0
        while True:
            watches = list(model.watches(self.states, self.start.references))
            segment = expand(model, self.states, self.start, self.pieces, length, count)
            if count >= FEW:
                self.work.add(count * model.size)
            found = [self._lead(watch, segment, known) for watch in watches]
            falling = [
                (lead + watch.order, watch)
                for watch, (lead, sign) in zip(watches, found, strict=True)
                if lead is not None and sign < 0
            ]
            if falling:
                lowest = min(order for order, _ in falling)
                changes += 1
                if (recording and lowest == 0) or changes > 4 * len(model.contacts) + 4:
                    raise NoContactStateError(f"no state of the contacts agrees with the motion at {self.now!r} s")
                for order, watch in falling:
                    if order == lowest:
                        known[watch.contact, watch.side] = order
                        self.states = model.changed(self.states, watch)
            elif count < most and any(lead is None for lead, _ in found):
                count = FEW if count < FEW else most
            else:
                break
        self.watches = [watch._replace(lead=lead) for watch, (lead, _) in zip(watches, found, strict=True)]
        self.resting |= {watch.contact for watch in self.watches if watch.lead is None and watch.side == NORMAL}
        if recording:
            self.record(was)

    def _lead(self, watch: Watch, segment: Segment, known: Mapping[tuple[int, int], int]) -> tuple[int | None, int]:
        """The number of the first term of a function that is not zero, and its sign; None: all are."""
        terms = segment.function(watch)
        reaches = self.transport.reach(watch, self.states, segment, self.offset).terms()
        zeros = known.get((watch.contact, watch.side), 0) - watch.order
        for k, (term, reach) in enumerate(zip(terms, reaches, strict=True)):
            if k >= zeros and abs(term) > reach:
                return k, 1 if term > 0 else -1
        return None, 0

    def record(self, was: Sequence[int]) -> None:
        """Add the changes of states to the switches."""
        for c, before in enumerate(was):
            now = self.states[c]
            if before == now or {before, now} == {
                OPEN,
                RELEASED,
            }:  # a released contact carries as little as an open one
                continue
            kind = "sticks" if now == STICKS else "slips"
            if before in CARRIES_NOTHING:
                kind = "closes"
            elif now in CARRIES_NOTHING:
                kind = "opens"
            self.add_switch(c, kind)

    def add_switch(self, contact: int, kind: str) -> None:
        """Record a change of a contact at this instant."""
        sign = self.states[contact] // 2 if kind == "slips" else 0
        midpoint = self.start.time.str(40, radius=False)
        joint = self.model.contacts[contact]
        self.switches.append(Switch(self.now, joint.name, kind, midpoint, self.offset, joint.number, sign))
        if len(self.switches) > self.limit:
            raise TooManySwitchesError(self.now, f"more than {self.limit} switches")
