"""Histories of the two-block model by other programs' time schemes and contact methods, each as its authors write it.

Two unknowns, v of the centroid and the strain ey. Schemes that `oracles.staged` has are stepped there, each other one
is the recursion of its paper with matrices and a loop; nothing is shared with `dda`, `fem_reference` or what `compare`
steps. Contact is a spring of 2 p under both corners
that is always closed (`opens=False`) or presses only; contact methods of their own are below the schemes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from oracles.staged import System, march, of_second_order, theta
from scipy.optimize import brentq


@dataclass(frozen=True)
class Body:
    """The block on its springs."""

    a: float = 2.0  # [m], a square
    rho: float = 2700.0
    E: float = 1e9
    p: float = 1e9  # per corner [N/m]
    q: float = 5e6  # [Pa]
    g: float = 0.0

    @property
    def M(self):
        m = self.rho * self.a**2
        return np.diag([m, m * self.a**2 / 12])

    @property
    def K(self):
        """Of the block alone, without the springs."""
        return np.diag([0.0, self.E * self.a**2])

    @property
    def B(self):
        """Row of the gap."""
        return np.array([1.0, -self.a / 2])

    @property
    def k(self):
        return 2 * self.p

    @property
    def F(self):
        load = self.q * self.a
        return np.array([-load - self.rho * self.a**2 * self.g, -load * self.a / 2])


@dataclass(frozen=True)
class Run:
    """What is run: a method by name, with its numbers."""

    method: str
    numbers: dict[str, Any] = field(default_factory=dict)
    body: Body = Body()
    dt: float = 2e-3
    steps: int = 100
    gg: float = 1.0
    opens: bool = False

    def history(self):
        """Return displacement and contact pressure of every step."""
        rows = METHODS[self.method](self, **self.numbers)
        x = np.array([row[0] for row in rows])
        N = np.array([row[1] for row in rows])
        return x[:, 0], N / self.body.a


def spring_force(run, w):
    """Return the force of the springs at a gap."""
    return -run.body.k * w if w < 0 or not run.opens else 0.0


# ---- schemes --------------------------------------------------------------------------------------------------------


def staged(run, name="", form="force", **numbers):
    """Return the rows of a scheme of `oracles.staged`; springs that hold are part of the stiffness."""
    b = run.body
    springs = b.k * np.outer(b.B, b.B)
    rows = b.B[None, :] if run.opens else None
    system = System(b.M, b.K if run.opens else b.K + springs, lambda t: b.F, B=rows, p=b.k)
    rest = np.zeros(2)
    x, _, N = march(system, name, run.dt, run.steps, rest, rest, run.gg, mean=form == "state", **numbers)
    return list(zip(x[1:], N[1:, 0] if run.opens else -b.k * x[1:] @ b.B, strict=True))


def newmark(run, alpha, delta, zero=False):
    return staged(run, weights=(alpha, delta), zero=zero)


def by_weights(run, am, af, zero=False, form="force"):
    return staged(run, form=form, stage=of_second_order(am, af), zero=zero)


def hht(run, e, zero=False, form="force"):
    return by_weights(run, 0.0, e, zero, form)


def stepped(run, advance, a=0.0):
    """Return the rows of a recursion from rest: x, v, a and N at the end of a step from x, gg v and a at its start."""
    x = np.zeros(2)
    v = np.zeros(2)
    rows = []
    for _ in range(run.steps):
        x, v, a, N = advance(x, run.gg * v, a)
        rows.append((x, N))
    return rows


def symplectic_euler(run):
    b, dt = run.body, run.dt

    def advance(x, u, a):
        v = u + dt * np.linalg.solve(b.M, b.F - b.K @ x + b.B * spring_force(run, b.B @ x))
        x = x + dt * v
        return x, v, a, spring_force(run, b.B @ x)

    return stepped(run, advance)


def houbolt(run):
    """(2 x1 - 5 x + 4 x_-1 - x_-2) / dt^2; the first two rows by average acceleration."""
    b, dt = run.body, run.dt
    K = b.K + b.k * np.outer(b.B, b.B)
    first = newmark(replace(run, steps=2), 0.25, 0.5)
    past = [np.zeros(2), first[0][0], first[1][0]]
    while len(past) <= run.steps:
        right = b.F + b.M @ (5 * past[-1] - 4 * past[-2] + past[-3]) / dt**2
        past.append(np.linalg.solve(2 * b.M / dt**2 + K, right))
    return [(x, -b.k * b.B @ x) for x in past[1 : run.steps + 1]]


def wilson(run, share=1.4):
    b, dt = run.body, run.dt
    K = b.K + b.k * np.outer(b.B, b.B)
    h = share * dt

    def advance(x, u, a):
        ahead = x + h * u + h * h / 3 * a
        at = np.linalg.solve(b.M + h * h / 6 * K, b.F - K @ ahead)
        a1 = a + (at - a) / share
        x = x + dt * u + dt * dt / 6 * (2 * a + a1)
        return x, u + dt / 2 * (a + a1), a1, -b.k * b.B @ x

    return stepped(run, advance, np.linalg.solve(b.M, b.F))


def runge_kutta(run):
    """The classical one of order four, without a discount."""
    b, dt = run.body, run.dt

    def rate(y):
        N = spring_force(run, b.B @ y[:2])
        return np.concatenate([y[2:], np.linalg.solve(b.M, b.F - b.K @ y[:2] + b.B * N)])

    def advance(x, u, a):
        y = np.concatenate([x, u])
        k1 = rate(y)
        k2 = rate(y + dt / 2 * k1)
        k3 = rate(y + dt / 2 * k2)
        k4 = rate(y + dt * k3)
        y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return y[:2], y[2:], a, spring_force(run, b.B @ y[:2])

    return stepped(replace(run, gg=1.0), advance)


# ---- contact methods ------------------------------------------------------------------------------------------------


def contact_split(run, law):
    """A contact force beside average acceleration of the block: Kane et al. 1999, or Armero and Petocz 1998.

    It enters a step's displacement and velocity twice as much as a part of the acceleration at its end would.
    """
    k, half = run.body.k, run.dt**2 / 2

    def kane(wf, rate, compliance, w0):
        return -2 * k * wf / (1 + k * half * compliance) if wf < 0 or not run.opens else 0.0

    def conserving(wf, rate, compliance, w0):
        return 2 * _energy_conserving(k, half * compliance, w0, wf, run.opens)

    if law == "kane":
        return by_free_gap(run, 0.25, 0.5, False, kane, lambda w, N: N / 2)
    return by_free_gap(run, 0.25, 0.5, False, conserving, lambda w, N: spring_force(run, w))


def _energy_conserving(k, C, w0, wf, opens):
    if not opens:
        return -k * (wf + w0) / (2 + k * C)

    def energy(w):
        return k * min(w, 0.0) ** 2 / 2

    def force(w1):
        if abs(w1 - w0) < 1e-14:
            return -k * min(w0, 0.0)
        return -(energy(w1) - energy(w0)) / (w1 - w0)

    high = max(wf, 0.0) + abs(w0) + 1e-9
    return force(brentq(lambda w: w - wf - C * force(w), wf - 1e-9, high, xtol=1e-17, rtol=1e-15))


def by_free_gap(run, alpha, delta, zero, force, beside=None):
    """Newmark's step with a contact force of the free gap, its rate, the compliance B M_eff^(-1) B and the gap before.

    One that stands beside the accelerations is no part of those that the next step starts from; gap and N tell it.
    """
    b, dt = run.body, run.dt
    S = b.M + alpha * dt * dt * b.K
    C = b.B @ np.linalg.solve(S, b.B)

    def advance(x, u, a):
        if beside:
            a = np.linalg.solve(b.M, b.F - b.K @ x)
        ahead = x + dt * u + dt * dt * (0.5 - alpha) * a
        af = np.linalg.solve(S, b.F - b.K @ ahead)
        wf = b.B @ (ahead + alpha * dt * dt * af)
        N = force(wf, b.B @ (u + dt * ((1 - delta) * a + delta * af)), C, b.B @ x)
        a1 = af + np.linalg.solve(S, b.B * N)
        x = ahead + alpha * dt * dt * a1
        return x, u + dt * ((1 - delta) * a + delta * a1), a1, beside(b.B @ x, N) if beside else N

    return stepped(run, advance, np.zeros(2) if zero else np.linalg.solve(b.M, b.F))


def dashpot(run, c, alpha=0.25, delta=0.5, clipped=True, zero=False):
    """Spring and dashpot at the end of the step, closed where the free gap is negative (unclipped: until w = 0)."""
    k, dt = run.body.k, run.dt

    def force(wf, rate, C, w0):
        N = -(k * wf + c * rate) / (1 + C * (alpha * dt * dt * k + delta * dt * c))
        if run.opens and wf >= 0:
            return 0.0
        return max(N, 0.0) if run.opens and clipped else N

    return by_free_gap(run, alpha, delta, zero, force)


def moreau(run, e, theta=0.5):
    """Moreau-Jean: velocity-level contact with Newton's restitution where the forecast gap is not positive."""
    b, dt = run.body, run.dt
    S = b.M + theta**2 * dt * dt * b.K

    def advance(x, u, a):
        vf = np.linalg.solve(S, b.M @ u + dt * (b.F - b.K @ x - theta * (1 - theta) * dt * b.K @ u))
        P = 0.0
        if b.B @ x + dt / 2 * (b.B @ u) <= 0:
            P = max(0.0, -(b.B @ vf + e * (b.B @ u)) / (b.B @ np.linalg.solve(S, b.B)))
        v = vf + np.linalg.solve(S, b.B * P)
        return x + dt * (theta * v + (1 - theta) * u), v, a, P / dt

    return stepped(run, advance)


