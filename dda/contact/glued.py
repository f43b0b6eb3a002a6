r"""Forces of closed contacts that are glued in shear, for a given state of all contacts.

A contact that closes within the step slides freely up to its crossing. Its equation,

    d_f + (C lambda)_d + T/(beta p_s) = 0,    beta = 1 - theta = (N/p) / (w_n + N/p),

is that of a softer spring, so that for given beta the matrix is symmetric and positive definite like that of
contacts that stay closed (beta = 1). beta itself is found by Newton's method on beta = beta(N).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import SLIDES, Corners, Unilateral, slide_forces, slipped_share

Array = NDArray[np.float64]
Floats = Sequence[float]

CROSSING_STEPS = 60  # of Newton's method, which takes about five
CROSSING_CHANGE = 1e-9  # of its last step, whose square is below rounding


class Free(NamedTuple):
    """What a step without contact forces does to the contacts, and what forces change of it."""

    gap: Floats  # w_f [m]
    slide: Floats  # d_f, displacement along the base in the coordinates of SLIDES [m]; empty if frictionless
    C: Sequence[Floats]  # flexibility [m/N], in (w, those coordinates) if glued, else in w
    gains: dict[tuple[int, ...], list[list[float]]]  # kept by a step length: forces of contacts that stay closed


class _Tried(NamedTuple):
    """Forces for given shares beta."""

    normal: Array  # N of the closed contacts
    shear: Array  # T of the closed contacts
    slope: Array  # dN/dbeta, one column for each closed contact; zero for one without shear


def glued(law: Unilateral, before: Corners, free: Free, closed: tuple[bool, ...]) -> Corners:
    """Return the corners at the end of the step if these are closed; with NaN where no crossing is found."""
    shut = [i for i, now in enumerate(closed) if now]
    closing = [k for k, i in enumerate(shut) if not before.closed[i]]
    system = ClosedContacts(law, before, free, shut)
    if not closing:
        return system.corners(closed, *system.held())
    return system.corners(closed, *system.crossed(np.ones(len(shut)), closing))


class ClosedContacts:
    """The equations of the closed contacts, `shut`; of those that are held in shear T is unknown."""

    def __init__(self, law: Unilateral, before: Corners, free: Free, shut: list[int]) -> None:
        self.law, self.before, self.free, self.shut = law, before, free, shut
        self.loose = np.array([*free.gap, *free.slide])  # without the unknown forces

    def crossed(self, beta: Array, closing: list[int]) -> tuple[list[float], list[float]]:
        """Return N and T, those of `closing` held from their crossings on; NaN where none is found."""
        tried = self.solve(beta)
        for _ in range(CROSSING_STEPS):
            before = [self.before.gap[self.shut[k]] for k in closing]
            shares = [slipped_share(self.law, w, float(tried.normal[k])) for w, k in zip(before, closing, strict=True)]
            rates = np.array([rate for _, rate in shares])
            J = np.eye(len(closing)) - rates[:, None] * tried.slope[np.ix_(closing, closing)]
            change = np.linalg.solve(J, np.array([share for share, _ in shares]) - beta[closing])
            beta[closing] = np.clip(beta[closing] + change, 0.0, 1.0)
            tried = self.solve(beta)
            if np.all(np.abs(change) <= CROSSING_CHANGE * beta[closing]):
                return tried.normal.tolist(), tried.shear.tolist()
        return [math.nan] * len(beta), [math.nan] * len(beta)

    def drag(self, A: Array, rows: Array) -> None:
        """Add to the matrix what T does that follows N; nothing where all closed contacts are held."""

    def _rows(self, active: list[int], soft: Array) -> tuple[Array, Array]:
        """Return the unknown forces as rows over (w, slides), and T of the active contacts from the last of them.

        H and G keep apart the rigid and the elastic flexibility, but mix unequal softnesses: beyond the rigid
        flexibility these decide, and the corners' own forces keep the digits.
        """
        n, m, C = len(self.before.closed), len(self.shut), self.free.C
        rows = np.zeros((m + len(active), len(C)))
        rows[range(m), self.shut] = 1.0
        if len(active) == 2 and (soft[0] == soft[1] or max(soft) <= C[n][n]):
            rows[m:, n:] = np.eye(2)
            return rows, np.array([[0.5, -1.0], [0.5, 1.0]])
        for row, k in enumerate(active, start=m):
            rows[row, n:] = SLIDES[n][self.shut[k]]
        return rows, np.eye(len(active))

    def matrix(self, beta: Array, active: list[int]) -> tuple[Array, Array, Array, Array]:
        """Return the matrix, its scale (a stiff direction keeps its digits), the rows and W."""
        m = len(self.shut)
        soft = 1 / (self.law.shear * beta[active])
        rows, W = self._rows(active, soft)
        A = rows @ np.array(self.free.C) @ rows.T
        A[range(m), range(m)] += self.law.compliance
        A[m:, m:] += (W.T * soft) @ W
        scale = 1 / np.sqrt(np.diag(A))
        self.drag(A, rows)
        return A * scale * scale[:, None], scale, rows, W

    def solve(self, beta: Array) -> _Tried:
        """Return the forces with the springs in shear that beta makes softer."""
        m, active = len(self.shut), [k for k, share in enumerate(beta) if share > 0]
        scaled, scale, rows, W = self.matrix(beta, active)
        b = -(rows @ self.loose)
        b[m:] -= W.T @ np.array([self.before.stretch[self.shut[k]] for k in active])
        forces = np.linalg.solve(scaled, b * scale) * scale
        shear, slope = np.zeros(m), np.zeros((m, m))
        shear[active] = W @ forces[m:]
        push = np.zeros((len(b), len(active)))
        push[m:] = W.T * (shear[active] / (self.law.shear * beta[active] ** 2))
        slope[:, active] = (np.linalg.solve(scaled, push * scale[:, None]) * scale[:, None])[:m]
        return _Tried(forces[:m], shear, slope)

    def held(self) -> tuple[list[float], list[float]]:
        """Return N and T of contacts that were closed before, by the inverse that the step length keeps."""
        key, m = tuple(self.shut), len(self.shut)
        if key not in self.free.gains:
            self.free.gains[key] = self._gain()
        slides, stretch = self.free.slide, [self.before.stretch[i] for i in self.shut]
        if m == 2:  # the coordinates are mean and difference
            loose = [slides[0] + (stretch[0] + stretch[1]) / 2, slides[1] + (stretch[1] - stretch[0])]
        else:
            line = SLIDES[len(self.before.closed)][self.shut[0]]
            loose = [stretch[0] + sum(q * s for q, s in zip(line, slides, strict=True))]
        y = [*(self.free.gap[i] for i in self.shut), *loose]
        forces = [-sum(g * v for g, v in zip(row, y, strict=True)) for row in self.free.gains[key]]
        if m == 2:
            return forces[:2], [forces[2] / 2 - forces[3], forces[2] / 2 + forces[3]]
        return forces[:1], forces[1:]

    def _gain(self) -> list[list[float]]:
        """Return the inverse of the matrix of contacts that stay closed."""
        scaled, scale, _, _ = self.matrix(np.ones(len(self.shut)), list(range(len(self.shut))))
        gain: list[list[float]] = (np.linalg.inv(scaled) * scale * scale[:, None]).tolist()
        return gain

    def corners(self, closed: tuple[bool, ...], forces: Sequence[float], held: Sequence[float]) -> Corners:
        """Return all contacts under N and T of the closed ones."""
        n, soft = len(closed), self.law.compliance
        normal, shear, gap = [0.0] * n, [0.0] * n, list(self.free.gap)
        for i, N, T in zip(self.shut, forces, held, strict=True):
            normal[i], shear[i], gap[i] = N, T, 0.0 - N * soft
        both = [*normal, *slide_forces(shear)]
        for i in range(n):
            if not closed[i]:
                gap[i] += sum(c * force for c, force in zip(self.free.C[i], both, strict=True))
        stretch = tuple(0.0 - T / self.law.shear for T in shear)
        return Corners(closed, tuple(gap), stretch, self.before.reference, tuple(normal), tuple(shear))
