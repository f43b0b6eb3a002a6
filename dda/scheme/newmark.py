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

Other schemes are rows of numbers (`dda.scheme.stages`) for the same lines, with f1 a mean of the forces at both ends
of a step where the scheme balances them so: `staged_step`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice, repeat
from typing import ClassVar, Literal, TypeVar

import numpy as np

from dda.model.arrays import Array
from dda.model.checks import check_not_negative, check_positive, check_share
from dda.scheme.stages import Stage, Table

NEWMARK = "newmark"
Start = Literal["zero", "consistent"]
Real = TypeVar("Real", float, Array)  # one mode, all unknowns at once; `dda.scheme.blocked` puts in decimal numbers
State = tuple[Real, Real, Real, Real]  # D, P, f, and the force that f would balance


@dataclass(frozen=True)
class Scheme:
    """Newmark's parameters, or a scheme by its stages (`dda.named_scheme`); Newmark's is its own only stage.

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

    e_0: float = field(init=False, repr=False, compare=False)  # weights of A in Newmark's displacement and velocity
    g_0: float = field(init=False, repr=False, compare=False)
    named_stages: tuple[Stage, ...] = field(init=False, repr=False, compare=False)  # with gg and step
    # of Newmark's stage, beside alpha, delta, gg and step; whole numbers go with decimal ones
    d_u: ClassVar[int] = 1
    d_g: ClassVar[int] = 0
    e_g: ClassVar[int] = 0
    g_g: ClassVar[int] = 0
    am: ClassVar[int] = 0
    af: ClassVar[int] = 0
    begin: ClassVar[int] = 0
    end: ClassVar[int] = 1

    def __post_init__(self) -> None:
        """Check the ranges."""
        object.__setattr__(self, "e_0", (1 - 2 * self.alpha) / 2)  # whole numbers: decimal ones go with no doubles
        object.__setattr__(self, "g_0", 1 - self.delta)
        stages = self.table.stages if self.table else ()
        object.__setattr__(self, "named_stages", tuple(s._replace(gg=self.gg, step=self.step) for s in stages))
        check_not_negative(alpha=self.alpha, delta=self.delta)
        check_share(gg=self.gg)
        check_positive(step=self.step)
        check_not_negative(mass_damping=self.mass_damping, stiffness_damping=self.stiffness_damping)
        if self.start not in ("zero", "consistent"):
            raise ValueError(f'start: must be "zero" or "consistent", got {self.start!r}')
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
    def stages(self) -> tuple[Stage | Scheme, ...]:
        """What a step is made of."""
        return (self,) if self.table is None else self.named_stages

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


def plain_stage(stage: Scheme | Stage) -> Stage:
    """Return the numbers of a stage alone, for a momentum that is discounted already and a step of length one."""
    return Stage(*(float(getattr(stage, name)) for name in Stage._fields))._replace(gg=1.0, step=1.0)


def implicit_weight(stage: Scheme | Stage) -> float:
    """Return the weight of dt^2 K beside M in the matrix of a stage, alpha of Newmark's."""
    return stage.alpha * (1 - stage.af) / (1 - stage.am)


def effective_matrix(scheme: Scheme | Stage, M: Real, k: Real) -> Real:
    """Return S = M + delta dt C + alpha dt^2 K, at C = 0 alpha dt^2 times the matrix of eq. (9)."""
    if isinstance(scheme, Scheme) and scheme.damped:
        mass_factor = 1 + scheme.delta * scheme.mass_damping * scheme.step
        return mass_factor * M + (scheme.alpha + scheme.delta * scheme.stiffness_damping / scheme.step) * k
    return M + implicit_weight(scheme) * k


def dashpot_matrix(scheme: Scheme | Stage, M: Array, C: Array, K: Array) -> Array:
    """Return the matrix of the accelerations of a stage under any damping, M + delta dt C + alpha dt^2 K."""
    share = (1 - scheme.af) / (1 - scheme.am)
    return M + share * scheme.delta * scheme.step * C + share * scheme.alpha * scheme.step**2 * K


def predictors(scheme: Scheme | Stage, D: Array, V: Array, A: Array) -> tuple[Array, Array]:
    """Return D* and V* of eq. (6) and (7), what is known of the end of a step before its acceleration.

    Of a scheme with the step 1, V and A stand for dt V and dt^2 A.
    """
    dt = scheme.step
    displaced = D + scheme.d_u * scheme.gg * dt * V + dt**2 * scheme.e_0 * A
    return displaced, scheme.gg * V + dt * scheme.g_0 * A


