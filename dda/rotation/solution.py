"""Histories of a block that turns: its steps, cut where the contacts have no single state."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.model.load import BaseMotion
from dda.one_block.contact_result import early_end
from dda.one_block.solution import check_damping, check_request, step_times
from dda.one_block.unilateral import check_scheme
from dda.rotation.energy import energies
from dda.rotation.model import RollingModel, RollingOptions
from dda.rotation.result import RollingResult, observed, parts_of
from dda.rotation.step import RollingHistory, history_of, make_steps, rolling_equations
from dda.scheme.newmark import Scheme
from dda.stepping.compiled import run_loop
from dda.stepping.driver import OUTCOMES, base_record, counts_of, reached_rows

Array = NDArray[np.float64]

PLAIN_STEP = 4e-4  # seconds of plain Python for each step


def base_motion(model: RollingModel) -> BaseMotion | None:
    """Return the motion of the base, along and away from it."""
    motion = model.load.motion
    if motion is None:
        return None
    return BaseMotion(motion.time, np.asarray(motion.displacement, dtype=float) @ model.body.to_base.T)


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
    motion = base_motion(model)
    body = rolling_equations(setting, scheme)
    history, counts = history_of(body.corners, steps), counts_of(steps, True)
    ready = perf_counter()
    (reached, outcome), left, how = run_loop(
        make_steps,
        (body, start, start),
        (base_record(motion),),
        (history, counts, steps, options.cut),
        steps * PLAIN_STEP,
    )
    history = RollingHistory(*reached_rows(history, reached))
    values = observed(setting.body, start, history)
    instants = scheme.step * np.arange(reached + 1.0)
    base = np.zeros(reached + 1) if motion is None else motion.at(instants)[:, 0]
    return RollingResult(
        time=step_times(scheme, reached),
        columns={name: values[name] for name in columns},
        unknowns=6,
        nonzeros=int(np.count_nonzero(setting.body.M)),
        factorisations=int(left[0].made[0]),
        solves=int(counts.solves[:reached].sum()),
        notes=(
            f"stepped, {how}: outline and contacts anew at every step, {setting.rotation} rotation",
            *early_end(outcome, reached),
        ),
        setup_seconds=ready - began,
        stepping_seconds=perf_counter() - ready,
        outcome=OUTCOMES[outcome],
        step_solves=counts.solves[:reached],
        step_cuts=counts.cuts[:reached],
        base_contacts=setting.body.base,
        parts=parts_of(setting.body, start, history, base, body.law.softness),
        balance=lambda: energies(setting, start, history, counts.losses[:reached]),
        body=setting.body,
        start=start,
        history=history,
    )
