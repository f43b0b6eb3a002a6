"""Histories of a block that turns: its steps, cut where the contacts have no single state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.one_block.solution import check_damping, check_request, step_times
from dda.one_block.unilateral import COMPLETED, OVERFLOW, check_scheme
from dda.rotation.model import RollingModel, RollingOptions
from dda.rotation.result import RollingResult, observed
from dda.rotation.step import Made, Part, advance
from dda.scheme.cutting import in_parts
from dda.scheme.newmark import Scheme

Array = NDArray[np.float64]


class Rolling:
    """The steps of one block."""

    def __init__(self, model: RollingModel, scheme: Scheme, options: RollingOptions) -> None:
        self.model, self.scheme, self.options = model, scheme, options
        self.setting = model.setting(options)
        self.parts = [Part(model.start(self.setting, scheme), scheme, self._base(0.0))]  # after that at t = 0
        self.ends: list[int] = []  # part with which each step ends
        self.solves: list[int] = []
        self.cuts: list[int] = []
        self.outcome = COMPLETED

    def _base(self, time: float) -> Array:
        """Return the displacement of the base along and away from it [m]."""
        motion = self.model.load.motion
        if motion is None:
            return np.zeros(2)
        moved: Array = self.model.body.to_base @ motion.at([time])[0]
        return moved

    def run(self, steps: int) -> None:
        """Make the steps that are reached; `outcome` says how it ended."""
        for number in range(steps):
            made = in_parts(partial(self._attempt, number), self.parts[-1], self.options.cut)
            if made.failure is not None:
                self.outcome = made.failure
                return
            parts = [after for _, _, after in made.parts]
            if not math.isfinite(float(np.sum(parts[-1].state.V) + np.sum(parts[-1].state.c))):
                self.outcome = OVERFLOW
                return
            self.parts += parts
            self.ends.append(len(self.parts) - 1)
            self.solves.append(made.solves)
            self.cuts.append(made.cuts)

    def _attempt(self, number: int, last: Part, begun: float, ratio: float) -> tuple[Part | None, Made]:
        """Return a part of step `number`, where it begins and how long it is in steps; None where it has no state."""
        own = self.scheme
        if ratio != 1:
            own = replace(own, step=own.step * ratio, gg=own.gg**ratio)
        after = self._base(self.scheme.step * (number + begun + ratio))
        made = advance(self.setting, own, last.state, np.array([last.base, after]))
        return None if made.state is None else Part(made.state, own, after), made


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
    began = perf_counter()
    rolling = Rolling(model, scheme, options or RollingOptions())
    ready = perf_counter()
    with np.errstate(all="ignore"):
        rolling.run(steps)
    return _result(rolling, columns, began, ready)


def _result(rolling: Rolling, columns: Sequence[str], began: float, ready: float) -> RollingResult:
    made = len(rolling.ends)
    ended = () if rolling.outcome == COMPLETED else (f"{rolling.outcome} at step {made + 1}",)
    states = [rolling.parts[end].state for end in rolling.ends]
    seen = observed(rolling.setting.body, rolling.parts[0].state, states)
    return RollingResult(
        time=step_times(rolling.scheme, made),
        columns={name: seen[name] for name in columns},
        unknowns=6,
        nonzeros=int(np.count_nonzero(rolling.setting.body.M)),
        factorisations=len(rolling.parts) - 1,
        solves=sum(rolling.solves),
        notes=(f"stepped: outline and contacts anew at every step, {rolling.setting.rotation} rotation", *ended),
        setup_seconds=ready - began,
        stepping_seconds=perf_counter() - ready,
        outcome=rolling.outcome,
        setting=rolling.setting,
        parts=rolling.parts,
        ends=rolling.ends,
        step_solves=np.array(rolling.solves, dtype=int),
        step_cuts=np.array(rolling.cuts, dtype=int),
    )
