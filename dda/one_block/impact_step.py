r"""One time step of a block on rigid contact with a coefficient of restitution, by the theta method (Moreau and Jean).

With u = gg V at the start, h the step's length, k0 = h^2 K0, F for h^2 F and impulses P (`dda.contact.impact`),

    S0 h (V1 - u) = F - k0 (D + theta h u) + h B' P,        S0 = M + theta^2 k0
    D1 = D + h (theta V1 + (1 - theta) u)

Without impulses this is Newmark's scheme with alpha = theta^2 and delta = 2 theta - 1/2, whose weights it takes; no
acceleration is carried, and how it starts does not matter. The rates are those of the gaps after gg: e counts from u.
Forces of contact are N = P/h, which grow as 1/h in an impact.

Of the energy an impact takes -P (w'_0 + w'_1)/2, and the algorithm

    (theta - 1/2) [ (V1 - u)' M (V1 - u) + (D1 - D)' K0 (D1 - D) - sum of P (w'_1 - w'_0) ].
"""

from __future__ import annotations

import math

from dda.contact.dense import Vector, dot, multiply, quadratic
from dda.contact.impact import impulses
from dda.contact.kernel import FOUND, Shear
from dda.one_block.unilateral_step import (
    BlockEquations,
    BlockState,
    StepLength,
    begin_step,
    keep,
    length_of,
    mean_share,
)
from dda.stepping.driver import BaseRecord, Part, driver
from dda.stepping.energy import ALGORITHMIC, CONTACT, DAMPING, GIVEN, IMPULSE


def advance(
    block: BlockEquations,
    shear_law: Shear,
    state: BlockState,
    after: BlockState,
    base: BaseRecord | None,
    part: Part,
) -> tuple[int, int]:
    """Make a part of a step from `state` to `after`; return the outcome and the number of solves."""
    room = block.room
    n = len(block.K)
    c = len(room.slide)
    length = length_of(block, shear_law, block.last, part.ratio)
    h = length.numbers[2]
    theta = math.sqrt(block.last.numbers.alpha)
    begin_step(block, state, length)
    if block.ramp > 0:
        share = mean_share(block, block.last.numbers, part, theta)
        for i in range(n):
            length.F[i] = share * h * h * block.load[i]
    start = room.change  # h u
    multiply(block.inverse_mass, room.P, n, n, start)
    for i in range(n):
        room.balance[i] = length.F[i] - length.k[i] * (state.D[i] + theta * start[i])
    multiply(length.inverse, room.balance, n, n, room.x)
    rate = room.slide
    for i in range(c):
        rate[i] = start[n - c + i] / h
        room.free.gap[i] = (start[n - c + i] + room.x[n - c + i]) / h
    outcome, solves = impulses(
        block.law, block.restitution, h, state.contacts, rate, room.free, length, after.contacts, block.work
    )
    if outcome == FOUND:
        accept(block, length, theta, state, after)
    return outcome, solves


def accept(block: BlockEquations, length: StepLength, theta: float, state: BlockState, after: BlockState) -> None:
    """Write (D, P) at the end of the step under the impulses, and the contacts: their gaps, and N = P/h."""
    room = block.room
    n = len(block.K)
    c = len(room.slide)
    h = length.numbers[2]
    contacts = after.contacts
    start = room.change
    end = room.x  # h V1
    for i in range(n):
        end[i] = start[i] + room.x[i] + h * dot(length.pushed[i], contacts.normal, c)
    for i in range(c):
        contacts.normal[i] /= h
    for i in range(n):
        after.D[i] = state.D[i] + (theta * end[i] + (1 - theta) * start[i])
        after.f[i] = 0.0
        after.P[i] = dot(block.M[i], end, n) / length.numbers[0]
    for i in range(c):
        contacts.gap[i] = after.D[n - c + i]


def account(
    block: BlockEquations, shear_law: Shear, state: BlockState, after: BlockState, part: Part, sums: Vector
) -> None:
    """Add what an accepted part of a step loses [J]."""
    room = block.room
    n = len(block.K)
    c = len(room.slide)
    length = length_of(block, shear_law, block.last, part.ratio)
    gg = length.numbers[1]
    h = length.numbers[2]
    theta = math.sqrt(block.last.numbers.alpha)
    if gg != 1:
        sums[DAMPING] += (1 - gg * gg) * quadratic(block.inverse_mass, state.P, n) / 2 / (block.step * block.step)
    share = 1.0
    if block.ramp > 0:
        share = mean_share(block, block.last.numbers, part, theta)
    change = room.change
    stored = 0.0
    for i in range(n):
        moved = after.D[i] - state.D[i]
        stored += block.K[i] * moved * moved
        sums[GIVEN] += (share - 1) * block.load[i] * moved
        change[i] = part.ratio * after.P[i] - room.P[i]
    stored += quadratic(block.inverse_mass, change, n) / (h * h)
    for i in range(c):
        P = block.multiplicity * h * after.contacts.normal[i]
        before = dot(block.inverse_mass[n - c + i], room.P, n) / h
        difference = dot(block.inverse_mass[n - c + i], change, n) / h
        sums[CONTACT] -= P * (before + difference / 2)
        sums[IMPULSE] += P
        stored -= P * difference
    sums[ALGORITHMIC] += (theta - 0.5) * stored


make_impact_steps = driver(advance, account, keep)
