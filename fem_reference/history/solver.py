"""Histories and static values of the finite-element model."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from fem_reference.history.adaptive import ADAPTIVE_COLUMNS, AdaptiveDiscount
from fem_reference.history.reduced import Reduced, reduced
from fem_reference.mesh.fields import FieldWriter
from fem_reference.mesh.model import Model, build
from fem_reference.problem.digits import bounded, coarse
from fem_reference.problem.problem import Array, Problem, Scheme
from fem_reference.problem.result import COLUMNS, Result, check_request, just_ended
from fem_reference.scheme.newmark import Stepper, Work


def solve(
    problem: Problem,
    scheme: Scheme,
    steps: int,
    columns: tuple[str, ...] = ("displacement", "contact_pressure"),
    full: bool = False,
    fields: str | Path | None = None,
    model: Model | None = None,
    floor: float | None = None,
) -> Result:
    """Integrate the block from rest under its loads.

    Parameters
    ----------
    problem, scheme
        What is solved and how it is integrated.
    steps
        Number of steps, at least 1.
    columns
        Columns of the history, among `fem_reference.COLUMNS`, and with a floor among `ADAPTIVE_COLUMNS`.
    full
        Solve the whole block step by step, without any saving.
    fields
        Path of an ``.xdmf`` file (time series) or a ``.vtu`` file (last step) for displacement and stress.
    model
        The model of `problem` (and `full`) where it was built before.
    floor
        Least discount where the kinetic damping adapts, from 0 to 1; with 1 nothing is damped.

    Raises
    ------
    ValueError
        If the block cannot be meshed, or `steps`, `columns`, `fields` or `floor` are not valid.
    """
    adaptive = () if floor is None else ADAPTIVE_COLUMNS
    observed = tuple(name for name in columns if name not in adaptive)
    _check(problem, scheme, steps, observed)
    began = time.perf_counter()
    model = build(problem, full) if model is None else model
    stepper = Stepper(model.M, model.K, model.F, scheme)
    discount = None if floor is None else AdaptiveDiscount(problem, scheme, model.M, floor)
    writer = None if fields is None else FieldWriter(problem, model, Path(fields), scheme.step, steps)
    ready = time.perf_counter()
    small: Reduced | str = "all savings off"
    if floor is not None:
        small = f"adaptive discount from {floor:g} to 1"
    elif not full:
        small = _in_small_space(problem, model, stepper, steps, observed, writer)
    if isinstance(small, str):
        instants = scheme.stage_times(steps)
        moved = None if problem.motion is None else problem.motion(instants)
        shares = problem.load_shares(instants) if problem.ramp else None
        history = run(stepper, model, steps, observed, writer, moved, shares, discount)
        estimate = None
    else:
        history = small.history
        estimate = small.estimate
    every = dict(zip(observed, bounded(history, problem.load_size), strict=True))
    if discount is not None:
        every |= discount.columns(problem.load_size**2 * (2 if model.kind == "half" else 1))
    return Result(
        **just_ended(scheme.step, steps, began, ready),
        columns={name: every[name] for name in columns},
        unknowns=len(model.F),
        **vars(stepper.work),
        notes=(*model.notes, *coarse(problem, scheme.step), _note(small)),
        estimate=estimate,
    )


def _check(problem: Problem, scheme: Scheme, steps: int, columns: tuple[str, ...]) -> None:
    check_request(steps, tuple(columns))
    if scheme.damped and problem.motion is not None:
        raise ValueError("damping: mass and stiffness damping do not go with a base that moves, got both")


def _note(small: Reduced | str) -> str:
    return f"stepped: {small}" if isinstance(small, str) else f"blocked in {small.vectors} Krylov vectors"


def _in_small_space(
    problem: Problem, model: Model, stepper: Stepper, steps: int, columns: tuple[str, ...], writer: FieldWriter | None
) -> Reduced | str:
    """The history in a Krylov space, or why it must be stepped."""
    if problem.motion is not None:
        return "the base moves"
    if problem.ramp:
        return "the load rises in a ramp"
    if writer is not None:
        return "fields are written"
    if stepper.scheme.damped:
        return "viscous damping"
    return reduced(stepper, _rows(model, columns), steps)


def _rows(model: Model, columns: tuple[str, ...]) -> Array:
    """Rows that observe the columns, shape (columns, unknowns)."""
    return np.array([model.observers[name] for name in columns]).reshape(len(columns), len(model.F))


def run(
    stepper: Stepper,
    model: Model,
    steps: int,
    columns: tuple[str, ...],
    writer: FieldWriter | None,
    moved: Array | None = None,
    shares: Array | None = None,
    discount: AdaptiveDiscount | None = None,
) -> Array:
    """Observe every step for a load of unit size; shape (columns, steps).

    `moved` is the displacement of the base at the scheme's `stage_times`, shape (instants, 2) [m], None where it is
    fixed, and `shares` is what acts of the load then, shape (instants,), None where it is constant.
    """
    rows = _rows(model, columns)
    history = np.empty((len(columns), steps))
    forces = None if shares is None else shares[:, None] * model.F
    if moved is not None:
        forces = (model.F if forces is None else forces) + moved @ model.base_force.T
    stages = len(stepper.scheme.stages)
    # A scheme beyond its limit grows until it overflows; that is the caller's to name.
    with np.errstate(over="ignore", invalid="ignore"):
        for n, state in enumerate(stepper.states(steps, forces, discount)):
            history[:, n] = rows @ state.D
            if writer is not None:
                writer.record(n + 1, state.D)
    if writer is not None:
        writer.close()
    if moved is not None and "contact_pressure" in columns:
        history[columns.index("contact_pressure")] += moved[stages::stages] @ model.base_pressure
    return history


def static(problem: Problem, full: bool = False, model: Model | None = None) -> dict[str, float]:
    """Value of every column at rest under the constant loads, on the base's last position: K^-1 F observed."""
    model = build(problem, full) if model is None else model
    moved = np.zeros(2) if problem.motion is None else problem.motion(np.array([np.inf]))[0]
    D = Work().factor(model.K)(model.F + model.base_force @ moved)
    values = {name: float(problem.load_size * (model.observers[name] @ D)) for name in COLUMNS}
    values["contact_pressure"] += float(model.base_pressure @ moved)
    return values
