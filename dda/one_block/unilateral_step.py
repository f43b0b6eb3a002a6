r"""One time step with contact that opens, in the force form.

The contact forces lambda of the end of the step are found before its displacements: with h the step's length,
k0 = h^2 K0, F for h^2 F, mu = h^2 lambda, momentum P = h M V and inertia force f = h^2 M A,

    S0 (D1 - D) = gg P + (1/2 - alpha) f + alpha (F - k0 D) + alpha B' mu,     S0 = M + alpha k0
    f1 = F - k0 D1 + B' mu
    P1 = gg P + (1 - delta) f + delta f1

so that S0 is factorised once for all contact states and the flexibility of the contacts is
C = alpha h^2 B S0^-1 B'. A closed corner's gap is -N/p, set on acceptance: it is no sum of increments.

Two other rules keep the contact force out of f, the block's own, and put one force of the step into the displacement,
with weight 1/2 for alpha, and into the momentum, with weight 1. With "implicit" it is the force at the end (Kane,
Repetto, Ortiz and Marsden 1999); with "energy-conserving" that of `dda.contact.conserving`, and average acceleration
of the block itself is then the midpoint rule, with F - K D0 for M A0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.conserving import conserving
from dda.contact.glued import Free
from dda.contact.iteration import Iteration, open_close
from dda.contact.rules import find_states
from dda.contact.unilateral import SLIDES, Corners, Unilateral, at_rest, slide_forces
from dda.one_block.unilateral_form import U_INDEX, UnilateralForm
from dda.scheme.newmark import (
    Scheme,
    acceleration_corrector,
    effective_matrix,
    initial_acceleration,
    momentum_balance,
    velocity_corrector,
)

Array = NDArray[np.float64]
Vector = list[float]
NEWMARK, IMPLICIT, CONSERVING = "newmark", "implicit", "energy-conserving"


class State(NamedTuple):
    """Where the block is, in units of the scheme's own step dt."""

    D: Vector  # unknowns of the form
    P: Vector  # dt M V
    f: Vector  # dt^2 M A
    corners: Corners


@dataclass(frozen=True, eq=False)
class Factor:
    """A positive definite matrix as L d L', the last unknowns (the gaps) eliminated last."""

    L: list[Vector]  # rows below the diagonal
    d: Vector

    @classmethod
    def of(cls, matrix: Array) -> Factor:
        """Factorise a handful of unknowns."""
        A = matrix.tolist()
        n = len(A)
        L: list[Vector] = [[] for _ in range(n)]
        d: Vector = []
        for i in range(n):
            for j in range(i):
                L[i].append((A[i][j] - sum(L[i][k] * d[k] * L[j][k] for k in range(j))) / d[j])
            d.append(A[i][i] - sum(L[i][k] * L[i][k] * d[k] for k in range(i)))
        return cls(L, d)

    def solve(self, b: Vector) -> Vector:
        """Return the solution for one right-hand side."""
        x: Vector = []
        for row, value in zip(self.L, b, strict=True):
            for entry, known in zip(row, x, strict=False):
                value -= entry * known
            x.append(value)
        x = [value / pivot for value, pivot in zip(x, self.d, strict=True)]
        for i in range(len(x) - 1, 0, -1):
            value = x[i]
            for j, entry in enumerate(self.L[i]):
                x[j] -= entry * value
        return x


@dataclass(frozen=True, eq=False)
class StepLength:
    """Everything of a step that depends on its length alone."""

    ratio: float  # length h over the scheme's step
    scheme: Scheme  # of this length, gg for this length
    k: Vector  # h^2 K0
    F: Vector  # h^2 F
    factor: Factor  # of S0
    push: list[Vector]  # multiplicity B', rows over the unknowns
    pushed: list[Vector]  # weight h^2 S0^-1 multiplicity B': displacement of unit forces, rows over the unknowns
    slides: list[Vector]  # rows of B along the base
    C: list[Vector]  # flexibility of the contacts [m/N]
    rule: str
    gains: dict[tuple[int, ...], list[Vector]] = field(default_factory=dict)  # of contacts that stay closed

    @classmethod
    def of(cls, form: UnilateralForm, scheme: Scheme, ratio: float, rule: str) -> StepLength:
        """Factorise S0 and find the flexibility of the contacts.

        A shorter step keeps the share gg^ratio of the velocity, so that the steps of an interval keep gg.
        """
        own = scheme if ratio == 1 else replace(scheme, gg=scheme.gg**ratio, step=scheme.step * ratio)
        h2 = own.step * own.step
        k = h2 * form.K
        factor = Factor.of(effective_matrix(own, form.M, np.diag(k)))
        push = form.multiplicity * form.B.T
        weight = (own.alpha if rule == NEWMARK else 0.5) * h2
        pushed = weight * np.array([factor.solve(column) for column in push.T.tolist()]).T
        slides = form.B[form.contacts :].tolist()
        C = (form.B @ pushed).tolist()
        F = (h2 * form.F).tolist()
        return cls(ratio, own, k.tolist(), F, factor, push.tolist(), pushed.tolist(), slides, C, rule)


