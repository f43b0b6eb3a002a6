"""Histories of the two-block model by the robust Newmark step.

They are blocked (`dda.scheme.blocked`) unless the scheme grows or every saving is off; the notes say which.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.one_block.gap_form import COLUMNS, GapForm
from dda.one_block.natural_modes import ModalForm, modal_form
from dda.one_block.two_block import TwoBlockModel, carried
from dda.scheme.blocked import blocked_modes, why_stepped
from dda.scheme.newmark import Scheme, carried_histories, stepped_modes

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Result:
    """Histories and what they cost; element 0 is step 1."""

    time: Array  # (steps,) [s]
    columns: dict[str, Array]  # name -> (steps,), displacements in m, pressure in Pa
    unknowns: int  # number of unknowns that were integrated [-]
    nonzeros: int  # of the matrix that is diagonalised
    factorisations: int  # or diagonalisations
    solves: int  # one a step where it is stepped, none where it is blocked
    notes: tuple[str, ...]  # savings used and warnings, in words
    setup_seconds: float  # assembly and factorisation [s]
    stepping_seconds: float  # the steps [s]


def solve(
    model: TwoBlockModel,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    full: bool = False,
) -> Result:
    """Step the two-block model from rest and return the asked columns.

    The model is linear: it is solved, mode by mode, for a load of 1 Pa and the columns are
    multiplied by the load, so that no load, however large, overflows within. An unstable
    scheme is run as asked; a column is infinite from its first overflow on.

    The error is a few roundings of the modes' contributions. A triangle's contact pressure is a
    small difference of these as long as every mode has hardly begun to move (steps * w dt << 1),
    because its base does not feel the load at once; there its error is small beside the load only.

    Parameters
    ----------
    steps : int
        Number of steps.
    columns : sequence of str
        Any of `dda.COLUMNS`.
    full : bool
        Keep all six unknowns, also those that the load cannot reach, and step.

    Raises
    ------
    ValueError
        If the number of steps is not positive or a column is unknown.
    """
    check_request(steps, columns)
    check_damping(scheme, model.motion is not None)
    began = perf_counter()
    form = model.gap_form if full else model.gap_form.reduced()
    with np.errstate(all="ignore"):
        modal = modal_form(form)
        rows = np.array([form.observers[name] @ modal.shapes for name in columns])
        stepped = _why_stepped(model, scheme, modal, full)
        ready = perf_counter()
        observed = modal_histories(scheme, modal, rows, steps, blocked=stepped is None)
        observed *= model.load_size
        observed += 0.0
        overflow = bound_overflow(observed, model.load_size)
        if model.motion is not None:
            observed += _carried(model, scheme, modal, rows, columns, steps)
            overflow = bound_overflow(observed, 1.0)
    ended = perf_counter()
    return Result(
        time=step_times(scheme, steps),
        columns=dict(zip(columns, observed, strict=True)),
        unknowns=len(form.unknowns),
        nonzeros=int(np.count_nonzero(form.M)),
        factorisations=1,
        solves=steps if stepped else 0,
        notes=(*_savings(form), f"stepped: {stepped}" if stepped else "blocked", *overflow),
        setup_seconds=ready - began,
        stepping_seconds=ended - ready,
    )


def _why_stepped(model: TwoBlockModel, scheme: Scheme, modal: ModalForm, full: bool) -> str | None:
    """Return why the history is stepped, in words; None where it is blocked."""
    if full:
        return "all savings off"
    return "the base moves" if model.motion is not None else why_stepped(scheme, modal.frequencies)


def _carried(
    model: TwoBlockModel, scheme: Scheme, modal: ModalForm, rows: Array, columns: Sequence[str], steps: int
) -> Array:
    """Return the part of the columns that the base's motion causes, (columns, steps)."""
    motion = model.motion
    if motion is None:
        return np.zeros((len(columns), steps))
    instants = scheme.step * np.arange(steps + 1.0)
    histories = carried_histories(scheme, modal.frequencies, modal.translation, motion.at(instants))
    own = carried(motion, instants[1:])
    added: Array = rows @ histories.T + np.array([own.get(name, np.zeros(steps)) for name in columns])
    return added


def modal_histories(scheme: Scheme, modal: ModalForm, rows: Array, steps: int, blocked: bool) -> Array:
    """Return the columns of every step from rest under 1 Pa, (columns, steps); `rows` observe the modes."""
    if not blocked:
        return rows @ stepped_modes(scheme, modal.frequencies, modal.load, steps)
    static = modal.load / modal.frequencies / modal.frequencies
    return blocked_modes(scheme, modal.frequencies, rows * static, steps)


def check_request(steps: int, columns: Sequence[str]) -> None:
    """Raise ValueError unless steps is a positive integer and every column is known."""
    if isinstance(steps, bool) or not isinstance(steps, int) or steps < 1:
        raise ValueError(f"steps: must be a positive integer, got {steps!r}")
    for name in columns:
        if name not in COLUMNS:
            raise ValueError(f"columns: must be among {', '.join(COLUMNS)}, got {name!r}")


def check_damping(scheme: Scheme, moving: bool) -> None:
    """Raise ValueError for viscous damping on a moving base, whose velocity the scheme does not know."""
    if scheme.damped and moving:
        raise ValueError("damping: mass and stiffness damping do not go with a base that moves, got both")


def step_times(scheme: Scheme, steps: int) -> Array:
    """Return the times of step 1 to the last [s]."""
    times = np.arange(1.0, steps + 1)
    times *= scheme.step
    return times


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
    held = np.logical_and.accumulate(finite, axis=1)
    observed[~held] = np.inf
    broken = np.flatnonzero(~np.all(held, axis=0))
    return (f"overflow at step {broken[0] + 1}",) if broken.size else ()


def _savings(form: GapForm) -> tuple[str, ...]:
    """Say which unknowns were kept if not all of them."""
    if len(form.unknowns) == 6:
        return ()
    return (f"{len(form.unknowns)} of 6 unknowns kept: {', '.join(form.unknowns)}",)
