"""How far the motion of many unknowns may be off: one number in the energy norm.

It bounds the distance e of the centre of the motion from the true one in the metric

    e' M e' + e (K + soft^2 M) e,    K of the blocks and of the contacts that are closed,

of which e' M e' + e K e is conserved or lost while no contact changes: in shear also where contacts slip, since
friction is monotone (the distance of two motions never grows in it); in pressure it grows only as a contact closes.
The rest grows at most by exp(soft t / 2). Forces are continuous at a switch, so that what its instant may be off moves
the motion by a term of second order only.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from flint import arb, arb_mat

from fem_reference.events.column_model import ColumnModel
from fem_reference.events.contacts import OPEN, States, Watch
from fem_reference.events.series import INFLATION, Segment, floats
from fem_reference.events.watching import Change, Reach
from fem_reference.problem.problem import Array


class EnergyNorm:
    """The distance of the motion of a column from the true one."""

    def __init__(self, model: ColumnModel) -> None:
        self.model = model
        self.error = arb(0)
        self.stiffness = np.array([float(model.spring(c)) for c in range(len(model.contacts))])
        self.compliance = model.row_sizes**2  # b M^-1 b'
        B = np.abs(floats(model.rows))
        K = np.abs(floats(model.stiffness)) + B.T @ (self.stiffness[:, None] * B)
        mass = np.abs(floats(model.mass)).sum(axis=1)
        # of a displacement and of a velocity of one in each unknown, in the metric
        self.displacement_norm = math.sqrt((K.sum(axis=1) + model.soft**2 * mass).sum()) * INFLATION
        self.velocity_norm = math.sqrt(mass.sum()) * INFLATION
        # rates of the error by what is left out of the base's displacement, rate and acceleration, and of the pressure
        inputs = np.abs(floats(model.inputs))
        inputs[:, 0] += B.T @ (self.stiffness * floats(model.on_base)[:, 0])
        self.pushes = (model.sizes @ inputs * INFLATION).tolist()

    def record(self) -> arb:
        """What a node keeps of it."""
        return self.error

    def take(self, u: arb_mat, v: arb_mat) -> None:
        """Take the radii of a state, which its centre leaves out."""
        radii = [max(x.rad().upper() for x in part.entries()) for part in (u, v)]
        added = radii[0] * arb(self.displacement_norm) + radii[1] * arb(self.velocity_norm)
        self.error = (self.error + added).upper()

    def take_reference(self, contact: int, radius: arb) -> None:
        """Take the radius of the reference of a contact."""
        self.error = (self.error + self.model.spring(contact).sqrt() * radius).upper()

    def begin(self, segment: Segment) -> None:
        """Let the error grow over a step, by itself and by what the series of the drives leaves out."""
        span = arb(segment.length)
        base, pressure = segment.drive_tails
        units = [base, base / span, base / (span * span), pressure]
        pushes = (tail * arb(push) for tail, push in zip(units, self.pushes, strict=True))
        self.error = (self.error * arb(self.model.soft * segment.length / 2).exp() + sum(pushes, arb(0)) * span).upper()

    def reach(self, watch: Watch, states: States, segment: Segment, offset: float) -> Reach:
        """How far each term of a function may be off, where the instant of its start may be off too."""
        error = self.error
        if offset:
            speed, bend = (max(abs(x).upper() for x in term.entries()) for term in segment.terms[1:3])
            span = arb(segment.length)
            rate = speed / span * arb(self.displacement_norm) + 2 * bend / (span * span) * arb(self.velocity_norm)
            error = (error + 2 * rate * arb(offset)).upper()
        speed_reach = self.compliance[watch.contact] ** 0.5
        growth = max((self.model.rate(states) + self.model.soft) * segment.length, 1.0)
        parts = speed_reach * segment.length * exponential_terms(growth, segment.count)[: segment.count - watch.rates]
        if not watch.rates:
            position = speed_reach / self.model.soft
            if states[watch.contact] != OPEN:
                position = min(position, self.stiffness[watch.contact] ** -0.5)
            parts[1:] /= growth
            parts[0] = position
        return Reach(error * abs(watch.parts[0].factor), parts * INFLATION)

    def advance(self, states: States, seconds: arb) -> None:
        """Nothing: `begin` has let the error grow over the whole step."""

    def switch(self, change: Change) -> None:
        """Take what the centre misses its switch by, the time in which states may differ, and springs that close."""
        watch = change.watch
        offset = arb(change.offset)
        if watch is not None:
            c = watch.contact
            k = self.model.spring(c)
            miss = abs(change.value).upper()
            if not self.model.unilateral:
                miss = miss / k * (offset if watch.rates else 1)
                self.error = (self.error + k.sqrt() * miss).upper()
            else:
                compliance = arb(float(self.compliance[c]))
                speed = abs(change.slope).upper()
                late = k * compliance.sqrt() * (miss + speed * offset) * offset * 2
                spread = (k * compliance / arb(self.model.soft) * 2 * offset).exp()
                self.error = ((self.error + late) * spread).upper()
        gain = 1.0
        if self.model.unilateral:
            for c, (was, now) in enumerate(zip(change.was, change.now, strict=True)):
                if was == OPEN and now != OPEN:
                    gain += self.stiffness[c] * self.compliance[c] / self.model.soft**2 * (1 + 1e-9)
        if gain > 1:
            self.error = (self.error * arb(gain).sqrt()).upper()


@lru_cache(maxsize=8)
def exponential_terms(x: float, count: int) -> Array:
    """The terms x^k / k! of the series of an exponential."""
    return np.cumprod([1.0, *(x / np.arange(1, count))])
