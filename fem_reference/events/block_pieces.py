"""One piece of the block's motion: between two switches the block is linear, in closed form.

Where no corner slips, in its modes; where one slips the stiffness is not symmetric, and a power series is summed.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from operator import add, mul

import numpy as np

from fem_reference.events.block_model import LEFT, OPEN, RIGHT, BlockModel, States
from fem_reference.events.block_rows import Corner, Row, State
from fem_reference.events.decimals import ONE, ZERO, Matrix, Vector, dot, eigen, small, split
from fem_reference.events.oscillation import Oscillation, Smooth
from fem_reference.events.series import ANGLE, Series, Stepper, positive, terms
from fem_reference.problem.problem import Array

GUARD = 15
"""Digits that a sum may lose before what is left of it counts as zero."""
FLOATS = 25
"""Digits of a series that is rounded to floats: more than a float has, whatever cancels at its end."""
ROUNDED = 1e-13
"""Part of its terms by which a sum of rounded coefficients may be wrong."""
SPAN = 60
"""Longest piece as an angle of its fastest mode [rad]; the sines of longer pieces would lose digits in floats."""
UNKNOWNS = [[Decimal(int(i == j)) for j in range(6)] for i in range(6)]
"""Rows of the unknowns themselves."""


@dataclass(frozen=True)
class Modes:
    """Natural modes of the block on its closed corners, M-orthonormal."""

    squares: Vector  # squared angular frequencies [rad2/s2]; exactly zero for a rigid mode
    shapes: Matrix  # mode shapes over the unknowns, one a row

    @classmethod
    def of(cls, model: BlockModel, states: States) -> Modes:
        """Modes of M^(-1/2) K M^(-1/2)."""
        roots = [m.sqrt() for m in model.mass]
        K = model.stiffness(states)
        values, vectors = eigen([[K[i][j] / (roots[i] * roots[j]) for j in range(6)] for i in range(6)])
        floor = small(GUARD) * max(values)
        squares = [value if value > floor else ZERO for value in values]
        return cls(squares, [[x / r for x, r in zip(row, roots, strict=True)] for row in vectors])


@dataclass(frozen=True)
class Piece:
    """The motion from a state on, as long as no corner switches."""

    model: BlockModel
    state: State

    @property
    def longest(self) -> Decimal | None:
        """Time for which the closed form keeps its digits [s]; None if it always does."""
        raise NotImplementedError

    def observe(self, row: Row) -> Smooth:
        """A linear function of the unknowns or of their rates, over the time since the state."""
        raise NotImplementedError

    def first_fall(self, row: Row, end: Decimal, start: Decimal) -> Decimal | None:
        """The first time in (start, end] at which such a function falls through zero, None if it does not."""
        return self.observe(row).first_fall(end, start)

    def after(self, s: Decimal) -> tuple[Vector, Vector]:
        """Unknowns and their rates a time s after the state."""
        raise NotImplementedError

    def table(self, rows: list[Row]) -> tuple[float, Array, Array]:
        """A scale of time [s], frequencies, and the coefficients of (s / scale)^k, cosines and sines.

        They are those of the six unknowns and of each row, shape (6 + rows, ...).
        """
        raise NotImplementedError

    def corner(self, index: int) -> Corner:
        """One of the corners."""
        return Corner(self.model, self.state, index)

    @property
    def forces(self) -> tuple[Vector, Vector]:
        """Forces F0 + F1 s that do not depend on the block."""
        return self.model.forces(self.state.states, self.state.references, self.state.base)


@dataclass(frozen=True)
class ModalPiece(Piece):
    """A piece in which no corner slips."""

    modes: Modes

    @cached_property
    def coordinates(self) -> list[Oscillation]:
        """The modal coordinates q as functions of the time since the state."""
        mass = self.model.mass
        F0, F1 = self.forces
        found = []
        for square, shape in zip(self.modes.squares, self.modes.shapes, strict=True):
            weighted = [m * x for m, x in zip(mass, shape, strict=True)]
            q, rate = dot(weighted, self.state.displacement), dot(weighted, self.state.velocity)
            f = dot(shape, F0)
            if square:
                w, drift = square.sqrt(), dot(shape, F1) / square
                wave = w, q - f / square, (rate - drift) / w
                found.append(Oscillation((f / square, drift, ZERO), (wave,)))
            else:  # no spring holds a rigid mode, so that the base does not move it either
                found.append(Oscillation((q, rate, f / 2), ()))
        return found

    @property
    def longest(self) -> Decimal | None:
        """Time for which sines keep their digits in floats [s]; None without modes."""
        fastest = max(q.fastest for q in self.coordinates)
        return SPAN / fastest if fastest else None

    def observe(self, row: Row) -> Oscillation:
        """A linear function of the unknowns over the time since the state."""
        c: Vector = [row.constant, row.drift, ZERO]
        size, waves = abs(row.constant), []
        for shape, q in zip(self.modes.shapes, self.coordinates, strict=True):
            share = dot(row.weights, shape)
            c = [old + share * new for old, new in zip(c, q.polynomial, strict=True)]
            size += abs(share * q.polynomial[0])
            waves += [(w, share * A, share * B) for w, A, B in q.waves]
        size += sum((abs(A) + abs(B) for _, A, B in waves), ZERO)
        kept = tuple(wave for wave in waves if abs(wave[1]) + abs(wave[2]) > small(GUARD) * size)
        first = c[0] if abs(c[0]) > small(GUARD) * size else ZERO
        return Oscillation((first, c[1], c[2]), kept)

    def table(self, rows: list[Row]) -> tuple[float, Array, Array]:
        """A scale of time of 1 s, frequencies, and the coefficients of powers, cosines and sines."""
        functions = [self.observe(row) for row in [*map(Row, UNKNOWNS), *rows]]
        frequencies = sorted({w for f in functions for w, _, _ in f.waves})
        coefficients = np.array([_coefficients(f, frequencies) for f in functions])
        return 1.0, np.array([float(w) for w in frequencies]), coefficients

    def after(self, s: Decimal) -> tuple[Vector, Vector]:
        """Unknowns and their rates a time s after the state."""
        x, rate = [ZERO] * 6, [ZERO] * 6
        for shape, q in zip(self.modes.shapes, self.coordinates, strict=True):
            value, slope, _ = q(s)
            x = [old + value * share for old, share in zip(x, shape, strict=True)]
            rate = [old + slope * share for old, share in zip(rate, shape, strict=True)]
        return x, rate


@dataclass(frozen=True)
class SlippingPiece(Piece):
    """A piece in which a corner slips."""

    stepper: Stepper

    @cached_property
    def longest(self) -> Decimal:
        """Length of the series [s]."""
        return ANGLE / Decimal(self.stepper.rate)

    @cached_property
    def coefficients(self) -> Matrix:
        """Coefficients of the powers of the time since the state over `longest`."""
        start = self.state.displacement, self.state.velocity
        return self.stepper.coefficients(start, self.forces, self.longest, terms())

    @cached_property
    def columns(self) -> list[tuple[Decimal, ...]]:
        """The same coefficients, unknown by unknown."""
        return list(zip(*self.coefficients, strict=True))

    @cached_property
    def rounded(self) -> Array:
        """Those of them that floats can see, in floats, shape (terms, unknowns)."""
        return np.array(self.coefficients[: terms(FLOATS)], dtype=float)

    def observe(self, row: Row, count: int | None = None) -> Series:
        """A linear function of the unknowns or of their rates, over the time since the state, or its first terms."""
        parts = [(w, column[:count]) for w, column in zip(row.weights, self.columns, strict=True) if w]
        c = [ZERO] * len(self.coefficients[:count])
        for i, (w, column) in enumerate(parts):
            part = column if w == 1 else map(w.__mul__, column)
            c = list(map(add, c, part) if i else part)
        if row.of_rates:
            c = [k * x / self.longest for k, x in enumerate(c)][1:]
        c[0] += row.constant
        c[1] += row.drift * self.longest
        return Series(self.longest, tuple(c))

    def first_fall(self, row: Row, end: Decimal, start: Decimal) -> Decimal | None:
        """The first time in (start, end] at which such a function falls through zero, None if it does not.

        Most functions are far from it, which floats show in a part of the time.
        """
        weights, length = np.array(row.weights, dtype=float), float(self.longest)
        c, sizes = self.rounded @ weights, np.abs(self.rounded) @ np.abs(weights)
        if row.of_rates:
            c, sizes = (x[1:] * np.arange(1, len(x)) / length for x in (c, sizes))
        added = np.array([float(row.constant), float(row.drift) * length])
        c[:2] += added
        clear = positive(c, float(end) / length, ROUNDED * float(sizes.sum() + np.abs(added).sum()))
        return None if clear else super().first_fall(row, end, start)

    def table(self, rows: list[Row]) -> tuple[float, Array, Array]:
        """The length of the series as scale of time [s], no frequencies, and the coefficients of the powers."""
        found = [self.observe(row, terms(FLOATS)).coefficients for row in rows]
        return float(self.longest), np.zeros(0), np.vstack([self.rounded.T, np.array(found, dtype=float)])

    def after(self, s: Decimal) -> tuple[Vector, Vector]:
        """Unknowns and their rates a time s after the state."""
        z, powers = s / self.longest, [ONE]
        for _ in self.coefficients[1:]:
            powers.append(powers[-1] * z)
        slopes = [k * power / self.longest for k, power in enumerate(powers[:-1], 1)]
        x = [sum(map(mul, column, powers), ZERO) for column in self.columns]
        return x, [sum(map(mul, column[1:], slopes), ZERO) for column in self.columns]


class Pieces:
    """The pieces of one block; what a state of the corners needs is prepared once."""

    def __init__(self, model: BlockModel) -> None:
        self.model = model
        self._modes: dict[States, Modes] = {}
        self._steppers: dict[States, Stepper] = {}

    def __call__(self, state: State) -> Piece:
        """The piece that begins with a state."""
        own = state.states
        if LEFT in own or RIGHT in own:
            return SlippingPiece(self.model, state, self.stepper(own))
        if own not in self._modes:
            self._modes[own] = Modes.of(self.model, own)
        return ModalPiece(self.model, state, self._modes[own])

    def stepper(self, states: States) -> Stepper:
        """What the power series of a state of the corners needs."""
        if states not in self._steppers:
            self._steppers[states] = Stepper.of(self.model.mass, self.model.stiffness(states))
        return self._steppers[states]


class FloatPiece:
    """A piece in floating point, for many instants at once.

    Its coefficients are rounded after everything that cancels has been added up in decimal arithmetic.
    """

    def __init__(self, piece: Piece, before: FloatPiece | None) -> None:
        state, corners = piece.state, [piece.corner(c) for c in (0, 1)]
        self.start = split(state.time)
        self.released = float(state.released)
        self.states = np.array(state.states, dtype=float)
        self.references = np.array([float(x) for x in state.references])
        self.slipped = np.array([float(x) for x in state.slipped])
        rows = [corner.gap for corner in corners] + [corner.stretch for corner in corners]
        rows += [corner.slide for corner in corners]
        self.scale, self.frequencies, self.coefficients = piece.table(rows)
        self.loss = self._loss(float(piece.model.ps))
        self.power, self.given = self._power(piece), 0.0
        if before is not None:
            here = np.array([self.start[0]])
            self.loss[0], self.given = before.dissipated(here)[0], before.worked(here)[0]

    def values(self, times: Array) -> tuple[Array, Array]:
        """Unknowns, gaps, stretches s - r and slides, each of shape (12, times), and their rates."""
        s = (times - self.start[0]) - self.start[1]
        angle = np.outer(self.frequencies, s)
        w = self.frequencies[:, None]
        count = self.coefficients.shape[1] - 2 * len(self.frequencies)
        powers = np.vander(s / self.scale, count, increasing=True).T
        slopes = np.vstack([np.zeros_like(s), powers[:-1] * np.arange(1, count)[:, None] / self.scale])
        basis = np.vstack([powers, np.cos(angle), np.sin(angle)])
        rates = np.vstack([slopes, -w * np.sin(angle), w * np.cos(angle)])
        return self.coefficients @ basis, self.coefficients @ rates

    def contacts(self, times: Array, values: Array) -> Array:
        """States, movements of the references, energies lost by opening and by friction, base's work, (7, times)."""
        slipping = np.abs(self.states) == RIGHT
        moved = slipping[:, None] * (values[10:12] - values[8:10] - self.references[:, None])
        ones = np.ones_like(times)
        states, slipped = np.outer(self.states, ones), self.slipped[:, None] + moved
        return np.vstack([states, slipped, self.released * ones, self.dissipated(times), self.worked(times)])

    def worked(self, times: Array) -> Array:
        """Work of the base until some instants of the piece [J]."""
        s, w = (times - self.start[0]) - self.start[1], self.frequencies[:, None]
        count = len(self.power) - 2 * len(w)
        powers = np.vander(s / self.scale, count + 1, increasing=True).T[1:] / np.arange(1, count + 1)[:, None]
        swings = [np.sin(w * s) / w, 2 * np.sin(w * s / 2) ** 2 / w]
        return self.given + self.power @ np.vstack([self.scale * powers, *swings])

    def _power(self, piece: Piece) -> Array:
        """Coefficients of N y' + T x', the power of the base, like those of the rows."""
        base, closed = piece.state.base, self.states != OPEN
        N, T = -float(piece.model.p) * self.coefficients[6:8], -float(piece.model.ps) * self.coefficients[8:10]
        return np.asarray(closed @ (float(base.vy) * N + float(base.vx) * T))

    def dissipated(self, times: Array) -> Array:
        """Energy lost by friction until some instants of the piece [J]."""
        z = ((times - self.start[0]) - self.start[1]) / self.scale
        return np.asarray(np.polynomial.polynomial.polyval(z, self.loss))

    def _loss(self, ps: float) -> Array:
        """Coefficients of the integral of -T r', T = -p_s (s - r), over (s / scale)^k; zero where no corner slips."""
        total = np.zeros(2 * self.coefficients.shape[1])
        for c in np.flatnonzero(np.abs(self.states) == RIGHT):
            stretch, slide = self.coefficients[8 + c], self.coefficients[10 + c]
            moved = (slide - stretch)[1:] * np.arange(1, len(slide))
            power = np.convolve(ps * stretch, moved)
            total[1 : len(power) + 1] += power / np.arange(1, len(power) + 1)
        return total


def _coefficients(row: Oscillation, frequencies: list[Decimal]) -> list[float]:
    """Coefficients of 1, s, s^2, the cosines and the sines."""
    even = dict.fromkeys(frequencies, ZERO)
    odd = dict(even)
    for w, A, B in row.waves:
        even[w] += A
        odd[w] += B
    return [float(x) for x in (*row.polynomial, *even.values(), *odd.values())]
