r"""Friction as common programs have it: one solve behind, and out of the convergence test.

It is here to be recognised and explained, not to be used. What such programs do (Shi's and those that descend from it):

- the iteration ends when no contact opens or closes any more; stick and slip are not looked at;
- a slipping contact carries T = -sigma (tan(phi) N + c) with N of the solve before, of the last step in the first one;
- after a solve a sticking contact slips from then on if |T| > tan(phi) N + c, a slipping one sticks if it moved
  against its slip within the step;
- r of a slipping contact is s at the beginning of each step, so that it sticks again from (almost) no shear force.

A contact that slips too late carries too much, one that sticks again has lost its force: a stable block creeps, all
the more the smaller the step. Dead bands (`Unilateral.band`) are another matter, and make it worse.
"""

from __future__ import annotations

from dda.contact.friction import ROUNDING, State, pressed, states
from dda.contact.glued import Free
from dda.contact.iteration import NONE, Iteration
from dda.contact.unilateral import OPEN, SLIP, STICK, Corners, Unilateral


def lagged(law: Unilateral, before: Corners, free: Free, limit: int) -> Iteration:
    """Find the contacts at the end of a step; their states are those that the next step begins with."""
    state, held = states(before), _limits(law, before)
    for solve in range(1, limit + 1):
        after = pressed(law, before, free, state, 0.0, held)
        moved = [r + stretch for r, stretch in zip(after.slipped, after.stretch, strict=True)]  # s - r of slipping ones
        here = [way - stretch for way, stretch in zip(moved, before.stretch, strict=True)]
        given = zip(state, after.gap, after.normal, after.shear, here, strict=True)
        agreed = tuple(_following(law, *corner) for corner in given)
        if all((now == OPEN) == (was == OPEN) for now, was in zip(agreed, state, strict=True)):
            return Iteration(_kept(after, agreed, moved, here), solve)
        state, held = agreed, _limits(law, after)
    return Iteration(None, limit, NONE)


def _limits(law: Unilateral, corners: Corners) -> tuple[float, ...]:
    return tuple(law.limit(N) for N in corners.normal)


def _following(law: Unilateral, state: int, gap: float, N: float, T: float, here: float) -> int:
    """Return the state of a contact after a solve in which it moved by `here`."""
    if state == OPEN:
        return STICK if law.closes(gap) else OPEN
    if not law.stays_closed(N):
        return OPEN
    if state == STICK:
        return STICK if abs(T) <= law.limit(N) * (1 + ROUNDING) else -SLIP if T > 0 else SLIP
    return state if state * here >= 0 else STICK


def _kept(after: Corners, state: State, moved: list[float], here: list[float]) -> Corners:
    """Return the contacts with the references that the next step begins with."""
    stretch, slipped = list(after.stretch), [0.0] * len(state)
    for i, (was, now) in enumerate(zip(after.state, state, strict=True)):
        if abs(was) == SLIP:
            stretch[i] = here[i] if now == STICK else 0.0
            slipped[i] = moved[i] - stretch[i]
        elif abs(now) == SLIP:
            stretch[i], slipped[i] = 0.0, stretch[i]
    return after._replace(state=state, stretch=tuple(stretch), slipped=tuple(slipped))
