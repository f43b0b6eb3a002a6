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
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice, repeat
from typing import Literal, NamedTuple, TypeVar

import numpy as np

from dda.model.arrays import Array
from dda.model.checks import check_not_negative, check_positive, check_share

Start = Literal["zero", "consistent"]
Real = TypeVar("Real", float, Array)  # one mode, all unknowns at once; `dda.scheme.blocked` puts in decimal numbers


@dataclass(frozen=True)
class Scheme:
    """Newmark parameters.

    Raises
    ------
    ValueError
        If a number is not finite or out of range, or the start is unknown.
    """

    alpha: float  # [-]
    delta: float  # [-]
    gg: float  # share of the velocity that a step starts with [-]
    step: float  # dt [s]
    start: Start = "zero"  # initial acceleration: "zero", or "consistent" with M A0 = F
    mass_damping: float = 0.0  # a0 of C = a0 M + a1 K [1/s]
    stiffness_damping: float = 0.0  # a1 [s]

    def __post_init__(self) -> None:
        """Check the ranges."""
        check_not_negative(alpha=self.alpha, delta=self.delta)
        check_share(gg=self.gg)
        check_positive(step=self.step)
        check_not_negative(mass_damping=self.mass_damping, stiffness_damping=self.stiffness_damping)
        if self.start not in ("zero", "consistent"):
            raise ValueError(f'start: must be "zero" or "consistent", got {self.start!r}')

    @property
    def damped(self) -> bool:
        """Whether there is viscous damping."""
        return bool(self.mass_damping or self.stiffness_damping)


class StepScheme(NamedTuple):
    """Newmark's numbers for a step of one length."""

    alpha: float
    delta: float
    gg: float
    step: float  # [s]


def effective_matrix(scheme: Scheme, M: Real, k: Real) -> Real:
    """Return S = M + delta dt C + alpha dt^2 K, at C = 0 alpha dt^2 times the matrix of eq. (9)."""
    if scheme.damped:
        mass_factor = 1 + scheme.delta * scheme.mass_damping * scheme.step
        return mass_factor * M + (scheme.alpha + scheme.delta * scheme.stiffness_damping / scheme.step) * k
    return M + scheme.alpha * k


def dashpot_matrix(scheme: Scheme, M: Array, C: Array, K: Array) -> Array:
    """Return the matrix of the accelerations under any damping, M + delta dt C + alpha dt^2 K."""
    return M + scheme.delta * scheme.step * C + scheme.alpha * scheme.step**2 * K


def predictors(scheme: Scheme, D: Array, V: Array, A: Array) -> tuple[Array, Array]:
    """Return D* and V* of eq. (6) and (7), what is known of the end of a step before its acceleration.

    Of a scheme with the step 1, V and A stand for dt V and dt^2 A.
    """
    dt = scheme.step
    displaced = D + scheme.gg * dt * V + dt**2 * (0.5 - scheme.alpha) * A
    return displaced, scheme.gg * V + dt * (1 - scheme.delta) * A


def correctors(scheme: Scheme, D: Array, V: Array, A1: Array) -> tuple[Array, Array]:
    """Return D1 and V1 from the predicted ones and the acceleration at the end of the step."""
    return D + scheme.alpha * scheme.step**2 * A1, V + scheme.delta * scheme.step * A1


def initial_acceleration(scheme: Scheme, F: Real) -> Real:
    """Return the inertia force dt^2 M A0 at rest: dt^2 F if consistent, else zero."""
    return F if scheme.start == "consistent" else 0 * F


def predictor(scheme: Scheme | StepScheme, P: Real, f: Real) -> Real:
    """Return M (D* - D) = gg dt M V + dt^2 (1/2 - alpha) M A, the right-hand side of eq. (9)."""
    return scheme.gg * P + (1 - 2 * scheme.alpha) / 2 * f  # whole numbers: decimal ones go with no doubles


def acceleration_corrector(F: Real, k: Real, D: Real) -> Real:
    """Return the inertia force dt^2 M A = dt^2 (F - K D), eq. (4) and (6)."""
    return F - k * D


def velocity_corrector(scheme: Scheme | StepScheme, P: Real, f: Real, f1: Real) -> Real:
    """Return dt M V1 = gg dt M V + dt^2 M ((1 - delta) A + delta A1), eq. (7)."""
    return scheme.gg * P + (1 - scheme.delta) * f + scheme.delta * f1


def momentum_balance(scheme: Scheme | StepScheme, F: Real, k: Real, D: Real, P: Real, f: Real) -> Real:
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
        Of the load that act at t = 0, dt, 2 dt, ...
    """
    k = omega * omega
    S = effective_matrix(scheme, 1.0, k)
    coming = iter(shares)
    state = (0.0, 0.0, initial_acceleration(scheme, next(coming) * F))
    for share in coming:
        state = modal_step(scheme, S, k, share * F, state)
        yield state[0]


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
    moved : (steps + 1, 2) array
        Displacement y of the base at t = 0, dt, ... [m]; the block starts undisplaced.
    """
    k = (scheme.step * frequencies) ** 2
    S = effective_matrix(scheme, np.ones_like(k), k)
    pushes = np.diff(moved, axis=0) @ translation.T
    D = -(translation @ moved[0])
    P = np.zeros_like(k)
    f = initial_acceleration(scheme, -k * D)
    histories = np.empty((len(pushes), len(k)))
    for row, push in zip(histories, pushes, strict=True):
        D = D + (momentum_balance(scheme, 0.0 * k, k, D, P, f) - push) / S
        f1 = acceleration_corrector(0.0 * k, k, D)
        P = velocity_corrector(scheme, P, f, f1)
        f = f1
        row[:] = D
    return histories
