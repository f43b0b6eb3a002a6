r"""Contact forces that do exactly the work of their springs: Armero and Petocz 1998, frictionless.

Over a step in which the gap goes from w0 to w1 a contact with the energy U(w) = p min(w, 0)^2 / 2 presses with

    N = - (U(w1) - U(w0)) / (w1 - w0),

so that its work N (w1 - w0) is the energy that its spring gives, in contact, in landing and in lift-off alike.
With the gap w_f of a step without forces and w = w_f + C N, for one contact:

    pressed before and after   N = -(w_f + w0) / (C + 2/p)
    opening, w0 < 0 < w1       C N^2 + (w_f - w0) N = p w0^2 / 2
    closing, w1 = -u < 0 < w0  (p C + 2) u^2 + 2 (w0 - u_f) u = 2 u_f w0,    u_f = -w_f,    N = p u^2 / (2 (w0 + u))

U is convex: N never increases with w1 and there always is exactly one solution. Two contacts are solved in turn,
N_N by Newton's method on the map of one round, whose slope is known and below one.
"""

from __future__ import annotations

import math

from dda.contact.rows import FOUND, INSIDE, LOWER, NONE, Flexibility, Laws, Rows, Solved, Work

ROUNDS = 400  # of two contacts, which take about five; a slender block that lands takes more
SETTLED = 2e-16  # change of a force by which the rounds end


def conserving(laws: Laws, before: Rows, flexible: Flexibility, after: Rows, work: Work) -> Solved:
    """Find the contacts at the end of a step, and in `work.mean` their forces over the step.

    A contact is closed if its gap is negative at the end; its force there is that of its spring.
    """
    W = flexible.W
    p = 1 / laws.compliance[0]
    w0 = before.opening
    w_f = work.q
    if len(w0) == 1:
        after.opening[0], work.mean[0], _ = one_contact(p, W[0][0], w0[0], w_f[0])
        write_springs(p, after)
        return FOUND, 1
    force = 0.0
    residual = math.inf
    for solves in range(1, ROUNDS + 1):
        w_M, N_M, s_M = one_contact(p, W[0][0], w0[0], w_f[0] + W[0][1] * force)
        w_N, N_N, s_N = one_contact(p, W[1][1], w0[1], w_f[1] + W[1][0] * N_M)
        change = N_N - force
        slope = W[0][1] * W[1][0] * s_M * s_N
        if abs(change) <= SETTLED * abs(N_N):
            after.opening[0] = w_M
            after.opening[1] = w_N
            work.mean[0] = N_M
            work.mean[1] = N_N
            write_springs(p, after)
            return FOUND, solves
        # by Newton's method as long as it helps; a round itself always comes nearer
        force = force + change / (1 - slope) if abs(change) < residual / 2 else N_N
        residual = abs(change)
    return NONE, ROUNDS


def write_springs(p: float, after: Rows) -> None:
    """Write what follows from the gaps at the end of the step."""
    for i in range(len(after.opening)):
        after.state[i] = INSIDE if after.opening[i] < 0 else LOWER
        after.force[i] = p * max(-after.opening[i], 0.0)
        after.slip[i] = 0.0


def one_contact(p: float, C: float, w0: float, w_f: float) -> tuple[float, float, float]:
    """Return w1 and N of one contact, and -dN/dw_f [N/m]."""
    if w0 >= 0 and w_f >= 0:
        return w_f, 0.0, 0.0
    if w0 >= 0:
        u = _penetration(p * C + 2, w0, -w_f)
        share = u / (w0 + u) if u else 0.0
        stiffness = p * share * (2 - share) / 2
        return -u, p * u * share / 2, stiffness / (1 + C * stiffness)
    N = -(w_f + w0) / (C + 2 / p)
    if -p * w0 <= 2 * N:
        return -2 * N / p - w0, N, 1 / (C + 2 / p)
    rise = w_f - w0
    root = math.sqrt(rise * rise + 2 * C * p * w0 * w0)
    N = p * w0 * w0 / (rise + root) if rise > 0 else (root - rise) / (2 * C)
    if N == 0:  # of a penetration whose square is below all numbers
        return w_f, 0.0, 0.0
    risen = p * w0 * w0 / (2 * N)
    return w0 + risen, N, N / (risen + C * N)


def _penetration(c: float, w0: float, u_f: float) -> float:
    """Return the positive root u of c u^2 + 2 (w0 - u_f) u = 2 u_f w0."""
    root = math.sqrt((w0 - u_f) * (w0 - u_f) + 2 * c * u_f * w0)
    return (u_f - w0 + root) / c if u_f > w0 else 2 * u_f * w0 / (w0 - u_f + root)
