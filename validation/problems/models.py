"""Runs of a problem by which answers are explained: exact but for rounding, or DDA's own by a scheme at the steps."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from validation.diagnosis.fits.bar import norm
from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.hooks import DiagnosisHooks
from validation.diagnosis.sentences import scheme_words
from validation.errors import InputError
from validation.problems.bands import Standard
from validation.problems.truth import truth_of
from validation.runs.history import Array, History
from validation.runs.run import Outcome
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.scenes.tables import TimeSection
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, get_solver

FINER = (8, 32, 128)  # steps in one of the scene's, of which the first that is accurate is taken
LONG = 64  # more steps than that in one of the scene's are run for linear scenes only, whose steps cost nothing
PARTS = 8  # of a step of the scene, at which an exact solution is kept: answers between steps are seen in it
ACCURATE = 0.06  # of the band: what a run that stands for the exact motion may be away from it
INTERCHANGED = "alpha and delta are interchanged"
AHEAD = 0.12  # of the duration, that such a run goes on: a motion that is too fast is seen in it
MOST_SAMPLES = 20_000  # runs that are kept: some 100 MB of the longest
Columns = Mapping[str, Array]


@dataclass(frozen=True)
class Base:
    """A way to run a problem, mostly by DDA: a scheme and how many of its steps make one of the scene's."""

    words: str  # the scheme's; empty where the run stands for the exact motion
    values: Mapping[str, Any]
    every: int = 1
    usual: bool = False  # whether wrong numbers are looked for in runs of it as well
    solver: str = ""  # an exact solution that runs it; empty where it is DDA

    @property
    def exact(self) -> bool:
        """Whether the run stands for the exact motion."""
        return not self.words

    def alpha(self, time: TimeSection) -> float:
        """Return its alpha, where it states none that of the scene."""
        return float(self.values.get("time.alpha", time.alpha))

    def delta(self, time: TimeSection) -> float:
        """Return its delta, where it states none that of the scene."""
        return float(self.values.get("time.delta", time.delta))


@functools.lru_cache(maxsize=2)
def runs_of(scene: Scene, reference: Standard) -> Runs:
    """Return the runs of a scene, shared by all answers that are judged by one standard."""
    return Runs(scene, reference)


@dataclass(eq=False)
class Runs:
    """Runs of one scene: each is made once, at the steps of the scene, for all answers to it."""

    scene: Scene
    standard: Standard
    samples: dict[str, Columns | None] = field(default_factory=dict)

    def dense(self, base: Base, values: Mapping[str, Any] | None = None) -> History | None:
        """Return a run at its own steps with other data, None where its solver cannot run it."""
        return _run_by(self.scene, self._stepped(base, values or {}), base.solver or by_role(Role.JUDGED)[0])

    def _stepped(self, base: Base, values: Mapping[str, Any]) -> dict[str, Any]:
        t = self.scene.time
        steps = math.ceil(t.steps * (1 + AHEAD)) if base.exact else t.steps
        return {**base.values, "time.step": t.step / base.every, "time.steps": steps * base.every, **values}

    def sampled(self, base: Base, values: Mapping[str, Any] | None = None) -> Columns | None:
        """Return a run at the steps of the scene."""
        key = base.solver + json.dumps(self._stepped(base, values or {}), sort_keys=True)
        if key not in self.samples:
            if len(self.samples) >= MOST_SAMPLES:
                self.samples.clear()
            run = self.dense(base, values)
            rows = slice(base.every - 1, self.scene.time.steps * base.every, base.every)
            self.samples[key] = None if run is None else {name: x[rows].copy() for name, x in run.columns.items()}
        return self.samples[key]

    def apart(self, answer: Columns, columns: Columns) -> float:
        """Return the largest difference of columns over the exact motion's norm and over its band; inf if not finite.

        Columns that one of them lacks, and rows that are not judged, do not count.
        """
        shares = [0.0]
        for name, band in self.standard.bands.items():
            if name in answer and name in columns:
                size = norm(self.standard.exact.columns[name][: band.rows])
                with np.errstate(all="ignore"):
                    gap = norm(answer[name][: band.rows] - columns[name][: band.rows])
                shares.append(gap / (size * band.high) if math.isfinite(gap) else math.inf)
        return max(shares)

    def exact(self) -> Base | None:
        """Return the cheapest run that stands for the exact motion, None where none comes near enough."""
        for base in self._accurate():
            columns = self.sampled(base)
            if columns is not None and self.apart(columns, self.standard.exact.columns) <= ACCURATE:
                return base
        return None

    def _accurate(self) -> Iterator[Base]:
        if features.OF_MOVING_COLUMN & {*features.of(self.scene)}:
            # more blocks would be more contacts, and elastic bars need so many that the exact solution costs less
            yield Base("", {}, PARTS, solver=truth_of(self.scene).name)
            return
        values = DiagnosisHooks.of(self.scene).accurate(self.scene)
        yield Base("", {})
        for every in FINER:
            if every <= LONG or features.linear(self.scene):
                yield Base("", values, every)

    def schemes(self) -> Iterator[Base]:
        """Yield the schemes by which programs step, at the steps of the scene and, the usual ones, at parts of them."""
        t, slow = self.scene.time, features.ROTATION in features.of(self.scene)
        scene_pair = (t.alpha, t.delta)
        yield Base(scheme_words(*scene_pair, t.discount), {}, usual=True)
        if slow:
            return
        for pair in dict.fromkeys([scene_pair, *NAMED.values()]):
            for start in ("zero", "consistent"):
                if (pair, start) != (scene_pair, t.start):
                    usual = (pair, start) == (NAMED["average acceleration"], "consistent")
                    words = f"{scheme_words(*pair, t.discount)}, initial acceleration {start}"
                    yield Base(words, {"time.alpha": pair[0], "time.delta": pair[1], "time.start": start}, usual=usual)
        for pair in dict.fromkeys([scene_pair, NAMED["constant acceleration"], NAMED["average acceleration"]]):
            alpha, delta = reversed(pair)
            if alpha != delta:
                words = f"{INTERCHANGED}, {scheme_words(alpha, delta, t.discount)}"
                yield Base(words, {"time.alpha": alpha, "time.delta": delta})
        for every in (2, 4):
            for pair in dict.fromkeys([scene_pair, (0.25, 0.5)]):
                values = {"time.alpha": pair[0], "time.delta": pair[1], "time.start": "consistent"}
                words = f"{scheme_words(*pair, t.discount)} at a step of {t.step / every:g} s"
                yield Base(words, values, every)


def _run_by(scene: Scene, values: Mapping[str, Any], name: str) -> History | None:
    try:
        changed = scene.with_values(dict(values))
        solver = get_solver(name)
        if solver.refusal(changed) is not None:
            return None
        with np.errstate(all="ignore"):
            run = solver.solve(changed)
    except (InputError, ArithmeticError, ValueError):
        return None
    whole = run.outcome is Outcome.COMPLETED and run.history is not None
    return run.history if whole else None