def start_state(form: UnilateralForm, law: Unilateral, scheme: Scheme, velocity: float, rule: str) -> State:
    """Return the state at t = 0: unstrained, without contact force, the corners at the starting gap."""
    dt = scheme.step
    if rule == CONSERVING:
        scheme = replace(scheme, start="consistent")
    P = (dt * velocity) * (form.M @ form.translation[:, 1])
    f = initial_acceleration(scheme, dt * dt * form.F)
    return State(form.start.tolist(), P.tolist(), f.tolist(), at_rest(law, form.contacts))


def advance(
    law: Unilateral, length: StepLength, state: State, limit: int, carried: Vector | None = None
) -> tuple[State | None, Iteration]:
    """Return the state one step later, or None where the contacts have no single state; `state` stays as it is.

    Unknowns count from a moving base: x = D + R y with K0 R = 0, so that its way in the step enters as the momentum
    M R (y1 - y), `carried`.
    """
    D, P, f = state.D, state.P, state.f
    if length.ratio != 1:
        P, f = _scaled(P, length.ratio), _scaled(f, length.ratio * length.ratio)
    scheme, k, F = length.scheme, length.k, length.F
    b = [momentum_balance(scheme, *given) for given in zip(F, k, D, P, f, strict=True)]
    x = length.factor.solve(b if carried is None else [own - way for own, way in zip(b, carried, strict=True)])
    free = _free(length, D, x)
    found = (
        conserving(law, state.corners, free)
        if length.rule == CONSERVING
        else find_states(law, state.corners, free, limit)
    )
    if found.corners is None:
        return None, found
    D1, P1, f1 = _accepted(length, (D, P, f), x, found.corners, found.mean or found.corners.normal)
    after = _referred(length, D1, state.corners, found.corners) if length.slides else found.corners
    if length.ratio != 1:
        P1, f1 = _scaled(P1, 1 / length.ratio), _scaled(f1, 1 / (length.ratio * length.ratio))
    return State(D1, P1, f1, after), found


def _scaled(values: Vector, factor: float) -> Vector:
    return [factor * value for value in values]


def _free(length: StepLength, D: Vector, x: Vector) -> Free:
    """Return what the step does to the contacts without their forces; the gaps are the last unknowns."""
    gaps = len(length.C) - len(length.slides)
    slide = [sum(b * xi for b, xi in zip(row, x, strict=True)) for row in length.slides]
    return Free([d + xi for d, xi in zip(D[-gaps:], x[-gaps:], strict=True)], slide, length.C, length.gains)


def _accepted(
    length: StepLength, before: tuple[Vector, Vector, Vector], x: Vector, corners: Corners, normal: Sequence[float]
) -> tuple[Vector, Vector, Vector]:
    """Return (D, P, f) at the end of the step under the contact forces."""
    D, P, f = before
    scheme, h2 = length.scheme, length.scheme.step * length.scheme.step
    D1 = [d + xi for d, xi in zip(D, x, strict=True)]
    pressed = [0.0] * len(D)
    if any(normal) or any(corners.shear):
        forces = [*normal, *slide_forces(corners.shear)] if length.slides else normal
        moved = (sum(g * y for g, y in zip(row, forces, strict=True)) for row in length.pushed)
        D1 = [d + by for d, by in zip(D1, moved, strict=True)]
        pressed = [h2 * sum(b * y for b, y in zip(row, forces, strict=True)) for row in length.push]
    D1[-len(corners.gap) :] = corners.gap
    f1 = [acceleration_corrector(*given) for given in zip(length.F, length.k, D1, strict=True)]
    if length.rule == NEWMARK:
        f1 = [own + contact for own, contact in zip(f1, pressed, strict=True)]
    P1 = [velocity_corrector(scheme, *given) for given in zip(P, f, f1, strict=True)]
    if length.rule != NEWMARK:
        P1 = [own + contact for own, contact in zip(P1, pressed, strict=True)]
    return D1, P1, f1