def correctors(scheme: Scheme | Stage, D: Array, V: Array, A1: Array) -> tuple[Array, Array]:
    """Return D1 and V1 from the predicted ones and the acceleration at the end of the step."""
    return D + scheme.alpha * scheme.step**2 * A1, V + scheme.delta * scheme.step * A1


def initial_acceleration(scheme: Scheme, F: Real) -> Real:
    """Return the inertia force dt^2 M A0 at rest: dt^2 F if consistent, else zero."""
    return F if scheme.start == "consistent" else 0 * F


def predictor(scheme: Scheme | Stage, P: Real, f: Real) -> Real:
    """Return M (D* - D) = gg dt M V + dt^2 (1/2 - alpha) M A, the right-hand side of eq. (9).

    Of a stage that weighs the velocity by d_u, P is d_u times the momentum.
    """
    return scheme.gg * P + scheme.e_0 * f


def acceleration_corrector(F: Real, k: Real, D: Real) -> Real:
    """Return the inertia force dt^2 M A = dt^2 (F - K D), eq. (4) and (6)."""
    return F - k * D


def velocity_corrector(scheme: Scheme | Stage, P: Real, f: Real, f1: Real) -> Real:
    """Return dt M V1 = gg dt M V + dt^2 M ((1 - delta) A + delta A1), eq. (7)."""
    return scheme.gg * P + scheme.g_0 * f + scheme.delta * f1


def inertia_force(scheme: Scheme | Stage, force: Real, force_0: Real, f: Real) -> Real:
    """Return the inertia force f1 at the end of a stage: (1 - am) f1 + am f = (1 - af) force + af force_0.

    Parameters
    ----------
    force, force_0
        dt^2 times all other forces at the end and at the start of the step.
    f
        The inertia force at the start.
    """
    if scheme.am == 0 and scheme.af == 0:
        return force
    return ((1 - scheme.af) * force + scheme.af * force_0 - scheme.am * f) / (1 - scheme.am)


def momentum_balance(scheme: Scheme | Stage, F: Real, k: Real, D: Real, P: Real, f: Real) -> Real:
    """Return S (D1 - D) = M (D* - D) + alpha dt^2 (F - K D), eq. (8) in the robust form."""
    return predictor(scheme, P, f) + scheme.alpha * acceleration_corrector(F, k, D)


def modal_step(scheme: Scheme, S: Real, k: Real, F: Real, state: tuple[Real, Real, Real]) -> tuple[Real, Real, Real]:
    """Return (D, P, f) of one mode one step later."""
    if scheme.damped:
        return viscous_step(scheme, k, F, state)
    D, P, f = state
    D = D + momentum_balance(scheme, F, k, D, P, f) / S
    f1 = acceleration_corrector(F, k, D)
    return D, velocity_corrector(scheme, P, f, f1), f1


def staged_step(
    scheme: Scheme, S: Sequence[Real], k: Real, loads: Sequence[Real], pushes: Sequence[Real], state: State[Real]
) -> State[Real]:
    """Return (D, P, f, R) one step later by any scheme without viscous damping.

    Parameters
    ----------
    S
        The matrix of each stage.
    loads
        dt^2 F at the end of each stage.
    pushes
        M R (y1 - y) of each stage, by which the base moves from under D.
    state
        Displacement, dt M V, dt^2 M A, and dt^2 times the force that M A would balance there, at the start.
    """
    D, P, f, force_0 = state
    P1 = P
    f1 = f
    force = force_0
    for stage, matrix, F, push in zip(scheme.stages, S, loads, pushes, strict=True):
        # of the stage before: in the first stage these weights are zero
        balance = predictor(stage, stage.d_u * P, f) + stage.d_g * P1 + stage.e_g * f1
        accelerated = stage.g_g * f1
        balance = balance + stage.alpha * inertia_force(stage, acceleration_corrector(F, k, D), force_0, f)
        D = D + (balance - push) / matrix
        force = acceleration_corrector(F, k, D)
        f1 = inertia_force(stage, force, force_0, f)
        P1 = velocity_corrector(stage, P, f, f1) + accelerated
    return D, P1, f1, force


def rest(scheme: Scheme, F: Real, D: Real, k: Real) -> State[Real]:
    """Return the state at t = 0 of a body at rest under dt^2 F; a velocity that lags is that of half a step before."""
    force = acceleration_corrector(F, k, D)
    f = initial_acceleration(scheme, force)
    return D, late_momentum(scheme, 0 * f, f), f, force


