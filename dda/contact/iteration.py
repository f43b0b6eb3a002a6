r"""The open-close iteration in the force form: which contacts are closed at the end of a step, and their forces.

Without contact forces a step would bring the contacts to the gaps w_f and move them along the base by d_f.
Forces lambda = (N, T) add the flexibility C of the step,

    (w, d) = (w_f, d_f) + C lambda,

and the law holds at the end of the step: N = -p w of a closed contact, T = -p_s (s - r). So

    closed               (C lambda)_w + N/p = -w_f
    closed before, too   (C lambda)_d + T/p_s = -(s_n - r + d_f)
    closing              (C lambda)_d + T/((1 - theta) p_s) = -d_f,   1 - theta = (N/p) / (w_n + N/p)

and no stiffness is added to C: a stiff spring costs no digit and a rigid stop is 1/p = 0. The iteration
solves for the present states, updates all of them at once and ends when none changes. Where it does not
end, all states are tried: exactly one that agrees with its own forces is taken.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

from dda.contact.glued import Free, glued
from dda.contact.unilateral import Corners, Unilateral

NONE = "no consistent contact state"
SEVERAL = "several consistent contact states"


class Iteration(NamedTuple):
    """Corners at the end of a step and the solves they took, or why there are none."""

    corners: Corners | None
    solves: int
    failure: str | None = None
    mean: tuple[float, ...] | None = None  # normal forces over the step where they are not those of its end [N]


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
    nothing = (0.0,) * len(closed)
    if not any(closed):
        return Corners(closed, tuple(free.gap), nothing, before.reference, nothing, nothing)
    if len(free.slide):
        return glued(law, before, free, closed)
    gap, normal = _frictionless(law.compliance, free, closed)
    return Corners(closed, gap, nothing, before.reference, normal, nothing)


def _frictionless(soft: float, free: Free, closed: tuple[bool, ...]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return gaps and normal forces."""
    C, w = free.C, free.gap
    if len(closed) == 1:
        N = -w[0] / (C[0][0] + soft)
        return (0.0 - N * soft,), (N,)
    if all(closed):
        normal = _pair(C[0][0] + soft, C[0][1], C[1][1] + soft, -w[0], -w[1])
        return (0.0 - normal[0] * soft, 0.0 - normal[1] * soft), normal
    shut = 0 if closed[0] else 1
    N = -w[shut] / (C[shut][shut] + soft)
    pressed, other = 0.0 - N * soft, w[1 - shut] + C[1 - shut][shut] * N
    return ((pressed, other), (N, 0.0)) if shut == 0 else ((other, pressed), (0.0, N))


def _pair(a: float, b: float, c: float, x: float, y: float) -> tuple[float, float]:
    """Solve [[a, b], [b, c]], positive definite, such that exchanging the unknowns exchanges the answers."""
    return (x - b / c * y) / (a - b / c * b), (y - b / a * x) / (c - b / a * b)
