"""What every linear body answers: at rest, by its modes, under a steady vibration, and its highest frequency.

One block on its springs, a system of glued blocks and a column of bonded ones each have equations in some unknowns, and
in the forces (or the motion) by which these are joined to others and to the base:

    F                    load of unit size, by the unknowns
    rows(columns)        what observes some columns: rows by the unknowns, and by the forces
    at_base(F, (x, y))   unknowns and forces at rest under a load, the base at some place [m]
    pushed(size)         the load that shares refer to, where the loads have some size
    lowest(count)        w^2, mass-normalised shapes and their forces, of the lowest modes or, of few unknowns, of all
    largest()            the highest natural frequency [rad/s]
    steady(rows, F, (x, y), scheme, frequencies, exact)    amplitudes of what rows observe, (rows, frequencies)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from dda.model.arrays import Array
from dda.model.checks import check_columns, check_damping
from dda.model.load import BaseMotion
from dda.scheme import roots
from dda.scheme.harmonic import Complex
from dda.scheme.newmark import Scheme, staged_step, step_matrices, viscosity

ROUNDING = 1e-12  # of the largest share, below which a mode has none


class LinearBody(Protocol):
    """A body whose motion is linear."""

    @property
    def names(self) -> Sequence[str]:
        """Names of all columns."""

    @property
    def motion(self) -> BaseMotion | None:
        """That of the base."""

    @property
    def moving(self) -> Array:
        """Whether the equations have the motion of the base in x and in y, 1 or 0 each."""

    @property
    def load_size(self) -> float:
        """Size of the loads."""

    @property
    def equations(self) -> Any:
        """The equations in all unknowns."""

    @property
    def reached(self) -> Any:
        """The equations without the unknowns that no load can reach."""


@dataclass(frozen=True)
class Mode:
    """A natural mode and what one step of the scheme does to it."""

    frequency: float  # w [rad/s], undamped natural
    share: float  # of the static response, (phi'F)^2 / (w^2 F'D_static) [-]
    eigenvalues: tuple[complex, complex]  # of the mode's own one-step operator, larger modulus first
    contact_share: float  # static contact pressure that the mode carries, over the applied pressure [-]


def static(body: LinearBody) -> dict[str, float]:
    """Return the value of every column at rest under the constant loads, on the base's last position."""
    system = body.reached
    by_unknowns, by_force = system.rows(body.names)
    last = np.zeros(2) if body.motion is None else body.motion.at([math.inf])[0]
    x, force = system.at_base(system.F * body.load_size, last)
    return dict(zip(body.names, (by_unknowns @ x + by_force @ force + 0.0).tolist(), strict=True))


def modes(body: LinearBody, scheme: Scheme, count: int = 12, full: bool = False) -> tuple[Mode, ...]:
    """Return modes, the largest static share first, with what a step of the scheme does to each.

    Where the base alone acts the load is the inertia of its unit acceleration.

    Parameters
    ----------
    count : int
        Number of lowest modes, of one block all; doubled until the mode of the largest share is among them.
    full : bool
        Count the modes that no load can reach as well.
    """
    system = body.equations if full else body.reached
    F = system.pushed(body.load_size)
    x, _ = system.at_base(F, np.zeros(2))
    while True:
        squares, shapes, forces = system.lowest(count)
        shares = (shapes.T @ F) ** 2 / (squares * (F @ x))
        if len(squares) < count or np.max(shares) > 1 - np.sum(shares):
            break
        count *= 2
    by_unknowns, by_force = system.rows(("contact_pressure",))
    carried = (by_unknowns @ shapes + by_force @ forces)[0] * (shapes.T @ F) / squares
    counted = np.where(shares > ROUNDING * np.max(shares), shares, 0.0)  # of no share: by their frequency
    order = np.lexsort((squares, -counted))
    return modes_of(scheme, np.sqrt(squares[order]), shares[order], carried[order])


def modes_of(scheme: Scheme, frequencies: Array, shares: Array, carried: Array) -> tuple[Mode, ...]:
    """Return modes with what a step of the scheme does to each."""
    rows = zip(frequencies.tolist(), shares.tolist(), carried.tolist(), strict=True)
    return tuple(Mode(w, share, scalar_eigenvalues(scheme, w), pressure) for w, share, pressure in rows)


def response(
    body: LinearBody,
    scheme: Scheme,
    frequencies: ArrayLike,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    along: tuple[float, float] | None = None,
    exact: bool = False,
) -> dict[str, Complex]:
    """Return the complex amplitudes of the columns, (K - W2 M) D = F.

    Parameters
    ----------
    frequencies : (n,) array_like
        Of the load [Hz].
    along : pair of float
        The base moves along this vector with an amplitude of its length [m], and no load acts; None: the loads act
        with their own amplitudes, all in phase.
    exact : bool
        As the system that is exact in time answers, not as the scheme steps it.

    Raises
    ------
    ValueError
        If a column is unknown, gg = 0 has no limit that is exact in time, or the base moves under viscous damping,
        without a motion of its own or in a direction in which that does not move it.
    """
    check_columns(body.names, columns)
    if along is not None:
        _check_along(body.moving, along)
    check_damping(scheme.damped, along is not None)
    system = body.reached
    F = system.F * (body.load_size if along is None else 0.0)
    base = np.zeros(2) if along is None else np.array(along)
    return dict(zip(columns, system.steady(system.rows(columns), F, base, scheme, frequencies, exact), strict=True))


def _check_along(moving: Array, along: tuple[float, float]) -> None:
    """Raise ValueError for a vector with a part in a direction, 1 or 0 for x and y, in which the base does not move."""
    if not np.any(moving):
        raise ValueError(f"along: needs a base of prescribed motion, `motion` of the loads, got {along!r} without one")
    if np.any(np.asarray(along)[moving == 0] != 0):
        only = "xy"[int(np.argmax(moving))]
        raise ValueError(f"along: must lie in {only}, as `motion` of the loads moves the base, got {along!r}")


def highest_frequency(body: LinearBody) -> float:
    """Return the highest natural frequency that a load reaches [rad/s], which limits an explicit scheme.

    Raises
    ------
    OverflowError
        If mass or stiffness leave the range of double precision.
    """
    return float(body.reached.largest())


def scalar_eigenvalues(scheme: Scheme, frequency: float) -> tuple[complex, complex]:
    """Return the two non-zero eigenvalues of one step of a mode, the larger modulus first.

    The step is applied to the unit states of (D, dt V) with the acceleration that equilibrium
    gives them, A = -w^2 D - (a0 + a1 w^2) V, which every step but the first starts from. Of schemes by their stages
    they are those of the closed form, `dda.scheme.roots`.
    """
    if scheme.table is not None:
        return roots.eigenvalues(scheme, frequency * scheme.step)
    k = (frequency * scheme.step) ** 2
    S = step_matrices(scheme, 1.0, k)
    a, c, *_ = staged_step(scheme, S, k, [0.0], [0.0], (1.0, 0.0, -k, -k))
    b, d, *_ = staged_step(scheme, S, k, [0.0], [0.0], (0.0, 1.0, 0.0 - viscosity(scheme, k), 0.0))
    root = np.sqrt(complex(((a - d) / 2) ** 2 + b * c))
    pair = sorted(((a + d) / 2 + root, (a + d) / 2 - root), key=abs, reverse=True)
    return complex(pair[0]), complex(pair[1])
