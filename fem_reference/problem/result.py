"""What a solver of this package returns."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array

COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement", "rotation")
"""Columns of a history: v at the centroid [m], mean base pressure [Pa], u and rotation at the centroid [m, 1]."""


@dataclass(frozen=True, kw_only=True)
class Result:
    """A history with its work counts; row 0 is step 1."""

    time: Array  # [s], shape (steps,)
    columns: dict[str, Array]  # one array of shape (steps,) for each asked column, in the units of `COLUMNS`
    unknowns: int  # that were integrated [-]
    nonzeros: int = 0  # of the matrix that was factorised [-]
    factorisations: int = 0
    solves: int = 0  # with a factorised matrix [-]
    notes: tuple[str, ...] = ()  # savings used and warnings, in words
    setup_seconds: float  # assembly and factorisation [s]
    stepping_seconds: float  # the steps [s]
    estimate: float | None = None  # estimated error over the maximum value [-]; None where none is made
    outcome: str | None = None  # of contacts: ``"completed"``, or why the history ends early


def just_ended(step: float, rows: int, began: float, ready: float) -> dict[str, Any]:
    """The instants and the times of a history of so many rows that has just ended, as fields of its result.

    The `step` is that of the scheme; its model was `began`, and `ready` for its first step, at instants [s].
    """
    return {
        "time": step * np.arange(1, rows + 1),
        "setup_seconds": ready - began,
        "stepping_seconds": perf_counter() - ready,
    }


@dataclass(frozen=True)
class Mode:
    """A natural mode and what one step of the scheme makes of it."""

    frequency: float  # w [rad/s]
    share: float  # of the static response, (phi'F)^2 / (w^2 F'D_static) [-]
    eigenvalues: NDArray[np.complex128]  # of the mode's own step, the complex pair first, shape (3,)


def check_request(steps: int, columns: tuple[str, ...], known: tuple[str, ...] = COLUMNS) -> None:
    """Raise a `ValueError` for a number of steps below one, or a column that is unknown."""
    require(steps >= 1, "steps", "must be at least 1", steps)
    for name in columns:
        require(name in known, "columns", f"must be among {known}", name)
