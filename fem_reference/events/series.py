"""Taylor series of M z'' + C z' + K z = drive + B' lambda over a step in which all contacts keep their states.

The rows y = B z + g (less the base, where a face is on it) have forces lambda that are linear in y, y' and references
(`contacts.laws`), so that with the mobility W = M^-1::

    z'' = A z + D z' + R r + f + E s,    s = (base, base', base'', pressure)

All series are in the share of a step, t = start + share * length, so that their terms are displacements and fall like
those of an exponential.

**The tail.** The last two terms of a drive belong to its own tail, so that the terms of the motion from the last two on
follow from these alone. In the norm of the system (`System.norm`), with w^2 the norm of A and d that of D::

    |C_(k+2)| <= (w^2 |C_k| + d (k+1) |C_(k+1)|) length^2 / ((k+1) (k+2))

Where x = rate * length with w^2 + d rate <= rate^2, terms below M x^k / k! stay so. M is that of the last two.

What the drives leave out, their tails in s, accelerates the motion by P |E| at most. By Duhamel's formula this moves it
by no more than P length^2 e^x over the step, and its derivatives in the share by (1 + x)^3 times that.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, arb_poly

from fem_reference.events.column_drive import Piece, tail_sum
from fem_reference.events.contacts import Contact, States, Watch, laws, watches
from fem_reference.events.enclosure import ZERO, ball, term_count
from fem_reference.problem.problem import Array

LEAST_TERMS = 28  # terms of a step, at least
FURTHER_TERMS = 6  # terms beyond those that the angle of the step needs: the tail bounds three derivatives too
# Rate that stands for none, as of a rigid block in flight [rad/s]; its series end after the square of the time.
LEAST_RATE = 1.0
INFLATION = 1 + 1e-9  # what covers the rounding of floats that bound radii and rates


class Start(NamedTuple):
    """Where the motion is, exactly."""

    time: arb  # [s]
    u: arb_mat  # displacements of the unknowns
    v: arb_mat  # their rates
    references: list[arb]  # r of each contact, for those that stick


class Motion(NamedTuple):
    """The matrices of the motion while the contacts keep their states."""

    A: arb_mat
    D: arb_mat | None  # None: zero
    R: arb_mat
    f: arb_mat
    E: arb_mat


class Rates(NamedTuple):
    """Bounds of the motion in the norm of the mass [rad/s]."""

    frequency: float  # root of the norm of A
    motion: float  # d/2 + sqrt(d^2/4 + w^2), d the norm of D


class System:
    """What moves: unknowns with a mass, rows of contacts, drives.

    Its norm is that of the mass, |x|^2 = x' M x.
    """

    angle: float  # length of a step times the rate, at most [rad]
    contacts: list[Contact]
    mass: arb_mat  # M
    mobility: arb_mat  # M^-1, of rigid bodies the sum of d d' / (d' M d) over their motions d
    stiffness: arb_mat  # K
    load: arb_mat  # what acts for ever
    rows: arb_mat  # B
    offsets: arb_mat  # g
    damping: arb_mat | None = None  # C
    on_base: arb_mat  # 1 for each row with a face on the base
    inputs: arb_mat  # forces of the base's displacement, rate and acceleration, and of the pressure

    def __init__(self) -> None:
        self.motions: dict[States, Motion] = {}
        self.rates: dict[States, Rates] = {}

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.mobility.nrows()

    @cached_property
    def root(self) -> tuple[Array, Array]:
        """L' and its inverse in floats, M = L L'."""
        upper = np.asarray(np.linalg.cholesky(floats(self.mass)).T)
        return upper, np.asarray(np.linalg.inv(upper))

    @cached_property
    def sizes(self) -> Array:
        """Greatest value of each unknown of norm one."""
        return np.asarray(np.linalg.norm(self.root[1], axis=1) * INFLATION)

    @cached_property
    def row_sizes(self) -> Array:
        """Greatest value of each row where the unknowns have the norm one."""
        return np.asarray(np.linalg.norm(floats(self.rows) @ self.root[1], axis=1) * INFLATION)

    def bounds_of(self, states: States) -> Rates:
        """Bounds of the rates of the motion while the contacts keep their states."""
        if states not in self.rates:
            motion = self.motion(states)
            upper, inverse = self.root
            frequency = math.sqrt(float(np.linalg.norm(upper @ floats(motion.A) @ inverse, 2))) or LEAST_RATE
            half = 0.0
            if motion.D is not None:
                half = float(np.linalg.norm(upper @ floats(motion.D) @ inverse, 2)) / 2
            self.rates[states] = Rates(frequency * INFLATION, (half + math.hypot(half, frequency)) * INFLATION)
        return self.rates[states]

    def rate(self, states: States) -> float:
        """The bound of the motion [rad/s]."""
        return self.bounds_of(states).motion

    def growth(self, states: States, radii: Array, passed: float) -> Array:
        """How far the unknowns may be off after a time [s] in which the contacts keep their states.

        `radii` are those of unknowns, rates and references before.
        """
        n = self.size
        bounds = self.bounds_of(states)
        upper = np.abs(self.root[0])
        apart = bounds.frequency * np.linalg.norm(upper @ radii[:n]) + np.linalg.norm(upper @ radii[n : 2 * n])
        pull = np.linalg.norm(upper @ np.abs(floats(self.motion(states).R)) @ radii[2 * n :]) / bounds.motion
        return self.sizes / bounds.frequency * math.exp(bounds.motion * passed) * (apart + pull)

    def norm(self, x: Sequence[arb]) -> arb:
        """Norm of the unknowns, in which `rate` bounds the motion."""
        vector = column(x)
        return (vector.transpose() * self.mass * vector)[0, 0].abs_upper().sqrt().upper()

    def watches(self, states: States, references: Sequence[arb]) -> Iterable[Watch]:
        """The functions that are positive as long as the contacts keep their states."""
        return watches(self.contacts, states, references)

    def changed(self, states: States, watch: Watch) -> States:
        """The states after a fall of a function."""
        return tuple(watch.becomes if c == watch.contact else state for c, state in enumerate(states))

    def motion(self, states: States) -> Motion:
        """The matrices of the motion in some states."""
        if states not in self.motions:
            law = laws(self.contacts, states, self.rows.nrows())
            pushes = self.mobility * self.rows.transpose()
            A = pushes * law.rows * self.rows - self.mobility * self.stiffness
            D = pushes * law.rates * self.rows
            f = self.mobility * self.load + pushes * (law.constant + law.rows * self.offsets)
            if self.damping is not None:
                D -= self.mobility * self.damping
            E = self.mobility * self.inputs - pushes * law.rows * self.on_base * arb_mat([[1, 0, 0, 0]])
            still = all(d == 0 for d in D.entries())
            self.motions[states] = Motion(A, None if still else D, pushes * law.references, f, E)
        return self.motions[states]

    def values(self, start: Start, drives: Sequence[Piece] = ()) -> list[arb]:
        """The rows at a state."""
        y = self.rows * start.u + self.offsets
        if drives:
            y -= self.on_base * drives[0].series(start.time, 1.0, 1)[0]
        return list(y.entries())

    def forces(self, states: States, start: Start, drives: Sequence[Piece]) -> tuple[list[arb], list[arb]]:
        """The rows at a state, and the forces along them; of dashpots on a base that does not move."""
        law = laws(self.contacts, states, self.rows.nrows())
        rows = self.values(start, drives)
        force = law.rows * column(rows) + law.rates * self.rows * start.v + law.references * column(start.references)
        return rows, list((force + law.constant).entries())

    def accelerations(self, states: States, start: Start, drives: Sequence[Piece]) -> arb_mat:
        """Second derivatives of the unknowns, and what the drives add to the third ones, shape (unknowns, 2)."""
        motion = self.motion(states)
        a = motion.A * start.u + motion.R * column(start.references) + motion.f
        if motion.D is not None:
            a += motion.D * start.v
        pushes = arb_mat(self.size, 2)
        if drives:
            b, rate, bend, third = drives[0].series(start.time, 1.0, 4)
            q, q_rate = drives[1].series(start.time, 1.0, 2)
            pushes = motion.E * arb_mat([[b, rate], [rate, 2 * bend], [2 * bend, 6 * third], [q, q_rate]])
        return a * arb_mat([[1, 0]]) + pushes


@dataclass(frozen=True)
class Segment:
    """Series of a step, term by term."""

    system: System
    length: float  # of the step [s]
    terms: list[arb_mat]  # of the unknowns
    drives: list[list[arb]]  # of each drive
    tail: arb  # norm of all further terms, and of three derivatives of them in the share of the step
    drive_tails: list[arb]  # the same of each drive
    functions: dict[tuple[int, int, int], list[arb]] = field(default_factory=dict)  # that were asked for

    @property
    def count(self) -> int:
        """Number of terms."""
        return len(self.terms)

    @cached_property
    def rows(self) -> list[list[arb]]:
        """The terms of each row."""
        y = [list(series) for series in zip(*((self.system.rows * term).entries() for term in self.terms), strict=True)]
        for series, offset, b in zip(y, self.system.offsets.entries(), self.system.on_base.entries(), strict=True):
            series[0] += offset
            if b != 0:
                series[:] = [c - base for c, base in zip(series, self.drives[0], strict=True)]
        return y

    def row_tail(self, row: int) -> arb:
        """What the series leaves out of a row, and three derivatives of it."""
        tail = self.tail * arb(float(self.system.row_sizes[row]))
        return tail + self.drive_tails[0] if self.system.on_base[row, 0] != 0 else tail

    @cached_property
    def unknowns(self) -> list[tuple[arb_poly, arb_poly]]:
        """Series of the unknowns and their derivatives."""
        coefficients = zip(*(term.entries() for term in self.terms), strict=True)
        polynomials = [arb_poly(list(of_unknown)) for of_unknown in coefficients]
        return [(polynomial, polynomial.derivative()) for polynomial in polynomials]

    def state(self, share: arb) -> tuple[arb_mat, arb_mat]:
        """Unknowns and their rates at a share of the step."""
        rest = column([ball((self.tail * arb(size)).upper()) for size in self.system.sizes.tolist()])
        u, v = (column([one(share) for one in series]) + rest for series in zip(*self.unknowns, strict=True))
        return u, v * (1 / arb(self.length))

    def function(self, watch: Watch) -> list[arb]:
        """Series of a watched function."""
        key = watch.contact, watch.side, watch.becomes
        if key in self.functions:
            return self.functions[key]
        terms: list[arb] = []
        for row, factor, dashpot in watch.parts:
            series = self.rows[row]
            slopes = [k * c for k, c in enumerate(series)][1:] if watch.rates or dashpot is not None else []
            part = [c * factor for c in (slopes if watch.rates else series)]
            if dashpot is not None:
                unit = dashpot / arb(self.length)
                part = [c + slope * unit for c, slope in zip(part, [*slopes, ZERO], strict=True)]
            terms = [one + other for one, other in zip(terms, part, strict=True)] if terms else part
        if not watch.rates:
            terms[0] += watch.offset
        self.functions[key] = terms
        return terms

    def function_tail(self, watch: Watch) -> arb:
        """What the series leaves out of a function, and of its first two derivatives."""
        tail = ZERO
        for row, factor, dashpot in watch.parts:
            size = abs(factor) if dashpot is None else abs(factor) + abs(dashpot) / arb(self.length)
            tail += size * self.row_tail(row)
        return tail.upper()

    def value_and_slope(self, watch: Watch, share: arb) -> tuple[arb, arb]:
        """A watched function and its rate in time at a share of the step."""
        series = arb_poly(self.function(watch))
        span = arb(self.length)
        unit = span if watch.rates else arb(1)
        return series(share) / unit, series.derivative()(share) / (unit * span)


def column(entries: Sequence[arb]) -> arb_mat:
    """A matrix of one column."""
    return arb_mat(len(entries), 1, list(entries))


def diagonal(entries: Sequence[arb]) -> arb_mat:
    """A diagonal matrix."""
    matrix = arb_mat(len(entries), len(entries))
    for i, entry in enumerate(entries):
        matrix[i, i] = entry
    return matrix


def step_length(system: System, states: States, drives: Sequence[Piece]) -> float:
    """The longest step; infinite where nothing bounds it [s]."""
    return min([system.angle / system.rate(states), *(piece.longest_step() for piece in drives)])


def expand(
    system: System, states: States, start: Start, drives: Sequence[Piece], length: float, count: int | None = None
) -> Segment:
    """The series of a step of a length [s].

    It has `count` terms, two at least; None: as many as the digits need, and a tail that bounds those that follow.
    """
    full = count is None
    angle = 0.0
    if count is None:
        angle = system.rate(states) * length
        of_motion = term_count(min(max(angle, 1.0), 2 * system.angle)) + FURTHER_TERMS
        count = max([LEAST_TERMS, of_motion, *(piece.term_count(length) + 2 for piece in drives)])
    known = count - 2 if full else count
    of_drives = [[*piece.series(start.time, length, known), *[ZERO] * (count - known)] for piece in drives]
    span = arb(length)
    motion = system.motion(states)
    terms = [start.u, start.v * span]
    square = span * span
    for k in range(count - 2):
        a = motion.A * terms[k]
        if k == 0:
            a = a + motion.R * column(start.references) + motion.f
        if motion.D is not None:
            a += motion.D * terms[k + 1] * ((k + 1) / span)
        if of_drives:
            base, pressure = of_drives
            rate = base[k + 1] * (k + 1) / span
            s = [base[k], rate, base[k + 2] * ((k + 1) * (k + 2)) / square, pressure[k]]
            a += motion.E * column(s)
        terms.append(a * (square / ((k + 1) * (k + 2))))
    if not full:
        return Segment(system, length, terms, of_drives, arb("inf"), [arb("inf") for _ in drives])
    drive_tails = [piece.tail(start.time, length, known).upper() for piece in drives]
    ratio = arb(angle) / count
    before, last = (system.norm(term.entries()) for term in terms[-2:])
    largest = max((last * ratio).upper(), (before * ratio * ratio * 1.1).upper())
    tail = tail_sum(ratio) * arb(count) ** 3 * largest
    if drives:
        of_base, of_pressure = drive_tails
        pushes = np.linalg.norm(system.root[0] @ floats(motion.E), axis=0) * INFLATION
        left_out = zip(pushes.tolist(), (of_base * square, of_base * span, of_base, of_pressure * square), strict=True)
        tail += sum((push * part for push, part in left_out), ZERO) * arb(angle).exp() * (1 + arb(angle)) ** 3
    tail = tail.upper()
    return Segment(system, length, terms, of_drives, tail, drive_tails)


def floats(matrix: arb_mat) -> Array:
    """Midpoints of a matrix."""
    return np.array([*map(float, matrix.entries())]).reshape(matrix.nrows(), matrix.ncols())