def late_momentum(scheme: Scheme, P: Real, f: Real) -> Real:
    """Return the momentum that a scheme carries at t = 0, whose next step takes gg of it."""
    if scheme.lag == 0:
        return P
    return (P - scheme.lag * f) / scheme.gg


def viscous_step(scheme: Scheme, k: Real, F: Real, state: tuple[Real, Real, Real]) -> tuple[Real, Real, Real]:
    """Return (D, P, f) of one mode one step later where M A + C V + K D = F.

    With e = dt (a0 + a1 w^2) and P* = gg P + (1 - delta) f, the part of the momentum that is known before the step,

        (1 + delta e + alpha k) (D1 - D) = (1 + delta e) [gg P + (1/2 - alpha) f] + alpha (F - k D - e P*)
        (1 + delta e) f1 = F - k D1 - e P*,        P1 = P* + delta f1.
    """
    D, P, f = state
    e = viscosity(scheme, k)
    velocity = scheme.gg * P + (1 - scheme.delta) * f
    viscous_factor = 1 + scheme.delta * e
    balance = viscous_factor * predictor(scheme, P, f) + scheme.alpha * (F - k * D - e * velocity)
    D = D + balance / (viscous_factor + scheme.alpha * k)
    f1 = (F - k * D - e * velocity) / viscous_factor
    return D, velocity_corrector(scheme, P, f, f1), f1


def viscosity(scheme: Scheme, k: Real) -> Real:
    """Return e = dt (a0 + a1 w^2) of modes with k = (w dt)^2."""
    return scheme.mass_damping * scheme.step + scheme.stiffness_damping / scheme.step * k


def modal_displacements(
    scheme: Scheme, omega: float, F: float, shares: Iterable[float] = repeat(1.0)
) -> Iterator[float]:
    """Yield D of step 1, 2, ... of one mode from rest under a load.

    Parameters
    ----------
    omega : float
        w dt [-].
    F : float
        dt^2 times the modal load.
    shares
        Of the load that act at t = 0 and at the end of each stage, `Scheme.instants`.
    """
    k = omega * omega
    coming = iter(shares)
    if scheme.table is None:
        S = effective_matrix(scheme, 1.0, k)
        state = (0.0, 0.0, initial_acceleration(scheme, next(coming) * F))
        for share in coming:
            state = modal_step(scheme, S, k, share * F, state)
            yield state[0]
        return
    matrices = [effective_matrix(stage, 1.0, k) for stage in scheme.stages]
    still = [0.0] * len(matrices)
    staged = rest(scheme, next(coming) * F, 0.0, k)
    while len(loads := [share * F for share in islice(coming, len(matrices))]) == len(matrices):
        staged = staged_step(scheme, matrices, k, loads, still, staged)
        yield staged[0]


def stepped_modes(
    scheme: Scheme, frequencies: Array, load: Array, steps: int, shares: Iterable[float] = repeat(1.0)
) -> Array:
    """Return D of every mode and step, (n, steps), from rest under a modal load; see `modal_displacements`."""
    dt = scheme.step
    histories = np.empty((len(load), steps))
    for row, w, F in zip(histories, frequencies.tolist(), load.tolist(), strict=True):
        row[:] = np.fromiter(islice(modal_displacements(scheme, dt * w, dt * dt * F, shares), steps), float, steps)
    return histories


def carried_histories(scheme: Scheme, frequencies: Array, translation: Array, moved: Array) -> Array:
    """Return D of every step and mode, (steps, n), measured from a moving base, without other loads.

    With x = D + R y the spring forces are those of D alone, and the scheme for x becomes

        S (D1 - D) = gg P + (1/2 - alpha) f - alpha k D - R (y1 - y),

    with the momentum P and the inertia force f of x; no spring force is a difference of
    large numbers.

    Parameters
    ----------
    translation : (n, 2) array
        Modal R of unit displacements of the base.
    moved : (1 + stages * steps, 2) array
        Displacement y of the base at t = 0 and at the end of each stage, `Scheme.instants` [m]; the block starts
        undisplaced.
    """
    k = (scheme.step * frequencies) ** 2
    matrices = [effective_matrix(stage, np.ones_like(k), k) for stage in scheme.stages]
    loads = [0.0 * k for _ in matrices]
    pushes = (np.diff(moved, axis=0) @ translation.T).reshape(-1, len(matrices), len(k))
    state = rest(scheme, loads[0], -(translation @ moved[0]), k)
    histories = np.empty((len(pushes), len(k)))
    for row, push in zip(histories, pushes, strict=True):
        state = staged_step(scheme, matrices, k, loads, list(push), state)
        row[:] = state[0]
    return histories
