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
from validation.diagnosis.numbers import AVERAGE
from validation.diagnosis.one_change import of_schemes, run_of
from validation.diagnosis.sentences import scheme_words
from validation.problems.bands import Standard
from validation.problems.truth import truth_of
from validation.runs.history import Array, History
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.scenes.tables import TimeSection
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

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
    solver: str = by_role(Role.JUDGED)[0]  # DDA, or an exact solution that runs it

    @property
    def exact(self) -> bool:
        """Whether the run stands for the exact motion."""
        return not self.words

    def pair(self, time: TimeSection) -> tuple[float, float]:
        """Return its alpha and delta, those of the scene where it states none."""
        return float(self.values.get("time.alpha", time.alpha)), float(self.values.get("time.delta", time.delta))


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
        return run_of(self.scene, self._stepped(base, values or {}), base.solver)

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

    def shares(self, answer: Columns, columns: Columns) -> list[Array]:
        """Return the difference of each column in the rows that are judged over the exact motion's norm and its band.

        Columns that one of them lacks are left out.
        """
        exact = self.standard.exact.columns
        with np.errstate(all="ignore"):
            return [
                (answer[name] - columns[name])[: band.rows] / (norm(exact[name][: band.rows]) * band.high)
                for name, band in self.standard.bands.items()
                if name in answer and name in columns
            ]

    def apart(self, answer: Columns, columns: Columns) -> float:
        """Return the largest norm of the `shares`; inf if not finite."""
        with np.errstate(all="ignore"):
            norms = [0.0, *map(norm, self.shares(answer, columns))]
        return float(np.max(np.nan_to_num(norms, nan=math.inf, posinf=math.inf)))

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
        t = self.scene.time
        own = t.alpha, t.delta
        yield Base(scheme_words(*own, t.discount), {}, usual=True)
        if features.ROTATION in features.of(self.scene):  # whose runs take long
            return
        for change in of_schemes(self.scene):
            values = change.changed(0.0)
            words = scheme_words(values["time.alpha"], values["time.delta"], t.discount)
            usual = values.items() >= AVERAGE.items()
            yield Base(f"{words}, initial acceleration {values['time.start']}", values, usual=usual)
        for alpha, delta in (own, NAMED["constant acceleration"], NAMED["average acceleration"]):
            if alpha != delta:
                words = f"{INTERCHANGED}, {scheme_words(delta, alpha, t.discount)}"
                yield Base(words, {"time.alpha": delta, "time.delta": alpha})
        for every in (2, 4):
            for alpha, delta in (own, NAMED["average acceleration"]):
                words = f"{scheme_words(alpha, delta, t.discount)} at a step of {t.step / every:g} s"
                yield Base(words, AVERAGE | {"time.alpha": alpha, "time.delta": delta}, every)
