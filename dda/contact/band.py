r"""The contact problem of a step of rows that meet their neighbours only, as those of a column do.

It is that of `dda.contact.rows`, where W has one diagonal beside the main one and no row has friction: the least of a
strictly convex function of the forces within bounds, which has exactly one solution. The iteration solves for the
present states and updates all at once; where it has not ended after `Laws.together` solves, it sets the first row that
disagrees alone (Murty 1974), which ends for every such matrix.
"""

from __future__ import annotations

from dda.contact.dense import copy
from dda.contact.rows import (
    FOUND,
    INSIDE,
    LIMIT,
    LOWER,
    NONE,
    ROUNDING,
    UPPER,
    Flexibility,
    Laws,
    Rows,
    Solved,
    Work,
    next_state,
)

ONE_BY_ONE = 1000  # solves for each row with one state changed at a time, beyond any known problem


def find_in_band(laws: Laws, before: Rows, flexible: Flexibility, after: Rows, work: Work) -> Solved:
    """Find states, forces and openings at the end of a step, as `dda.contact.rows.find` does.

    `flexible.W` holds the main diagonal and that beside it, (2, m).
    """
    m = len(before.force)
    tried = after.state
    force = after.force
    opening = after.opening
    slip = after.slip
    compliance = laws.compliance
    lower = laws.lower
    upper = laws.upper
    opens = laws.opens
    slips = laws.slips
    q = work.q
    pivot = work.scale
    right = work.first
    own = flexible.W[0]
    beside = flexible.W[1]
    copy(before.state, tried)
    solves = 0
    slack = 0.0
    while True:
        last = UPPER
        coupled = 0.0
        known = 0.0
        diagonal = 0.0
        right_side = 0.0
        for r in range(m):  # Gauss over each run of rows inside of their bounds
            state = tried[r]
            if state != INSIDE:
                known = lower[r] if state == LOWER else upper[r]
                force[r] = known
            else:
                if last != INSIDE:
                    right_side = 0.0 - q[r] - coupled * known
                    diagonal = own[r] + compliance[r]
                else:
                    factor = coupled / diagonal
                    right_side = 0.0 - q[r] - factor * right_side
                    diagonal = own[r] + compliance[r] - factor * coupled
                right[r] = right_side
                pivot[r] = diagonal
            last = state
            coupled = beside[r]
        above = 0.0
        for r in range(m - 1, -1, -1):
            if tried[r] == INSIDE:
                force[r] = (right[r] - beside[r] * above) / pivot[r]
            above = force[r]
        solves += 1
        if solves > laws.together:  # blocks which touch in common flight have states that only rounding tells apart
            slack = 0.0
            for r in range(m):
                slack = max(slack, ROUNDING * abs(force[r]))
        agree = True
        for r in range(m):
            state = tried[r]
            row_force = force[r]
            z = 0.0
            if state == INSIDE:
                opening[r] = 0.0 - row_force * compliance[r]  # no sum: a closed row keeps its digits
                if slips:
                    slip[r] = 0.0
                if lower[r] <= row_force <= upper[r]:
                    continue
            else:
                z = q[r] + own[r] * row_force
                if r > 0:
                    z += beside[r - 1] * force[r - 1]
                if r + 1 < m:
                    z += beside[r] * force[r + 1]
                if opens[r] == 1:
                    opening[r] = z
                else:
                    stretch = compliance[r] * row_force
                    z += stretch
                    opening[r] = 0.0 - stretch
                    slip[r] = z
                if state * z <= 0:  # as its bound has it
                    continue
            new = next_state(state, row_force, z, own[r] + compliance[r], lower[r], upper[r], opens[r], 0.0, slack)
            if new != state and (agree or solves <= laws.together):
                tried[r] = new
                agree = False
        if agree:
            return FOUND, solves
        if solves == laws.most:
            return LIMIT, solves
        if solves > laws.together + ONE_BY_ONE * (m + 1):
            return NONE, solves
