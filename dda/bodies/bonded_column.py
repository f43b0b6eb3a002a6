r"""Histories of a column with a dashpot.

One step from (D, V, A) is the scheme's (6) and (7), solved for the acceleration:

    D* = D + gg dt V + dt^2 (1/2 - alpha) A,        V* = gg V + dt (1 - delta) A
    (M + delta dt C + alpha dt^2 K) A1 = F1 - C V* - K D*
    D1 = D* + alpha dt^2 A1,                        V1 = V* + delta dt A1

in v = dt V and f = dt^2 A,

and of other schemes a stage or two of the same form (`dda.scheme.stage`), whose forces, those of the dashpot too, are
balanced between the ends of the step where the scheme says so. The matrix has three diagonals below and on the main one
and is factorised once. Nothing is divided by alpha, and alpha = 0 is the same code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from dda.bodies.column import Column
from dda.bodies.column_equations import DISPLACEMENT, PRESSURE, Equations, Loading, Observers, equations, observers
from dda.model.arrays import Array
from dda.model.checks import check_columns
from dda.result.result import Result, linear_result
from dda.scheme.newmark import Scheme, initial_acceleration, late_momentum
from dda.scheme.stage import dashpot_matrix, inertia_force, predictor, velocity_corrector

if TYPE_CHECKING:
    from scipy.sparse import csr_array

WIDTH = 2  # diagonals beside the main one: a block couples two displacements and the opening between them


@dataclass(frozen=True, eq=False)
class Drive:
    """What drives a column, at t = 0 and at every step, each (steps + 1,).

    Of a scheme of several stages it holds the end of each stage, `dda.Scheme.instants`.

    The base's motion is that of the base itself or, above a half-space, the particle motion of the wave that comes up.

    Raises
    ------
    ValueError
        If the lengths differ or a number is not finite.
    """

    displacement: Array  # of the base [m]
    velocity: Array  # of the base, or of the incident wave [m/s]
    acceleration: Array  # of the base [m/s^2]
    pressure: Array  # on the top, towards the base where positive (in shear: against the displacement) [Pa]

    def __post_init__(self) -> None:
        """Check lengths and numbers."""
        parts = [np.asarray(part) for part in vars(self).values()]
        if len({part.shape for part in parts}) != 1 or parts[0].ndim != 1:
            raise ValueError(f"drive: must hold arrays of one length, got {[part.shape for part in parts]}")
        if not all(np.all(np.isfinite(part)) for part in parts):
            raise ValueError("drive: must hold finite numbers only, got NaN or infinity")


def column_names(heights: Sequence[float], parts: Sequence[str] = (DISPLACEMENT, "stress")) -> tuple[str, ...]:
    """Return the names of the columns of a history: of top and base, then of parts at every height."""
    names = [f"{part}_{number + 1}" for part in parts for number in range(len(heights))]
    return (DISPLACEMENT, PRESSURE, *names)


def solve_column(
    column: Column,
    scheme: Scheme,
    drive: Drive,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
) -> Result:
    """Step a column from rest and return the asked columns.

    Parameters
    ----------
    drive : Drive
        What drives it; it holds one instant more than there are steps.
    columns : sequence of str
        ``displacement`` of the top [m], ``contact_pressure`` on the base [Pa], ``displacement_1``, ... [m] and
        ``stress_1``, ... [Pa, positive in compression; in shear minus the shear stress] at the heights.
    heights : sequence of float
        Heights above the base [m]; where two blocks meet, the lower one is observed.

    Raises
    ------
    ValueError
        If a column is unknown or a height lies outside.
    """
    import scipy.linalg  # noqa: F401  (before the clock starts)

    check_columns(column_names(heights), columns)
    began = perf_counter()
    system = equations(column)
    stepper = Stepper(system, scheme)
    observed = observers(system, columns, heights)
    ready = perf_counter()
    with np.errstate(all="ignore"):
        histories = stepper.run(drive, observed)
    return linear_result(
        scheme,
        (began, ready),
        columns,
        histories,
        1.0,
        unknowns=stepper.M.shape[1],
        nonzeros=int(np.count_nonzero(stepper.matrices[-1])),
        factorisations=len(stepper.solvers),
        solves=histories.shape[1] * len(stepper.solvers),
    )


class Stepper:
    """The scheme on the free unknowns of a column."""

    def __init__(self, system: Equations, scheme: Scheme) -> None:
        """Form the matrices and factorise the one of the step."""
        if scheme.lag and system.dashpot:
            raise ValueError(f"impedance: a half-space does not go with {scheme.name}, got {system.dashpot!r}")
        self.system = system
        self.scheme = scheme
        self.loading = Loading(system)
        self.M = bands(self.loading.M)
        self.c = scheme.step * bands(self.loading.C)
        self.k = scheme.step**2 * bands(self.loading.K)
        self.matrices = [dashpot_matrix(stage, self.M, self.c, self.k) for stage in scheme.stages]
        self.solvers = [_factorised(matrix) for matrix in self.matrices]

    def run(self, drive: Drive, rows: Observers) -> Array:
        """Return the observed rows at every step, (rows, steps)."""
        dt = self.scheme.step
        push = dt * dt * self.loading.push
        parts = np.column_stack([drive.displacement, drive.velocity, drive.acceleration, drive.pressure])
        by_D, by_V, by_A = self.loading.free(rows)
        by_state = np.hstack([by_D, by_V / dt, by_A / dt**2])
        M = _product(self.M)
        k = _product(self.k)
        c = _product(self.c)
        stages = tuple(zip(self.scheme.stages, self.solvers, strict=True))
        force = push @ parts[0]
        f = self._start(force)
        D = np.zeros_like(f)
        v = late_momentum(self.scheme, D, f)
        ends = parts[len(stages) :: len(stages)]
        observed_values = np.empty((len(by_state), len(ends)))
        coming = iter(parts[1:])
        for n in range(len(ends)):
            v_0 = v
            f_0 = f
            force_0 = force
            inertia_0 = M(f_0) if self.scheme.averages else f_0  # which am = 0 does not look at
            for stage, solve in stages:
                f_g = f
                D = D + predictor(stage, v_0, f_0, v, f_g)
                load = push @ next(coming)
                force = load - c(velocity_corrector(stage, v_0, f_0, f_g, 0 * f)) - k(D)
                f = solve(inertia_force(stage, force, force_0, inertia_0))
                D = D + stage.alpha * f
                v = velocity_corrector(stage, v_0, f_0, f_g, f)
                if self.scheme.averages:
                    force = load - c(v) - k(D)
            observed_values[:, n] = by_state @ np.concatenate((D, v + self.scheme.lag * f, f))
        return observed_values + self.loading.prescribed(rows) @ ends.T

    def _start(self, F: Array) -> Array:
        if self.scheme.start != "consistent":
            return initial_acceleration(self.scheme, F)
        if not self.system.prescribed and self.system.column.springs[0] is not None:
            raise ValueError("start: must be 'zero' where a spring lies between half-space and column")
        return _factorised(self.M)(F)


def bands(matrix: csr_array) -> Array:
    """Return the diagonals of a symmetric matrix, (WIDTH + 1, n), the main one first."""
    n = matrix.shape[0]
    rows = np.zeros((WIDTH + 1, n))
    for offset in range(min(WIDTH + 1, n)):
        rows[offset, : n - offset] = matrix.diagonal(-offset)
    return rows


def _product(matrix: Array) -> Callable[[Array], Array]:
    """Return the product of a matrix with vectors, by one call of BLAS."""
    from scipy.linalg.blas import dsbmv

    rows = np.asfortranarray(matrix)
    return lambda x: np.asarray(dsbmv(WIDTH, 1.0, rows, x, lower=1))


def _factorised(matrix: Array) -> Callable[[Array], Array]:
    """Return the solver of right-hand sides of a positive definite matrix, factorised now."""
    from scipy.linalg import cholesky_banded
    from scipy.linalg.lapack import dpbtrs

    if not np.isfinite(matrix).all():
        raise OverflowError("the matrix of the step is out of range")
    factor = np.asfortranarray(cholesky_banded(matrix, lower=True))

    def solve(right: Array) -> Array:
        solution: Array = dpbtrs(factor, right, lower=1)[0]
        return solution

    return solve
