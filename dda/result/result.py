"""The result of a history whose motion is linear, and the checks of every request."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from dda.model.arrays import Array, Columns
from dda.model.checks import check_columns, check_count
from dda.scheme.newmark import Scheme

COLUMNS = (
    "displacement",
    "contact_pressure",
    "horizontal_displacement",
    "rotation",
    "strain_x",
    "strain_y",
    "shear_strain",
)  # of one block, or of the observed point of a system


@dataclass(frozen=True, eq=False)
class Result:
    """Histories and what they cost; element 0 is step 1."""

    time: Array  # (steps,) [s]
    columns: Columns  # name -> (steps,), displacements in m, pressure in Pa
    unknowns: int  # number of unknowns that were integrated [-]
    nonzeros: int  # of the matrix that is diagonalised
    factorisations: int  # or diagonalisations
    solves: int  # one a step where it is stepped, none where it is blocked
    notes: tuple[str, ...]  # savings used and warnings, in words
    setup_seconds: float  # assembly and factorisation [s]
    stepping_seconds: float  # the steps [s]


def check_request(steps: int, columns: Sequence[str]) -> None:
    """Raise ValueError unless steps is a positive integer and every column is known."""
    check_count(steps=steps)
    check_columns(COLUMNS, columns)


def linear_result(
    scheme: Scheme,
    clock: tuple[float, float],
    names: Sequence[str],
    observed: Array,
    size: float,
    notes: tuple[str, ...] = (),
    **work: Any,
) -> Result:
    """Return the result of steps of which none may fail; a column is infinite from its first overflow on.

    The clock has when set-up and steps began [s]; what is `observed`, (columns, steps), is changed where it overflows;
    without the `size` of the loads nothing moves.
    """
    observed += 0.0
    overflow = bound_overflow(observed, size)
    return Result(
        **times_of(scheme, observed.shape[1], *clock),
        columns=dict(zip(names, observed, strict=True)),
        notes=(*notes, *overflow),
        **work,
    )


def times_of(scheme: Scheme, steps: int, began: float, ready: float) -> dict[str, Any]:
    """Return the times of a result: of its steps, and what set-up and steps took, the last ones ending now [s]."""
    return {
        "time": step_times(scheme, steps),
        "setup_seconds": ready - began,
        "stepping_seconds": perf_counter() - ready,
    }


def step_times(scheme: Scheme, steps: int) -> Array:
    """Return the times of step 1 to the last [s]."""
    return scheme.step * np.arange(1.0, steps + 1)


def bound_overflow(observed: Array, pressure: float) -> tuple[str, ...]:
    """Set each column to inf in place from its first overflow, inf or NaN, on; say where.

    Without pressure nothing moves, whatever an unstable scheme makes of a unit load.
    """
    if pressure == 0:
        observed[:] = 0.0
        return ()
    finite = np.isfinite(observed)
    if np.all(finite):
        return ()
    still_finite = np.logical_and.accumulate(finite, axis=1)
    observed[~still_finite] = np.inf
    return (f"overflow at step {np.min(np.sum(still_finite, axis=1)) + 1}",)