def _referred(length: StepLength, D: Vector, before: Corners, after: Corners) -> Corners:
    """Return the corners with their references; where one stays closed, U in D is set from it.

    The sum of increments that U was may hold the rounding of a much larger motion without forces.
    """
    local = [sum(b * d for b, d in zip(row, D, strict=True)) for row in length.slides]
    stays = [was and now for was, now in zip(before.closed, after.closed, strict=True)]
    if after.slipped:
        stays = [kept and not way for kept, way in zip(stays, after.slipped, strict=True)]
    where = [sum(q * y for q, y in zip(row, local, strict=True)) for row in SLIDES[len(stays)]]
    if len(stays) == 2 and any(stays):
        glued = zip(before.reference, after.stretch, where, stays, strict=True)
        held = [r + stretch - s for r, stretch, s, kept in glued if kept]
        shift = sum(held) / len(held)
        D[U_INDEX] += shift
        where = [s + shift for s in where]
    given = zip(stays, before.reference, where, after.stretch, strict=True)
    return after._replace(reference=tuple(r if kept else s - stretch for kept, r, s, stretch in given))


class Jump:
    """A whole step of frictionless contacts as matrices over v = (D, P, N, T, w), after any step but the first.

    It is `advance` with f = F - k D + multiplicity h^2 B' N put in: for the single steps in which contacts switch.
    """

    def __init__(self, form: UnilateralForm, law: Unilateral, length: StepLength) -> None:
        self.law, self.length = law, length
        place, scheme = form.layout, length.scheme
        n, c, h2 = place.unknowns, place.contacts, scheme.step * scheme.step
        k, F = np.diag(length.k), np.array(length.F)
        push, pushed = h2 * np.array(length.push), np.array(length.pushed)
        D, P, N = (np.eye(place.size)[part] for part in (place.D, place.P, place.contact(0)))
        f, own = push @ N - k @ D, -k @ D  # both without F
        inverse = np.array([length.factor.solve(column) for column in np.eye(n).tolist()]).T
        ahead = D + inverse @ (scheme.gg * P + (0.5 - scheme.alpha) * f + scheme.alpha * own)
        fallen = inverse @ ((0.5 - scheme.alpha) * F + scheme.alpha * F)
        self.rows, self.constant = np.zeros((place.size, place.size)), np.zeros(place.size)
        self.forced = np.zeros((place.size, c))
        self.rows[place.D], self.constant[place.D], self.forced[place.D] = ahead, fallen, pushed
        self.rows[place.P] = scheme.gg * P + (1 - scheme.delta) * f - scheme.delta * (k @ ahead)
        self.constant[place.P] = F - scheme.delta * (k @ fallen)
        self.forced[place.P] = scheme.delta * (push - k @ pushed)
        gaps, w = slice(n - c, n), place.contact(2)
        self.rows[w], self.constant[w], self.forced[w] = ahead[gaps], fallen[gaps], pushed[gaps]
        self.forced[place.contact(0)] = np.eye(c)
        self.forced = self.forced.T.copy()
        self.gaps, self.unknown_gaps = w.start, n - c

    def step(self, v: Array, closed: tuple[bool, ...], limit: int) -> tuple[Array, Iteration]:
        """Return v one step later and the contacts; where there are none v is what it would be without forces."""
        nothing = (0.0,) * len(closed)
        after = self.rows @ v + self.constant
        free = Free(after[self.gaps :].tolist(), (), self.length.C, {})
        found = open_close(self.law, Corners(closed, nothing, nothing, nothing, nothing, nothing), free, limit)
        if found.corners is None:
            return after, found
        for N, moved in zip(found.corners.normal, self.forced, strict=True):
            if N:
                after += N * moved
        for i, w in enumerate(found.corners.gap):  # of a closed corner -N/p, no sum
            after[self.gaps + i] = after[self.unknown_gaps + i] = w
        return after, found
