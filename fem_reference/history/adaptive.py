r"""Histories of the finite-element model with self-adaptive kinetic damping.

With T_n = V_n' M V_n / 2 at the end of step n, the velocity at the start of step n + 1 is gg_(n+1) V_n,

    gg_(n+1) = 1                                    where T_n >= T_(n-1),
    gg_(n+1) = max(floor, sqrt(T_n / T_(n-1)))      where it falls,

the same for all nodes; the first step starts from rest. The motion is not linear and is stepped without any saving in
time.
"""

from __future__ import annotations

import math
import time

import numpy as np

from fem_reference.mesh.model import Model, build
from fem_reference.problem.digits import bounded, front
from fem_reference.problem.problem import Array, Problem, Scheme
from fem_reference.problem.result import COLUMNS, Result, check_request, just_ended
from fem_reference.scheme.newmark import Stepper

ADAPTIVE_COLUMNS = ("discount", "kinetic_damping_loss")
"""Further columns: gg that a step starts with [-], kinetic energy that it has taken up to the step's end [J]."""


def solve_adaptive(
    problem: Problem,
    scheme: Scheme,
    steps: int,
    columns: tuple[str, ...] = ("displacement", "contact_pressure"),
    floor: float = 0.0,
    full: bool = False,
    model: Model | None = None,
) -> Result:
    """Integrate the block from rest, the discount of each step chosen from the kinetic energies before it.

    Parameters
    ----------
    problem, scheme
        What is solved and how it is integrated; the scheme has gg = 1 and no viscous damping.
    steps
        Number of steps, at least 1.
    columns
        Columns of the history, among `fem_reference.COLUMNS` and `ADAPTIVE_COLUMNS`.
    floor
        Least discount, from 0 to 1; with 1 nothing is damped.
    full
        Solve the whole block, without any saving.
    model
        The model of `problem` (and `full`) where it was built before.

    Raises
    ------
    ValueError
        If a number is out of range, a column is unknown, the scheme has a damping of its own, or the base moves.
    """
    _check(problem, scheme, steps, columns, floor)
    began = time.perf_counter()
    model = build(problem, full) if model is None else model
    stepper = Stepper(model.M, model.K, model.F, scheme)
    ready = time.perf_counter()
    history, discount, loss = _stepped(stepper, model, steps, floor)
    size = problem.load_size
    loss *= size * size * (2 if model.kind == "half" else 1)
    every = dict(zip(COLUMNS, bounded(history, size), strict=True))
    every |= dict(zip(ADAPTIVE_COLUMNS, (discount, loss), strict=True))
    return Result(
        **just_ended(scheme.step, steps, began, ready),
        columns={name: every[name] for name in columns},
        unknowns=len(model.F),
        **vars(stepper.work),
        notes=(*model.notes, *front(problem, scheme.step), f"stepped: adaptive discount from {floor:g} to 1"),
    )


def _check(problem: Problem, scheme: Scheme, steps: int, columns: tuple[str, ...], floor: float) -> None:
    check_request(steps, tuple(name for name in columns if name not in ADAPTIVE_COLUMNS))
    if not 0 <= floor <= 1:
        raise ValueError(f"floor: must be from 0 to 1, got {floor!r}")
    if scheme.table is not None:
        raise ValueError(f"scheme: must be 'newmark' where the discount adapts, got {scheme.name!r}")
    if scheme.gg != 1:
        raise ValueError(f"gg: must be 1 where the discount adapts, got {scheme.gg!r}")
    moves = problem.motion is not None
    for name, is_there in (("viscous damping", scheme.damped), ("a moving base", moves), ("a ramp", problem.ramp)):
        if is_there:
            raise ValueError(f"adaptive discount: excludes viscous damping, a moving base and a ramp, got {name}")


def _stepped(stepper: Stepper, model: Model, steps: int, floor: float) -> tuple[Array, Array, Array]:
    """Return all columns, shape (columns, steps), the discounts and the energy taken, for a load of unit size."""
    rows = np.array([model.observers[name] for name in COLUMNS])
    history = np.empty((len(COLUMNS), steps))
    discount = np.ones(steps)
    loss = np.zeros(steps)
    M = stepper.M
    before = energy = 0.0
    # A scheme beyond its limit grows until it overflows; that is the caller's to name.
    with np.errstate(over="ignore", invalid="ignore"):
        state = stepper.start()
        for n in range(steps):
            if energy < before:
                discount[n] = max(floor, math.sqrt(energy / before))
                loss[n] = (1 - discount[n] ** 2) * energy
            state = stepper.advance(state, gg=float(discount[n]))
            history[:, n] = rows @ state.D
            before = energy
            energy = float(state.V @ (M @ state.V)) / 2
    return history, discount, np.cumsum(loss)
