r"""The open-close iteration in the force form: which contacts are closed at the end of a step, and their forces.

Without contact forces a step would bring the contacts to the gaps w_f and move them along the base by d_f.
Forces lambda = (N, T) add the flexibility C of the step,

    (w, d) = (w_f, d_f) + C lambda,

and the law holds at the end of the step: N = -p w of a closed contact, T = -p_s (s - r). So

    closed               (C lambda)_w + N/p = -w_f
    closed before, too   (C lambda)_d + T/p_s = -(s_n - r + d_f)
    closing              (1 - theta) (d_f + (C lambda)_d) + T/p_s = 0,   1 - theta = (N/p) / (w_n + N/p)

and no stiffness is added to C: a stiff spring costs no digit and a rigid stop is 1/p = 0. The iteration
solves for the present states, updates all of them at once and ends when none changes. Where it does not
end, all states are tried: exactly one that agrees with its own forces is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import Corners, Unilateral, slipped_share

NONE = "no consistent contact state"
SEVERAL = "several consistent contact states"
CROSSING_STEPS = 60  # of Newton's method for theta, which takes about five
CROSSING_CHANGE = 1e-10  # of its last step, whose square is far below rounding

Array = NDArray[np.float64]
Floats = Sequence[float]


class Free(NamedTuple):
    """What a step without contact forces does to the contacts, and what forces change of it."""

    gap: Floats  # w_f [m]
    slide: Floats  # d_f, tangential displacement within the step [m]
    C: Sequence[Floats]  # flexibility [m/N], in (N, T) if glued, else in N


class Iteration(NamedTuple):
    """Corners at the end of a step and the solves they took, or why there are none."""

    corners: Corners | None
    solves: int
    failure: str | None = None


def open_close(law: Unilateral, before: Corners, free: Free, limit: int) -> Iteration:
    """Find the states of all contacts at the end of a step.

    Parameters
    ----------
    law
        The law of the contacts.
    before
        The contacts at the start of the step.
    free
        The step without contact forces.
    limit
        Greatest number of solves before all states are tried.
    """
    closed = before.closed
    for solve in range(1, limit + 1):
        after = trial(law, before, free, closed)
        agreed = states_after(law, after)
        if agreed == closed:
            return Iteration(after, solve)
        closed = agreed
    return _all_states(law, before, free, limit)


def _all_states(law: Unilateral, before: Corners, free: Free, solves: int) -> Iteration:
    """Return the only state that agrees with its own forces."""
    found = []
    for closed in product((False, True), repeat=len(before.closed)):
        solves += 1
        after = trial(law, before, free, closed)
        if states_after(law, after) == closed:
            found.append(after)
    if len(found) == 1:
        return Iteration(found[0], solves)
    return Iteration(None, solves, SEVERAL if found else NONE)


def states_after(law: Unilateral, tried: Corners) -> tuple[bool, ...]:
    """Return the states that the law makes of tried corners."""
    return tuple(
        law.stays_closed(N) if shut else law.closes(w)
        for shut, w, N in zip(tried.closed, tried.gap, tried.normal, strict=True)
    )


def trial(law: Unilateral, before: Corners, free: Free, closed: tuple[bool, ...]) -> Corners:
    """Return the corners at the end of the step if these are closed, whether their forces agree or not."""
    if not any(closed):
        nothing = (0.0,) * len(closed)
        return Corners(closed, tuple(free.gap), nothing, nothing, nothing)
    if law.shear == 0:
        return _frictionless(law, free, closed)
    return _glued(law, before, free, closed)


def _frictionless(law: Unilateral, free: Free, closed: tuple[bool, ...]) -> Corners:
    C, w, soft = free.C, free.gap, law.compliance
    if len(closed) == 1:
        N = -w[0] / (C[0][0] + soft)
        return Corners(closed, (0.0 - N * soft,), (0.0,), (N,), (0.0,))
    if all(closed):
        normal = _pair(C[0][0] + soft, C[0][1], C[1][1] + soft, -w[0], -w[1])
        return Corners(closed, (0.0 - normal[0] * soft, 0.0 - normal[1] * soft), (0.0, 0.0), normal, (0.0, 0.0))
    shut = 0 if closed[0] else 1
    N = -w[shut] / (C[shut][shut] + soft)
    pressed, other = 0.0 - N * soft, w[1 - shut] + C[1 - shut][shut] * N
    gap, normal = ((pressed, other), (N, 0.0)) if shut == 0 else ((other, pressed), (0.0, N))
    return Corners(closed, gap, (0.0, 0.0), normal, (0.0, 0.0))


def _pair(a: float, b: float, c: float, x: float, y: float) -> tuple[float, float]:
    """Solve [[a, b], [b, c]] for two unknowns, positive definite, so that exchanging them exchanges the answers."""
    t = b / a
    second = (y - t * x) / (c - t * b)
    t = b / c
    return (x - t * y) / (a - t * b), second


def _glued(law: Unilateral, before: Corners, free: Free, closed: tuple[bool, ...]) -> Corners:
    """Solve for the forces of closed contacts that hold in shear, closing ones at their crossing."""
    n, C = len(closed), free.C
    shut = [i for i in range(n) if closed[i]]
    held = [i for i in shut if before.closed[i]]
    rows = [*shut, *(n + i for i in shut)]
    A = np.array([[C[i][j] for j in rows] for i in rows])
    m = len(shut)
    A[range(m), range(m)] += law.compliance
    A[range(m, 2 * m), range(m, 2 * m)] += 1 / law.shear
    stretch = [before.stretch[i] + free.slide[i] if i in held else free.slide[i] for i in shut]
    b = -np.array([*(free.gap[i] for i in shut), *stretch])
    forces: Array = np.linalg.solve(A, b)
    closing = [k for k, i in enumerate(shut) if i not in held]
    if closing:
        forces = _at_crossing(law, before, A, b, forces, [(k, shut[k]) for k in closing])
    return _corners(law, free, closed, shut, forces.tolist())


def _at_crossing(
    law: Unilateral,
    before: Corners,
    A: Array,
    b: Array,
    forces: Array,
    closing: list[tuple[int, int]],
) -> Array:
    """Solve the equations with the crossing in them by Newton's method; `closing` pairs row and contact.

    No state agrees with the NaN that is returned where the method does not converge.
    """
    m, soft = len(b) // 2, 1 / law.shear
    for _ in range(CROSSING_STEPS):
        J, y = A.copy(), b.copy()
        for k, i in closing:
            share, rate = slipped_share(law, before.gap[i], float(forces[k]))
            slid = float(A[m + k] @ forces) - soft * float(forces[m + k]) - float(b[m + k])
            J[m + k] *= share
            J[m + k, m + k] += (1 - share) * soft
            J[m + k, k] += rate * slid
            y[m + k] = share * b[m + k] + rate * slid * forces[k]
        found: Array = np.linalg.solve(J, y)
        moved = np.max(np.abs(found - forces))
        forces = found
        if moved <= CROSSING_CHANGE * np.max(np.abs(found)):
            return forces
    return np.full_like(forces, np.nan)


def _corners(law: Unilateral, free: Free, closed: tuple[bool, ...], shut: list[int], forces: list[float]) -> Corners:
    """Return the corners under given forces of the closed ones, (N, T)."""
    n, m = len(closed), len(shut)
    normal, shear, gap, stretch = [0.0] * n, [0.0] * n, list(free.gap), [0.0] * n
    for k, i in enumerate(shut):
        normal[i], shear[i] = forces[k], forces[m + k]
        gap[i], stretch[i] = 0.0 - normal[i] * law.compliance, 0.0 - shear[i] / law.shear
    both = [*normal, *shear]
    for i in range(n):
        if not closed[i]:
            gap[i] += sum(c * force for c, force in zip(free.C[i], both, strict=True))
    return Corners(closed, tuple(gap), tuple(stretch), tuple(normal), tuple(shear))
