"""Histories of a block that turns: its steps, cut where the contacts have no single state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.one_block.solution import check_damping, check_request, step_times
from dda.one_block.unilateral import COMPLETED, OVERFLOW, check_scheme
from dda.rotation.model import RollingModel, RollingOptions
from dda.rotation.result import RollingResult, observed
from dda.rotation.step import Part, advance
from dda.scheme.cutting import FLOOR
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
            parts, solves, cuts = self._interval(self.parts[-1], number)
            if not parts:
                return
            last = parts[-1]
            if not math.isfinite(float(np.sum(last.state.V) + np.sum(last.state.c))):
                self.outcome = OVERFLOW
                return
            self.parts += parts
            self.ends.append(len(self.parts) - 1)
            self.solves.append(solves)
            self.cuts.append(cuts)

    def _interval(self, last: Part, number: int) -> tuple[list[Part], int, int]:
        """Return the parts of one step of the scheme, none where it cannot be made, with solves and cuts."""
        parts: list[Part] = []
        left = ratio = 1.0
        solves = cuts = 0
        while True:
            own = self.scheme
            if ratio != 1:
                own = replace(own, step=own.step * ratio, gg=own.gg**ratio)
            after = self._base(self.scheme.step * (number + 1 - left + ratio))
            made = advance(self.setting, own, last.state, np.array([last.base, after]))
            solves += made.solves
            if made.state is None:
                if ratio <= FLOOR:
                    self.outcome = str(made.failure)
                    return [], solves, cuts
                ratio, cuts = max(self.options.cut * ratio, FLOOR), cuts + 1
                continue
            last = Part(made.state, own, after)
            parts.append(last)
            if ratio == left:
                return parts, solves, cuts
            left -= ratio
            ratio = left


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
