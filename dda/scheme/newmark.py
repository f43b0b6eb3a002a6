r"""The Newmark scheme with kinetic damping, eq. (6) and (7), in a form that keeps its digits.

The scheme is carried in the displacement D, the momentum P = dt M V and the inertia force
f = dt^2 M A, with k = dt^2 K and F standing for dt^2 F:

    S (D1 - D) = gg P + (1/2 - alpha) f + alpha (F - k D),     S = M + alpha k
    f1 = F - k D1
    P1 = gg P + (1 - delta) f + delta f1

which is (6), (7) and M A1 + K D1 = F, rearranged. Nothing is divided by alpha or dt, M is
never inverted, and with a diagonal k every force is one product: an error of one rounding in
a displacement is an error of one rounding in its force, however stiff the spring.

Histories are made mode by mode (M = 1, k = (w dt)^2), because the rounding of a large slow
motion must not reach a stiff contact mode, whose roots near -1 would let it grow; `dda.scheme.blocked`
does so without a loop over the steps, from the same lines.

These formulas stand in `dda.scheme.stage`; every scheme is rows of numbers for them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from dda.model.arrays import Array, ArrayPair
from dda.model.checks import check_among, check_not_negative, check_positive, check_share
from dda.scheme.stage import (
    Real,
    Stage,
    Table,
    effective_matrix,
    inertia_force,
    newmark_stage,
    predictor,
    velocity_corrector,
)

NEWMARK = "newmark"
Start = Literal["zero", "consistent"]
State = tuple[Real, Real, Real, Real]  # D, P, f, and the force that f would balance


@dataclass(frozen=True)
class Scheme:
    """Newmark's parameters, or a scheme by its stages (`dda.named_scheme`).

    Raises
    ------
    ValueError
        If a number is not finite or out of range, the start is unknown, or a scheme lacks what it needs.
    """

    alpha: float  # [-]; of a scheme by its stages that of the last one
    delta: float  # [-]
    gg: float  # share of the velocity that a step starts with [-]
    step: float  # dt [s]
    start: Start = "zero"  # initial acceleration: "zero", or "consistent" with M A0 = F
    mass_damping: float = 0.0  # a0 of C = a0 M + a1 K [1/s]
    stiffness_damping: float = 0.0  # a1 [s]
    name: str = NEWMARK  # among `dda.SCHEMES`
    table: Table | None = None  # its stages; None of Newmark's

    stages: tuple[Stage, ...] = field(init=False, repr=False, compare=False)  # what a step is made of

    def __post_init__(self) -> None:
        rows = self.table.stages if self.table else (newmark_stage(self.alpha, self.delta),)
        object.__setattr__(self, "stages", tuple(row._replace(gg=self.gg, step=self.step) for row in rows))
        check_not_negative(alpha=self.alpha, delta=self.delta)
        check_share(gg=self.gg)
        check_positive(step=self.step)
        check_not_negative(mass_damping=self.mass_damping, stiffness_damping=self.stiffness_damping)
        check_among(("zero", "consistent"), start=self.start)
        if self.table is None:
            return
        if self.damped:
            damping = (self.mass_damping, self.stiffness_damping)
            raise ValueError(f"mass_damping, stiffness_damping: go with {NEWMARK} only, got {damping} with {self.name}")
        if self.table.lag and self.start != "consistent":
            raise ValueError(f"start: must be 'consistent' with {self.name}, got {self.start!r}")
        if self.table.lag and self.gg == 0:
            raise ValueError(f"gg: must be positive with {self.name}, got 0")

    @property
    def damped(self) -> bool:
        """Whether there is viscous damping."""
        return bool(self.mass_damping or self.stiffness_damping)

    @property
    def lag(self) -> float:
        """By how much of a step the velocities are older than the displacements."""
        return self.table.lag if self.table else 0.0

    @property
    def explicit(self) -> bool:
        """Whether no stage has an equation to solve."""
        return all(stage.alpha == 0 for stage in self.stages)

    @property
    def averages(self) -> bool:
        """Whether a stage balances the forces between the ends of a step, so that M A is not the force at its end."""
        return any(stage.am != 0 or stage.af != 0 for stage in self.stages)

    def instants(self, steps: int) -> Array:
        """Return t = 0 and the ends of all stages of so many steps [s]."""
        ends = np.array([float(stage.end) for stage in self.stages])
        number = np.arange(steps)[:, None] + ends
        return np.concatenate([[0.0], self.step * number.ravel()])


def step_matrices(scheme: Scheme, M: Real, k: Real) -> list[Real]:
    """Return S of every stage, by dt^2 K; with viscous damping M + delta dt C + alpha dt^2 K."""
    if scheme.damped:
        mass_factor = 1 + scheme.delta * scheme.mass_damping * scheme.step
        return [mass_factor * M + (scheme.alpha + scheme.delta * scheme.stiffness_damping / scheme.step) * k]
    return [effective_matrix(stage, M, k) for stage in scheme.stages]


def initial_acceleration(scheme: Scheme, F: Real) -> Real:
    """Return the inertia force dt^2 M A0 at rest: dt^2 F if consistent, else zero."""
    return F if scheme.start == "consistent" else 0 * F


def staged_step(
    scheme: Scheme, S: Sequence[Real], k: Real, loads: Sequence[Real], pushes: Sequence[Real], state: State[Real]
) -> State[Real]:
    """Return (D, P, f, R) one step later.

    Parameters
    ----------
    S
        The matrix of each stage, `step_matrices`.
    loads
        dt^2 F at the end of each stage.
    pushes
        M R (y1 - y) of each stage, by which the base moves from under D.
    state
        Displacement, dt M V, dt^2 M A, and dt^2 times the force that M A would balance there, at the start.
    """
    if scheme.damped:
        return viscous_step(scheme, S[0], k, loads[0], state)
    D, P, f, force_0 = state
    P1 = P
    f1 = f
    force = force_0
    for stage, matrix, F, push in zip(scheme.stages, S, loads, pushes, strict=True):
        f_g = f1
        balance = predictor(stage, P, f, P1, f_g) + stage.alpha * inertia_force(stage, F - k * D, force_0, f)
        D = D + (balance - push) / matrix
        force = F - k * D
        f1 = inertia_force(stage, force, force_0, f)
        P1 = velocity_corrector(stage, P, f, f_g, f1)
    return D, P1, f1, force


def rest(scheme: Scheme, F: Real, D: Real, k: Real) -> State[Real]:
    """Return the state at t = 0 of a body at rest under dt^2 F; a velocity that lags is that of half a step before."""
    force = F - k * D
    f = initial_acceleration(scheme, force)
    return D, late_momentum(scheme, 0 * f, f), f, force


def late_momentum(scheme: Scheme, P: Real, f: Real) -> Real:
    """Return the momentum that a scheme carries at t = 0, whose next step takes gg of it."""
    if scheme.lag == 0:
        return P
    return (P - scheme.lag * f) / scheme.gg


def viscous_step(scheme: Scheme, S: Real, k: Real, F: Real, state: State[Real]) -> State[Real]:
    """Return (D, P, f, f) of modes one step later by Newmark's scheme where M A + C V + K D = F.

    With e = dt (a0 + a1 w^2) and P* = gg P + (1 - delta) f, the part of the momentum that is known before the step,

        (1 + delta e + alpha k) (D1 - D) = (1 + delta e) [gg P + (1/2 - alpha) f] + alpha (F - k D - e P*)
        (1 + delta e) f1 = F - k D1 - e P*,        P1 = P* + delta f1.
    """
    D, P, f, _ = state
    (stage,) = scheme.stages
    e = viscosity(scheme, k)
    drag = e * velocity_corrector(stage, P, f, f, 0 * f)
    viscous_factor = 1 + scheme.delta * e
    balance = viscous_factor * predictor(stage, P, f, P, f) + scheme.alpha * (F - k * D - drag)
    D = D + balance / S
    f1 = (F - k * D - drag) / viscous_factor
    return D, velocity_corrector(stage, P, f, f, f1), f1, f1


def viscosity(scheme: Scheme, k: Real) -> Real:
    """Return e = dt (a0 + a1 w^2) of modes with k = (w dt)^2."""
    return scheme.mass_damping * scheme.step + scheme.stiffness_damping / scheme.step * k


def stepped_modes(
    scheme: Scheme,
    frequencies: Array,
    load: Array,
    steps: int,
    shares: Array | None = None,
    moved: ArrayPair | None = None,
) -> Array:
    """Return D of every mode and step from rest, (n, steps), measured from the base where that moves.

    With x = D + R y the spring forces are those of D alone, P and f those of x, and the right-hand side of the first
    line above gets - R (y1 - y): no spring force is a difference of large numbers.

    Parameters
    ----------
    frequencies, load : (n,) arrays
        w [rad/s], and the modal load.
    shares : (1 + stages * steps,) array
        Of the load that act at t = 0 and at the end of each stage, `Scheme.instants`; all of it without them.
    moved : (n, 2) and (1 + stages * steps, 2) arrays
        Modal R of unit displacements of the base, and its displacement y at these instants [m]; the block starts
        undisplaced.
    """
    dt = scheme.step
    k = (dt * frequencies) ** 2
    F = dt * dt * load
    matrices = step_matrices(scheme, np.ones_like(k), k)
    count = len(matrices)
    coming = np.ones(1 + count * steps) if shares is None else shares
    translation, base = (np.zeros((len(k), 1)), np.zeros((len(coming), 1))) if moved is None else moved
    pushes = np.diff(base, axis=0) @ translation.T
    state = rest(scheme, coming[0] * F, -(translation @ base[0]), k)
    histories = np.empty((len(k), steps))
    for n in range(steps):
        stages = range(count * n, count * (n + 1))
        loads = [coming[i + 1] * F for i in stages]
        state = staged_step(scheme, matrices, k, loads, [pushes[i] for i in stages], state)
        histories[:, n] = state[0]
    return histories
