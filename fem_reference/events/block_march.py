"""The motion of a block from switch to switch, with the base below it and impacts on a rigid contact.

The instant of an impact is enclosed like that of a switch. Where impacts follow each other as short hops, each number
is followed in its own ball until they are over or proven to accumulate (`block_impacts`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import arb, arb_mat, ctx
from scipy.linalg import block_diag

from fem_reference.events.block_impacts import Accumulation, Hops, State
from fem_reference.events.block_model import ANGLE, BlockModel, BlockProblem, RigidContact
from fem_reference.events.column_drive import path
from fem_reference.events.contacts import NORMAL, OPEN, STICKS, States
from fem_reference.events.enclosure import ZERO, ball, precision, radius_of
from fem_reference.events.march import March, Node
from fem_reference.events.series import INFLATION, Start, column, floats
from fem_reference.events.switches import (
    AccumulationError,
    Cascade,
    Impact,
    LostDigitsError,
    NoContactStateError,
    TooMuchWorkError,
    Work,
)
from fem_reference.problem.motion import Motion
from fem_reference.problem.problem import Array

# Most steps of `ANGLE` radians; as many of a block at rest on p = 1e18 N/m took 18 s and 90 MB.
STEPS = 60_000
IDLE = 500  # steps without a switch after which a motion that would take too many steps is given up
TAIL_BITS = 0.3  # part of the working bits to which hops are followed before the rest of them is enclosed at once
# Part of the end of the motion below which a hop has no node of its own: no float tells its instants apart.
INSTANT = 1e-18


class BlockMarch(March):
    """The motion of a block from t = 0 on."""

    seen_from_base = True

    def __init__(self, problem: BlockProblem, end: float, limit: int) -> None:
        self.block = BlockModel(problem)
        super().__init__(self.block, end, limit, Work())
        self.problem = problem
        base = problem.base or Motion((0.0,), (0.0,), (0.0,))
        self.courses = path(base.time, base.x)(), path(base.time, base.y)()
        self.impacts: list[Impact] = []
        self.cascades: list[Cascade] = []
        self.last_switch = 0  # nodes before the last switch

    def initial(self) -> tuple[Start, States]:
        """Where the block is as seen from the base; corners that touch count as closed until they lift off."""
        (x, vx), (y, vy) = (piece.series(ZERO, 1.0, 2) for piece in self.drives)
        u = column([-x, arb(self.problem.gap) - y, *[ZERO] * 4])
        v = column([-vx, arb(self.problem.velocity) - vy, *[ZERO] * 4])
        is_open = u[1, 0] > 0 and not self.block.locked  # a base that begins below the block pulls at a locked one
        states = (OPEN, OPEN) if is_open or self.block.contact else (STICKS, STICKS)
        # Springs that never let go are unstrained where the base's record is zero, others where their corner touches.
        reference = ZERO if self.block.locked else -x.mid()
        return Start(ZERO, u, v, [reference, reference]), states

    def jump(self, rates: Sequence[arb]) -> arb_mat:
        """What the block takes over, as seen from its base, of a jump of the base's rates."""
        return column([*rates, *[ZERO] * 4])

    def check_work(self) -> None:
        """Stop where the block oscillates too fast for the length of its motion."""
        rate = self.block.rate(self.states)
        left = (self.end - self.now) * rate / ANGLE
        idle = len(self.nodes) - self.last_switch > IDLE
        # corners that never change cannot shorten the work
        hopeless = left > STEPS and (idle or self.block.locked)
        if hopeless or len(self.nodes) >= STEPS:
            reason = f"{STEPS} steps of {ANGLE:g} radians are the limit, and {left:.3g} more would be needed"
            within = self.now + (STEPS - len(self.nodes)) * ANGLE / rate
            raise TooMuchWorkError(within, f"{reason}, since the block oscillates at {rate:.3g} rad/s")

    def record(self, was: Sequence[int]) -> None:
        """Add the changes of states to the switches."""
        super().record(was)
        if tuple(was) != self.states:
            self.last_switch = len(self.nodes)

    # ---- impacts ----

    def strike(self, touches: bool) -> arb_mat | None:
        """Let the rates jump where the gap of a rigid contact is zero and closes."""
        contact = self.block.contact
        if contact is None or self.states != (OPEN, OPEN):
            return None
        rows = np.kron(np.eye(2), floats(contact.row))  # of the gap and its rate over unknowns and rates
        of_gap, of_rate = self.transport.radius(np.pad(rows, [(0, 0), (0, 2)])).tolist()
        if not touches and abs(contact.closing(self.start.u)) > of_gap:
            return None
        acceleration = self.block.accelerations(self.states, self.start, ())
        of_rate += 2 * self.offset * float(abs(contact.closing(acceleration)).upper())
        approach = -contact.closing(self.start.v)
        if not approach > of_rate:
            return None
        self._add_impact(contact, approach)
        self.place(self.start.time, self.start.u, contact.impact * self.start.v)
        return contact.impact

    def follow_impact(self) -> None:
        """Record an impact after which the contact is open, and follow the hops after it."""
        contact = self.block.contact
        if contact is None or self.states != (OPEN, OPEN):
            return
        self._add_rebound()
        if 0 < contact.restitution < 1:
            self._follow_hops(contact)

    def _add_impact(self, contact: RigidContact, approach: arb) -> None:
        self.impacts.append(Impact(self.now, float(approach), float(contact.impulse(approach))))
        self.last_switch = len(self.nodes)

    def _add_rebound(self) -> None:
        """Record that both corners touch for an instant."""
        for kind in ("closes", "opens"):
            for corner in (0, 1):
                self.add_switch(corner, kind)

    def _follow_hops(self, contact: RigidContact) -> None:
        """Follow impacts that hops lie between, from right after one on.

        It ends where a hop is long, or not proven to be concave, or leads beyond the end, or where all hops that are
        left are shorter together than the digits can tell: these are enclosed, and the contact rests after them.
        """
        hops = Hops(self.block, contact)
        e = contact.restitution
        time = self.start.time + ball(self.offset)
        hull = self.transport.record()
        state = State(self.start.u + balls(hull[:6]), self.start.v + balls(hull[6:12]))
        row = np.pad(floats(contact.row), [(0, 0), (6, 2)])
        speed = contact.closing(self.start.v) + ball(float(self.transport.radius(row)[0]))
        speed += contact.closing(hops.accelerations(state)) * ball(self.offset)
        cascade_start = None
        impulse = ZERO
        finest = arb(2) ** (-TAIL_BITS * ctx.prec) / hops.rate
        length = arb(self.end)
        while True:
            if speed.contains(0) or speed.rel_accuracy_bits() < ctx.prec // 4:
                raise LostDigitsError(float(time), "impacts have cost most of the digits")
            late = ball(time.rad())  # to first order, from the midpoint of the instant of the impact to this itself
            landed = State(state.u + state.v * late, state.v + hops.accelerations(state) * late)
            if cascade_start is None or length < finest:
                rest = hops.find_accumulation(landed, speed)
                if rest is not None and time + rest.length < self.end:
                    if cascade_start is None:
                        cascade_start = float(time)
                    if rest.length < finest:
                        impulse += contact.impulse(rest.speeds)
                        self._rest_after(hops, rest, state, time)
                        self.cascades.append(Cascade(cascade_start, self.now, float(impulse), self.offset))
                        return
            hop = hops.find_hop(landed, speed)
            if hop is None or not time + hop.length < self.end:
                return
            length = hop.length
            if cascade_start is None and length < self.end * 2.0 ** (-ctx.prec // 2):
                reason = "impacts follow each other ever faster, and that they accumulate is not proven"
                raise AccumulationError(float(time), f"{reason}; another restitution or load, however near, may do")
            if length > self.end * INSTANT:
                self.add_node()
            time += length
            moved = hops.after(state, difference(time.mid(), self.start.time))
            state = hops.pushed(moved, hop.approach, time.rad())
            speed = e * hop.approach
            self._stand_in(state, time)
            self.watches = [watch._replace(lead=1) for watch in self.block.watches(self.states, self.start.references)]
            self.last_switch = len(self.nodes)
            if cascade_start is None:
                self._add_impact(contact, hop.approach)
                self._add_rebound()
            else:
                impulse += contact.impulse(hop.approach)

    def _stand_in(self, state: State, time: arb) -> None:
        """Stand at the middle of balls that hold the state at the middle of an instant."""
        radii = [x.rad() for part in state for x in part.entries()]
        self.transport.restart([*radii, ZERO, ZERO])
        self.start = Start(time.mid(), state.u.mid(), state.v.mid(), self.start.references)
        self.offset = radius_of(time)

    def _rest_after(self, hops: Hops, rest: Accumulation, state: State, time: arb) -> None:
        """Take the state in which the impacts that are left accumulate, and let the contact rest.

        `state` is that after the last impact that was followed, at the midpoint of its instant, `time` [s].
        """
        error = self.transport.record()
        error[:12] += [float(rest.reach * x) * INFLATION for part in hops.units for x in part.entries()]
        self.nodes.append(Node(self.start, self.states, self.drives, (), error))
        time += rest.length
        state = hops.after(state, difference(time.mid(), self.start.time))
        state = hops.pushed(state, rest.speeds, rest.length.upper() + 2 * time.rad())
        second_order = 2 * (hops.rate * time.rad()) ** 2 * hops.change_norm(state) / hops.rate
        self._stand_in(hops.spread(state, second_order.upper()), time)
        projection = block_diag(*[floats(hops.contact.rest)] * 2, np.eye(2))
        self.transport.transport(self.transport.unit @ projection @ self.transport.inverse)
        self.place(self.start.time, hops.contact.rest * self.start.u, hops.contact.rest * self.start.v)
        self.follow()  # springs aside begin where the corners are
        self.settle({(0, NORMAL): 2})
        if self.states != (STICKS, STICKS):
            raise NoContactStateError(f"the contact does not rest after the impacts at {self.now!r} s")


def difference(one: arb, other: arb) -> arb:
    """An exact difference of instants."""
    with precision(4 * ctx.prec):
        return (one - other).mid()


def balls(radii: Array) -> arb_mat:
    """Balls about zero, in one column."""
    return column([ball(radius) for radius in radii.tolist()])
