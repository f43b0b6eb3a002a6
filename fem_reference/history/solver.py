"""Histories and static values of the finite-element model."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from fem_reference.history.adaptive import ADAPTIVE_COLUMNS, AdaptiveDiscount
from fem_reference.history.reduced import reduced
from fem_reference.mesh.fields import frames_of, write_fields
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
    columns
        Among `fem_reference.COLUMNS`, and with a floor among `ADAPTIVE_COLUMNS`.
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
    check_request(steps, observed)
    if scheme.damped and problem.motion is not None:
        raise ValueError("damping: mass and stiffness damping do not go with a base that moves, got both")
    began = time.perf_counter()
    model = build(problem, full) if model is None else model
    stepper = Stepper(model.M, model.K, model.F, scheme)
    discount = None if floor is None else AdaptiveDiscount(problem, scheme, model.M, floor)
    frames = [] if fields is None else frames_of(Path(fields), steps)
    kept = dict.fromkeys(frames, np.zeros(0))
    ready = time.perf_counter()
    reasons = {
        f"adaptive discount from {floor or 0:g} to 1": floor is not None,
        "all savings off": full,
        "the base moves": problem.motion is not None,
        "the load rises in a ramp": problem.ramp > 0,
        "fields are written": fields is not None,
        "viscous damping": scheme.damped,
    }
    reason = next((reason for reason, holds in reasons.items() if holds), None)
    small = reason or reduced(stepper, model.rows(observed), steps)
    if isinstance(small, str):
        instants = scheme.stage_times(steps)
        moved = None if problem.motion is None else problem.motion(instants)
        shares = np.minimum(instants / problem.ramp, 1.0) if problem.ramp else None
        history = run(stepper, model, steps, observed, moved, shares, discount, kept)
        estimate = None
        how = f"stepped: {small}"
    else:
        history = small.history
        estimate = small.estimate
        how = f"blocked in {small.vectors} Krylov vectors"
    if fields is not None:
        write_fields(problem, model, Path(fields), {scheme.step * number: D for number, D in kept.items()})
    every = dict(zip(observed, bounded(history, problem.load_size), strict=True))
    if discount is not None:
        every |= discount.columns(problem.load_size**2 * (2 if model.kind == "half" else 1))
    return Result(
        **just_ended(scheme.step, steps, began, ready),
        columns={name: every[name] for name in columns},
        unknowns=len(model.F),
        **vars(stepper.work),
        notes=(*model.notes, *coarse(problem, scheme.step), how),
        estimate=estimate,
    )


def run(
    stepper: Stepper,
    model: Model,
    steps: int,
    columns: tuple[str, ...],
    moved: Array | None = None,
    shares: Array | None = None,
    discount: AdaptiveDiscount | None = None,
    out: dict[int, Array] | None = None,
) -> Array:
    """Observe every step for a load of unit size; shape (columns, steps).

    `moved` is the displacement of the base at the scheme's `stage_times`, shape (instants, 2) [m], None where it is
    fixed, and `shares` is what acts of the load then, shape (instants,), None where it is constant. Displacements at
    the steps that are keys of `out` are put there.
    """
    rows = model.rows(columns)
    history = np.empty((len(columns), steps))
    forces = None if shares is None else shares[:, None] * model.F
    if moved is not None:
        forces = (model.F if forces is None else forces) + moved @ model.base_force.T
    stages = len(stepper.scheme.stages)
    # A scheme beyond its limit grows until it overflows; that is the caller's to name.
    with np.errstate(over="ignore", invalid="ignore"):
        for n, state in enumerate(stepper.states(steps, forces, discount)):
            history[:, n] = rows @ state.D
            if out and n + 1 in out:
                out[n + 1] = state.D
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
