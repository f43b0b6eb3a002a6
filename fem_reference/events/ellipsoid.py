"""How far the motion may be off: an ellipsoid over z = (x, x', r), unknowns, their rates and references.

The centre of the motion is computed without radii. What it may be off is size * S y, |y| <= 1, in units in which the
mass is one: z is taken times

    U = diag(w L', L', w / b),   M = L L',   w the frequency of the closed contacts,  b the greatest value of a row.

Between two switches it moves as exp(G s), and over a switch as the linear map below, neither of which makes the set any
larger than it is: S is multiplied by the matrix. What is added, a box d, lies in an ellipsoid of the root of its
number of entries times its radii, and the sum of two ellipsoids S and D in that of (1 + 1/p) S S' + (1 + p) D D' for
any p > 0, whose root is found by orthogonal rotations.

**Terms.** A function g z of the motion z' = G z has the terms g G^k z L^k / k!. With R the pull of the references,
which rest, and a norm in which the rest of G has the norm `rate`, those from the first on are at most

    |g| (|(x, x')| + |R r| / rate) (rate L)^k / k!

**Switches.** The function that falls does so after -g z / slope, until when z' is that of the former motion; this
changes z by `jump` times this time. Terms of second order in it are bounded by the sizes of z and of its derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from flint import arb
from scipy.linalg import block_diag, expm

from fem_reference.events.column_drive import Piece
from fem_reference.events.contacts import STICKS, States, Watch, direction
from fem_reference.events.enclosure import ZERO
from fem_reference.events.series import INFLATION, Segment, Start, System, floats
from fem_reference.events.watching import Change, Reach
from fem_reference.problem.problem import Array

# Part of the norm of a matrix by which floats of it, also of an exponential, and of its product may be wrong.
FLOAT_ERROR = 1e-13
LARGEST_WEIGHT = 1e6  # greatest p of a sum: so often the set may move before it has grown by a factor of sqrt(e)
DIFFERENCE_ERROR = 1e-14  # part of its terms by which a difference of floats may be wrong


class Ellipsoid:
    """A set that holds z less its centre."""

    def __init__(self, model: System) -> None:
        self.model = model
        n = model.size
        self.x = slice(0, n)
        self.v = slice(n, 2 * n)
        self.r = slice(2 * n, None)
        self.frequency = model.bounds_of((STICKS,) * len(model.contacts)).frequency
        self.rows = floats(model.rows)
        upper, inverse = model.root
        references = self.frequency / model.row_sizes[[contact.row for contact in model.contacts]]
        self.unit = block_diag(self.frequency * upper, upper, np.diag(references))
        self.inverse = block_diag(inverse / self.frequency, inverse, np.diag(1 / references))
        self.size = ZERO
        self.shape = np.zeros_like(self.unit)  # S
        self.generator = lru_cache(maxsize=32)(self._generator)

    def _generator(self, states: States) -> Array:
        """The G of z' = G z in the units of the set."""
        motion = self.model.motion(states)
        G = np.zeros_like(self.unit)
        G[self.x, self.v] = np.eye(self.model.size)
        G[self.v, self.x] = floats(motion.A)
        G[self.v, self.r] = floats(motion.R)
        if motion.D is not None:
            G[self.v, self.v] = floats(motion.D)
        return np.asarray(self.unit @ G @ self.inverse)

    def radius(self, rows: Array) -> Array:
        """Greatest values of rows over z, less those at the centre."""
        return np.asarray(np.linalg.norm(rows @ self.inverse @ self.shape, axis=-1) * float(self.size) * INFLATION)

    def record(self) -> Array:
        """Greatest distances of z from the centre."""
        return self.radius(np.eye(len(self.unit)))

    def restart(self, radii: Sequence[arb]) -> None:
        """Make the set a box."""
        self.size = ZERO
        self.take(radii)

    def take(self, radii: Sequence[arb]) -> None:
        """Take the radii of z, which its centre leaves out."""
        largest = max(radii)
        if largest > 0:
            shares = np.array([float(radius / largest) for radius in radii])
            self.transport(None, largest, np.abs(self.unit) @ shares)

    def advance(self, states: States, seconds: arb) -> None:
        """Go on by a part of a step."""
        self.transport(expm(self.generator(states) * float(seconds)))

    def transport(self, J: Array | None, size: arb = ZERO, box: Array | None = None) -> None:
        """Move the set by a matrix, and add a box of a size."""
        largest = (self.size + size).upper()
        if largest == 0:
            return
        shape = self.shape * float(self.size / largest)
        rounding = FLOAT_ERROR * np.linalg.norm(shape)
        if J is not None:
            shape = J @ shape
            rounding *= np.linalg.norm(J)
        added = np.full(len(shape), rounding)
        if box is not None:
            added += box * float(size / largest)
        added *= np.sqrt(len(shape)) * INFLATION
        weight = min(float(np.linalg.norm(shape) / np.linalg.norm(added)), LARGEST_WEIGHT) or 1e-9
        both = np.vstack([np.sqrt(1 + 1 / weight) * shape.T, np.diag(np.sqrt(1 + weight) * added)])
        root = np.asarray(np.linalg.qr(both, mode="r")).T
        norm = float(np.linalg.norm(root))
        self.shape = root / norm
        self.size = (largest * arb(norm * INFLATION)).upper()

    def function(self, watch: Watch) -> Array:
        """A watched function over z in the units of the set."""
        weights = np.zeros(len(self.unit))
        for row, factor, dashpot in watch.parts:
            weights[self.v if watch.rates else self.x] += float(factor) * self.rows[row]
            if dashpot is not None:
                weights[self.v] += float(dashpot) * self.rows[row]
        weights[self.r][watch.contact] += float(watch.pull)
        return np.asarray(weights @ self.inverse)

    def reach(self, watch: Watch, states: States, segment: Segment, offset: float) -> Reach:
        """How far each term of a function may be off, where the instant of its start may be off too."""
        bounds = self.model.bounds_of(states)
        length = segment.length
        g = self.function(watch)
        scale = np.repeat([bounds.frequency / self.frequency, 1.0], self.model.size)
        of_references = self.generator(states)[self.v, self.r] @ self.shape[self.r]
        deviation = np.linalg.norm(self.shape[: len(scale)].T * scale) + np.linalg.norm(of_references) / bounds.motion
        late = 0.0
        if offset:
            speed, bend = (floats(term)[:, 0] for term in segment.terms[1:3])
            rates = self.unit[: len(scale), : len(scale)] @ np.array([*speed / length, *2 * bend / length**2])
            late = 2 * float(np.linalg.norm(rates * scale))
        total = self.size + arb(offset)
        if total == 0:
            return Reach(total, np.zeros(segment.count - watch.rates))
        of_set = float(self.size / total)
        late *= float(arb(offset) / total)
        size = np.linalg.norm(g[: len(scale)] / scale)
        parts = (
            size * (deviation * of_set + late) * exponential_terms(bounds.motion * length, segment.count - watch.rates)
        )
        parts[0] = np.linalg.norm(g @ self.shape) * of_set + size * late
        return Reach(total * arb(length if watch.rates else 1.0), parts * INFLATION)

    def switch(self, change: Change, drives: Sequence[Piece]) -> None:
        """Move the set over a switch, whose instant depends on where in it the motion is."""
        model = self.model
        offset = arb(change.offset)
        G = np.abs(self.generator(change.was))
        next_G = np.abs(self.generator(change.now))
        P, of_base = self._of_references(change.was)
        if change.impact is not None:
            upper, inverse = model.root
            P[self.v] = upper @ floats(change.impact) @ inverse @ P[self.v]
        course = drives[0].series(change.before.time, 1.0, 3) if drives else [ZERO] * 3
        base_rate, base_bend = float(course[1]), 2 * float(abs(course[2]))
        rates, further = self._rates(change.before, change.was, drives)
        next_rates, next_further = self._rates(change.after, change.now, drives)
        into = np.abs(P)
        hull = np.linalg.norm(self.shape, axis=1) * INFLATION  # over the size of the set
        jump = P @ rates + of_base * base_rate - next_rates
        doubt = DIFFERENCE_ERROR * (into @ np.abs(rates) + np.abs(of_base * base_rate) + np.abs(next_rates))
        absolute = hull * float(self.size)
        fast = np.abs(rates) + G @ absolute
        moved = into @ fast + np.abs(of_base * base_rate)
        second = into @ (G @ fast + further) + np.abs(of_base) * base_bend + 2 * next_G @ moved
        second += next_G @ (np.abs(next_rates) + next_G @ into @ absolute) + 3 * next_further
        added = [(offset * offset, second)]
        M = P
        several = sum(was != now for was, now in zip(change.was, change.now, strict=True)) > 1
        if change.watch is None or change.grazing or several or change.slope.contains(0):
            added.append((2 * offset, np.abs(jump) + doubt))  # contacts need not switch at one instant of the ball
        else:
            g = self.function(change.watch) / float(change.slope)
            M = P - np.outer(jump, g)
            late = arb(np.abs(g) @ (G @ fast)) * offset * offset + arb(2 * np.abs(g) @ G @ hull) * offset * self.size
            late += abs(change.value / change.slope.mid())
            added.append((late.upper(), np.abs(jump) + doubt))
            added.append((offset * self.size, (into @ G + next_G @ into) @ hull))
            added.append((self.size, doubt * (np.abs(g) @ hull)))
        references = np.zeros((len(hull), len(change.radii)))
        references[self.r] = self.unit[self.r, self.r]
        added += list(zip(change.radii, references.T, strict=True))
        size = sum((part for part, _ in added), ZERO).upper()
        box = sum(vector * float(part / size) for part, vector in added) if size > 0 else None
        self.transport(M, size, box)

    def _rates(self, start: Start, states: States, drives: Sequence[Piece]) -> tuple[Array, Array]:
        """The z' at a state, and the size of what its drives add to z''."""
        a, third = floats(self.model.accelerations(states, start, drives)).T
        still = np.zeros(len(states))
        further = np.abs(self.unit) @ np.abs(np.array([*0 * third, *third, *still]))
        return self.unit @ np.array([*floats(start.v)[:, 0], *a, *still]), further

    def _of_references(self, states: States) -> tuple[Array, Array]:
        """What taking the references along makes of z, and what the displacement of the base adds to it."""
        P = np.eye(len(self.unit))
        of_base = np.zeros(len(self.unit))
        on_base = floats(self.model.on_base)[:, 0]
        for c, (contact, state) in enumerate(zip(self.model.contacts, states, strict=True)):
            if state == STICKS or contact.slide is None:
                continue
            weights = np.zeros(len(self.rows))
            weights[contact.slide] = 1.0
            if direction(state) and contact.cohesion is not None and contact.gap is not None:
                friction = contact.friction * contact.stiffness / contact.shear_stiffness
                weights[contact.gap] = direction(state) * float(friction)
            unit = self.unit[self.r, self.r][c, c]
            P[self.r][c] = 0.0
            P[self.r, self.x][c] = unit * weights @ self.rows @ self.inverse[self.x, self.x]
            of_base[self.r][c] = -unit * weights @ on_base
        return P, of_base


@lru_cache(maxsize=8)
def exponential_terms(x: float, count: int) -> Array:
    """The terms x^k / k! of the series of an exponential."""
    return np.cumprod([1.0, *(x / np.arange(1, count))])
