"""Histories of a block that turns: its steps, cut where the contacts have no single state."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.contact.kernel import shear_law_of
from dda.model.load import BaseMotion
from dda.one_block.contact_result import contact_parts, run_fields
from dda.one_block.solution import check_damping, check_request
from dda.one_block.unilateral import check_scheme
from dda.rotation.body import motion_of
from dda.rotation.model import RollingModel, RollingOptions
from dda.rotation.result import RollingResult, energies, observed
from dda.rotation.step import STATE, make_steps, rolling_equations
from dda.scheme.newmark import Scheme
from dda.stepping.compiled import run_loop
from dda.stepping.driver import base_record, history_of, reached_history

Array = NDArray[np.float64]

COMPILE_TIME = 4.0  # of the loop, over that of contacts which slide freely
PLAIN_STEP = 4e-4  # seconds of plain Python for each step


def base_motion(model: RollingModel) -> BaseMotion | None:
    """Return the motion of the base, along and away from it."""
    return model.load.motion and model.load.motion.along(model.body.to_base)


def solve_rolling(
    model: RollingModel,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    options: RollingOptions | None = None,
) -> RollingResult:
    """Step a block that slides, rocks, topples and rolls over its base.

    Displacements and rotation count from t = 0, strains are those along axes that turn with the block. A numerical
    failure is an outcome, not an exception: the history then ends with the last step that was reached.

    Parameters
    ----------
    model, scheme
        What moves and how it is stepped. The start "consistent" means M A0 = F, since no contact presses at t = 0.
    steps : int
        Number of steps.
    columns : sequence of str
        Any of `dda.COLUMNS`.
    options
        How the steps are made; the defaults if absent.

    Raises
    ------
    ValueError
        If the number of steps is not positive, a column is unknown, or scheme and contact exclude each other.
    """
    check_request(steps, columns)
    check_damping(scheme, True)
    check_scheme(model.contact, scheme)
    options = options or RollingOptions()
    began = perf_counter()
    setting = model.setting(options)
    start = model.start(setting, scheme)
    base = base_motion(model)
    body = rolling_equations(setting, scheme)
    shear_law = shear_law_of(setting.law)
    history = history_of(steps, STATE, len(body.xi), energies=True)
    ready = perf_counter()
    (reached, ended), left, how = run_loop(
        make_steps,
        (body, shear_law, start, start),
        (base_record(base),),
        (history, steps, options.cut),
        steps * PLAIN_STEP,
        COMPILE_TIME,
    )
    history = reached_history(history, reached)
    motion = motion_of(history.motion)
    values = observed(setting.body, motion, history)
    velocity = motion.V[1:, :2] @ model.body.to_base

    def slide() -> Array:
        placed = motion.points(setting.body.xi)[:, :, 0].T
        if base is not None:
            placed = placed - base.at(scheme.step * np.arange(reached + 1.0))[:, 0]
        return placed[:, 1:] - placed[:, :1]

    parts = contact_parts(
        history,
        setting.law.softness,
        slide=slide,
        slipped=lambda: np.abs(history.slipped[1:].T),
        horizontal_velocity=lambda: velocity[:, 0],
        velocity=lambda: velocity[:, 1],
    )
    note = f"stepped, {how}: outline and contacts anew at every step, {setting.rotation} rotation"
    return RollingResult(
        **run_fields(history, ended, scheme, [note], (began, ready)),
        columns={name: values[name] for name in columns},
        unknowns=6,
        nonzeros=int(np.count_nonzero(setting.body.M)),
        factorisations=int(left[0].made[0]),
        base_contacts=setting.body.base,
        parts=parts,
        balance=lambda: energies(setting, motion, history),
        body=setting.body,
        motion=motion,
        history=history,
    )
