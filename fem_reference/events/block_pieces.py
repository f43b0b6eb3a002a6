"""One piece of the block's motion: between two switches the block is linear and its modes are in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property

import numpy as np

from fem_reference.events.block_model import BlockModel
from fem_reference.events.decimals import ZERO, Matrix, Vector, dot, eigen, small, split
from fem_reference.events.oscillation import Oscillation
from fem_reference.problem.problem import Array

GUARD = 15
"""Digits that a sum may lose before what is left of it counts as zero."""
Closed = tuple[bool, bool]


@dataclass(frozen=True)
class Modes:
    """Natural modes of the block on its closed corners, M-orthonormal."""

    squares: Vector  # squared angular frequencies [rad2/s2]; exactly zero for a rigid mode
    shapes: Matrix  # mode shapes over the unknowns, one a row

    @classmethod
    def of(cls, model: BlockModel, closed: Closed) -> Modes:
        """Modes of M^(-1/2) K M^(-1/2)."""
        roots = [m.sqrt() for m in model.mass]
        K = model.stiffness(closed)
        values, vectors = eigen([[K[i][j] / (roots[i] * roots[j]) for j in range(6)] for i in range(6)])
        floor = small(GUARD) * max(values)
        squares = [value if value > floor else ZERO for value in values]
        return cls(squares, [[x / r for x, r in zip(row, roots, strict=True)] for row in vectors])


@dataclass(frozen=True)
class State:
    """An instant of the motion."""

    time: Decimal  # instant [s]
    displacement: Vector  # unknowns (u, v, ux, uy, vx, vy) [m, -]
    velocity: Vector  # their rates [m/s, 1/s]
    closed: Closed  # which of the corners M and N are closed from now on
    references: tuple[Decimal, Decimal]  # shear stretch at which each corner closed last [m]
    released: Decimal  # energy of the shear springs lost by opening until now [J]


@dataclass(frozen=True)
class Piece:
    """The motion from a state on, as long as no corner switches."""

    model: BlockModel
    modes: Modes
    state: State

    @cached_property
    def coordinates(self) -> list[Oscillation]:
        """The modal coordinates q as functions of the time since the state."""
        mass = self.model.mass
        F = self.model.force(self.state.closed, self.state.references)
        found = []
        for square, shape in zip(self.modes.squares, self.modes.shapes, strict=True):
            weighted = [m * x for m, x in zip(mass, shape, strict=True)]
            q, rate = dot(weighted, self.state.displacement), dot(weighted, self.state.velocity)
            f = dot(shape, F)
            if square:
                w = square.sqrt()
                found.append(Oscillation((f / square, ZERO, ZERO), ((w, q - f / square, rate / w),)))
            else:
                found.append(Oscillation((q, rate, f / 2), ()))
        return found

    def observe(self, row: Vector, constant: Decimal = ZERO) -> Oscillation:
        """A linear function of the unknowns, row x + constant, over the time since the state."""
        c: Vector = [constant, ZERO, ZERO]
        size, waves = abs(constant), []
        for shape, q in zip(self.modes.shapes, self.coordinates, strict=True):
            share = dot(row, shape)
            c = [old + share * new for old, new in zip(c, q.polynomial, strict=True)]
            size += abs(share * q.polynomial[0])
            waves += [(w, share * A, share * B) for w, A, B in q.waves]
        size += sum((abs(A) + abs(B) for _, A, B in waves), ZERO)
        kept = tuple(wave for wave in waves if abs(wave[1]) + abs(wave[2]) > small(GUARD) * size)
        first = c[0] if abs(c[0]) > small(GUARD) * size else ZERO
        return Oscillation((first, c[1], c[2]), kept)

    def gap(self, corner: int) -> Oscillation:
        """Gap of a corner [m]."""
        return self.observe(self.model.normal[corner], self.model.gap)

    def after(self, s: Decimal) -> tuple[Vector, Vector]:
        """Unknowns and their rates a time s after the state."""
        x, rate = [ZERO] * 6, [ZERO] * 6
        for shape, q in zip(self.modes.shapes, self.coordinates, strict=True):
            value, slope, _ = q(s)
            x = [old + value * share for old, share in zip(x, shape, strict=True)]
            rate = [old + slope * share for old, share in zip(rate, shape, strict=True)]
        return x, rate


class FloatPiece:
    """A piece in floating point, for many instants at once.

    Its coefficients are rounded after everything that cancels has been added up in decimal arithmetic.
    """

    def __init__(self, piece: Piece) -> None:
        model, state = piece.model, piece.state
        self.start = split(state.time)
        self.released = float(state.released)
        self.closed = np.array(state.closed, dtype=float)
        rows = [piece.observe(_unit(i)) for i in range(6)]
        rows += [piece.gap(c) for c in (0, 1)]
        rows += [piece.observe(model.shear[c], -state.references[c]) for c in (0, 1)]
        frequencies = sorted({w for row in rows for w, _, _ in row.waves})
        self.frequencies: Array = np.array([float(w) for w in frequencies])
        self.coefficients: Array = np.array([_coefficients(row, frequencies) for row in rows])

    def values(self, times: Array) -> tuple[Array, Array]:
        """Unknowns, gaps and shear stretches, each of shape (10, times), and their rates."""
        s = (times - self.start[0]) - self.start[1]
        angle = np.outer(self.frequencies, s)
        w = self.frequencies[:, None]
        one, zero = np.ones_like(s), np.zeros_like(s)
        basis = np.vstack([one, s, s * s, np.cos(angle), np.sin(angle)])
        rates = np.vstack([zero, one, 2 * s, -w * np.sin(angle), w * np.cos(angle)])
        return self.coefficients @ basis, self.coefficients @ rates


def _unit(i: int) -> Vector:
    return [Decimal(int(i == j)) for j in range(6)]


def _coefficients(row: Oscillation, frequencies: list[Decimal]) -> list[float]:
    """Coefficients of 1, s, s^2, the cosines and the sines."""
    even = dict.fromkeys(frequencies, ZERO)
    odd = dict(even)
    for w, A, B in row.waves:
        even[w] += A
        odd[w] += B
    return [float(x) for x in (*row.polynomial, *even.values(), *odd.values())]
