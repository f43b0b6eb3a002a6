"""How far the motion of a block may be off: axes times a box, Lohner's method, over the z of `flow`."""

from __future__ import annotations

import math

import numpy as np
from flint import arb, arb_mat

from fem_reference.events.block_model import BlockModel
from fem_reference.events.contacts import STICKS, States, Watch, direction
from fem_reference.events.enclosure import radius_of
from fem_reference.events.flow import SIZE, UNIT
from fem_reference.events.series import INFLATION, Segment, floats
from fem_reference.events.watching import Change, Reach
from fem_reference.problem.problem import Array

REGULAR = 8
"""Moves after which the axes of the box are made orthogonal again."""
TABLE_ERROR = 1e-13
"""Part of their size by which floats of the terms of a function may be wrong."""
DIFFERENCE_ERROR = 1e-14
"""Part of its terms by which a difference of floats may be wrong."""


class Axes:
    """A set that holds z less its centre: axes times a box, plus a box.

    Each move turns the axes of the box by its own matrix, so that the box does not grow by being wrapped into the axes
    of z move after move.
    """

    def __init__(self, model: BlockModel) -> None:
        self.model = model
        # In the metric of the energy of the closed block the motion of most states is nearly a rotation.
        closed = model.flow((STICKS, STICKS))
        mass = np.array([float(m) for m in model.masses])
        rows = floats(model.rows)
        p = float(model.contacts[0].stiffness)
        ps = float(model.contacts[0].shear_stiffness)
        stiffness = floats(model.stiffness) + 1e-4 * closed.rate**2 * np.diag(mass)
        stiffness += p * rows[:2].T @ rows[:2] + ps * rows[2:4].T @ rows[2:4]
        self.metric = np.eye(SIZE)
        self.metric[:6, :6] = np.linalg.cholesky((stiffness + stiffness.T) / 2).T
        self.metric[6:12, 6:12] = np.diag(np.sqrt(mass))
        self.metric[12:14, 12:14] *= np.sqrt(ps + p * 1e-4) or 1.0
        self.inverse = np.linalg.inv(self.metric)
        self.axes = self.inverse.copy()
        self.radii = np.zeros(SIZE)
        self.box = np.zeros(SIZE)
        self.moves = 0

    def record(self) -> Array:
        """Greatest distances from the centre, shape (15,)."""
        return np.asarray((np.abs(self.axes) @ self.radii + self.box) * INFLATION)

    def radius(self, rows: Array) -> Array:
        """Greatest values of rows over z, less those at the centre."""
        return np.asarray((np.abs(rows @ self.axes) @ self.radii + np.abs(rows) @ self.box) * INFLATION)

    def restart(self, radii: Array) -> None:
        """Make the set a box."""
        self.axes = UNIT.copy()
        self.radii = radii
        self.box = np.zeros(SIZE)

    def take(self, u: arb_mat, v: arb_mat) -> None:
        """Take the radii of a state, which its centre leaves out."""
        self.box[:12] += [radius_of(x) for x in (*u.entries(), *v.entries())]

    def take_reference(self, contact: int, radius: arb) -> None:
        """Take the radius of the reference of a corner."""
        self.box[12 + contact] += float(radius) * INFLATION

    def begin(self, segment: Segment) -> None:
        """Nothing: the set moves with the block, in `advance`."""

    def reach(self, watch: Watch, states: States, segment: Segment, offset: float) -> Reach:
        """How far each term of a function may be off, where the instant of its start may be off too."""
        flow = self.model.flow(states)
        length = segment.length
        table = flow.terms(watch, segment.count - watch.rates)
        hull = self.record()[:14] / flow.units[:14]
        apart = TABLE_ERROR * math.sqrt(hull @ hull)
        if offset:
            v, a = (floats(term)[:, 0] for term in segment.terms[1:3])
            apart += 2 * offset * flow.norm(np.array([*v / length, *2 * a / length**2]))
        scaled = table[0, :14] * flow.units[:14]
        size = math.sqrt(scaled @ scaled)
        numbers = np.arange(len(table))
        angle = flow.rate * length
        parts = self.radius(table) * (angle / flow.angle) ** numbers
        parts[1:] += size * apart * np.cumprod(angle / numbers[1:])
        parts[0] += size * apart
        return Reach(arb(length if watch.rates else 1.0), parts * INFLATION)

    def advance(self, states: States, seconds: arb) -> None:
        """Go on by a part of a step."""
        flow = self.model.flow(states)
        hull = self.record()
        J = flow.exponential(float(seconds))
        self.transport(J, flow.exponential_error(J, hull))

    def transport(self, J: Array, added: Array) -> None:
        """Turn the set by a matrix, and add a box that holds what its floats may be wrong by."""
        self.box = (np.abs(J) @ self.box + added) * INFLATION
        self.axes = J @ self.axes
        self.moves += 1
        if self.moves % REGULAR == 0:
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

    def switch(self, change: Change) -> None:
        """Move the set over a switch, whose instant depends on where in it the motion is.

        The function that falls does so after -g z, g its row over its rate, and until then z' is that of the former
        flow, which changes z by `jump` times this time; terms of second order in the time are bounded by the sizes of
        z. P is what the switch itself makes of z.
        """
        model = self.model
        offset = change.offset
        P = self._of_references(change.was)
        if change.impact and model.contact is not None:
            P[6:12] = floats(model.contact.impact) @ P[6:12]
        before = np.abs(model.flow(change.was).G)
        after = np.abs(model.flow(change.now).G)
        into = np.abs(P)
        hull = self.record()
        rates, next_rates = (
            np.array(
                [*floats(start.v)[:, 0], *floats(model.motion(states).acceleration(*start[1:]))[:, 0], 0.0, 0.0, 0.0]
            )
            for start, states in ((change.before, change.was), (change.after, change.now))
        )
        jump = P @ rates - next_rates
        doubt = DIFFERENCE_ERROR * (into @ np.abs(rates) + np.abs(next_rates))
        u, v, references = change.before[1:]
        size = np.abs([*map(float, (*u.entries(), *v.entries(), *references)), 1.0]) + hull
        fast = before @ size
        turned = into @ before + after @ into
        second = (into @ (before @ fast) + 2 * after @ (into @ fast) + after @ (after @ (into @ size))) * offset**2
        M = P
        several = sum(was != now for was, now in zip(change.was, change.now, strict=True)) > 1
        timed = change.watch is not None and not (change.grazing or several or change.slope.contains(0))
        if not timed:
            second += 2 * (np.abs(jump) + doubt) * offset  # corners need not switch at one instant of the ball
        elif change.watch is not None:
            g = model.flow(change.was).function(change.watch) / float(change.slope)
            M = P - np.outer(jump, g)
            late = np.abs(g) @ (before @ fast * offset**2 + 2 * before @ hull * offset)
            late += float(abs(change.value / change.slope.mid()).upper())
            second += (np.abs(jump) + doubt) * late + turned @ hull * offset + doubt * (np.abs(g) @ hull)
        second[12:14] += [float(radius) for radius in change.radii]
        self.transport(M, second * INFLATION)

    def _of_references(self, states: States) -> Array:
        """What taking the references along makes of z, shape (15, 15)."""
        P = UNIT.copy()
        rows = self.model.flow(states).rows
        for c, (contact, state) in enumerate(zip(self.model.contacts, states, strict=True)):
            if state == STICKS or contact.slide is None:
                continue
            P[12 + c] = 0.0
            P[12 + c, :6] = rows[2 + c]
            side = direction(state)
            if side and contact.cohesion is not None:
                softness = side / float(contact.shear_stiffness)
                P[12 + c, :6] += softness * float(contact.friction * contact.stiffness) * rows[c]
                P[12 + c, 14] = -softness * float(contact.cohesion)
        return P