def lagrange(run, alpha, delta, zero=False, tolerance=0.0, r=0.0):
    """Rigid contact in displacements: complementarity, or passes of an augmented Lagrangian down to a penetration."""

    def force(wf, rate, compliance, w0):
        C = alpha * run.dt**2 * compliance
        if not tolerance:
            return max(0.0, -wf / C)
        N = 0.0
        for _ in range(100000):
            # with the penalty r of the pass: w = wf + C N', N' = max(0, N - r w)
            N = max(0.0, (N - r * wf) / (1 + r * C))
            if wf + C * N > -tolerance:
                break
        return N

    return by_free_gap(run, alpha, delta, zero, force)


METHODS = {
    "newmark": newmark,
    "chung-hulbert": lambda run, r, **how: staged(run, "chung-hulbert", rho=r, **how),
    "hht": hht,
    "wbz": lambda run, r, **how: staged(run, "wbz", rho=r, **how),
    "weights": by_weights,
    "leapfrog": lambda run: staged(run, "leapfrog"),
    "symplectic-euler": symplectic_euler,
    "implicit-euler": lambda run: staged(run, stage=theta(1.0)),
    "theta": lambda run, share: staged(run, stage=theta(share)),
    "composite": lambda run, split, r: staged(run, "composite", rho=r, split=split),
    "tr-bdf2": lambda run: staged(run, "composite", split=2 - math.sqrt(2)),
    "midpoint": lambda run: staged(run, stage=theta(0.5)),
    "houbolt": houbolt,
    "wilson": wilson,
    "runge-kutta": runge_kutta,
    "contact-split": contact_split,
    "dashpot": dashpot,
    "moreau": moreau,
    "lagrange": lagrange,
}


def rounded(values, digits):
    """Return values as a file with so many significant digits gives them."""
    return np.array([float(f"{value:.{digits - 1}e}") for value in values]) if digits < 17 else values
