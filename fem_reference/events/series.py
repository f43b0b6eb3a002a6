"""Power series of a linear motion whose matrix need not be symmetric, and what falls through zero in them.

M x'' + K x = F0 + F1 s has the entire solution x = sum of c_k s^k with::

    (k + 1)(k + 2) M c_(k+2) = F_k - K c_k,    F_k = 0 from k = 2 on

Eigenvalues may be complex or repeated without vectors of their own: nothing of it matters to the series. It is
summed over `ANGLE` radians of the greatest rate that the matrix can give, so that few digits cancel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal, getcontext
from functools import cache, cached_property
from operator import mul

import numpy as np

from fem_reference.events.decimals import ONE, ZERO, Matrix, Vector
from fem_reference.events.oscillation import Smooth
from fem_reference.problem.problem import Array

ANGLE = 4
"""Length of a series times the greatest rate [rad]; e^4 = 55 is how far its terms may cancel."""
MARGIN = 1e-9
"""Share of the largest terms by which a function must stay positive in floats to need no closer look."""

Sparse = list[list[tuple[int, Decimal]]]
Pair = tuple[Vector, Vector]


@dataclass(frozen=True)
class Series(Smooth):
    """Sum of coefficients times (s / scale)^k, for 0 <= s <= scale."""

    scale: Decimal  # greatest s
    coefficients: tuple[Decimal, ...]

    def __call__(self, s: Decimal) -> tuple[Decimal, Decimal, Decimal]:
        """Value, first and second derivative."""
        z = s / self.scale
        value = slope = half = ZERO
        for c in reversed(self.coefficients):
            half = half * z + slope
            slope = slope * z + value
            value = value * z + c
        return value, slope / self.scale, 2 * half / self.scale**2

    @cached_property
    def third(self) -> Decimal:
        """Bound of the third derivative."""
        terms = (k * (k - 1) * (k - 2) * abs(c) for k, c in enumerate(self.coefficients))
        return sum(terms, ZERO) / self.scale**3

    def size(self, s: Decimal) -> Decimal:
        """Sum of the absolute values of the terms at the end, the scale of their rounding."""
        return sum(map(abs, self.coefficients), ZERO)

    def first_fall(self, end: Decimal, start: Decimal = ZERO) -> Decimal | None:
        """The first s in (start, end] at which the function falls through zero, None if it does not."""
        clear = positive(np.array(self.coefficients, dtype=float), float(end / self.scale))
        return None if clear else super().first_fall(end, start)


def positive(coefficients: Array, z: float, error: float = 0.0) -> bool:
    """Whether Bernstein's form of a polynomial on [0, z], whose polygon holds it, is positive by more than an error."""
    c = coefficients * z ** np.arange(len(coefficients))
    return bool((_bernstein(len(c)) @ c).min() > MARGIN * np.abs(c).sum() + error)


_BERNSTEIN: dict[int, Array] = {}


def _bernstein(count: int) -> Array:
    """Matrix from the coefficients of powers to Bernstein's, C(j, k) / C(n, k) with n = count - 1."""
    if count not in _BERNSTEIN:
        n = count - 1
        rows = [[math.comb(j, k) / math.comb(n, k) for k in range(count)] for j in range(count)]
        _BERNSTEIN[count] = np.array(rows)
    return _BERNSTEIN[count]


def terms(digits: int | None = None) -> int:
    """Terms of a series whose remainder is below so many digits; by default those of the current decimal context."""
    return _terms(digits or getcontext().prec)


@cache
def _terms(digits: int) -> int:
    left, n = 0.0, 0
    while left > -digits - 5 or n < 2 * ANGLE:
        n += 1
        left += math.log10(ANGLE / n)
    return n


@dataclass(frozen=True)
class Stepper:
    """M^-1 K of one contact state, and how far its series go."""

    rows: Sparse  # non-zeros of M^-1 K, row by row [1/s2]
    mass: Vector  # diagonal of M [kg, kg m2]
    rate: float  # bound of the rates of the motion [rad/s]

    @classmethod
    def of(cls, mass: Vector, stiffness: Matrix) -> Stepper:
        """The stepper of a mass and a stiffness matrix."""
        rows = [[(j, k / m) for j, k in enumerate(row) if k] for row, m in zip(stiffness, mass, strict=True)]
        roots = np.sqrt([float(m) for m in mass])
        scaled = np.array([[float(k) for k in row] for row in stiffness]) / roots / roots[:, None]
        return cls(rows, mass, math.sqrt(float(np.linalg.norm(scaled, 2))))

    def coefficients(self, start: Pair, force: Pair, scale: Decimal, count: int) -> Matrix:
        """Coefficients of (s / scale)^k for k below `count`, each over the unknowns.

        Parameters
        ----------
        start
            Unknowns and their rates at s = 0.
        force
            F0 and F1.
        scale
            Unit of s [s].
        count
            Number of terms.
        """
        square = scale * scale
        units = square, square * scale
        pushes = [
            [f * u / m for f, m in zip(part, self.mass, strict=True)] for part, u in zip(force, units, strict=True)
        ]
        rows = [([j for j, _ in row], [k * square for _, k in row]) for row in self.rows]
        nothing = [ZERO] * len(rows)
        found = [start[0], [v * scale for v in start[1]]]
        for k in range(count - 2):
            pulls = [sum(map(mul, entries, map(found[k].__getitem__, places)), ZERO) for places, entries in rows]
            push = pushes[k] if k < 2 else nothing
            share = ONE / ((k + 1) * (k + 2))
            found.append([(f - pull) * share for f, pull in zip(push, pulls, strict=True)])
        return found

    def bounds(self, start: Pair, force: Pair, scale: Decimal, count: int) -> Array:
        """Bounds of the coefficients in floats, from absolute values alone, shape (count, unknowns)."""
        units = np.array([[1.0], [float(scale)]])
        pushes = np.abs(np.array(force, dtype=float)) * units * float(scale) ** 2 / np.array(self.mass, dtype=float)
        matrix = np.zeros((len(self.mass), len(self.mass)))
        for i, row in enumerate(self.rows):
            for j, entry in row:
                matrix[i, j] = abs(float(entry * scale * scale))
        found = list(np.abs(np.array(start, dtype=float)) * units)
        for k in range(count - 2):
            push = pushes[k] if k < 2 else np.zeros(len(matrix))
            found.append((push + matrix @ found[k]) / ((k + 1) * (k + 2)))
        return np.array(found)
