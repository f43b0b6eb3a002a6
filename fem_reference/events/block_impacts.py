"""A block that hops on a rigid contact, and the instant at which infinitely many impacts accumulate, in balls.

Between two impacts the gap w of both corners is a power series that begins with w = 0 and w' = s > 0. Where its second
derivative is proven to be negative throughout, the gap is concave, so that it has one more root t. With
w = s t + a_2 t^2 + a_3 t^3 + ... this root and the speed of the landing are::

    0 = s + a_2 t + a_3 t^2 + ...,    -w'(t) = s - a_3 t^2 - 2 a_4 t^3 - ...

The second series is -w' and twice the first one. It is without a_2, whose ball would widen that of the speed at every
impact: a gap that falls evenly closes as fast as it opened.

An impact adds (1 + e) |w'| d to z, d what changes the gap's rate by one, and the flow before and after it is the same,
z' = G z. So at an instant t after impacts at t_k ::

    z(t) = exp(G (t - t_0)) z(t_0) + (1 + e) sum |w'_k| exp(G (t - t_k)) d

holds z at the midpoints of the balls of the t_k, and what is not known of t_k enters by its impulse alone.

**Accumulation.** Let -A <= w'' <= -B < 0 in every flight after an impact that leaves the gap with the rate s. A flight
with the rate s lasts from 2 s/A to 2 s/B and lands at a speed from s/r to r s, r = sqrt(A/B), since the height h of the
gap obeys s^2/(2A) <= h <= s^2/(2B). So the next rate is from e s/r to e r s. With rho = e r < 1 and R = e/r all flights
together last, and all landing speeds together are::

    2 s/(A (1 - R)) <= T <= 2 s/(B (1 - rho)),    (s/r)/(1 - R) <= sum |w'| <= r s/(1 - rho)

Infinitely many impacts take a finite time, after which the gap is zero and at rest. A and B follow from what they
imply: in a norm in which G has the norm lambda, z moves within T by no more than
Y = exp(lambda T) (T |G z| + (1 + e) |d| sum |w'|), and therefore w'' by no more than T (|g_3 z| + |g_3| Y), g_3 the row
of the third derivative. If this is at most what A and B allow for, both hold up to the accumulation, for a first
instant at which one of them failed would contradict it. The contact then rests and presses, for w'' <= -B of the free
block means a force of at least B/C.

The state from then on is that of the closed contact. Continued to the midpoint of the ball of the accumulation, it
differs from that of the free block by a force along d for as long as this ball is wide, and by second orders of this
time. With w = w' = 0 it is thus the free block's state, projected along d.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from flint import arb, arb_mat, arb_poly, ctx

from fem_reference.events.block_model import BlockModel, RigidContact
from fem_reference.events.contacts import OPEN
from fem_reference.events.enclosure import NEWTON_STEPS, ZERO, ball
from fem_reference.events.series import Segment, Start, column, expand

# Longest flight that is a hop [rad]; in a longer one the gap need not be concave, nor its series be short.
LONGEST_HOP = 0.03
SHORTEST = 1e-300  # length of a series over no time [s]
ATTEMPTS = 8  # times that bounds of w'' are widened before accumulation counts as not proven
WIDENING = 1.2  # factor by which they are widened beyond what they imply


class Hop(NamedTuple):
    """A flight from one impact to the next."""

    length: arb  # [s]
    approach: arb  # speed at which the gap closes at its end [m/s]


class Accumulation(NamedTuple):
    """What infinitely many impacts come to."""

    length: arb  # time from the last impact that was followed to the end of all [s]
    speeds: arb  # sum of the speeds of all landings [m/s]
    reach: arb  # greatest change of z until then, in the units of the flow


class State(NamedTuple):
    """Balls that hold the block, in flight."""

    u: arb_mat  # unknowns
    v: arb_mat  # their rates


class Hops:
    """Hops of the open contact, and what they come to."""

    def __init__(self, model: BlockModel, contact: RigidContact) -> None:
        self.model = model
        self.contact = contact
        self.e = contact.restitution
        self.motion = model.motion((OPEN, OPEN))
        rate = model.rate((OPEN, OPEN))
        self.rate = arb(rate)
        self.units = State(column((model.sizes / rate).tolist()), column(model.sizes.tolist()))
        self.third = contact.row * self.motion.A  # the gap's third derivative over the rates
        weights = [x * unit for x, unit in zip(self.third.entries(), self.units.v.entries(), strict=True)]
        self.third_norm = euclidean(weights)
        self.direction = State(arb_mat(6, 1), contact.direction)
        self.direction_norm = self.norm(self.direction)

    def norm(self, state: State) -> arb:
        """Norm of unknowns and rates, in which those of the block in flight change by `rate` at most."""
        parts = zip(state, self.units, strict=True)
        return euclidean([x / unit for part, of in parts for x, unit in zip(part.entries(), of.entries(), strict=True)])

    def spread(self, state: State, size: arb) -> State:
        """The state with each change of at most a norm."""
        unit = ball(size.upper())
        return State(state.u + self.units.u * unit, state.v + self.units.v * unit)

    def accelerations(self, state: State) -> arb_mat:
        """Second derivatives of the unknowns."""
        return self.motion.A * state.u + self.motion.f

    def change_norm(self, state: State) -> arb:
        """Norm of the derivative of a state."""
        return self.norm(State(state.v, self.accelerations(state)))

    def series(self, state: State, length: float) -> Segment:
        """The series of a flight."""
        zero = ZERO
        return expand(self.model, (OPEN, OPEN), Start(zero, *state, [zero, zero]), (), length)

    def after(self, state: State, time: arb) -> State:
        """The state after a flight of a time [s]."""
        length = float(abs(time).upper()) * (1 + 1e-9) or SHORTEST
        return State(*self.series(state, length).state(time / arb(length)))

    def pushed(self, state: State, speeds: arb, spread: arb) -> State:
        """The state after impacts by the sum of their speeds [m/s], all within a time `spread` around now [s]."""
        angle = self.rate * spread
        late = self.spread(self.direction, angle * angle.exp() * self.direction_norm)
        push = (1 + self.e) * speeds
        return State(state.u + late.u * push, state.v + late.v * push)

    def find_hop(self, state: State, speed: arb) -> Hop | None:
        """The flight right after an impact, the gap opening at a speed [m/s]; None if not proven short and concave."""
        bend = self.contact.closing(self.accelerations(state))
        if not bend < 0:
            return None
        longest = (4 * speed / -bend).upper()
        if not longest * self.rate < LONGEST_HOP:
            return None
        length = float(longest.upper()) * (1 + 1e-9)
        span = arb(length)
        segment = self.series(state, length)
        start = speed * span
        a = [*segment.rows[0], ball(segment.row_tail(0).upper())]  # the last one holds the tail
        height = arb_poly([start, *a[2:]])  # the gap over the share of the length
        rise = height.derivative()
        # bounds of how far slope and curvature of the gap over the share move from a_2 and from 2 a_2
        moved = arb_poly([0, *((k - 1) * abs(a[k]) for k in range(3, len(a)))])
        one = arb(1)
        slope = a[2] + ball(moved(one).upper())
        curvature = 2 * a[2] + ball((2 * moved(one) + moved.derivative()(one)).upper())
        if not (curvature < 0 and height(one) < 0):
            return None
        x = (start / -a[2]).mid()
        for _ in range(NEWTON_STEPS):
            following = (x - height(x) / rise(x)).mid()
            finished = abs(following - x) <= x * arb(2) ** (8 - ctx.prec)
            x = following
            if finished:
                break
        # the mean value theorem: a slope in between leads from the root to x
        root = x - height(x) / slope
        lost = root * root * arb_poly([(k - 2) * a[k] for k in range(3, len(a))])(root)
        return Hop(root * span, speed - lost / span)

    def find_accumulation(self, state: State, speed: arb) -> Accumulation | None:
        """Where the impacts after one accumulate, None if that is not proven; arguments as those of `find_hop`."""
        e = self.e
        now = -self.contact.closing(self.accelerations(state))
        third_now = abs((self.third * state.v)[0, 0]).upper()
        change_norm = self.change_norm(state)
        fastest = speed.upper()
        slowest = speed.lower()
        margin = ZERO
        for _ in range(ATTEMPTS):
            A = now.upper() + margin
            B = now.lower() - margin
            if not B > 0:
                return None
            ratio = (A / B).sqrt()
            rho = e * ratio
            if not rho < 1:
                return None
            longest = (2 * fastest / B / (1 - rho)).upper()
            most = (ratio * fastest / (1 - rho)).upper()
            reach = longest * change_norm + (1 + e) * self.direction_norm * most
            reach = ((self.rate * longest).exp() * reach).upper()
            implied = (longest * (third_now + self.third_norm * reach)).upper()
            if implied <= margin:
                least = slowest / ratio / (1 - e / ratio)
                length = (2 * slowest / A / (1 - e / ratio)).union(longest)
                return Accumulation(length, least.union(most), reach)
            margin = (implied * WIDENING).upper()
        return None


def euclidean(entries: Sequence[arb]) -> arb:
    """Upper bound of the root of a sum of squares."""
    return sum((x * x for x in entries), ZERO).abs_upper().sqrt().upper()
