r"""Forces of closed contacts that are glued in shear, for a given state of all contacts.

A contact that closes within the step slides freely up to its crossing. Its equation,

    d_f + (C lambda)_d + T/(beta p_s) = 0,    beta = 1 - theta = (N/p) / (w_n + N/p),

is that of a softer spring, so that for given beta the matrix is symmetric and positive definite like that of
contacts that stay closed (beta = 1). beta itself is found by Newton's method on beta = beta(N).
"""

from __future__ import annotations

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


class _Tried(NamedTuple):
    """Forces for given shares beta."""

    normal: Array  # N of the closed contacts
    shear: Array  # T of the closed contacts
    slope: Array  # dN/dbeta, one column for each closed contact; zero for one without shear


def glued(law: Unilateral, before: Corners, free: Free, closed: tuple[bool, ...]) -> Corners:
    """Return the corners at the end of the step if these are closed; with NaN where no crossing is found."""
    shut = [i for i, now in enumerate(closed) if now]
    closing = [k for k, i in enumerate(shut) if not before.closed[i]]
    system = _System(law, before, free, shut)
    beta = np.ones(len(shut))
    tried = system.solve(beta)
    for _ in range(CROSSING_STEPS if closing else 0):
        shares = [slipped_share(law, before.gap[shut[k]], float(tried.normal[k])) for k in closing]
        rates = np.array([rate for _, rate in shares])
        J = np.eye(len(closing)) - rates[:, None] * tried.slope[np.ix_(closing, closing)]
        change = np.linalg.solve(J, np.array([share for share, _ in shares]) - beta[closing])
        beta[closing] = np.clip(beta[closing] + change, 0.0, 1.0)
        tried = system.solve(beta)
        if np.all(np.abs(change) <= CROSSING_CHANGE * beta[closing]):
            return system.corners(closed, tried)
    if closing:
        tried = _Tried(tried.normal * np.nan, tried.shear, tried.slope)
    return system.corners(closed, tried)


class _System:
    """The equations of the closed contacts, `shut`."""

    def __init__(self, law: Unilateral, before: Corners, free: Free, shut: list[int]) -> None:
        self.law, self.before, self.free, self.shut = law, before, free, shut
        self.C = np.array(free.C)
        self.y = np.array([*free.gap, *free.slide])

    def _rows(self, active: list[int]) -> tuple[Array, Array]:
        """Return the unknown forces as rows over (w, slides), and T of the active contacts from the last of them."""
        n, m = len(self.before.closed), len(self.shut)
        rows = np.zeros((m + len(active), len(self.y)))
        rows[range(m), self.shut] = 1.0
        if len(active) == 2:  # H and G
            rows[m:, n:] = np.eye(2)
            return rows, np.array([[0.5, -1.0], [0.5, 1.0]])
        for k in active:
            rows[m:, n:] = SLIDES[n][self.shut[k]]
        return rows, np.eye(len(active))

    def solve(self, beta: Array) -> _Tried:
        """Return the forces with the springs in shear that beta makes softer."""
        m, active = len(self.shut), [k for k, share in enumerate(beta) if share > 0]
        rows, W = self._rows(active)
        soft = 1 / (self.law.shear * beta[active])
        stretch = np.array([self.before.stretch[self.shut[k]] for k in active])
        A = rows @ self.C @ rows.T
        A[range(m), range(m)] += self.law.compliance
        A[m:, m:] += (W.T * soft) @ W
        b = -(rows @ self.y)
        b[m:] -= W.T @ stretch
        scale = 1 / np.sqrt(np.diag(A))  # symmetric, so that a stiff direction keeps its digits beside a soft one
        scaled = A * scale * scale[:, None]
        forces = np.linalg.solve(scaled, b * scale) * scale
        shear, slope = np.zeros(m), np.zeros((m, m))
        shear[active] = W @ forces[m:]
        push = np.zeros((len(b), len(active)))
        push[m:] = W.T * (soft * shear[active] / beta[active])
        slope[:, active] = (np.linalg.solve(scaled, push * scale[:, None]) * scale[:, None])[:m]
        return _Tried(forces[:m], shear, slope)

    def corners(self, closed: tuple[bool, ...], tried: _Tried) -> Corners:
        """Return all contacts under the forces of the closed ones."""
        n = len(closed)
        normal, shear = [0.0] * n, [0.0] * n
        for i, N, T in zip(self.shut, tried.normal.tolist(), tried.shear.tolist(), strict=True):
            normal[i], shear[i] = N, T
        moved = self.free.gap + self.C[:n] @ np.array([*normal, *slide_forces(shear)])
        soft = self.law.compliance
        gap = (0.0 - N * soft if now else w for now, N, w in zip(closed, normal, moved.tolist(), strict=True))
        stretch = (0.0 - T / self.law.shear for T in shear)
        return Corners(closed, tuple(gap), tuple(stretch), self.before.reference, tuple(normal), tuple(shear))
